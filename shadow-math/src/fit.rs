//! Where the samples of a map go: the light's cameras.
//!
//! | fit | what it covers | source |
//! |---|---|---|
//! | uniform | all that the light reaches; of a cascade the box around what it covers | Williams 1978 |
//! | focused | the smallest rectangle around the image of what is seen and can be shadowed | Brabec, Annen and Seidel 2002; Freeman and Shapira 1975 |
//! | LiSPSM | the same, with more samples near the camera | Wimmer, Scherzer and Purgathofer 2004 |
//! | plane-optimal | a plane, with one sample for each of its pixels | Chong and Gortler 2004 |
//! | stabilised | the sphere around a cascade, moved by whole texels | Valient 2007 |
//!
//! Every fit gives [`ViewFit`]s in double precision; the plan rounds them once. A fit that cannot be had says so ([`FitOutcome`]): the light then has its uniform view, or none where there
//! is nothing to be seen.

mod body;
mod boxed;
mod cube;
mod depth_range;
mod frame;
mod lispsm;
mod ogre;
mod outcome;
mod pancake;
mod plane_optimal;
mod stabilised;
mod uniform;

pub use body::{Eye, Subject, visible_body, visible_in_view, visible_range, widened_by, widened_slice};
pub use boxed::{Content, MAX_POINTS, boxed_view, focused_view};
pub use cube::{CUBE_FACES, cube_face_of, cube_face_view};
pub use depth_range::{
    DepthRange, MIN_NEAR_SHARE, RANGE_MARGIN, distance_to_box, heights_along, heights_of_casters, range_around_point,
    range_in_view,
};
pub use frame::{LightFrame, Window};
pub use lispsm::{LispsmWarp, MAX_WARP_PARAMETER, lispsm_view, optimal_warp};
pub use ogre::{
    OGRE_THRESHOLD, OgreLightSpace, OgreSetup, ogre_frame, ogre_standard_matrix, ogre_tweak, ogre_uniform_view, ogre_warp,
};
pub use outcome::{FallBack, FitOutcome};
pub use pancake::MIN_PANCAKE_SHARE;
pub use plane_optimal::{PlaneOptimal, plane_depth_factor, plane_optimal};
pub use stabilised::{CascadeSphere, sphere_depths, stabilised_view};
pub use uniform::{directional_view, spot_view};

use glam::{DMat4, DVec4};

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
    /// Width and height of a texel in metres: at a distance of 1 m for a perspective view, anywhere for an orthographic one, and where most of what is seen is for a warped one.
    pub texel_metres: [f64; 2],
    /// Width and height of the map in texels.
    pub size: u32,
    /// The depths, as this view counts them, of the near and the far plane between which casters are drawn: 0 and 1, but for [pancaked](ViewFit::pancaked) views, whose own planes lie
    /// between these.
    pub caster_depth: [f64; 2],
    /// Whether w is something else than the distance along the axis, or 1 for parallel light.
    pub is_warped: bool,
    /// The row that is at least 0 where the matrix has a meaning.
    pub half_space: DVec4,
    /// The greatest w, for each metre along the axis of a light at a place, of what a warped view was fitted to, with a margin; infinite for others. A warp can leave one texel for all that lies beyond, up to infinity:
    /// the map contains it, and is of no use there.
    pub farthest_w: f64,
    /// How the view came about.
    pub outcome: FitOutcome,
}

impl ViewFit {
    /// What views that are not warped have in common.
    fn unwarped(size: u32) -> Self {
        Self {
            view_from_world: DMat4::IDENTITY,
            clip_from_view: DMat4::IDENTITY,
            range: DepthRange { near: 0.0, far: 1.0 },
            depth_scale: DepthScale::orthographic(1.0),
            texel_metres: [1.0; 2],
            caster_depth: [0.0, 1.0],
            size,
            is_warped: false,
            half_space: DVec4::W,
            farthest_w: f64::INFINITY,
            outcome: FitOutcome::Fitted,
        }
    }

    /// The same camera with reversed depth: 1 at the near plane, 0 at the far plane. `caster_depth` stays as it is, counted from the near plane.
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

    /// The four planes of the map's sides, as `(normal, offset)` with `dot(normal, point) + offset >= 0` inside.
    #[must_use]
    pub fn sides(&self) -> [DVec4; 4] {
        let matrix = self.clip_from_world();
        let [x, y, w] = [0, 1, 3].map(|row| matrix.row(row));
        [w + x, w - x, w + y, w - y]
    }

    /// The same, `texels` farther out.
    #[must_use]
    pub fn sides_widened_by(&self, texels: f64) -> [DVec4; 4] {
        // Half the map is 1 in clip space.
        let beyond = self.clip_from_world().row(3) * (2.0 * texels / f64::from(self.size));
        self.sides().map(|side| side + beyond)
    }

    /// The row that takes points to their distance along the axis, in metres; 1 everywhere for parallel light.
    #[must_use]
    pub fn distance_row(&self) -> DVec4 {
        if self.depth_scale.w_per_metre > 0.0 { -self.view_from_world.row(2) } else { DVec4::W }
    }

    /// Whether casters are drawn between wider planes than the view's own.
    #[must_use]
    pub fn is_pancaked(&self) -> bool {
        self.caster_depth != [0.0, 1.0]
    }

    /// The light as a homogeneous point: the vector toward parallel light, with a 0, or a position, with a 1.
    #[must_use]
    pub fn light(&self) -> DVec4 {
        let world_from_view = self.view_from_world.inverse();
        if self.depth_scale.w_per_metre > 0.0 { world_from_view.w_axis } else { world_from_view.z_axis }
    }

    /// The same view as what another fit fell back to.
    #[must_use]
    pub fn in_place_of_another(self, why: FallBack) -> Self {
        Self { outcome: FitOutcome::FellBackToUniform { why }, ..self }
    }
}

/// By how much the image of what is fitted must be magnified so that `guard` texels stay free on every side of a map
/// of `size` texels: the taps of a receiver at the rim then still fall into the map.
fn guard_scale(size: u32, guard: u32) -> f64 {
    f64::from(size) / (f64::from(size) - 2.0 * f64::from(guard))
}
