//! Lengths in a view, in double precision: for those who judge a plan rather than follow it.

use glam::{DVec3, DVec4};

use super::data::ViewPlan;

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
        let step = |column: [f32; 4]| {
            let column = row(column);
            (column.truncate() - point * column.w) * w
        };
        // A point that keeps its texel moves along the light's ray.
        let along = step(self.world_from_depth).normalize_or_zero();
        let across = |v: DVec3| (v - along * along.dot(v)).length();
        across(step(self.world_from_texel_x)).max(across(step(self.world_from_texel_y)))
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
