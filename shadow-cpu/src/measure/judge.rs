//! The judge: what a camera truly sees, and what is wrong with a frame of it.

use glam::DVec3;
use rayon::prelude::*;
use shadow_math::{
    LightKind, LightShape, MapAccess, Receiver,
    filter::filtered_test,
    plan::{LightPlan, ViewPlan},
    vector::row_times_point,
    visibility::{Choice, Lookup, NO_VIEW, choose_views, lookup, lookup_in_view, visibility_in_view},
};
use shadow_scene::{Frame, FrameMaps, FramePlan, Layer, LayerName, NO_TRIANGLE, Pixels, Scene, SceneLight};

use super::{
    cause::{Cause, Counts},
    regions::{Region, worst_regions},
    taps::{HidingTap, Taps},
};
use crate::trace::{CameraView, Hit, Rays, Sampling, Seen, SeenLights, SurfacePoint, Tracer};

/// Why a frame cannot be judged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum JudgeError {
    /// A layer that the judgement needs is not there.
    #[error("the frame has no layer `{0}`; ask the renderer for its camera and visibility layers")]
    Missing(LayerName),
    /// The frame is not of the judge's view.
    #[error(
        "the layer `{layer}` has {width} x {height} pixels of this kind, but the judge looked at {judge_width} x {judge_height}"
    )]
    Size {
        /// The layer.
        layer: LayerName,
        /// Its width in pixels; 0 if its pixels are of another kind.
        width: u32,
        /// Its height.
        height: u32,
        /// The width of the judge's view.
        judge_width: u32,
        /// The height of the judge's view.
        judge_height: u32,
    },
    /// The plan is not for the judge's scene.
    #[error("the plan has {plan} lights, but the judge's scene has {scene}")]
    Lights {
        /// Those of the plan.
        plan: usize,
        /// Those of the scene.
        scene: usize,
    },
}

/// What a camera truly sees of a scene and its lights.
#[derive(Debug)]
pub struct Judge<'a> {
    pub(super) tracer: &'a Tracer<'a>,
    pub(super) seen: Seen,
    lights: SeenLights,
    /// Whether each pixel sees the middle of each light, the lights of a pixel side by side; true where there is nothing.
    sees_center: Vec<bool>,
}

/// What is wrong with the visibility of one light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightJudgement {
    /// How many pixels are wrong, and why.
    pub counts: Counts,
    /// For each pixel the number of its [`Cause`], or 0 where it is right or was not judged.
    pub causes: Vec<u8>,
    /// For each pixel how far its visibility is from the truth, that of the light's whole size: from 0 to 1.
    pub errors: Vec<f32>,
}

/// What is wrong with a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Light by light, in the order of the scene's lights.
    pub lights: Vec<LightJudgement>,
}

impl Judgement {
    /// All lights together: a pixel counts once for each light.
    #[must_use]
    pub fn total(&self) -> Counts {
        let mut total = Counts::default();
        for light in &self.lights {
            total += light.counts;
        }
        total
    }

    /// The cause of each pixel's largest error among the lights for which it is wrong, or 0.
    #[must_use]
    pub fn causes(&self) -> Vec<u8> {
        let worst = |pixel: usize| {
            let wrong = self.lights.iter().filter(|light| light.causes[pixel] != 0);
            wrong.max_by(|a, b| a.errors[pixel].total_cmp(&b.errors[pixel]))
        };
        let pixels = self.width as usize * self.height as usize;
        (0..pixels).map(|pixel| worst(pixel).map_or(0, |light| light.causes[pixel])).collect()
    }

    /// The largest error of each pixel among the lights, from 0 to 1.
    #[must_use]
    pub fn errors(&self) -> Vec<f32> {
        let pixels = self.width as usize * self.height as usize;
        (0..pixels).map(|pixel| self.lights.iter().map(|light| light.errors[pixel]).fold(0.0, f32::max)).collect()
    }

    /// Up to `count` squares of `side` pixels in which the errors add up to most, the worst first; none overlap.
    #[must_use]
    pub fn worst_regions(&self, side: u32, count: usize) -> Vec<Region> {
        worst_regions(self.width, self.height, &self.errors(), &self.causes(), side, count)
    }
}

