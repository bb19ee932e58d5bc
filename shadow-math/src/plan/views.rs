//! The views of one light: which there are, and what each is fitted to.

use glam::{DVec3, DVec4};

use super::{
    data::{LightPlan, SELECT_BY_CONTAINMENT, SELECT_BY_DEPTH, SPLIT_CASCADES, SPLIT_CUBE, SPLIT_SINGLE, ViewPlan},
    error::PlanError,
    pancake::Room,
    view::{plan_view, rounded},
};
use crate::{
    filter::guard_texels,
    fit::{
        self, CUBE_FACES, CascadeSphere, Content, Eye, FallBack, FitOutcome, LightFrame, LispsmWarp, MAX_POINTS, OGRE_THRESHOLD,
        OgreSetup, Subject, ViewFit, boxed_view, focused_view, lispsm_view, ogre_tweak, ogre_uniform_view, ogre_warp,
        optimal_warp, plane_depth_factor, plane_optimal, stabilised_view, visible_body, visible_in_view, visible_range,
    },
    light::{Light, LightKind, MAX_SINGLE_MAP_OUTER_ANGLE},
    polytope::Polytope,
    settings::{Cascades, Fit, FitFrom, MAX_CASCADES, Selection, ShadowSettings, Split, SplitScheme},
    splits::{histogram_bin, practical_split, quantile_splits},
};

/// How many views a light takes under these settings: 1, 6, or one for each cascade. Fits that make one map for any light, plane-optimal and OGRE's uniform one, take one where they exist, and these where they do not.
///
/// # Errors
///
/// [`PlanError::CubeAroundDirection`], [`PlanError::CascadesOfCube`] and [`PlanError::CascadeCount`].
pub fn view_count(light: &Light, settings: &ShadowSettings) -> Result<usize, PlanError> {
    let takes_cube = match light.kind {
        LightKind::Directional { .. } => false,
        LightKind::Spot { outer, .. } => outer > MAX_SINGLE_MAP_OUTER_ANGLE,
        LightKind::Point { .. } => true,
    };
    match settings.split {
        Split::Single if takes_cube => Ok(CUBE_FACES.len()),
        Split::Single => Ok(1),
        Split::Cube if light.position().is_none() => Err(PlanError::CubeAroundDirection),
        Split::Cube => Ok(CUBE_FACES.len()),
        Split::Cascades(_) if takes_cube => Err(PlanError::CascadesOfCube),
        Split::Cascades(Cascades { count, .. }) => {
            let views = count as usize;
            if (1..=MAX_CASCADES).contains(&views) { Ok(views) } else { Err(PlanError::CascadeCount(count)) }
        }
    }
}

