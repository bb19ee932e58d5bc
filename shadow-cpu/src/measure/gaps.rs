//! How far shadows begin from what casts them.

use glam::DVec3;
use rayon::prelude::*;
use shadow_math::{
    Receiver,
    bias::{GRADIENT_MARGIN, depth_gradient},
    filter::support,
    plan::{LightPlan, ViewPlan},
    vector::row_times_point,
    visibility::{Lookup, NO_VIEW, footprint},
};
use shadow_scene::{FramePlan, NO_TRIANGLE, SceneLight};

use super::{
    judge::{Ask, Judge, receiver_at, toward_center, weightiest_lookup},
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
            snap: slope * view.snap_texels,
            rounding: slope * (view.rounding_texels[0] + view.rounding_texels[1] / w)
                + (view.rounding_depth[0] + view.rounding_depth[1] / w),
        }
    }
}

/// A shift below this many texels counts as none: coordinates of up to 16384 texels in f32 have steps of a thousandth.
const LEAST_SHIFT: f64 = 1.0 / 64.0;

/// What a bias costs at a pixel, in metres on the surface. Both are NaN where the automatic bias asks no map.
///
/// Let the light's ray through the lookup meet the surface's plane in B, and let the depth that is compared lie c before B on that ray, at an angle to the
/// surface's normal. A wall that stands on the surface, across the light, at a distance x from the receiver is seen if it is met before that depth is: if `x > b + c sin`, with
/// b the part of the way from the receiver to B that leads toward the light. A depth bias has b = 0 and a gap of `c sin`; a step along the normal has no gap, for b is `-c sin`,
/// and moves every outline on the surface by as much ("Price" of a bias).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// How far from the foot of a wall its shadow begins; infinite where the rule asks no map any more.
    pub gap: f32,
    /// How far outlines of distant casters are moved.
    pub shift: f32,
}

impl Price {
    const NONE: Self = Self { gap: f32::NAN, shift: f32::NAN };
    /// Of a lookup that left the light's view: everything is lit.
    const EVERYTHING: Self = Self { gap: f32::INFINITY, shift: 0.0 };
}

/// A pixel whose receiver asks a map of a light.
struct AskingPixel<'a> {
    light: &'a SceneLight,
    plan: &'a LightPlan,
    receiver: Receiver,
    point: SurfacePoint,
    /// Toward the light, of unit length.
    toward: DVec3,
    /// What the automatic bias asks.
    lookup: Lookup,
}

impl AskingPixel<'_> {
    /// The sine of the angle between normal and light.
    fn sine(&self) -> f64 {
        self.point.normal.cross(self.toward).length()
    }

    fn price(&self, view: &ViewPlan, lookup: &Lookup) -> Price {
        let taps = Taps::of(self.plan, view, lookup, &self.point, 0.0);
        let Some(behind) = taps.behind(lookup) else { return Price { gap: 0.0, shift: 0.0 } };
        // Single precision moves a lookup by some thousandths of a texel: that is no step.
        let texel = view.texel_width_at(self.point.position);
        let moved = behind.position - self.point.position;
        let moved = if moved.length() < LEAST_SHIFT * texel { DVec3::ZERO } else { moved };
        let across = (self.toward - self.point.normal * self.point.normal.dot(self.toward)).normalize_or_zero();
        let gap = moved.dot(across) + self.sine() * taps.gap_metres(self.light, lookup);
        Price { gap: gap.max(0.0) as f32, shift: moved.length() as f32 }
    }
}

impl Judge<'_> {
    /// What a rule costs, pixel by pixel. `triangles` and `ask` are as for [`Self::judge_rule`].
    ///
    /// # Panics
    ///
    /// As [`Self::judge_rule`].
    #[must_use]
    pub fn prices(&self, plan: &FramePlan, light: usize, triangles: &[u32], ask: &Ask<'_>) -> Vec<Price> {
        self.of_asking_pixels(plan, light, triangles, Price::NONE, |pixel| {
            let found = ask(pixel.plan, &plan.views, &pixel.receiver);
            plan.views.get(found.view as usize).map_or(Price::EVERYTHING, |view| pixel.price(view, &found))
        })
    }

    /// The gaps that the parts of the automatic bias would leave as depths: `h(g)`, snap and rounding.
    ///
    /// # Panics
    ///
    /// As [`Self::judge_rule`].
    #[must_use]
    pub fn needs(&self, plan: &FramePlan, light: usize, triangles: &[u32]) -> Needs {
        let gaps = self.of_asking_pixels(plan, light, triangles, [f32::NAN; 3], |pixel| {
            let view = &plan.views[pixel.lookup.view as usize];
            let NeededParts { filter, snap, rounding } = NeededParts::of(pixel.plan, view, &pixel.receiver);
            let gap = |depth| pixel.sine() * metres_before(pixel.light, view, pixel.point.position, f64::from(depth));
            [filter, snap, rounding].map(|depth| gap(depth) as f32)
        });
        let [filter, snap, rounding] = [0, 1, 2].map(|part| gaps.iter().map(|gaps| gaps[part]).collect());
        Needs { filter, snap, rounding }
    }

    /// What `value` says of each pixel whose surface faces a light and asks one of its maps under the automatic bias, in the order of the pixels; `none` for each that does not.
    fn of_asking_pixels<T: Copy + Send + Sync>(
        &self,
        plan: &FramePlan,
        light: usize,
        triangles: &[u32],
        none: T,
        value: impl Fn(&AskingPixel<'_>) -> T + Sync,
    ) -> Vec<T> {
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
            let toward = toward_center(scene_light, point.position)?.normalize_or_zero();
            let receiver = receiver_at(scene, plan, hit.triangle, x, y);
            let lookup = weightiest_lookup(light_plan, &plan.views, &receiver);
            (lookup.view != NO_VIEW)
                .then(|| value(&AskingPixel { light: scene_light, plan: light_plan, receiver, point, toward, lookup }))
        };
        let pixels = (0..self.seen.hits.len()).into_par_iter();
        self.tracer.install(|| pixels.map(|pixel| of_pixel(pixel).unwrap_or(none)).collect())
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

    use shadow_math::fit::Subject;

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
            let plan = plan_light(&light, &Subject::unseen(&[bounds], bounds), &settings, [0, 0], &mut views)
                .expect("the light is planned");
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
