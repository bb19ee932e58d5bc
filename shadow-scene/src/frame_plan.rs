//! The plan of a whole frame: the camera's, every light's, every view's.

use shadow_math::{
    Camera, PlanError, ShadowSettings,
    bounds::Aabb,
    exposure::Exposure,
    fit::MIN_NEAR_SHARE,
    plan::{BIAS_BACK_FACES, CameraPlan, LightPlan, ViewPlan, plan_camera, plan_light, view_count},
};

use crate::scene::{Scene, SceneLight};

/// What both renderers follow: neither derives a matrix of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// How the picture is taken.
    pub camera: CameraPlan,
    /// One plan a light, in the order of the scene's lights.
    pub lights: Vec<LightPlan>,
    /// The views of all lights; view `i` is layer `i` of the maps.
    pub views: Vec<ViewPlan>,
    /// Width and height of every map in texels.
    pub map_size: u32,
    /// The exposure value (EV at ISO 100) that was chosen or given.
    pub ev: f32,
    /// What a person should know about the plan: rules that took effect at the cost of something.
    pub notes: Vec<String>,
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
        (width, height): (u32, u32),
        ev: Option<f32>,
    ) -> Result<Self, FramePlanError> {
        let mut exposure = Exposure::automatic(scene.lights().iter().map(|light| &light.light), scene.bounds());
        if let Some(ev) = ev {
            if !(ev.abs() <= MAX_EV) {
                return Err(FramePlanError::ExposureValue(ev));
            }
            exposure = exposure.with_ev(ev);
        }
        let camera = plan_camera(camera, width, height, exposure, scene.lights().len() as u32).map_err(FramePlanError::Camera)?;
        let casters: Vec<Aabb> = scene.instances().iter().map(|instance| instance.bounds).collect();
        let mut lights = Vec::with_capacity(scene.lights().len());
        let mut views = Vec::new();
        for (index, light) in scene.lights().iter().enumerate() {
            let failed = |source| FramePlanError::Light { index, name: light.name.clone(), source };
            let first = views.len();
            let settings = &ShadowSettings { map_size, ..settings(index, light) };
            let count = view_count(&light.light, settings).map_err(failed)?;
            views.resize(first + count, ViewPlan::default());
            let plan = plan_light(&light.light, &casters, scene.bounds(), settings, first as u32, &mut views[first..])
                .map_err(failed)?;
            lights.push(plan);
        }
        let notes = near_rule_note(scene, &lights, &views).into_iter().collect();
        Ok(Self { camera, lights, views, map_size, ev: exposure.ev(), notes })
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

/// A sentence on the lights whose near plane lies at the smallest share of the far plane's distance: what is nearer to them casts no shadow.
fn near_rule_note(scene: &Scene, lights: &[LightPlan], views: &[ViewPlan]) -> Option<String> {
    /// Rounding to f32 may lift the share a little.
    const ROUNDING: f64 = 1.0 + 1e-6;
    let nears: Vec<(String, f32)> = lights
        .iter()
        .zip(scene.lights())
        .enumerate()
        .filter_map(|(index, (plan, light))| {
            let view = &views[plan.first_view as usize];
            let [near, far] = view.depth_range;
            let is_limited = view.w_per_metre > 0.0 && f64::from(near) <= f64::from(far) * MIN_NEAR_SHARE * ROUNDING;
            let name = if light.name.is_empty() { format!("light {index}") } else { format!("`{}`", light.name) };
            is_limited.then_some((name, near))
        })
        .collect();
    let (first, near) = nears.first()?;
    let others = if nears.len() > 1 { format!(" and {} more", nears.len() - 1) } else { String::new() };
    Some(format!(
        "{first}{others} is among the scene's bounds: what is nearer to it than {near:.3} m casts no shadow (1/1024 of the distance to the farthest \
         part of the scene; a smaller range of the light brings it closer)"
    ))
}
