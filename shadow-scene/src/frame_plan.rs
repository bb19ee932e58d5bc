//! The plan of a whole frame: the camera's, every light's, every view's.

use shadow_math::{
    Camera, PlanError, ShadowSettings,
    bounds::Aabb,
    depth::LAYER_FIRST,
    exposure::Exposure,
    fit::{Eye, FitOutcome, MIN_NEAR_SHARE, Subject},
    picture::plan_picture,
    plan::{
        BIAS_BACK_FACES, COMPOSE_ADDITIVE, COMPOSE_FACTOR, COMPOSE_MODULATIVE, COMPOSE_UNSHADOWED, CameraPlan, LightPlan,
        ViewPlan, plan_camera, plan_light, plan_unshadowed_light, view_count,
    },
    settings::{Cascades, Composition, FitFrom, MIN_MAP_SIZE, Split, SplitScheme},
};

use crate::{
    feedback::Feedback,
    frame::LayerName,
    scene::{Scene, SceneLight},
    surfaces::first_word_of,
};

/// What both renderers follow: neither derives a matrix of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// How the picture is taken.
    pub camera: CameraPlan,
    /// One plan a light, in the order of the scene's lights.
    pub lights: Vec<LightPlan>,
    /// The views of all lights; each says which layer of the maps is its own.
    pub views: Vec<ViewPlan>,
    /// Width and height of every map in texels.
    pub map_size: u32,
    /// Into how many passes the picture is taken apart.
    pub light_passes: LightPasses,
    /// The exposure value (EV at ISO 100) that was chosen or given.
    pub ev: f32,
    /// What a person should know about the plan: rules that took effect at the cost of something.
    pub notes: Vec<String>,
}

/// Into how many passes a picture is taken apart. The picture is the same but for rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightPasses {
    /// All lights in one pass.
    #[default]
    One,
    /// A pass for each light, added to or multiplied with those before: see [`FramePlan::passes_of_lights`].
    Each,
}

/// Why the plan of a frame cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FramePlanError {
    /// The picture or the camera.
    #[error("{0}")]
    Camera(PlanError),
    /// A light.
    #[error("light {index} (`{name}`): {source}")]
    Light {
        /// The light's index.
        index: usize,
        /// The light's name.
        name: String,
        /// What is wrong.
        source: PlanError,
    },
    /// A part of the shadows' colour is not from 0 to 1.
    #[error("a shadow color with {0} makes no sense; its parts are linear, from 0 (black) to 1 (no shadow)")]
    ShadowColor(f32),
    /// The maps take more memory than they may.
    #[error(
        "{maps} maps of {map_size} x {map_size} texels take {needed} bytes, and the budget (--shadow-budget) is {allowed}; {}",
        if *fitting >= MIN_MAP_SIZE { format!("maps of up to {fitting} texels fit (--map-size), or fewer lights that cast shadows (--no-shadow)") } else { format!("so many maps do not fit at any size from {MIN_MAP_SIZE} texels on; take a larger budget, or fewer lights that cast shadows (--no-shadow)") }
    )]
    Budget {
        /// What they take, in bytes.
        needed: u64,
        /// What they may take, in bytes.
        allowed: u64,
        /// How many there are.
        maps: u64,
        /// Their size in texels.
        map_size: u32,
        /// The largest size in texels at which as many would fit.
        fitting: u32,
    },
    /// The exposure value is not a usable number.
    #[error(
        "an exposure value of {0} cannot be used; it must lie between -{MAX_EV} and {MAX_EV} (15 suits a sunny day, 5 a lit room)"
    )]
    ExposureValue(f32),
}

/// The largest exposure value, either way: the exposure scale stays a normal f32 with room for any light.
pub const MAX_EV: f32 = 64.0;

impl FramePlan {
    /// Plans a picture of `width` by `height` pixels whose lights are all shadowed alike.
    ///
    /// # Errors
    ///
    /// As [`FramePlan::with_settings_of`].
    pub fn new(
        scene: &Scene,
        camera: &Camera,
        settings: &ShadowSettings,
        width: u32,
        height: u32,
        ev: Option<f32>,
    ) -> Result<Self, FramePlanError> {
        Self::with_settings_of(scene, camera, settings.map_size, |_, _| *settings, (width, height), ev)
    }

