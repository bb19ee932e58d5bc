//! Where the samples of a map go: the light's cameras.
//!
//! Every fit gives [`ViewFit`]s in double precision; the plan rounds them once.

mod cube;
mod depth_range;
mod uniform;

pub use cube::{CUBE_FACES, cube_face_of, cube_face_view};
pub use depth_range::{DepthRange, MIN_NEAR_SHARE, RANGE_MARGIN, distance_to_box, range_around_point, range_in_view};
pub use uniform::{directional_view, spot_view};

use glam::DMat4;

use crate::depth::DepthScale;

/// A light's camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewFit {
    /// From world to view space; the view looks along -z.
    pub view_from_world: DMat4,
    /// From view to clip space, z from 0 to 1.
    pub clip_from_view: DMat4,
    /// The near and far planes.
    pub range: DepthRange,
    /// How depth grows along the axis.
    pub depth_scale: DepthScale,
    /// Width and height of a texel in metres: at a distance of 1 m for a perspective view, anywhere for an orthographic one.
    pub texel_metres: [f64; 2],
}

impl ViewFit {
    /// The same camera with reversed depth: 1 at the near plane, 0 at the far plane.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let mut transposed = self.clip_from_view.transpose();
        transposed.z_axis = transposed.w_axis - transposed.z_axis;
        Self { clip_from_view: transposed.transpose(), ..*self }
    }

    /// From world to clip space.
    #[must_use]
    pub fn clip_from_world(&self) -> DMat4 {
        self.clip_from_view * self.view_from_world
    }
}

/// By how much the image of what is fitted must be magnified so that `guard` texels stay free on every side of a map
/// of `size` texels: the taps of a receiver at the rim then still fall into the map.
fn guard_scale(size: u32, guard: u32) -> f64 {
    f64::from(size) / (f64::from(size) - 2.0 * f64::from(guard))
}
