//! The mathematics of shadow mapping, without a renderer.
//!
//! This crate says where the samples of a shadow map go, how much bias a lookup needs, how depth tests are averaged and
//! what a lit pixel looks like.
//! It draws nothing: a renderer asks it for a [`plan`] (plain data, computed once a frame), renders the maps that the plan
//! describes, and calls [`visibility()`] for every receiver.
//!
//! ```
//! use shadow_math::{
//!     Light, LightKind, MapAccess, Receiver, ShadowSettings, bounds::Aabb, fit, glam::Vec3, plan, visibility,
//! };
//!
//! // A sun over a scene of 10 m.
//! let sun = Light { kind: LightKind::Directional { direction: Vec3::new(0.3, -1.0, 0.2) }, color: Vec3::ONE, intensity: 80_000.0 };
//! let scene = Aabb::new(Vec3::splat(-5.0), Vec3::splat(5.0));
//! let mut views = [plan::ViewPlan::default(); plan::MAX_VIEWS_PER_LIGHT];
//! let casters = [scene];
//! let subject = fit::Subject::unseen(&casters, scene);
//! let light = plan::plan_light(&sun, &subject, &ShadowSettings::default(), [0, 0], &mut views)?;
//! assert_eq!(light.view_count, 1);
//! assert!(views[0].texel_metres[0] < 0.01, "one texel of the map covers about 8 mm");
//!
//! // The renderer draws the map with this matrix (see below); here something 3 m above the origin shades all of it.
//! let blocker = views[0].clip_from_world().project_point3(Vec3::Y * 3.0).z;
//! struct Map(f32);
//! impl MapAccess for Map {
//!     fn fetch_texel(&self, _layer: u32, _x: u32, _y: u32) -> f32 {
//!         self.0
//!     }
//! }
//! let floor = Receiver::new(Vec3::ZERO, Vec3::Y);
//! assert_eq!(visibility(&light, &views, &Map(blocker), &floor), 0.0);
//! assert_eq!(visibility(&light, &views, &Map(1.0), &floor), 1.0);
//! # Ok::<(), shadow_math::PlanError>(())
//! ```
//!
//! # Drawing a map
//!
//! Each [`plan::ViewPlan`] is one depth pass. Draw all casters, none of them culled, with [`plan::ViewPlan::clip_from_world`] (or its rows, summed in
//! ascending order, to repeat this project's bits) into layer `layer` at rectangle `rect`, as deep and as wide as the settings' `map_size`: depth z / w from
//! 0 at the near plane, the nearest wins, cleared to 1; rows of texels count downward, as in WebGPU, Vulkan and Direct3D. Add no depth bias: it is in the lookup.
//!
//! [`plan::plan_light`] writes the views of one light to the slice it is lent, which must hold [`plan::view_count`] of them; [`visibility()`] takes the views
//! of the whole frame, in which the light's `first_view` counts.
//!
//! # Main types
//!
//! - [`Camera`] and [`Light`] describe what is to be seen; [`ShadowSettings`] says by which technique.
//! - [`plan::LightPlan`] and [`plan::ViewPlan`] are what both renderers consume, byte for byte.
//! - [`Receiver`] is a point that asks whether it is lit, [`MapAccess`] the way to the shadow maps.
//!
//! # Conventions
//!
//! World space is right-handed with y up, in metres; views look along -z; vectors are columns; angles are radians; colours are
//! linear. [`spaces`] defines every space once. Positions are relative to an origin that the scene keeps in double precision.
//!
//! # Two kinds of arithmetic
//!
//! What is computed once a frame (matrices, fits, bounds on rounding) is computed in `f64` and rounded once.
//! What is computed once a pixel is `f32`, uses only `+ - * /` and `sqrt`, in an order that is written out, so that a
//! shader which repeats the statements repeats the bits. Those modules name the shader file that mirrors them.
//!
//! # Features
//!
//! - `std` (default) takes square roots and trigonometry from the standard library.
//! - `libm` takes them from the `libm` crate. One of the two is required; the crate itself never needs `std` or a heap.
//! - `serde` derives serialisation for settings, cameras and lights.

#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "std")]
extern crate std;

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("shadow-math needs square roots and trigonometry: enable the feature `std` or the feature `libm`");

pub use glam;

mod float;

pub mod vector;
pub mod spaces;
pub mod bounds;
pub mod camera;
pub mod frustum;
pub mod polytope;
pub mod rectangle;
pub mod splits;
pub mod light;
pub mod settings;
pub mod depth;
pub mod gradient;
pub mod caster;
pub mod rounding;
pub mod fit;
pub mod plan;
pub mod triangle;
pub mod bias;
pub mod filter;
pub mod visibility;
pub mod aliasing;
pub mod approx;
pub mod srgb;
pub mod material;
pub mod picture;
pub mod shade;
pub mod exposure;

pub use camera::{Camera, CameraError, Projection};
pub use light::{Light, LightError, LightKind, LightShape};
pub use plan::PlanError;
pub use settings::{
    Bias, Cascades, Composition, Filter, Fit, FitFrom, Selection, ShadowSettings, Split, SplitScheme, Store, Terminator, Texels,
};
pub use visibility::{MapAccess, Receiver, visibility};
