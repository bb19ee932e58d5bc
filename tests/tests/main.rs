//! The tests across crates: one program, one file a topic.

mod tidy;
mod invariants;
mod layout;
mod mirrors;
mod comparator;
mod analytic;
mod truth;
mod judge;
mod acne;
mod tune;
mod planar_bias;
mod limits;
mod import;
mod poses;
mod malformed;
mod agreement;
mod sweep;
mod program;
mod program_files;
mod program_scenes;
mod probe;
