//! Lengths in a view, in double precision: for those who judge a plan rather than follow it.

use glam::{DVec3, DVec4};

use super::data::ViewPlan;
use crate::depth::DEPTH_Z_OVER_W;

impl ViewPlan {
    /// How wide the longer side of a texel is across the light's ray, where a point is, in metres: what [`texel_width`](crate::bias::texel_width) is for receivers.
    ///
    /// `point` is in metres relative to the scene's origin. Behind the light of a view that is not warped the width is below 0, as w is.
    #[must_use]
    pub fn texel_width_at(&self, point: DVec3) -> f64 {
        let w = row(self.clip_w).dot(point.extend(1.0));
        if self.is_warped == 0 {
            return f64::from(self.texel_metres[0].max(self.texel_metres[1])) * w;
        }
        let [[x, _], [y, _]] = self.texel_steps_at(point);
        x.max(y)
    }

    /// How far a point moves from a texel to the next one where its depth stays the same, in metres: `[across, along]` the light's ray, for a step in x and one in y.
    ///
    /// `point` is in metres relative to the scene's origin. Surfaces of one depth lie across the axis of a view that is not warped, and lean in others.
    #[must_use]
    pub fn texel_steps_at(&self, point: DVec3) -> [[f64; 2]; 2] {
        let w = row(self.clip_w).dot(point.extend(1.0));
        let step = |column: [f32; 4]| {
            let column = row(column);
            (column.truncate() - point * column.w) * w
        };
        // A point that keeps its texel moves along the light's ray.
        let ray = step(self.world_from_depth).normalize_or_zero();
        [self.world_from_texel_x, self.world_from_texel_y].map(|column| {
            let step = step(column);
            let along = ray.dot(step);
            [(step - ray * along).length(), along.abs()]
        })
    }

    /// The distances along the axis, in metres, of the planes between which casters are drawn: the view's own, but for pancaked ones, whose planes lie between these. Of warped views their own.
    #[must_use]
    pub fn drawn_range(&self) -> [f64; 2] {
        let [near, far] = self.depth_range.map(f64::from);
        if !self.is_pancaked() || self.is_warped != 0 {
            return [near, far];
        }
        let (scale, offset) = (f64::from(self.drawn_scale), f64::from(self.drawn_offset));
        let nearest = if self.depth_kind == DEPTH_Z_OVER_W { offset } else { 1.0 - offset - scale };
        [nearest, nearest + scale].map(|depth| {
            if self.w_per_metre == 0.0 {
                return near + depth * (far - near);
            }
            near * far / (far - depth * (far - near))
        })
    }

    /// How many metres along the view's axis the last `depth` of z / w before a point takes up: the inverse of [`DepthScale::depth_of_metres`](crate::depth::DepthScale::depth_of_metres), for any view.
    ///
    /// `point` is in metres relative to the scene's origin.
    #[must_use]
    pub fn metres_of_depth(&self, point: DVec3, depth: f64) -> f64 {
        let [w, distance] = [self.clip_w, self.distance].map(|numbers| row(numbers).dot(point.extend(1.0)));
        depth * w * distance / (f64::from(self.depth_factor) + depth * w * f64::from(self.w_per_metre))
    }
}

fn row(numbers: [f32; 4]) -> DVec4 {
    DVec4::from_array(numbers.map(f64::from))
}