/// Fits a light's views and writes them, and what receivers need to choose among them.
pub(super) fn plan_views(
    plan: &mut LightPlan,
    light: &Light,
    subject: &Subject<'_>,
    settings: &ShadowSettings,
    first_layer: u32,
    views: &mut [ViewPlan],
) -> Result<(), PlanError> {
    if let (Split::Cascades(Cascades { stabilised: true, .. }), Some(_)) = (settings.split, light.position()) {
        return Err(PlanError::StabilisedLight);
    }
    let guard = guard_texels(plan, settings.bias);
    plan.guard_texels = guard as f32;
    if let Some(metres) = settings.shadow_distance {
        plan.shadow_far = metres;
    }
    if let Some(eye) = subject.eye {
        eye.camera.validate()?;
        if settings.fit_from == FitFrom::Samples && eye.samples.is_empty() {
            return Err(PlanError::NoSamples);
        }
        plan.view_distance = rounded(eye.distance_row());
    } else if plan.shadow_far < f32::MAX
        || matches!(settings.split, Split::Cascades(_))
        || settings.fit != Fit::Uniform
        || settings.pancake
    {
        return Err(PlanError::NoCamera);
    }
    // Whether a map contains a receiver is asked in single precision: a texel more keeps what the map was fitted to away from where rounding decides.
    let is_contained = matches!(settings.split, Split::Cascades(Cascades { selection: Selection::Containment, .. }));
    let fitting = Fitting { light, subject, settings, guard: guard + u32::from(is_contained) };
    plan.split = match (settings.split, views.len()) {
        (Split::Cascades(_), _) => SPLIT_CASCADES,
        (_, 1) => SPLIT_SINGLE,
        _ => SPLIT_CUBE,
    };
    let mut layer = first_layer;
    let light_plan = *plan;
    let mut write = |view: &mut ViewPlan, fit: &ViewFit, asked: Looked| {
        *view = plan_view(fit, subject.bounds, settings, layer);
        if let Some(depths) = fitting.depths(&light_plan, fit, view, asked) {
            *view = plan_view(&fit.pancaked(depths), subject.bounds, settings, layer);
        }
        layer += u32::from(fit.outcome != FitOutcome::NothingVisible);
    };
    match settings.split {
        Split::Cascades(cascades) => {
            let covered = fitting.covered_range(&cascades)?;
            let ends = fitting.cascade_ends(&cascades, covered)?;
            for size in &cascades.map_sizes[..cascades.count as usize] {
                fitting.check_size(size.unwrap_or(settings.map_size))?;
            }
            // Distances that are given can end cascades beyond all that is seen: those after it do not exist.
            let farthest = ends[cascades.count as usize];
            let count = 1 + ends[1..cascades.count as usize].iter().filter(|end| **end < farthest).count() as u32;
            let cascades = Cascades { count, ..cascades };
            plan.view_count = count;
            fitting.set_selection(plan, &cascades, &ends);
            let mut asked = Asked { range: covered, ..Asked::default() };
            for (cascade, view) in views[..count as usize].iter_mut().enumerate() {
                let begin = if cascade == 0 { covered.map_or(0.0, |[nearest, _]| nearest) } else { ends[cascade] };
                if ends[cascade + 1] <= begin {
                    // Or before all that is seen.
                    write(view, &ViewFit { outcome: FitOutcome::NothingVisible, ..fitting.uniform(None) }, Looked::All);
                    continue;
                }
                let size = cascades.map_sizes[cascade].unwrap_or(settings.map_size);
                let slice = fitting.padded_slice(plan, &cascades, &ends, covered, cascade)?;
                let fit = fitting.cascade(&cascades, cascade, slice, &mut asked, size)?;
                // By containment whatever is seen may ask.
                let range = if cascades.selection == Selection::Depth { slice } else { covered.unwrap_or_default() };
                write(view, &fit, if cascades.stabilised { Looked::Sphere(range) } else { Looked::Slice(range) });
            }
        }
        _ => {
            fitting.check_size(settings.map_size)?;
            let count = views.len();
            let face_of = |view: usize| if count == 1 { None } else { Some(view) };
            let mut why = None;
            if settings.fit.makes_one_map() {
                match fitting.of_all(face_of(0))? {
                    Ok(fit) => {
                        write(&mut views[0], &fit, Looked::All);
                        (plan.view_count, plan.split) = (1, SPLIT_SINGLE);
                        return Ok(());
                    }
                    Err(fall_back) => why = Some(fall_back),
                }
            }
            for (index, view) in views.iter_mut().enumerate() {
                let fit = match why {
                    Some(why) => fitting.uniform(face_of(index)).in_place_of_another(why),
                    None => fitting.whole(face_of(index))?,
                };
                write(view, &fit, Looked::All);
            }
        }
    }
    Ok(())
}

/// What the views of one light are made from.
struct Fitting<'a> {
    light: &'a Light,
    subject: &'a Subject<'a>,
    settings: &'a ShadowSettings,
    guard: u32,
}

/// What is fitted of a camera's view.
#[derive(Clone, Copy)]
struct Slice {
    /// Between which distances along the camera's axis, in metres.
    range: [f64; 2],
    /// Who else may ask the map.
    asked: Asked,
    /// The map's size in texels.
    size: u32,
    /// What the best warp's parameter is multiplied by; 0 for no warp.
    lispsm_factor: f64,
    /// The camera's near and far distances as OGRE's warp takes them: 0 for no far plane.
    ogre_planes: [f64; 2],
}