impl<'a> Judge<'a> {
    /// Traces what a camera sees. `on_row` is called, from any thread, as each row is done: three times in all for each.
    #[must_use]
    pub fn new(tracer: &'a Tracer<'a>, view: CameraView, sampling: Sampling, on_row: &(dyn Fn() + Sync)) -> Self {
        let seen = tracer.camera(view, on_row);
        let lights = tracer.lights(&seen, sampling, on_row);
        let count = tracer.scene().lights().len();
        let width = view.width() as usize;
        let mut sees_center = vec![true; seen.hits.len() * count];
        let rows = sees_center.par_chunks_mut((width * count).max(1)).zip(seen.hits.par_chunks(width));
        tracer.install(|| {
            rows.enumerate().for_each(|(y, (sees_center, hits))| {
                let mut rays = tracer.rays();
                for (x, hit) in hits.iter().enumerate().filter(|(_, hit)| hit.triangle != NO_TRIANGLE) {
                    for (index, light) in tracer.scene().lights().iter().enumerate() {
                        let place = x * count + index;
                        sees_center[place] = if light.shape == LightShape::Point {
                            lights.samples_seen[y * width * count + place] > 0
                        } else {
                            let point = tracer.surface_point(hit, view.ray(x as u32, y as u32));
                            rays.sees_center(&point, light)
                        };
                    }
                }
                on_row();
            });
        });
        Self { tracer, seen, lights, sees_center }
    }

    /// What the camera sees.
    #[must_use]
    pub fn seen(&self) -> &Seen {
        &self.seen
    }

    /// How much of each light is truly seen.
    #[must_use]
    pub fn lights(&self) -> &SeenLights {
        &self.lights
    }

    /// Says what is wrong with a frame that was rendered by `plan`: one of the judge's scene, lights and view.
    ///
    /// The frame needs its triangle layer and the visibility of every light. With its shadow maps too, acne is told from what slivers do to a map: see
    /// [`Counts::by_slivers`].
    ///
    /// # Errors
    ///
    /// [`JudgeError`]: a layer that is missing or of another size, or another number of lights.
    pub fn judge(&self, plan: &FramePlan, frame: &Frame) -> Result<Judgement, JudgeError> {
        let lights = self.tracer.scene().lights();
        if plan.lights.len() != lights.len() {
            return Err(JudgeError::Lights { plan: plan.lights.len(), scene: lights.len() });
        }
        let triangles = self.layer(frame, LayerName::Triangle, |pixels| match pixels {
            Pixels::Id(values) => Some(values.as_slice()),
            _ => None,
        })?;
        let maps = FrameMaps::of(frame, plan);
        let maps = maps.as_ref().map(|maps| maps as &Maps);
        let judged = (0..lights.len()).map(|light| {
            let visibility = self.layer(frame, LayerName::Visibility { light: light as u32 }, |pixels| match pixels {
                Pixels::Float(values) => Some(values.as_slice()),
                _ => None,
            })?;
            Ok(self.judge_light(plan, light, triangles, &|pixel, _| visibility[pixel], (&weightiest_lookup, true), maps))
        });
        let lights = judged.collect::<Result<_, _>>()?;
        Ok(Judgement { width: self.seen.view.width(), height: self.seen.view.height(), lights })
    }

    /// Says what would be wrong with one light's visibility if receivers asked the maps of `plan` by another rule: `ask` takes the place of
    /// [`lookup`](shadow_math::visibility::lookup). `triangles` are those that the renderer's camera sees.
    ///
    /// # Panics
    ///
    /// If the plan, the maps or the triangles are not of the judge's scene and view, or the scene has no such light.
    #[must_use]
    pub fn judge_rule(
        &self,
        plan: &FramePlan,
        light: usize,
        triangles: &[u32],
        maps: &(impl MapAccess + Sync),
        ask: &Ask<'_>,
    ) -> LightJudgement {
        let light_plan = &plan.lights[light];
        let answer = |receiver: &Receiver| {
            let found = ask(light_plan, &plan.views, receiver);
            let Some(view) = plan.views.get(found.view as usize) else { return found.known };
            filtered_test(maps, view, light_plan, &found)
        };
        // Where nothing is drawn, everything is lit.
        let visibility = |_: usize, receiver: Option<&Receiver>| receiver.map_or(1.0, answer);
        self.judge_light(plan, light, triangles, &visibility, (ask, false), Some(maps))
    }