    /// Plans a picture of `size` pixels. `settings` says how a light is shadowed, by its index; all of them have maps of `map_size` texels, since these lie in one array.
    ///
    /// `ev` is an exposure value (EV at ISO 100); `None` chooses the exposure by a fixed rule from the lights
    /// ([`Exposure::automatic`]).
    ///
    /// # Errors
    ///
    /// [`FramePlanError`]: a camera, light or setting that cannot be used, named.
    pub fn with_settings_of(
        scene: &Scene,
        camera: &Camera,
        map_size: u32,
        settings: impl Fn(usize, &SceneLight) -> ShadowSettings,
        size: (u32, u32),
        ev: Option<f32>,
    ) -> Result<Self, FramePlanError> {
        Self::with_feedback(scene, camera, map_size, settings, size, ev, &Feedback::default())
    }

    /// As [`Self::with_settings_of`], with what the camera sees: for fits and splits that follow it.
    ///
    /// # Errors
    ///
    /// As [`FramePlan::with_settings_of`].
    pub fn with_feedback(
        scene: &Scene,
        camera: &Camera,
        map_size: u32,
        settings: impl Fn(usize, &SceneLight) -> ShadowSettings,
        (width, height): (u32, u32),
        ev: Option<f32>,
        feedback: &Feedback,
    ) -> Result<Self, FramePlanError> {
        let mut exposure = Exposure::automatic(scene.lights().iter().map(|light| &light.light), scene.bounds());
        if let Some(ev) = ev {
            if !(ev.abs() <= MAX_EV) {
                return Err(FramePlanError::ExposureValue(ev));
            }
            exposure = exposure.with_ev(ev);
        }
        let eye = Eye {
            camera: *camera,
            aspect: f64::from(width) / f64::from(height.max(1)),
            samples: &feedback.samples,
            plane: feedback.plane,
        };
        let camera = plan_camera(camera, width, height, exposure, scene.lights().len() as u32).map_err(FramePlanError::Camera)?;
        let casting = scene.instances().iter().filter(|instance| instance.casts_shadows);
        let casters: Vec<Aabb> = casting.map(|instance| instance.bounds).collect();
        // Where nothing was added at all, maps are fitted to the bounds that stand in for it.
        let is_any_cast = !casters.is_empty() || scene.instances().is_empty();
        let subject = Subject { casters: &casters, bounds: scene.bounds(), origin: scene.origin(), eye: Some(eye) };
        let mut lights = Vec::with_capacity(scene.lights().len());
        let mut views = Vec::new();
        let mut notes = Vec::new();
        for (index, light) in scene.lights().iter().enumerate() {
            let failed = |source| FramePlanError::Light { index, name: light.name.clone(), source };
            let first = views.len();
            let mut settings = ShadowSettings { map_size, ..settings(index, light) };
            if feedback.is_seen && feedback.samples.is_empty() {
                settings = without_samples(settings);
            }
            let settings = &settings;
            let picture = |plan: &mut LightPlan| {
                let Some(index) = light.picture else { return Ok(()) };
                let count = scene.images().len();
                let image = scene.images().get(index as usize).ok_or(PlanError::MissingPicture { index, count })?;
                plan_picture(plan, &light.light, first_word_of(scene, index), image.width, image.height)
            };
            if !(light.casts_shadows && is_any_cast) {
                let mut plan = plan_unshadowed_light(&light.light, settings, first as u32).map_err(failed)?;
                picture(&mut plan).map_err(failed)?;
                lights.push(plan);
                continue;
            }
            let count = view_count(&light.light, settings).map_err(failed)?;
            views.resize(first + count, ViewPlan::default());
            let first_layer = layer_count(&views[..first]);
            let mut plan =
                plan_light(&light.light, &subject, settings, [first as u32, first_layer], &mut views[first..]).map_err(failed)?;
            // Some fits make one view where others take six.
            views.truncate(first + plan.view_count as usize);
            notes.extend(empty_cascades_note(index, light, settings, &views[first..]));
            picture(&mut plan).map_err(failed)?;
            lights.push(plan);
        }
        notes.extend(near_rule_note(scene, &lights, &views).into_iter().chain(fall_back_notes(scene, &lights, &views)));
        Ok(Self { camera, lights, views, map_size, light_passes: LightPasses::default(), ev: exposure.ev(), notes })
    }

