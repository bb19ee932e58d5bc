//! Between which depths a view's map is asked: where its planes may lie if casters beyond them are drawn onto them.

use glam::{DVec3, DVec4};

use super::data::{
    BIAS_AUTOMATIC, BIAS_CONSTANT, BIAS_NORMAL_OFFSET, BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, BIAS_SLOPE, LightPlan,
    ViewPlan,
};
use crate::{
    bias::OFFSET_SLOPE,
    depth::DEPTH_LINEAR,
    filter::{MOST_OF_A_STEP, farthest_tap},
    fit::{CascadeSphere, DepthRange, Eye, RANGE_MARGIN, Subject, ViewFit, sphere_depths},
    rounding::{UNIT_ROUNDOFF, map_bound},
};

/// What decides a receiver's test, in metres along the axis.
struct Lengths {
    /// How far before it what is compared with it may lie and still not hide it.
    bias: f64,
    /// How far behind it its plane is followed.
    plane: f64,
    /// How far its lookup is moved, to any side.
    step: f64,
}

/// The room that a view's texels ask for before and behind a receiver.
#[derive(Clone, Copy)]
pub(super) struct Room<'a> {
    light: &'a LightPlan,
    /// The view as it is without pancaking, and its plan.
    fit: &'a ViewFit,
    draft: &'a ViewPlan,
    /// The bound on rounding in texels, as in [`ViewPlan::rounding_texels`].
    rounding_texels: [f64; 2],
}

impl<'a> Room<'a> {
    /// The room of a view that is not pancaked. `draft` is its plan.
    pub(super) fn of(light: &'a LightPlan, fit: &'a ViewFit, draft: &'a ViewPlan) -> Self {
        Self { light, fit, draft, rounding_texels: draft.rounding_texels.map(f64::from) }
    }

    /// What decides a receiver's test, in metres.
    ///
    /// The automatic bias, that by slopes and a receiver plane are as long as a plane needs whose slope is [`OFFSET_SLOPE`]: steeper ones have their lookups moved by the first, and are grazed by the light under 2.4 degrees with the
    /// others. Lengths in metres, and steps along the normal, are what they are.
    fn lengths(&self, point: DVec3) -> Lengths {
        let LightPlan { bias, bias_metres, slope_scale, normal_texels, plane_metres, .. } = *self.light;
        let steps = self.draft.texel_steps_at(point);
        let (across, along) = (steps[0][0] + steps[1][0], steps[0][1] + steps[1][1]);
        let has = |part: u32| if bias & part != 0 { 1.0 } else { 0.0 };
        let scale = if bias & BIAS_RECEIVER_PLANE != 0 { 1.0 } else { f64::from(slope_scale) };
        let [rounding, rounding_over_w] = self.rounding_texels;
        let w = self.fit.clip_from_world().row(3).dot(point.extend(1.0));
        let reach =
            f64::from(farthest_tap(self.light)) * scale + f64::from(self.draft.snap_texels) + rounding + rounding_over_w / w;
        let by_slope =
            has(BIAS_AUTOMATIC | BIAS_SLOPE | BIAS_RECEIVER_PLANE) * reach * (f64::from(OFFSET_SLOPE) * across + along);
        let plane = has(BIAS_RECEIVER_PLANE) * f64::from(plane_metres);
        let steps = has(BIAS_NORMAL_OFFSET) * f64::from(normal_texels) + has(BIAS_AUTOMATIC) * f64::from(MOST_OF_A_STEP) * reach;
        let bias = by_slope + has(BIAS_CONSTANT) * f64::from(bias_metres) + plane;
        Lengths { bias, plane, step: steps * self.draft.texel_width_at(point) }
    }

    /// The depths of a stabilised view, as [`Self::depths`] has them for others: of a sphere before the camera.
    ///
    /// The bounds on rounding that a plan has go by where the map is. These do not, so that the range has one length: they hold wherever the camera is within twice the reach of the scene's bounds, and from there on in steps of a factor of two.
    pub(super) fn sphere_depths(&self, eye: &Eye<'_>, sphere: CascadeSphere, subject: &Subject<'_>) -> Option<[f64; 2]> {
        /// The steps by which the range is moved where the map has none of its own: those of 24 bits.
        const STEPS: f64 = 16_777_215.0;
        /// The roundings of both sides' rows, products and sums, of coordinates' size, with as many again to spare.
        const ROUNDINGS: f64 = 64.0;
        let bounds = f64::from(subject.bounds.abs_max().length());
        let mut farthest = 2.0 * bounds.max(sphere.radius);
        while farthest < eye.camera.eye.length() + sphere.distance + sphere.radius {
            farthest *= 2.0;
        }
        let metres = ROUNDINGS * UNIT_ROUNDOFF * (bounds + farthest);
        let texels = map_bound(f64::from(self.fit.size))[0] + metres / self.fit.texel_metres[0];
        let steps = f64::from(self.draft.depth_steps);
        let half_step = if steps > 0.0 { 0.5 / steps } else { 0.0 };
        let rounding = metres + (half_step + ROUNDINGS * UNIT_ROUNDOFF) * (self.fit.range.far - self.fit.range.near);
        let Lengths { bias, plane, step } = Self { rounding_texels: [texels, 0.0], ..*self }.lengths(DVec3::ZERO);
        let room = [bias + step + rounding, plane + step + rounding];
        sphere_depths(self.fit, eye, sphere, subject, room, if steps > 0.0 { steps } else { STEPS })
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
            let Lengths { bias, plane, step } = self.lengths(receiver);
            let depth = clip.z / clip.w;
            let depth_of = |clip: DVec4| if clip.w > 0.0 { clip.z / clip.w } else { f64::NEG_INFINITY };
            let (bias_depth, plane_depth) = (depth - depth_of(toward(bias)), depth_of(toward(-plane)) - depth);
            // Wherever a step takes the lookup.
            let (z_step, w_step) = (step * matrix.row(2).truncate().length(), step * matrix.row(3).truncate().length());
            let least_w = clip.w - w_step;
            if !(bias_depth.is_finite() && least_w > 0.0) {
                return Some([0.0, 1.0]);
            }
            let smallest = (clip.z - z_step) / if clip.z > z_step { clip.w + w_step } else { least_w };
            let largest = (clip.z + z_step) / if clip.z > -z_step { least_w } else { clip.w + w_step };
            // What lies behind all casters is compared at their far plane, less its own bias: a difference of z / w, or in linear depth a length.
            let beyond = (depth - 1.0).max(0.0);
            if beyond > 0.0 && self.draft.depth_kind == DEPTH_LINEAR {
                let DepthRange { near, far } = self.fit.range;
                let distance = (far - bias).max(near);
                nearest = nearest.min(far / (far - near) * (1.0 - near / distance) - rounding);
            }
            nearest = nearest.min(smallest - bias_depth - beyond - rounding);
            farthest = farthest.max(largest + plane_depth + rounding);
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