    /// The values of a layer of the judge's size.
    fn layer<'f, T>(
        &self,
        frame: &'f Frame,
        name: LayerName,
        values: impl Fn(&'f Pixels) -> Option<&'f [T]>,
    ) -> Result<&'f [T], JudgeError> {
        let layer: &Layer = frame.layer(name).ok_or(JudgeError::Missing(name))?;
        let (judge_width, judge_height) = (self.seen.view.width(), self.seen.view.height());
        let wrong_size = |width, height| JudgeError::Size { layer: name, width, height, judge_width, judge_height };
        let values = values(&layer.pixels).ok_or(wrong_size(0, 0))?;
        if (layer.width, layer.height, values.len()) == (judge_width, judge_height, self.seen.hits.len()) {
            Ok(values)
        } else {
            Err(wrong_size(layer.width, layer.height))
        }
    }

    /// Judges the visibility of one light: `visibility` of each pixel and receiver, where there is one, which came of what it asked.
    fn judge_light(
        &self,
        plan: &FramePlan,
        light: usize,
        triangles: &[u32],
        visibility: &(dyn Fn(usize, Option<&Receiver>) -> f32 + Sync),
        (ask, blends): (&Ask<'_>, bool),
        maps: Option<&Maps>,
    ) -> LightJudgement {
        let width = self.seen.view.width() as usize;
        let mut causes = vec![0; triangles.len()];
        let mut errors = vec![0.0; triangles.len()];
        let rows = causes.par_chunks_mut(width).zip(errors.par_chunks_mut(width));
        let counts = self.tracer.install(|| {
            let rows = rows.enumerate().map(|(y, (causes, errors))| {
                let mut rays = self.tracer.rays();
                let mut counts = Counts::default();
                for x in 0..width {
                    let pixel = y * width + x;
                    let triangle = triangles[pixel];
                    let receiver =
                        (triangle != NO_TRIANGLE).then(|| receiver_at(self.tracer.scene(), plan, triangle, x as u32, y as u32));
                    let answer = Answer { receiver, visibility: visibility(pixel, receiver.as_ref()), ask, blends, maps };
                    let judged = self.judge_pixel(plan, light, (x as u32, y as u32), triangle, &answer, &mut rays);
                    let Some(JudgedPixel { found, error, is_at_terminator }) = judged else { continue };
                    counts.judged += 1;
                    counts.at_terminator += u64::from(is_at_terminator);
                    counts.squared_error += error * error;
                    errors[x] = error as f32;
                    if let Some(Found { cause, is_by_slivers }) = found {
                        counts.by_slivers += u64::from(is_by_slivers);
                        causes[x] = cause as u8;
                        counts.causes[cause as usize - 1] += 1;
                    }
                }
                counts
            });
            // Added up in the order of the rows: a sum of floats depends on it.
            let rows: Vec<Counts> = rows.collect();
            rows.into_iter().fold(Counts::default(), |mut sum, row| {
                sum += row;
                sum
            })
        });
        LightJudgement { counts, causes, errors }
    }

    /// Judges one pixel; `None` where there is nothing, or nothing that the light could reach.
    fn judge_pixel(
        &self,
        plan: &FramePlan,
        light_index: usize,
        (x, y): (u32, u32),
        triangle: u32,
        answer: &Answer<'_>,
        rays: &mut Rays<'_>,
    ) -> Option<JudgedPixel> {
        let Answer { receiver, visibility, ask, blends, maps } = *answer;
        let scene = self.tracer.scene();
        let index = y as usize * self.seen.view.width() as usize + x as usize;
        let hit = &self.seen.hits[index];
        let place = index * scene.lights().len() + light_index;
        let truth = f64::from(self.lights.samples_seen[place]) / f64::from(self.lights.sampling.count());
        let is_wrong = visibility != f32::from(u8::from(self.sees_center[place]));
        // A visibility that is no number is as wrong as can be.
        let error = (f64::from(visibility) - truth).abs();
        let error = if error <= 1.0 { error } else { 1.0 };
        let Some(receiver) = receiver.filter(|_| hit.triangle == triangle) else {
            let shows_something = hit.triangle != NO_TRIANGLE || triangle != NO_TRIANGLE;
            let cause = is_wrong.then_some(Cause::Coverage);
            return shows_something.then_some(JudgedPixel { found: cause.map(Found::of), error, is_at_terminator: false });
        };
        let light_plan = &plan.lights[light_index];
        if row_times_point(light_plan.view_distance, receiver.point) > light_plan.shadow_far {
            // Beyond the distance up to which there are to be shadows nothing is owed.
            return None;
        }
        let ray = self.seen.view.ray(x, y);
        let point = self.tracer.surface_point(hit, ray);
        let light = &scene.lights()[light_index];
        let toward = toward_center(light, point.position)?;
        let shading_normal = shading_normal(scene, hit, ray.direction());
        let faces = |normal: DVec3| normal.dot(toward) > 0.0;
        let is_at_terminator = shading_normal != DVec3::ZERO && faces(shading_normal) != faces(point.normal);
        let found = is_wrong.then(|| {
            if is_at_terminator {
                return Found::of(Cause::Terminator);
            }
            let corners = self.tracer.corners(triangle);
            let largest = corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
            let light_plan = &plan.lights[light_index];
            let truth = f32::from(u8::from(self.sees_center[place]));
            let mut cause_of = |lookup: Lookup, visibility: f32| {
                let view = plan.views.get(lookup.view as usize);
                let taken = Taken { light, plan: light_plan, view, lookup, visibility, largest, maps };
                cause_by_taps(&point, &taken, self.sees_center[place], rays)
            };
            // Between two cascades the one that is wrong by itself is to blame; if both are, the one that counts more.
            let blended = if blends { blended_views(light_plan, &plan.views, &receiver) } else { None };
            if let (Some(indices), Some(maps)) = (blended, maps) {
                for index in indices {
                    let own = visibility_in_view(light_plan, &plan.views, &OfAnyKind(maps), index, &receiver);
                    if own != truth {
                        return cause_of(lookup_in_view(light_plan, &plan.views[index as usize], index, &receiver), own);
                    }
                }
            }
            cause_of(ask(light_plan, &plan.views, &receiver), visibility)
        });
        Some(JudgedPixel { found, error, is_at_terminator })
    }
}