    /// The same plan with another composition of lights and shadows.
    ///
    /// # Errors
    ///
    /// [`FramePlanError::ShadowColor`].
    pub fn with_composition(mut self, composition: Composition) -> Result<Self, FramePlanError> {
        (self.camera.composition, self.camera.shadow_color) = match composition {
            Composition::Modulative(color) => {
                if let Some(&part) = color.iter().find(|part| !(0.0..=1.0).contains(*part)) {
                    return Err(FramePlanError::ShadowColor(part));
                }
                (COMPOSE_MODULATIVE, color)
            }
            _ => (COMPOSE_ADDITIVE, [1.0; 3]),
        };
        Ok(self)
    }

    /// What the first pass draws: the whole picture, or what [`Self::passes_of_lights`] are blended with.
    #[must_use]
    pub fn first_pass(&self) -> CameraPlan {
        match (self.light_passes, self.camera.composition) {
            // The light from everywhere.
            (LightPasses::Each, COMPOSE_ADDITIVE) => CameraPlan { light_count: 0, ..self.camera },
            (LightPasses::Each, COMPOSE_MODULATIVE) => CameraPlan { composition: COMPOSE_UNSHADOWED, ..self.camera },
            _ => self.camera,
        }
    }

    /// The passes that follow, one for each light, as programs draw a picture that know one light at a time: added to what is there with additive composition, and with modulative
    /// composition multiplied with it ([`COMPOSE_FACTOR`]). None where one pass draws all, or where nothing is composed of lights and shadows.
    pub fn passes_of_lights(&self) -> impl Iterator<Item = CameraPlan> + '_ {
        let composition = match (self.light_passes, self.camera.composition) {
            (LightPasses::Each, COMPOSE_ADDITIVE) => Some(COMPOSE_ADDITIVE),
            (LightPasses::Each, COMPOSE_MODULATIVE) => Some(COMPOSE_FACTOR),
            _ => None,
        };
        let of_light = |light: u32, composition| CameraPlan {
            first_light: light,
            light_count: 1,
            ambient: [0.0; 3],
            composition,
            ..self.camera
        };
        composition
            .into_iter()
            .flat_map(move |composition| (0..self.camera.light_count).map(move |light| of_light(light, composition)))
    }

    /// How much memory the maps take, in bytes: 32 bits a texel, and as much as one more map where maps hold second surfaces, for the first.
    #[must_use]
    pub fn map_bytes(&self) -> u64 {
        let scratch = self.views.iter().any(|view| view.depth_layer != LAYER_FIRST);
        let maps = u64::from(self.layer_count()) + u64::from(scratch);
        maps * u64::from(self.map_size).pow(2) * size_of::<f32>() as u64
    }

    /// Whether the maps fit into so many bytes.
    ///
    /// # Errors
    ///
    /// [`FramePlanError::Budget`], with the largest size of maps that would fit.
    pub fn check_budget(&self, bytes: u64) -> Result<(), FramePlanError> {
        let needed = self.map_bytes();
        if needed <= bytes {
            return Ok(());
        }
        let maps = needed / (u64::from(self.map_size).pow(2) * size_of::<f32>() as u64);
        let fitting = (bytes as f64 / (maps * size_of::<f32>() as u64) as f64).sqrt().floor() as u32;
        Err(FramePlanError::Budget { needed, allowed: bytes, maps, map_size: self.map_size, fitting })
    }

    /// How many layers the maps take: one for each view in which anything is seen.
    #[must_use]
    pub fn layer_count(&self) -> u32 {
        layer_count(&self.views)
    }

    /// The maps in the order of their layers: each one's name and view.
    pub fn maps(&self) -> impl Iterator<Item = (LayerName, &ViewPlan)> {
        let views = self.lights.iter().enumerate().flat_map(move |(light, plan)| {
            (0..plan.view_count).map(move |view| {
                (LayerName::ShadowMap { light: light as u32, view }, &self.views[(plan.first_view + view) as usize])
            })
        });
        views.filter(|(_, view)| view.has_map())
    }

    /// The views of a light.
    #[must_use]
    pub fn views_of(&self, light: usize) -> &[ViewPlan] {
        let plan = &self.lights[light];
        &self.views[plan.first_view as usize..][..plan.view_count as usize]
    }

    /// Whether a view, by its place among all of them, takes of single-sided casters the back faces alone. No other leaves any casters out: a single-sided wall shadows from behind
    /// too.
    #[must_use]
    pub fn takes_back_faces(&self, view: usize) -> bool {
        self.lights.iter().any(|light| {
            let views = light.first_view as usize..(light.first_view + light.view_count) as usize;
            light.bias & BIAS_BACK_FACES != 0 && views.contains(&view)
        })
    }
}

