//! How well a light's maps are matched to a picture: over how many pixels their texels smear, and how many of them nobody sees.

use core::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, Vec2};
use rayon::{ThreadPoolBuilder, prelude::*};
use shadow_math::{
    Receiver,
    aliasing::Aliasing,
    plan::{FILTER_FOOTPRINT, LightPlan, ViewPlan},
    vector::row_times_point,
    visibility::{NO_VIEW, choose_views, footprint, lookup_in_view},
};
use shadow_scene::{FramePlan, NO_TRIANGLE, Scene, SceneLight};

use super::{
    judge::{receiver_at, toward_center},
    trials::Lengths,
};
use crate::CpuError;

/// The cosine between normal and light above which pixels are counted. At the terminator, where the light sees a surface edge-on, m has no bound, and there is no light to see it by: at this
/// cosine there is a tenth of what the light gives.
pub const MIN_COSINE: f64 = 0.1;

/// In [`LightAliasing::stretches`], the value of a pixel that has none.
pub const NO_STRETCH: f32 = -1.0;

/// The aliasing of the maps of one light, or of several together.
///
/// Counted are the pixels that show a surface which the light can reach, which faces it by more than [`MIN_COSINE`], and which asks a map. m is [`Aliasing::largest`]: over how many pixels a texel smears; of two maps that
/// are blended each has its share of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AliasingStatistics {
    /// How many pixels are counted, once for each light.
    pub pixels: u64,
    /// How many are left out, since the light grazes what they show.
    pub grazing: u64,
    /// The median of m; 0 if nothing is counted, as the two below.
    pub median: f32,
    /// What m is at most in 95 of 100 pixels.
    pub percentile_95: f32,
    /// The largest m.
    pub max: f32,
    /// How many pixels are counted whose m is above 1.
    pub above_one: u64,
    /// How many texels the maps have: those of the views' rectangles.
    pub texels: u64,
    /// How many of them are seen: they meet the footprint of a pixel that asks their map, grazing ones among them.
    pub seen_texels: u64,
}

impl AliasingStatistics {
    /// The share of the counted pixels whose m is above 1; 0 if nothing is counted.
    #[must_use]
    pub fn share_above_one(self) -> f64 {
        if self.pixels == 0 { 0.0 } else { self.above_one as f64 / self.pixels as f64 }
    }

    /// The share of the texels that nobody sees; 0 without maps.
    #[must_use]
    pub fn waste(self) -> f64 {
        if self.texels == 0 { 0.0 } else { 1.0 - self.seen_texels as f64 / self.texels as f64 }
    }
}

/// The aliasing of one light's maps.
#[derive(Clone, Debug, PartialEq)]
pub struct LightAliasing {
    /// What it comes to.
    pub statistics: AliasingStatistics,
    /// m for each pixel, the grazing ones among them; infinite where the light sees a surface edge-on, [`NO_STRETCH`] where no map is asked or no light arrives.
    pub stretches: Vec<f32>,
}

/// The aliasing of the maps of all lights in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameAliasing {
    /// Light by light, in the order of the scene's lights.
    pub lights: Vec<LightAliasing>,
    /// All lights together: a pixel counts once for each light.
    pub total: AliasingStatistics,
}