/// What a renderer's receiver is at a pixel that shows this triangle.
pub(super) fn receiver_at(scene: &Scene, plan: &FramePlan, triangle: u32, x: u32, y: u32) -> Receiver {
    scene.receiver(triangle, &plan.camera.rays, [x, y])
}

/// What a receiver asks of the view that counts most: between two cascades that is the one whose answer has the larger share.
pub(super) fn weightiest_lookup(light: &LightPlan, views: &[ViewPlan], receiver: &Receiver) -> Lookup {
    let choice = choose_views(light, views, receiver);
    if choice.first == NO_VIEW || choice.share <= 0.5 {
        return lookup(light, views, receiver);
    }
    lookup_in_view(light, &views[choice.second as usize], choice.second, receiver)
}

/// Both views that a receiver between two cascades asks, the one that counts more first; `None` elsewhere.
fn blended_views(light: &LightPlan, views: &[ViewPlan], receiver: &Receiver) -> Option<[u32; 2]> {
    let Choice { first, second, share, .. } = choose_views(light, views, receiver);
    (first != NO_VIEW && share > 0.0).then_some(if share > 0.5 { [second, first] } else { [first, second] })
}

/// Shadow maps of any kind, for those who want to know which.
struct OfAnyKind<'a>(&'a Maps<'a>);

impl MapAccess for OfAnyKind<'_> {
    fn fetch_texel(&self, layer: u32, x: u32, y: u32) -> f32 {
        self.0.fetch_texel(layer, x, y)
    }
}

/// Shadow maps of any kind.
type Maps<'a> = dyn MapAccess + Sync + 'a;

/// How a receiver asks the maps of a light, told all views of the frame.
pub type Ask<'a> = dyn Fn(&LightPlan, &[ViewPlan], &Receiver) -> Lookup + Sync + 'a;

/// What a pixel's receiver asked, and what came of it.
struct Answer<'a> {
    /// `None` where nothing is drawn.
    receiver: Option<Receiver>,
    visibility: f32,
    ask: &'a Ask<'a>,
    /// Whether two cascades may have answered together.
    blends: bool,
    maps: Option<&'a Maps<'a>>,
}

/// What a pixel is judged to be.
struct JudgedPixel {
    found: Option<Found>,
    error: f64,
    is_at_terminator: bool,
}

/// A lookup that was taken, and what came of it.
struct Taken<'a> {
    light: &'a SceneLight,
    plan: &'a LightPlan,
    /// The view that was asked, if any was.
    view: Option<&'a ViewPlan>,
    lookup: Lookup,
    visibility: f32,
    /// The largest coordinate of the receiver's triangle, in metres.
    largest: f64,
    /// The maps, if they are known.
    maps: Option<&'a Maps<'a>>,
}

/// A cause that was found.
struct Found {
    cause: Cause,
    /// Whether slivers in the map are to blame.
    is_by_slivers: bool,
}

impl Found {
    const fn of(cause: Cause) -> Self {
        Self { cause, is_by_slivers: false }
    }
}