/// Which receivers ask a map that lie beyond what it is fitted to.
#[derive(Clone, Copy, Default)]
struct Asked {
    /// Between which distances a receiver may lie that asks because it happens to be in the map; `None` where none does.
    range: Option<[f64; 2]>,
    /// The map before it, of which any receiver may ask that is in it: where the two are blended.
    before: Option<ViewFit>,
    /// What that has between its guard bands, as a sphere before the camera: of stabilised cascades.
    sphere: Option<CascadeSphere>,
}

/// What asks a map, as far as its depth goes.
#[derive(Clone, Copy)]
enum Looked {
    /// All that is seen.
    All,
    /// What is seen between two distances along the camera's axis, in metres.
    Slice([f64; 2]),
    /// What is there to be seen, whichever way the camera looks.
    Sphere([f64; 2]),
}

/// Where cascades begin and end, in metres from the camera along its axis: one number more than there are cascades.
type Ends = [f64; MAX_CASCADES + 1];

impl Fitting<'_> {
    /// Whether a map of this size has texels left within its guard bands.
    fn check_size(&self, size: u32) -> Result<(), PlanError> {
        // Stabilised cascades take a texel more, by which they are moved.
        if size <= 2 * self.guard + 1 {
            return Err(PlanError::MapTooSmallForFilter { size, filter: self.settings.filter, guard: self.guard });
        }
        Ok(())
    }

    /// The camera; an error where there is none.
    fn eye(&self) -> Result<&Eye<'_>, PlanError> {
        self.subject.eye.as_ref().ok_or(PlanError::NoCamera)
    }

    /// What bodies are made from: the camera, with its samples if fits follow them.
    fn fitted<'e>(&self, eye: &Eye<'e>) -> Eye<'e> {
        match self.settings.fit_from {
            FitFrom::Samples => *eye,
            FitFrom::Frustum => Eye { samples: &[], ..*eye },
        }
    }

    /// The distance up to which there are shadows, in metres.
    fn shadow_distance(&self) -> f64 {
        self.settings.shadow_distance.map_or(f64::INFINITY, f64::from)
    }

    /// The light's frame, or that of a face of the cube around it.
    fn frame(&self, face: Option<usize>) -> LightFrame {
        #[cfg(not(feature = "std"))]
        use crate::float::FloatFuncs;
        let limit = f64::from(self.light.range());
        match (self.light.kind, face) {
            (LightKind::Directional { direction }, _) => LightFrame::parallel(direction),
            (LightKind::Spot { position, direction, outer, .. }, None) => {
                LightFrame::perspective(position, direction.as_dvec3(), f64::from(outer).tan(), limit)
            }
            (LightKind::Spot { position, .. } | LightKind::Point { position, .. }, face) => {
                LightFrame::perspective(position, CUBE_FACES[face.unwrap_or(0)], 1.0, limit)
            }
        }
    }

    /// The uniform view: all that the light reaches.
    fn uniform(&self, face: Option<usize>) -> ViewFit {
        let (size, guard) = (self.settings.map_size, self.guard);
        let Subject { casters, bounds, .. } = *self.subject;
        let limit = f64::from(self.light.range());
        match (self.light.kind, face) {
            (LightKind::Directional { direction }, _) => fit::directional_view(direction, bounds, size, guard),
            (LightKind::Spot { position, direction, outer, .. }, None) => {
                fit::spot_view(position, direction, f64::from(outer), limit, casters, size, guard)
            }
            (LightKind::Spot { position, .. } | LightKind::Point { position, .. }, face) => {
                let range = fit::range_around_point(position.as_dvec3(), casters, limit);
                fit::cube_face_view(position, face.unwrap_or(0), range, size, guard)
            }
        }
    }

    /// A view of all that the camera sees, in one map or one face of a cube.
    fn whole(&self, face: Option<usize>) -> Result<ViewFit, PlanError> {
        let fit = self.settings.fit;
        if fit == Fit::Uniform {
            return Ok(self.uniform(face));
        }
        let eye = self.eye()?;
        let size = self.settings.map_size;
        let Some(range) = visible_range(&self.fitted(eye), self.subject.bounds, self.shadow_distance()) else {
            return Ok(ViewFit { outcome: FitOutcome::NothingVisible, ..self.uniform(face) });
        };
        let frame = self.frame(face);
        let [near, far] = eye.planes();
        let ogre_planes = [near, if far.is_finite() { far } else { 0.0 }];
        let slice = Slice { range, asked: Asked::default(), size, lispsm_factor: 1.0, ogre_planes };
        Ok(self.of_slice(fit, &frame, slice, || self.uniform(face)))
    }

    /// The one view of all that there is, of the fits that make one for any light.
    fn of_all(&self, face: Option<usize>) -> Result<Result<ViewFit, FallBack>, PlanError> {
        let eye = self.eye()?;
        if self.settings.fit == Fit::OgreUniform {
            let mut setup = OgreSetup::of_camera(&eye.camera, self.settings.shadow_distance.map_or(0.0, f64::from));
            if setup.far_distance <= 0.0 {
                // An orthographic camera can begin where it is, which OGRE's rule makes no distance of: then all of the scene.
                setup.far_distance = 2.0 * f64::from(self.subject.bounds.radius()).max(MIN_FAR_OF_SPLIT);
            }
            return Ok(Ok(ogre_uniform_view(self.light, &eye.camera, &setup, self.subject, self.settings.map_size)));
        }
        let Some(range) = visible_range(&self.fitted(eye), self.subject.bounds, self.shadow_distance()) else {
            return Ok(Ok(ViewFit { outcome: FitOutcome::NothingVisible, ..self.uniform(face) }));
        };
        Ok(self.plane_optimal(eye, &self.frame(None), range))
    }

    /// The view of what is seen between two distances, by one of the fits that follow a body.
    fn of_slice(&self, fit: Fit, frame: &LightFrame, slice: Slice, uniform: impl FnOnce() -> ViewFit) -> ViewFit {
        let Slice { range, asked, size, lispsm_factor, ogre_planes } = slice;
        let Some(eye) = &self.subject.eye else { return uniform() };
        let body = visible_body(&self.fitted(eye), range, self.subject, frame);
        let whole = asked.range.map_or(Polytope::EMPTY, |range| visible_body(&self.fitted(eye), range, self.subject, frame));
        let mut within = Polytope::EMPTY;
        if let Some(before) = asked.before.filter(|before| before.outcome != FitOutcome::NothingVisible) {
            within = whole;
            for plane in before.sides() {
                within.clip(plane);
            }
        }
        let mut points = [DVec3::ZERO; MAX_POINTS];
        let count = body.vertices().len() + within.vertices().len();
        for (point, vertex) in points.iter_mut().zip(body.vertices().iter().chain(within.vertices())) {
            *point = *vertex;
        }
        let points = &points[..count];
        if points.is_empty() {
            return ViewFit { outcome: FitOutcome::NothingVisible, ..uniform() };
        }
        let others = whole.vertices();
        let content = Content { points, others, casters: self.subject.casters };
        let view = match fit {
            Fit::Focused => Ok(focused_view(frame, &content, size, self.guard)),
            Fit::Lispsm | Fit::OgreLispsm => {
                // Receivers that only happen to be in the map have no say in how it is warped.
                let own = if body.vertices().is_empty() { points } else { body.vertices() };
                let optimal = optimal_warp(frame, eye, own);
                optimal.map(|warp| {
                    let (axis, parameter) = if fit == Fit::OgreLispsm {
                        ogre_axis_and_parameter(frame, eye, own, ogre_planes)
                    } else if lispsm_factor == 0.0 {
                        (eye.camera.eye, f64::INFINITY)
                    } else {
                        (eye.camera.eye, warp.parameter * lispsm_factor)
                    };
                    lispsm_view(frame, axis, LispsmWarp { parameter, ..warp }, &content, size, self.guard)
                })
            }
            _ => Ok(boxed_view(frame, &content, size, self.guard)),
        };
        // Where no warp is the best one, the map is as tight without it.
        view.unwrap_or_else(|why| boxed_view(frame, &content, size, self.guard).in_place_of_another(why))
    }

    /// The plane-optimal view.
    fn plane_optimal(&self, eye: &Eye<'_>, frame: &LightFrame, range: [f64; 2]) -> Result<ViewFit, FallBack> {
        // Settings are of no scene, and count from the world's origin; all else here counts from the scene's.
        let given = self.settings.plane.map(|plane| {
            let plane = DVec4::from_array(plane.map(f64::from));
            plane.with_w(plane.w + plane.truncate().dot(self.subject.origin))
        });
        let plane = given.or(eye.plane).ok_or(FallBack::NoPlane)?;
        let rows = plane_optimal(eye, plane, frame.light())?;
        if !rows.is_seen(eye, range) || !rows.faces(eye) {
            return Err(FallBack::PlaneOutOfView);
        }
        Ok(rows.view(eye, plane_depth_factor(&rows, self.subject.casters), self.settings.map_size))
    }

    /// The depths of a view between which receivers ask its map, with room for their biases; `None` where it is not to be pancaked, or nothing is gained. `draft` is the view's plan as it is.
    fn depths(&self, light: &LightPlan, fit: &ViewFit, draft: &ViewPlan, asked: Looked) -> Option<[f64; 2]> {
        if !self.settings.pancake || fit.outcome == FitOutcome::NothingVisible {
            return None;
        }
        let eye = self.fitted(self.subject.eye.as_ref()?);
        let room = Room::of(light, fit, draft);
        let range = match asked {
            Looked::All => visible_range(&eye, self.subject.bounds, self.shadow_distance())?,
            Looked::Slice(range) => range,
            Looked::Sphere(range) => {
                let sphere = CascadeSphere::around(eye.camera.projection, eye.aspect, range);
                return room.sphere_depths(&eye, sphere, self.subject);
            }
        };
        // A lookup that is moved, and one whose place is rounded, may be in the map where its receiver is not.
        let rim = f64::from(light.guard_texels) + 1.0;
        if eye.samples.is_empty() {
            return room.depths(visible_in_view(&eye, range, self.subject, fit, rim).vertices().iter().copied());
        }
        // Samples say where receivers are.
        let (row, sides) = (eye.distance_row(), fit.sides_widened_by(rim));
        let is_asked = |point: &DVec3| {
            let point = point.extend(1.0);
            let distance = row.dot(point);
            let is_in_range = distance >= range[0] && distance <= range[1] && fit.half_space.dot(point) >= 0.0;
            is_in_range && sides.iter().all(|side| side.dot(point) >= 0.0)
        };
        room.depths(eye.samples.iter().map(|point| point.as_dvec3()).filter(is_asked))
    }

    /// Where cascades begin and end: with numbers above 0 that grow, so that splits by factors exist.
    fn cascade_ends(&self, cascades: &Cascades, covered: Option<[f64; 2]>) -> Result<Ends, PlanError> {
        let eye = self.eye()?;
        // Nothing has splits, too.
        let [near, far] = covered.unwrap_or([eye.planes()[0]; 2]);
        let far = far.max(near * 2.0).max(MIN_FAR_OF_SPLIT);
        let near = near.max(far * MIN_NEAR_OF_SPLIT);
        let count = cascades.count as usize;
        let mut ends = [far; MAX_CASCADES + 1];
        ends[0] = near;
        match cascades.scheme {
            SplitScheme::Explicit(given) => {
                for (end, &metres) in ends[1..count].iter_mut().zip(&given) {
                    *end = f64::from(metres).clamp(near, far);
                }
            }
            SplitScheme::Histogram => {
                if eye.samples.is_empty() {
                    return Err(PlanError::NoSamples);
                }
                let row = eye.distance_row();
                let mut histogram = [0; HISTOGRAM_BINS];
                // What lies beyond the shadow distance asks no map.
                for distance in eye.samples.iter().map(|point| row.dot(point.as_dvec3().extend(1.0))).filter(|d| *d <= far) {
                    histogram[histogram_bin(distance, near, far, HISTOGRAM_BINS)] += 1;
                }
                quantile_splits(&histogram, near, far, &mut ends[..=count]);
            }
            scheme => {
                let lambda = match scheme {
                    SplitScheme::Uniform => 0.0,
                    SplitScheme::Practical(lambda) => lambda,
                    _ => 1.0,
                };
                for (i, end) in ends[..=count].iter_mut().enumerate() {
                    *end = practical_split(near, far, f64::from(lambda), i, count);
                }
            }
        }
        Ok(ends)
    }

    /// Between which distances from the camera, along its axis in metres, all cascades together have what can be seen; `None` where that is nothing.
    fn covered_range(&self, cascades: &Cascades) -> Result<Option<[f64; 2]>, PlanError> {
        let eye = self.eye()?;
        let bounds = self.subject.bounds;
        if !cascades.stabilised {
            return Ok(visible_range(&self.fitted(eye), bounds, self.shadow_distance()));
        }
        let [near, far] = eye.planes();
        let far = far.min(self.shadow_distance()).min(self.size_of_scene(eye));
        Ok(Some([near, far.max(near)]))
    }

    /// No less than what the camera can see of the scene, in metres along its axis: a power of two, so that it stays as it is while the camera moves, casters move the scene's bounds, and the origin moves with the camera.
    fn size_of_scene(&self, eye: &Eye<'_>) -> f64 {
        let bounds = self.subject.bounds;
        let radius = f64::from(bounds.radius()).max(MIN_FAR_OF_SPLIT);
        // A camera within the sphere around the scene sees none of it beyond twice the radius.
        let farthest = eye.camera.eye.distance(bounds.center().as_dvec3()) + radius;
        next_power_of_two((2.0 * radius).max(farthest))
    }

    /// Writes how receivers choose among cascades.
    fn set_selection(&self, plan: &mut LightPlan, cascades: &Cascades, ends: &Ends) {
        let count = cascades.count as usize;
        plan.selection = match cascades.selection {
            Selection::Depth => SELECT_BY_DEPTH,
            Selection::Containment => SELECT_BY_CONTAINMENT,
        };
        for cascade in 0..count {
            let [begin, end] = [ends[cascade], ends[cascade + 1]];
            plan.split_far[cascade / 4][cascade % 4] = end as f32;
            let is_last = cascade + 1 == count;
            let band = match cascades.selection {
                Selection::Depth => f64::from(cascades.blend) * (end - begin),
                Selection::Containment => f64::from(cascades.blend),
            };
            plan.split_band[cascade / 4][cascade % 4] = if is_last { 0.0 } else { band as f32 };
        }
        // The last cascade has whatever is beyond its end by rounding, up to where shadows end.
        plan.split_far[(count - 1) / 4][(count - 1) % 4] = f32::MAX;
    }

    /// The distances that a cascade covers: its own, the padding on both sides, and what the one before is blended over.
    fn padded_slice(
        &self,
        plan: &LightPlan,
        cascades: &Cascades,
        ends: &Ends,
        covered: Option<[f64; 2]>,
        cascade: usize,
    ) -> Result<[f64; 2], PlanError> {
        let Some([nearest, farthest]) = covered else { return Ok([0.0; 2]) };
        let eye = self.eye()?;
        let padding = f64::from(cascades.padding);
        let band = match (cascades.selection, cascade) {
            (Selection::Depth, 1..) => f64::from(plan.split_band[(cascade - 1) / 4][(cascade - 1) % 4]),
            // What is in the map before it is looked for there.
            _ if cascades.stabilised && cascades.blend > 0.0 => f64::INFINITY,
            _ => 0.0,
        };
        let bounds = self.subject.bounds;
        let begin = if cascade == 0 { nearest } else { (ends[cascade] - padding.max(band)).max(nearest) };
        let end = (ends[cascade + 1] + padding).min(farthest.max(ends[cascade + 1]));
        if cascades.stabilised {
            // As below, for a camera as far from the scene's origin as the bounds are: spheres must not follow the pose. An origin within the bounds is as far from all of them as the scene is large, wherever it is.
            let largest = self.size_of_scene(eye).max(next_power_of_two(f64::from(bounds.abs_max().length())));
            return Ok(fit::widened_by([begin, end], 2.0 * largest));
        }
        Ok(fit::widened_slice(eye, bounds, [begin, end]))
    }

    /// One cascade. `asked` says who asks it, and is told of it.
    fn cascade(
        &self,
        cascades: &Cascades,
        cascade: usize,
        slice: [f64; 2],
        asked: &mut Asked,
        size: u32,
    ) -> Result<ViewFit, PlanError> {
        let frame = self.frame(None);
        let eye = self.eye()?;
        if cascades.stabilised {
            let mut sphere = CascadeSphere::around(eye.camera.projection, eye.aspect, slice);
            if let (Selection::Containment, Some(before)) = (cascades.selection, asked.sphere.filter(|_| cascades.blend > 0.0)) {
                let around = (sphere.distance - before.distance).abs() + before.radius;
                sphere.radius = sphere.radius.max(around);
            }
            let view = stabilised_view(&frame, eye, sphere, self.subject, size, self.guard);
            let half = 0.5 * view.texel_metres[0] * (f64::from(size) - 2.0 * f64::from(self.guard));
            // Half a texel to each side by which the middle is moved, and one for the guard band that receivers are told to keep to.
            asked.sphere = Some(CascadeSphere { radius: half + 1.5 * view.texel_metres[0], ..sphere });
            return Ok(view);
        }
        let fit = cascades.fits[cascade].unwrap_or(self.settings.fit);
        let factor = f64::from(cascades.lispsm_factors[cascade]);
        let asking = match cascades.selection {
            Selection::Depth => Asked::default(),
            Selection::Containment if cascades.blend > 0.0 => *asked,
            Selection::Containment => Asked { before: None, ..*asked },
        };
        let slice = Slice { range: slice, asked: asking, size, lispsm_factor: factor, ogre_planes: slice };
        let boxed =
            || self.of_slice(Fit::Uniform, &frame, slice, || boxed_view(&frame, &Content::new(&[], &[]), size, self.guard));
        let view = self.of_slice(fit, &frame, slice, boxed);
        asked.before = Some(view);
        Ok(view)
    }
}