impl FrameAliasing {
    /// Measures a plan on what its camera sees; `triangles` are the triangles behind its pixels. `threads` is how many threads there are, 0 for one a core; the result does not depend on it.
    ///
    /// # Errors
    ///
    /// [`CpuError::Threads`].
    ///
    /// # Panics
    ///
    /// If the plan or the triangles are not of this scene, or the triangles of a picture of another size.
    ///
    /// ```
    /// use shadow_cpu::{CpuRenderer, RasterRules, measure::FrameAliasing};
    /// use shadow_math::ShadowSettings;
    /// use shadow_scene::{FramePlan, Request, builtin};
    ///
    /// let scene = builtin::box_on_plane();
    /// let renderer = CpuRenderer::new(0, RasterRules::default())?;
    /// let of_size = |map_size| {
    ///     let settings = ShadowSettings { map_size, ..ShadowSettings::default() };
    ///     let plan = FramePlan::new(&scene, &scene.cameras()[0].camera, &settings, 64, 36, None)?;
    ///     let frame = renderer.render(&renderer.prepare(&scene), &plan, Request { camera: true, ..Request::default() })?.frame;
    ///     Ok::<_, Box<dyn std::error::Error>>(FrameAliasing::of(&scene, &plan, frame.triangles().unwrap_or_default(), 0)?.total)
    /// };
    /// let (small, large) = (of_size(64)?, of_size(256)?);
    /// assert!(small.median > 3.0 * large.median, "with texels a quarter as wide");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(scene: &Scene, plan: &FramePlan, triangles: &[u32], threads: usize) -> Result<Self, CpuError> {
        assert_eq!(plan.lights.len(), scene.lights().len(), "the plan is of this scene");
        assert_eq!(triangles.len(), plan.camera.width as usize * plan.camera.height as usize, "a triangle for each pixel");
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("shadow-aliasing {index}"))
            .build()
            .map_err(|source| CpuError::Threads { threads, source })?;
        let measured = (0..plan.lights.len()).map(|light| pool.install(|| measure_light(scene, plan, light, triangles)));
        let mut all = Measured::default();
        let lights = measured.map(|(stretches, measured)| {
            let statistics = measured.statistics();
            all.add(measured);
            LightAliasing { statistics, stretches }
        });
        let lights = lights.collect();
        Ok(Self { lights, total: all.statistics() })
    }

    /// The largest m of each pixel among the lights; [`NO_STRETCH`] where it has none.
    #[must_use]
    pub fn worst(&self) -> Vec<f32> {
        let pixels = self.lights.first().map_or(0, |light| light.stretches.len());
        (0..pixels).map(|pixel| self.lights.iter().map(|light| light.stretches[pixel]).fold(NO_STRETCH, f32::max)).collect()
    }
}

/// What statistics are made of.
#[derive(Default)]
struct Measured {
    /// The m of what is counted.
    counted: Vec<f32>,
    grazing: u64,
    texels: u64,
    seen_texels: u64,
}

impl Measured {
    fn add(&mut self, other: Self) {
        self.counted.extend(other.counted);
        self.grazing += other.grazing;
        self.texels += other.texels;
        self.seen_texels += other.seen_texels;
    }

    fn statistics(&self) -> AliasingStatistics {
        let Lengths { pixels, median, percentile_95, max } = Lengths::of(self.counted.iter().copied());
        AliasingStatistics {
            pixels,
            grazing: self.grazing,
            median,
            percentile_95,
            max,
            above_one: self.counted.iter().filter(|&&stretch| stretch > 1.0).count() as u64,
            texels: self.texels,
            seen_texels: self.seen_texels,
        }
    }
}

/// The m of every pixel for one light, and what its statistics are made of.
fn measure_light(scene: &Scene, plan: &FramePlan, light: usize, triangles: &[u32]) -> (Vec<f32>, Measured) {
    let views = plan.views_of(light);
    let maps: Vec<SeenTexels> = views.iter().map(SeenTexels::new).collect();
    let asking = Asking { plan, light: &plan.lights[light], scene_light: &scene.lights()[light], maps: &maps };
    let width = plan.camera.width as usize;
    let mut stretches = vec![NO_STRETCH; triangles.len()];
    let rows = stretches.par_chunks_mut(width).zip(triangles.par_chunks(width)).enumerate();
    let rows = rows.map(|(y, (stretches, triangles))| {
        let mut row = Measured::default();
        for (x, &triangle) in triangles.iter().enumerate().filter(|(_, triangle)| **triangle != NO_TRIANGLE) {
            let receiver = receiver_at(scene, plan, triangle, x as u32, y as u32);
            let Some((stretch, cosine)) = asking.stretch_at(&receiver) else { continue };
            stretches[x] = stretch;
            if cosine > MIN_COSINE {
                row.counted.push(stretch);
            } else {
                row.grazing += 1;
            }
        }
        row
    });
    let rows: Vec<Measured> = rows.collect();
    let mut measured = Measured {
        texels: maps.iter().map(SeenTexels::count).sum(),
        seen_texels: maps.iter().map(SeenTexels::count_seen).sum(),
        ..Measured::default()
    };
    rows.into_iter().for_each(|row| measured.add(row));
    (stretches, measured)
}

