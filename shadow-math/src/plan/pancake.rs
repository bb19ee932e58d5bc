//! Between which depths a view's map is asked: where its planes may lie if casters beyond them are drawn onto them.

use glam::DVec3;

use super::data::{
    BIAS_AUTOMATIC, BIAS_CONSTANT, BIAS_NORMAL_OFFSET, BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, BIAS_SLOPE, LightPlan,
    ViewPlan,
};
use crate::{
    bias::OFFSET_SLOPE,
    filter::{MOST_OF_A_STEP, farthest_tap},
    fit::{RANGE_MARGIN, ViewFit},
    rounding::UNIT_ROUNDOFF,
};

/// The room that a view's texels ask for before and behind a receiver.
#[derive(Clone, Copy)]
pub(super) struct Room<'a> {
    pub(super) light: &'a LightPlan,
    /// The view as it is without pancaking, and its plan.
    pub(super) fit: &'a ViewFit,
    pub(super) draft: &'a ViewPlan,
}

impl Room<'_> {
    /// How far before a receiver the near plane has to be, in metres along the axis: what lies on that plane must not be hidden by the bias.
    ///
    /// The automatic bias, that by slopes and a receiver plane are as long as a plane needs whose slope is [`OFFSET_SLOPE`]: steeper ones have their lookups moved by the first, and are grazed by the light under 2.4 degrees
    /// with the others. Lengths in metres, and steps along the normal, are what they are.
    pub(super) fn metres(&self, point: DVec3) -> f64 {
        let LightPlan { bias, bias_metres, slope_scale, normal_texels, plane_metres, .. } = *self.light;
        let steps = self.draft.texel_steps_at(point);
        let (across, along) = (steps[0][0] + steps[1][0], steps[0][1] + steps[1][1]);
        let has = |part: u32| if bias & part != 0 { 1.0 } else { 0.0 };
        let scale = if bias & BIAS_RECEIVER_PLANE != 0 { 1.0 } else { f64::from(slope_scale) };
        let [rounding, rounding_over_w] = self.draft.rounding_texels.map(f64::from);
        let w = self.fit.clip_from_world().row(3).dot(point.extend(1.0));
        let reach =
            f64::from(farthest_tap(self.light)) * scale + f64::from(self.draft.snap_texels) + rounding + rounding_over_w / w;
        let by_slope = has(BIAS_AUTOMATIC | BIAS_SLOPE | BIAS_RECEIVER_PLANE) * reach;
        let by_length = has(BIAS_CONSTANT) * f64::from(bias_metres) + has(BIAS_RECEIVER_PLANE) * f64::from(plane_metres);
        let moved =
            f64::from(MOST_OF_A_STEP) * (has(BIAS_NORMAL_OFFSET) * f64::from(normal_texels) + has(BIAS_AUTOMATIC) * reach);
        // What is moved to the side, or compared there, has another depth where surfaces of one depth lean.
        by_slope * f64::from(OFFSET_SLOPE) * across + moved * across + (by_slope + moved) * along + by_length
    }

    /// How far behind a receiver the far plane has to be, in metres along the axis: a receiver plane is followed there, too.
    pub(super) fn metres_behind(&self) -> f64 {
        if self.light.bias & BIAS_RECEIVER_PLANE == 0 { 0.0 } else { f64::from(self.light.plane_metres) }
    }

    /// What a bias that is read off the map can be, as a share of the view's depth.
    fn share(&self) -> f64 {
        /// A bias of more than half of the range leaves little to tell apart.
        const MOST: f64 = 0.5;
        let LightPlan { bias, gradient_fixed, gradient_clamp, gradient_scale, .. } = *self.light;
        if bias & BIAS_RECEIVER_GRADIENT == 0 {
            0.0
        } else {
            f64::from(gradient_fixed + gradient_clamp * gradient_scale).min(MOST)
        }
    }

    /// The depths, z / w of the view without pancaking, between which all comparisons with some receivers are: with room before the nearest, and as little behind the farthest as they need; `None` without any.
    pub(super) fn depths(&self, receivers: impl Iterator<Item = DVec3>) -> Option<[f64; 2]> {
        /// What is added by drawing and turning depths into the view's own: see [`RoundingBound::of_pancake`](crate::rounding::RoundingBound::of_pancake).
        const DRAWING: f64 = 16.0 * UNIT_ROUNDOFF;
        let matrix = self.fit.clip_from_world();
        let (light, axis) = (self.fit.light(), self.fit.distance_row());
        let [rounding, rounding_over_w] = self.draft.rounding_depth.map(f64::from);
        let (mut nearest, mut farthest) = (f64::INFINITY, f64::NEG_INFINITY);
        for receiver in receivers {
            let clip = matrix * receiver.extend(1.0);
            if clip.w <= 0.0 {
                // So close to a light that there is no depth before it.
                nearest = 0.0;
                continue;
            }
            // Once more for how casters are drawn, by a row of their own.
            let rounding = 2.0 * (rounding + rounding_over_w / clip.w) + DRAWING;
            // Toward parallel light by so many times its direction, and toward another by a share of the way: lengths of biases are along the axis.
            let toward = |metres: f64| {
                if light.w == 0.0 {
                    return clip + matrix * light * metres;
                }
                let share = (metres / axis.dot(receiver.extend(1.0))).min(1.0);
                clip * (1.0 - share) + matrix * light * share
            };
            let (before, behind) = (toward(self.metres(receiver)), toward(-self.metres_behind()));
            nearest = nearest.min(if before.w > 0.0 { before.z / before.w - rounding } else { 0.0 });
            farthest = farthest.max(behind.z / behind.w + rounding);
        }
        let range = farthest - nearest;
        if !(range.is_finite() && range >= 0.0) {
            return None;
        }
        let margin = RANGE_MARGIN * range;
        let of_map = self.share() / (1.0 - self.share()) * range;
        Some([(nearest - margin - of_map).max(0.0), (farthest + margin).min(1.0)])
    }
}