/// The least power of two that is no less than a number, which is finite and not negative.
fn next_power_of_two(number: f64) -> f64 {
    let power = f64::from_bits(number.to_bits() & f64::INFINITY.to_bits());
    if power < number { 2.0 * power } else { power }
}

/// The bins of a histogram of distances, each a hundredth part deeper than the one before at a range of ten to one.
const HISTOGRAM_BINS: usize = 256;

/// The least distance from which splits by factors are counted, as a share of where the last one ends. What is nearer is the first cascade's.
const MIN_NEAR_OF_SPLIT: f64 = 1e-6;

/// The least distance in metres at which the last cascade ends.
const MIN_FAR_OF_SPLIT: f64 = 1e-6;

/// The point that the axis of OGRE's perspective goes through, which is the visible one nearest to the camera, and the parameter that OGRE takes by itself.
fn ogre_axis_and_parameter(frame: &LightFrame, eye: &Eye<'_>, points: &[DVec3], planes: [f64; 2]) -> (DVec3, f64) {
    /// OGRE's adjustment by default.
    const ADJUST: f64 = 0.1;
    let row = eye.distance_row();
    let distances = points.iter().map(|&point| (point, row.dot(point.extend(1.0))));
    let start = (eye.camera.eye, f64::INFINITY);
    let (point, distance) = distances.fold(start, |nearest, this| if this.1 < nearest.1 { this } else { nearest });
    let cosine = eye.camera.direction().dot(frame.rotation * DVec3::NEG_Z).abs();
    (point, ogre_warp(distance, planes, ADJUST, ogre_tweak(cosine, OGRE_THRESHOLD)))
}