/// A light of which receivers ask maps.
struct Asking<'a> {
    plan: &'a FramePlan,
    light: &'a LightPlan,
    scene_light: &'a SceneLight,
    /// For each of the light's views which texels are seen.
    maps: &'a [SeenTexels],
}

impl Asking<'_> {
    /// m at a receiver, and the cosine between its normal and the light; marks the texels that it sees. `None` where no light arrives or no map is asked.
    ///
    /// Of two cascades that are blended each has its share of m, as it has of the picture.
    fn stretch_at(&self, receiver: &Receiver) -> Option<(f32, f64)> {
        let normal = receiver.normal.as_dvec3();
        let toward = toward_center(self.scene_light, receiver.point.as_dvec3())?;
        let choice = choose_views(self.light, &self.plan.views, receiver);
        let first = self.stretch_in(choice.first, receiver);
        let second = if choice.share > 0.0 { self.stretch_in(choice.second, receiver) } else { None };
        let share = f64::from(choice.share);
        let stretch = match (first, second) {
            (Some(first), Some(second)) if share < 1.0 => first * (1.0 - share) + second * share,
            (_, Some(alone)) | (Some(alone), None) => alone,
            (None, None) => return None,
        };
        Some((stretch as f32, normal.normalize().dot(toward.normalize())))
    }

    /// m at a receiver in one view, by its place among all views; marks the texels that it sees there. `None` where it asks no texel of it.
    fn stretch_in(&self, index: u32, receiver: &Receiver) -> Option<f64> {
        let view = self.plan.views.get(index as usize)?;
        if lookup_in_view(self.light, view, index, receiver).view == NO_VIEW {
            return None;
        }
        let Aliasing { largest, .. } =
            Aliasing::at(&self.plan.camera, view, receiver.point.as_dvec3(), receiver.normal.as_dvec3())?;
        self.maps[(index - self.light.first_view) as usize].mark(&Footprint::of(self.light, view, receiver));
        Some(largest)
    }
}

/// A pixel's image in a map: a parallelogram around the receiver's place.
struct Footprint {
    /// In texels of the view's layer.
    center: DVec2,
    /// What a pixel to the right and one below are in the map, in texels.
    sides: [DVec2; 2],
}

impl Footprint {
    /// That of a receiver before the light, whatever the light's filter is. Its sides are infinite or NaN where the camera sees the surface edge-on.
    fn of(light: &LightPlan, view: &ViewPlan, receiver: &Receiver) -> Self {
        let [x, y, w] = [view.clip_x, view.clip_y, view.clip_w].map(|row| row_times_point(row, receiver.point));
        let center = Vec2::new(x, y) / w * Vec2::from(view.texel_scale) + Vec2::from(view.texel_offset);
        let sides = footprint(&LightPlan { filter: FILTER_FOOTPRINT, ..*light }, view, receiver, w);
        Self { center: center.as_dvec2(), sides: sides.map(Vec2::as_dvec2) }
    }

    /// The corners, in order around it.
    fn corners(&self) -> [DVec2; 4] {
        let [right, below] = self.sides;
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| self.center + right * x + below * y)
    }
}

/// Which texels of a view are seen: a bit each.
struct SeenTexels {
    /// The view's rectangle: x, y, width and height in texels of the layer.
    rect: [u32; 4],
    /// How many words hold a row.
    row_words: usize,
    /// The rows of the rectangle, one after the other. Bits are only ever set, in any order.
    words: Vec<AtomicU64>,
}

impl SeenTexels {
    /// Nothing is seen.
    fn new(view: &ViewPlan) -> Self {
        let row_words = view.rect[2].div_ceil(u64::BITS) as usize;
        let words = (0..row_words * view.rect[3] as usize).map(|_| AtomicU64::new(0)).collect();
        Self { rect: view.rect, row_words, words }
    }