/// Why the visibility of a pixel is wrong, where rays and rasteriser see the same triangle and both normals agree.
fn cause_by_taps(receiver: &SurfacePoint, taken: &Taken<'_>, sees_center: bool, rays: &mut Rays<'_>) -> Found {
    let Taken { light, plan, view, lookup, visibility, largest, maps } = taken;
    let Some(view) = view else {
        // Without a map a surface that faces away is dark: single and double precision disagree about that. All else is lit.
        return Found::of(if lookup.known == 0.0 { Cause::Terminator } else { Cause::Leak });
    };
    if !Rays::faces_center(receiver, light) {
        return Found::of(Cause::Terminator);
    }
    let taps = Taps::of(plan, view, lookup, receiver, *largest);
    if taps.cross_seam(plan, lookup) {
        return Found::of(Cause::Seam);
    }
    // Where the light's ray does not meet the plane, nothing of the plane is lit.
    let mut sees = |point: Option<SurfacePoint>| point.is_some_and(|point| rays.sees_center(&point, light));
    let mut is_mixed = taps.centers().any(|point| sees(point) != sees_center);
    if !is_mixed {
        // Where the centres agree, what lies as near to them as outlines in the map can be off must agree too.
        is_mixed = if sees_center {
            taps.centers().flatten().any(|point| rays.is_center_nearly_hidden(&point, light, taps.clearance(&point)))
        } else {
            taps.around().any(sees)
        };
    }
    if is_mixed {
        return Found::of(if *visibility > 0.0 && *visibility < 1.0 { Cause::Filter } else { Cause::Aliasing });
    }
    if sees_center {
        let hiding = maps.map_or_else(Vec::new, |maps| taps.hiding(maps, lookup).collect());
        // What a texel holds is wrong where no surface that the light sees first has that depth, and a sliver is there that may have been given it.
        let mut is_by_a_sliver = |tap: &HidingTap| {
            let seen = rays.first_from_center(tap.behind, light);
            let holds = seen.is_some_and(|seen| taps.can_hold(tap, &seen));
            !holds && rays.is_near_ray_from_center(tap.behind, light, taps.widest_clearance(), |corners| taps.is_sliver(corners))
        };
        let is_all_by_slivers = !hiding.is_empty() && hiding.iter().all(&mut is_by_a_sliver);
        return Found { cause: if is_all_by_slivers { Cause::Coverage } else { Cause::Acne }, is_by_slivers: is_all_by_slivers };
    }
    let gap = taps.gap_metres(light, lookup);
    let blocker = rays.blocker_of_center(receiver, light);
    let is_nearer = blocker.is_some_and(|(ray, hit)| {
        let pushed = taps.pushed_metres(light, ray.at(hit.distance), &rays.corners(hit.triangle));
        ray.direction().length() * hit.distance <= gap + pushed
    });
    Found::of(if is_nearer { Cause::PeterPanning } else { Cause::Leak })
}

/// The vector toward the middle of a light, of any length; `None` where its light does not reach.
pub(super) fn toward_center(light: &SceneLight, point: DVec3) -> Option<DVec3> {
    let reaches = |toward: DVec3, range: Option<f32>| range.is_none_or(|range| toward.length() <= f64::from(range));
    match light.light.kind {
        LightKind::Directional { direction } => Some(-direction.as_dvec3()),
        LightKind::Spot { position, direction, outer, range, .. } => {
            let toward = position.as_dvec3() - point;
            let is_in_cone = (-toward).angle_between(direction.as_dvec3()) < f64::from(outer);
            (is_in_cone && reaches(toward, range)).then_some(toward)
        }
        LightKind::Point { position, range } => {
            let toward = position.as_dvec3() - point;
            reaches(toward, range).then_some(toward)
        }
    }
}

/// The interpolated normal where a ray met a triangle, turned as the geometric one is; zero where the mesh has none.
fn shading_normal(scene: &Scene, hit: &Hit, direction: DVec3) -> DVec3 {
    let [i0, i1, i2] = scene.triangles()[hit.triangle as usize].map(|corner| corner as usize);
    let (normals, positions) = (&scene.vertices().normals, &scene.vertices().positions);
    let at = |corner: usize| normals[corner].as_dvec3();
    let normal = at(i0) * (1.0 - hit.u - hit.v) + at(i1) * hit.u + at(i2) * hit.v;
    let geometric = (positions[i1] - positions[i0]).as_dvec3().cross((positions[i2] - positions[i0]).as_dvec3());
    if geometric.dot(direction) > 0.0 { -normal } else { normal }
}
