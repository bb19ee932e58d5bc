//! The tests across crates: one program, one file a topic.

mod acne;
mod agreement;
mod analytic;
mod comparator;
mod import;
mod invariants;
mod judge;
mod layout;
mod limits;
mod malformed;
mod matrix;
mod mirrors;
mod planar_bias;
mod poses;
mod program;
mod program_files;
mod program_presets;
mod program_rival;
mod program_scenes;
mod stores;
mod sweep;
mod terminator;
mod tidy;
mod truth;
mod tune;