    /// How many texels there are.
    fn count(&self) -> u64 {
        u64::from(self.rect[2]) * u64::from(self.rect[3])
    }

    /// How many of them are seen.
    fn count_seen(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.load(Ordering::Relaxed).count_ones())).sum()
    }

    /// Marks the texels that a footprint meets: row by row, and so in no more steps than the map has rows. One without bounds, which the camera sees edge-on, marks nothing but the texel in its middle.
    fn mark(&self, footprint: &Footprint) {
        let origin = DVec2::new(f64::from(self.rect[0]), f64::from(self.rect[1]));
        let corners = footprint.corners();
        let corners = if corners.iter().all(|corner| corner.is_finite()) { corners } else { [footprint.center; 4] };
        let corners = corners.map(|corner| corner - origin);
        let top = corners.iter().map(|corner| corner.y).fold(f64::INFINITY, f64::min);
        let bottom = corners.iter().map(|corner| corner.y).fold(f64::NEG_INFINITY, f64::max);
        let Some((first, last)) = texels_between(top, bottom, self.rect[3]) else { return };
        for row in first..=last {
            let Some((left, right)) = extent_in_row(&corners, f64::from(row)) else { continue };
            if let Some((left, right)) = texels_between(left, right, self.rect[2]) {
                self.mark_row(row as usize, left as usize, right as usize);
            }
        }
    }

    /// Marks the texels of a row from `left` to `right`, which is one of them.
    fn mark_row(&self, row: usize, left: usize, right: usize) {
        const BITS: usize = u64::BITS as usize;
        for index in left / BITS..=right / BITS {
            let from = left.saturating_sub(index * BITS);
            let to = (right - index * BITS).min(BITS - 1);
            let mask = (u64::MAX >> (BITS - 1 - to)) & (u64::MAX << from);
            let word = &self.words[row * self.row_words + index];
            // Most texels are seen by several pixels: reading a word does not take it from other threads.
            if word.load(Ordering::Relaxed) & mask != mask {
                word.fetch_or(mask, Ordering::Relaxed);
            }
        }
    }
}

/// The first and the last of `count` texels that an interval meets by more than a border; an interval without a length meets the one that it lies in. `None` if it meets none.
fn texels_between(low: f64, high: f64, count: u32) -> Option<(u32, u32)> {
    let first = low.floor();
    let last = (high.ceil() - 1.0).max(first);
    let is_met = last >= 0.0 && first < f64::from(count);
    // The casts are within 0 and the count.
    is_met.then(|| (first.max(0.0) as u32, last.min(f64::from(count) - 1.0) as u32))
}

