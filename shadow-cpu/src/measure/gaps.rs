//! How far shadows begin from what casts them.

use rayon::prelude::*;
use shadow_math::{
    Receiver,
    bias::{GRADIENT_MARGIN, depth_gradient},
    filter::support,
    plan::{LightPlan, SNAP_TEXELS, ViewPlan},
    vector::row_times_point,
    visibility::{Lookup, footprint, lookup},
};
use shadow_scene::{FramePlan, NO_TRIANGLE, SceneLight};

use super::{
    judge::{Ask, Judge, receiver_at, toward_center},
    taps::{Taps, metres_before},
};
use crate::trace::SurfacePoint;

/// The gaps that the parts of the automatic bias leave, in metres, pixel by pixel; NaN where no map is asked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Needs {
    /// What the filter's taps need: h(g).
    pub filter: Vec<f32>,
    /// What the snapping of vertices needs.
    pub snap: Vec<f32>,
    /// The bound on rounding, of the stored depth and of the transforms on both sides.
    pub rounding: Vec<f32>,
}

/// The parts of [`needed_depth`](shadow_math::bias::needed_depth).
struct NeededParts {
    filter: f32,
    snap: f32,
    rounding: f32,
}

impl NeededParts {
    fn of(light: &LightPlan, view: &ViewPlan, receiver: &Receiver) -> Self {
        let w = row_times_point(view.clip_w, receiver.point);
        let gradient = depth_gradient(view, receiver.point, receiver.normal);
        let slope = gradient.abs().element_sum() * GRADIENT_MARGIN;
        let sides = footprint(light, view, receiver, w);
        Self {
            filter: slope * support(light, gradient, sides) * light.slope_scale,
            snap: slope * SNAP_TEXELS,
            rounding: slope * (view.rounding_texels[0] + view.rounding_texels[1] / w)
                + (view.rounding_depth[0] + view.rounding_depth[1] / w),
        }
    }
}

/// A pixel whose receiver asks a map of a light.
struct AskingPixel<'a> {
    light: &'a SceneLight,
    plan: &'a LightPlan,
    view: &'a ViewPlan,
    receiver: Receiver,
    point: SurfacePoint,
    lookup: Lookup,
    /// Of the angle between the normal and the light.
    sine: f64,
}

impl AskingPixel<'_> {
    /// The gap that a depth leaves at the receiver.
    fn gap_of(&self, depth: f32) -> f64 {
        self.sine * metres_before(self.light, self.view, self.point.position, f64::from(depth))
    }
}

