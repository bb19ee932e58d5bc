//! The plan of a frame: plain data, computed once, that both renderers follow byte for byte.
//!
//! A [`CameraPlan`] says how the picture is taken, a [`LightPlan`] how a light shines and which of the [`ViewPlan`]s are its
//! maps. The caller lends the memory, so there is no heap and no small maximum.
//!
//! All types are `repr(C)` and `Pod`, laid out as WGSL lays out storage buffers; `plan.wgsl` repeats them.

mod build;
mod check;
mod data;
mod error;
mod lengths;
mod pancake;
mod view;
mod views;

pub use build::{plan_camera, plan_light, plan_unshadowed_light};
pub use check::check_settings;
pub use data::{
    BIAS_AUTOMATIC, BIAS_BACK_FACES, BIAS_CONSTANT, BIAS_NONE, BIAS_NORMAL_OFFSET, BIAS_OGRE_2006, BIAS_POLYGON_OFFSET,
    BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, BIAS_SLOPE, COMPOSE_ADDITIVE, COMPOSE_FACTOR, COMPOSE_MODULATIVE,
    COMPOSE_UNSHADOWED, CameraPlan, FILTER_BILINEAR, FILTER_CROSS, FILTER_DISC, FILTER_FOOTPRINT, FILTER_HARD, FILTER_SEPARABLE,
    LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT, LightPlan, MAX_VIEWS_PER_LIGHT, PixelRays, SELECT_BY_CONTAINMENT,
    SELECT_BY_DEPTH, SPLIT_CASCADES, SPLIT_CUBE, SPLIT_SINGLE, TERMINATOR_HARD, TERMINATOR_SOFT, ViewPlan, toward_light,
};
pub use error::PlanError;
pub use views::view_count;