/// The settings for a camera that sees nothing: what would follow its samples follows its frustum.
fn without_samples(settings: ShadowSettings) -> ShadowSettings {
    let split = match settings.split {
        Split::Cascades(cascades) if cascades.scheme == SplitScheme::Histogram => {
            Split::Cascades(Cascades { scheme: SplitScheme::default(), ..cascades })
        }
        split => split,
    };
    ShadowSettings { fit_from: FitFrom::Frustum, split, ..settings }
}

/// How many layers the maps of some views take.
fn layer_count(views: &[ViewPlan]) -> u32 {
    views.iter().filter(|view| view.has_map()).count() as u32
}

/// What a light is called in a note.
fn name_in_note(index: usize, light: &SceneLight) -> String {
    if light.name.is_empty() { format!("light {index}") } else { format!("`{}`", light.name) }
}

/// A sentence on cascades between whose distances nothing is seen, where these were given.
fn empty_cascades_note(index: usize, light: &SceneLight, settings: &ShadowSettings, views: &[ViewPlan]) -> Option<String> {
    let Split::Cascades(Cascades { count, scheme: SplitScheme::Explicit(_), .. }) = settings.split else { return None };
    let empty = count - layer_count(views);
    let name = name_in_note(index, light);
    (empty > 0).then(|| {
        format!("{name}: {empty} of {count} cascades have no map, for nothing is seen between the distances that were given; choose others, or fewer cascades")
    })
}

/// A sentence on each light that has another fit than was asked for.
fn fall_back_notes(scene: &Scene, lights: &[LightPlan], views: &[ViewPlan]) -> Vec<String> {
    let note = |(index, (plan, light)): (usize, (&LightPlan, &SceneLight))| {
        let views = &views[plan.first_view as usize..][..plan.view_count as usize];
        let fall_backs = views.iter().filter_map(|view| match view.outcome() {
            FitOutcome::FellBackToUniform { why } => Some(why),
            _ => None,
        });
        let (count, why) = (fall_backs.clone().count(), fall_backs.clone().next()?);
        let name = name_in_note(index, light);
        let maps = if views.len() == 1 { "its map".to_string() } else { format!("{count} of {} maps", views.len()) };
        Some(format!("{name}: {maps} could not have the fit that was asked for, but a plain one: {why}"))
    };
    lights.iter().zip(scene.lights()).enumerate().filter_map(note).collect()
}

/// A sentence on the lights whose near plane lies at the smallest share of the far plane's distance: what is nearer to them casts no shadow.
fn near_rule_note(scene: &Scene, lights: &[LightPlan], views: &[ViewPlan]) -> Option<String> {
    /// Rounding to f32 may lift the share a little.
    const ROUNDING: f64 = 1.0 + 1e-6;
    let nears: Vec<(String, f64)> = lights
        .iter()
        .zip(scene.lights())
        .enumerate()
        .filter(|(_, (plan, _))| plan.view_count > 0)
        .filter_map(|(index, (plan, light))| {
            let limited = views[plan.first_view as usize..][..plan.view_count as usize].iter().filter_map(|view| {
                let [near, far] = view.drawn_range();
                let is_of_rule = view.w_per_metre > 0.0 && view.has_map() && view.is_warped == 0;
                (is_of_rule && near <= far * MIN_NEAR_SHARE * ROUNDING).then_some(near)
            });
            let near = limited.reduce(f64::max)?;
            let name = name_in_note(index, light);
            Some((name, near))
        })
        .collect();
    let (first, near) = nears.first()?;
    let others = if nears.len() > 1 { format!(" and {} more", nears.len() - 1) } else { String::new() };
    Some(format!(
        "{first}{others} is among the scene's bounds: what is nearer to it than {near:.3} m casts no shadow (1/1024 of the distance to the farthest \
         part of the scene; a smaller range of the light brings it closer)"
    ))
}