impl Judge<'_> {
    /// The gaps that a rule leaves: for every pixel whose surface faces the light and asks a map, how far in metres a shadow would begin from the foot of
    /// a wall that stands on the surface, across the light. NaN for every other pixel. `triangles` and `ask` are as for [`Self::judge_rule`].
    ///
    /// A depth that is compared c metres before the surface, along the light, leaves a gap of `c sin`, with the angle between the normal and the light; a
    /// step along the normal that clears as much shortens shadows by the same length.
    ///
    /// # Panics
    ///
    /// As [`Self::judge_rule`].
    #[must_use]
    pub fn gaps(&self, plan: &FramePlan, light: usize, triangles: &[u32], ask: &Ask<'_>) -> Vec<f32> {
        self.of_asking_pixels(plan, light, triangles, ask, |pixel| {
            let taps = Taps::of(pixel.plan, pixel.view, &pixel.lookup, &pixel.point, 0.0);
            pixel.sine * taps.gap_metres(pixel.light, &pixel.lookup)
        })
    }

    /// The gaps that the parts of the automatic bias leave, each as by [`Self::gaps`]: `h(g)`, snap and rounding.
    ///
    /// # Panics
    ///
    /// As [`Self::judge_rule`].
    #[must_use]
    pub fn needs(&self, plan: &FramePlan, light: usize, triangles: &[u32]) -> Needs {
        let gaps = |part: fn(&NeededParts) -> f32| {
            self.of_asking_pixels(plan, light, triangles, &lookup, |pixel| {
                pixel.gap_of(part(&NeededParts::of(pixel.plan, pixel.view, &pixel.receiver)))
            })
        };
        Needs { filter: gaps(|parts| parts.filter), snap: gaps(|parts| parts.snap), rounding: gaps(|parts| parts.rounding) }
    }

    /// What `value` says of each pixel whose surface faces a light and asks one of its maps, in the order of the pixels; NaN for each that does not.
    fn of_asking_pixels(
        &self,
        plan: &FramePlan,
        light: usize,
        triangles: &[u32],
        ask: &Ask<'_>,
        value: impl Fn(&AskingPixel<'_>) -> f64 + Sync,
    ) -> Vec<f32> {
        let scene = self.tracer.scene();
        let width = self.seen.view.width() as usize;
        let (scene_light, light_plan) = (&scene.lights()[light], &plan.lights[light]);
        let of_pixel = |pixel: usize| {
            let hit = &self.seen.hits[pixel];
            if hit.triangle == NO_TRIANGLE || hit.triangle != triangles[pixel] {
                return None;
            }
            let (x, y) = ((pixel % width) as u32, (pixel / width) as u32);
            let point = self.tracer.surface_point(hit, self.seen.view.ray(x, y));
            let toward = toward_center(scene_light, point.position)?;
            let receiver = receiver_at(scene, plan, hit.triangle, x, y);
            let lookup = ask(light_plan, &plan.views, &receiver);
            let view = plan.views.get(lookup.view as usize)?;
            let sine = point.normal.cross(toward).length() / toward.length();
            Some(value(&AskingPixel { light: scene_light, plan: light_plan, view, receiver, point, lookup, sine }))
        };
        let pixels = (0..self.seen.hits.len()).into_par_iter();
        self.tracer.install(|| pixels.map(|pixel| of_pixel(pixel).map_or(f32::NAN, |value| value as f32)).collect())
    }
}

#[cfg(test)]
mod tests {
    use shadow_math::{
        Light, LightKind, ShadowSettings,
        bias::needed_depth,
        bounds::Aabb,
        glam::{Vec2, Vec3},
        plan::{MAX_VIEWS_PER_LIGHT, plan_light},
    };

    use super::*;

    /// The parts are all that there is: they add up to the bias.
    #[test]
    fn the_parts_of_the_need_add_up_to_it() {
        let bounds = Aabb::new(Vec3::splat(-4.0), Vec3::splat(4.0));
        let kinds = [
            LightKind::Directional { direction: Vec3::new(0.3, -1.0, 0.2) },
            LightKind::Point { position: Vec3::new(1.0, 6.0, 2.0), range: None },
        ];
        for kind in kinds {
            let light = Light { kind, color: Vec3::ONE, intensity: 1.0 };
            let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
            let settings = ShadowSettings { map_size: 256, ..ShadowSettings::default() };
            let plan = plan_light(&light, &[bounds], bounds, &settings, 0, &mut views).expect("the light is planned");
            for view in &views[..plan.view_count as usize] {
                let receiver = Receiver::new(Vec3::new(0.5, -1.0, 0.25), Vec3::new(0.2, 1.0, -0.4));
                let w = row_times_point(view.clip_w, receiver.point);
                if w <= 0.0 {
                    continue;
                }
                let parts = NeededParts::of(&plan, view, &receiver);
                let needed = needed_depth(&plan, view, receiver.point, receiver.normal, w, [Vec2::ZERO; 2]);
                let sum = parts.filter + parts.snap + parts.rounding;
                // Three products and sums are rounded otherwise than one.
                assert!((sum - needed).abs() <= 1e-6 * needed, "{sum} {needed}");
                assert!(parts.snap > 0.0 && parts.rounding > 0.0 && parts.filter > parts.snap);
            }
        }
    }
}
