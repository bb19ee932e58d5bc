//! Scenes in, frames out: what both renderers take and what they give.
//!
//! A [`Scene`] is fully resolved: triangles in world space, materials without defaults, lights and cameras that can be used as
//! they are. It comes from a glTF 2.0 file ([`import()`]), from code ([`SceneBuilder`]) or is [built in](builtin).
//! A [`FramePlan`] says how it is to be rendered, and a [`Frame`] is the result: a set of named layers: colour, depth, triangle
//! numbers, one visibility per light, and the shadow maps. [`compare`] judges whether two frames of the same plan agree.
//!
//! Only [`import()`] touches files; nothing here prints or exits.

#![forbid(unsafe_code)]

pub mod scene;
pub mod source;
pub mod builder;
pub mod import;
pub mod builtin;
pub mod surfaces;
pub mod feedback;
pub mod frame_plan;
pub mod frame;
pub mod compare;

pub use builder::{Mesh, SceneBuilder, SceneError};
pub use feedback::Feedback;
pub use frame::{Frame, FrameMaps, Layer, LayerName, NO_TRIANGLE, Pixels, Request, StageTimes};
pub use frame_plan::{FramePlan, FramePlanError, LightPasses};
pub use import::{Choice, ImportError, ImportOptions, import, import_with};
pub use scene::{Alpha, Image, Instance, Material, Pass, Scene, SceneCamera, SceneLight, Texture, Vertices, Wrap};
pub use source::{AnimationFacts, ImageFacts, SourceFacts};
pub use surfaces::Surfaces;
