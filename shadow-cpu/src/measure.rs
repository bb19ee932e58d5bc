//! How wrong a frame is, and why: every wrong pixel gets one cause.
//!
//! A [`Judge`] traces what a camera sees once; [`Judge::judge`] then says of any renderer's frame of the same view how far its visibilities are from the
//! truth, and why. A pixel is wrong if its visibility is not exactly the truth of the light's centre, 0 or 1. Its [`Cause`] is decided by the taps that
//! made it: the texels that the filter weighted. Each tap's centre is projected along the light onto the receiver's plane, and rays say whether
//! that point sees the light. With causes that are defined so, a bias that is enough for planes leaves no acne on any geometry: what is left is for
//! resolution and filtering to answer for.
//!
//! ```
//! use shadow_cpu::{CpuRenderer, RasterRules, measure::{Cause, Judge}, trace::{CameraView, Sampling, Tracer}};
//! use shadow_math::{Bias, ShadowSettings};
//! use shadow_scene::{FramePlan, Request, builtin};
//!
//! let scene = builtin::box_on_plane();
//! let camera = scene.cameras()[0].camera;
//! let tracer = Tracer::new(&scene, 0)?;
//! let judge = Judge::new(&tracer, CameraView::new(&camera, 64, 36), Sampling::default(), &|| {});
//!
//! let renderer = CpuRenderer::new(0, RasterRules::default())?;
//! let prepared = renderer.prepare(&scene);
//! let acne = |bias| {
//!     let settings = ShadowSettings { bias, map_size: 256, ..ShadowSettings::default() };
//!     let plan = FramePlan::new(&scene, &camera, &settings, 64, 36, None)?;
//!     let frame = renderer.render(&prepared, &plan, Request::ALL)?.frame;
//!     Ok::<_, Box<dyn std::error::Error>>(judge.judge(&plan, &frame)?.total().count(Cause::Acne))
//! };
//! assert_eq!(acne(Bias::default())?, 0);
//! assert!(acne(Bias::NONE)? > 100);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cause;
mod taps;
mod judge;
mod regions;
mod stability;
mod rule;
mod gaps;
mod trials;
mod aliasing;

pub use self::{
    aliasing::{AliasingStatistics, FrameAliasing, LightAliasing, MIN_COSINE, NO_STRETCH},
    cause::{Cause, Counts},
    gaps::{Needs, Price},
    judge::{Ask, Judge, JudgeError, Judgement, LightJudgement},
    regions::Region,
    rule::{AlongNormal, ENGINES, EngineRule, Rule},
    stability::{Moment, Stability},
    trials::{Lengths, Onset, Trial, Trials, WIDER},
};
