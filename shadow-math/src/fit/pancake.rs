//! Pancaking: depth for what is seen alone.
//!
//! A map's depth has to tell receivers from what lies before them, and no caster from another. A pancaked view's near plane lies just before the nearest point that can be looked up and its far plane
//! behind the farthest; casters before or behind are drawn all the same, onto the planes: flat as a pancake. Each step of a depth of 16 bits is then a share of what is seen, not of the way up to the tallest tower.
//!
//! Casters are drawn between the planes that enclose them ([`ViewFit::caster_depth`]), so that none is clipped, and [`encoded_depth`](crate::depth::encoded_depth) moves what was drawn onto the view's own: depth z / w
//! under one pair of planes is an affine function of that under another. That asks nothing of a driver, whose own depth clamp is optional in WebGPU.
//!
//! What a caster before the near plane is drawn at hides a receiver if that lies deeper by more than its bias. So there is [room](ViewFit::pancaked) between the near plane and receivers.

use glam::{DMat4, DVec3, DVec4};

use super::{DepthRange, ViewFit};

/// The least depth of a pancaked view, as a share of the depth between the planes by which it is drawn: its 16 bits are then steps of 2^-24, which is what a drawn f32 has.
pub const MIN_PANCAKE_SHARE: f64 = 1.0 / 256.0;

impl ViewFit {
    /// The same camera whose near and far plane lie at these depths of it; casters beyond are drawn onto them.
    ///
    /// Depths are z / w, of a view that is not pancaked yet. Less than [`MIN_PANCAKE_SHARE`] is widened to that, toward the light. Depths that are no numbers, or do not grow, leave the view as it is.
    ///
    /// ```
    /// use shadow_math::{bounds::Aabb, fit::directional_view};
    /// use glam::{DVec3, Vec3};
    ///
    /// let scene = Aabb::new(Vec3::splat(-50.0), Vec3::splat(50.0));
    /// let view = directional_view(Vec3::NEG_Y, scene, 512, 2);
    /// let (roof, street) = (DVec3::Y * 4.0, DVec3::ZERO);
    /// let depths = [roof, street].map(|point| view.clip_from_world().project_point3(point).z);
    /// let view = view.pancaked(depths);
    /// assert!(view.clip_from_world().project_point3(roof).z.abs() < 1e-12);
    /// assert!((view.clip_from_world().project_point3(street).z - 1.0).abs() < 1e-12);
    /// // What is drawn reaches up to 50 m, over 12 times the depth that is left.
    /// assert!(view.caster_depth[0] < -11.0);
    /// ```
    #[must_use]
    pub fn pancaked(&self, [nearest, farthest]: [f64; 2]) -> Self {
        if !(nearest.is_finite() && farthest.is_finite() && nearest < farthest) || self.is_pancaked() {
            return *self;
        }
        let nearest = nearest.min(farthest - MIN_PANCAKE_SHARE);
        let share = farthest - nearest;
        let mut rows = self.clip_from_view.transpose();
        rows.z_axis = (rows.z_axis - rows.w_axis * nearest) / share;
        let depth_scale = crate::depth::DepthScale { factor: self.depth_scale.factor / share, ..self.depth_scale };
        let range = self.range_of([nearest, farthest]);
        let pancaked = Self {
            clip_from_view: rows.transpose(),
            depth_scale,
            range,
            caster_depth: [-nearest / share, (1.0 - nearest) / share],
            ..*self
        };
        if self.depth_scale.w_per_metre > 0.0 || self.is_warped {
            return pancaked;
        }
        // The eye of parallel light lies on the near plane.
        let moved = DMat4::from_translation(DVec3::Z * range.near);
        Self {
            view_from_world: moved * self.view_from_world,
            clip_from_view: pancaked.clip_from_view * DMat4::from_translation(DVec3::NEG_Z * range.near),
            range: DepthRange { near: 0.0, far: range.far - range.near },
            ..pancaked
        }
    }

    /// How far along the axis two depths lie, in metres. Of a warped view, where that is different from place to place, its range stays what it is.
    fn range_of(&self, depths: [f64; 2]) -> DepthRange {
        let DepthRange { near, far } = self.range;
        if self.is_warped {
            return self.range;
        }
        let is_perspective = self.depth_scale.w_per_metre > 0.0;
        let [near, far] = depths
            .map(|depth| if is_perspective { near * far / (far - depth * (far - near)) } else { near + depth * (far - near) });
        DepthRange { near, far }
    }

    /// The depth row by which casters are drawn, of the planes that enclose them; `is_reversed` for one that falls from 1 to 0. The view itself is not [reversed](ViewFit::reversed).
    #[must_use]
    pub fn drawn_row(&self, is_reversed: bool) -> DVec4 {
        let matrix = self.clip_from_world();
        let [nearest, farthest] = self.caster_depth;
        let (z, w) = (matrix.row(2), matrix.row(3));
        let forward = if self.is_pancaked() { (z - w * nearest) / (farthest - nearest) } else { z };
        if is_reversed { w - forward } else { forward }
    }
}