/// From where to where a convex outline reaches in x within the row of texels that begins at `row`; `None` if it does not touch it.
fn extent_in_row(corners: &[DVec2; 4], row: f64) -> Option<(f64, f64)> {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for corner in 0..4 {
        let (mut upper, mut lower) = (corners[corner], corners[(corner + 1) % 4]);
        if upper.y > lower.y {
            core::mem::swap(&mut upper, &mut lower);
        }
        let (from, to) = (upper.y.max(row), lower.y.min(row + 1.0));
        if from > to {
            continue;
        }
        let at = |y: f64| {
            if upper.y == lower.y { upper.x } else { upper.x + (lower.x - upper.x) * ((y - upper.y) / (lower.y - upper.y)) }
        };
        let ends = if upper.y == lower.y { [upper.x, lower.x] } else { [at(from), at(to)] };
        left = left.min(ends[0]).min(ends[1]);
        right = right.max(ends[0]).max(ends[1]);
    }
    (left <= right).then_some((left, right))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: u32 = 150;
    const HEIGHT: u32 = 90;

    /// The texels that footprints meet, found one by one: by a separating line, which is along a side of the parallelogram or of the texel.
    fn met(footprint: &Footprint, [left, top]: [u32; 2]) -> Vec<[u32; 2]> {
        let corners = footprint.corners();
        let axes = [DVec2::X, DVec2::Y, footprint.sides[0].perp(), footprint.sides[1].perp()];
        let meets = |x: u32, y: u32| {
            let texel = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(dx, dy)| DVec2::new(f64::from(x + dx), f64::from(y + dy)));
            axes.iter().all(|axis| {
                let extent = |points: &[DVec2; 4]| {
                    let along = points.map(|point| point.dot(*axis));
                    (along.into_iter().fold(f64::INFINITY, f64::min), along.into_iter().fold(f64::NEG_INFINITY, f64::max))
                };
                let ((a, b), (c, d)) = (extent(&corners), extent(&texel));
                a < d && c < b
            })
        };
        let texels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| [left + x, top + y]));
        texels.filter(|[x, y]| meets(*x, *y)).collect()
    }

    fn view() -> ViewPlan {
        ViewPlan { rect: [10, 20, WIDTH, HEIGHT], ..ViewPlan::default() }
    }

    fn marked(seen: &SeenTexels) -> Vec<[u32; 2]> {
        let is_marked = |x: usize, y: usize| seen.words[y * seen.row_words + x / 64].load(Ordering::Relaxed) >> (x % 64) & 1 == 1;
        let texels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| [x, y]));
        texels.filter(|[x, y]| is_marked(*x as usize, *y as usize)).map(|[x, y]| [x + seen.rect[0], y + seen.rect[1]]).collect()
    }

    /// Small and large footprints, flat and steep, inside, across the borders and far out: what they meet is marked, and nothing else.
    #[test]
    fn the_texels_that_a_footprint_meets_are_marked() {
        // Numbers whose corners fall on no border of a texel, where rounding would decide.
        let centers = [(71.3, 60.2), (10.4, 20.7), (159.9, 109.8), (0.2, 64.1), (85.7, 130.3), (-500.3, 64.2)];
        let sides = [
            ((0.31, 0.02), (0.03, 0.27)),
            ((7.3, 1.9), (-2.6, 5.2)),
            ((70.1, 55.3), (-0.4, 0.9)),
            ((1.7, -90.2), (0.6, 3.1)),
            ((1200.3, 3.7), (-40.9, 900.1)),
            ((-3.2, -4.4), (6.3, 8.1)),
        ];
        let mut found = 0;
        for center in centers {
            for (right, below) in sides {
                let footprint = Footprint { center: center.into(), sides: [right.into(), below.into()] };
                let seen = SeenTexels::new(&view());
                seen.mark(&footprint);
                let expected = met(&footprint, [10, 20]);
                assert_eq!(marked(&seen), expected, "{center:?} {right:?} {below:?}");
                assert_eq!((seen.count_seen(), seen.count()), (expected.len() as u64, u64::from(WIDTH * HEIGHT)));
                found += expected.len();
            }
        }
        assert!(found > 50_000, "the footprints meet something: {found} texels");
    }

    /// A footprint that ends where texels do meets no more of them; one that is a point, or has no bounds, meets one.
    #[test]
    fn borders_belong_to_one_side() {
        let of = |center: (f64, f64), right: (f64, f64), below: (f64, f64)| {
            let seen = SeenTexels::new(&view());
            seen.mark(&Footprint { center: center.into(), sides: [right.into(), below.into()] });
            marked(&seen)
        };
        assert_eq!(of((13.0, 23.0), (2.0, 0.0), (0.0, 2.0)), [[12, 22], [13, 22], [12, 23], [13, 23]]);
        assert_eq!(of((12.0, 23.0), (0.0, 0.0), (0.0, 0.0)), [[12, 23]]);
        assert_eq!(of((12.6, 23.2), (f64::INFINITY, 0.0), (0.0, 1.0)), [[12, 23]]);
        assert_eq!(of((12.6, 23.2), (f64::NAN, 0.0), (0.0, 1.0)), [[12, 23]]);
        assert!(of((9.5, 23.2), (0.9, 0.0), (0.0, 0.9)).is_empty(), "outside the rectangle");
        assert!(of((f64::NAN, 23.2), (0.9, 0.0), (0.0, 0.9)).is_empty());
        assert_eq!(of((80.0, 60.0), (1e30, 0.0), (0.0, 1e30)).len(), (WIDTH * HEIGHT) as usize);
    }
}
