//! Every kind of light camera, as settings that a frame's lights can have.

use shadow_cpu::{CpuRenderer, PreparedScene};
use shadow_math::{
    Bias, Camera, Cascades, Filter, Fit, FitFrom, LightKind, Selection, ShadowSettings, Split, SplitScheme, Store,
    light::MAX_SINGLE_MAP_OUTER_ANGLE,
    settings::{BiasParts, MIN_MAP_SIZE},
};
use shadow_scene::{Feedback, FramePlan, FramePlanError, Scene, SceneLight};

/// A way to place the samples of maps.
#[derive(Clone, Copy, Debug)]
pub struct Cameras {
    /// What it is called.
    pub name: &'static str,
    /// Where the samples go.
    pub fit: Fit,
    /// What fits follow.
    pub fit_from: FitFrom,
    /// How many maps there are.
    pub split: Split,
    /// How far there are shadows, as a share of the scene's size.
    pub shadow_distance: Option<f32>,
    /// Whether casters are drawn onto the planes of what is seen.
    pub pancake: bool,
}

/// Every fit and every kind of split, and what else can be said of them.
#[must_use]
pub fn all() -> Vec<Cameras> {
    let one = Cameras {
        name: "",
        fit: Fit::Uniform,
        fit_from: FitFrom::Frustum,
        split: Split::Single,
        shadow_distance: None,
        pancake: false,
    };
    let of_fit = |name, fit| Cameras { name, fit, ..one };
    let four = Cascades::default();
    let cascades = |name, fit, cascades| Cameras { name, fit, split: Split::Cascades(cascades), ..one };
    let mut sizes = [None; 8];
    sizes[1..4].copy_from_slice(&[Some(96), Some(64), Some(48)]);
    let mut fits = [None; 8];
    fits[..3].copy_from_slice(&[Some(Fit::Lispsm), Some(Fit::Focused), Some(Fit::Uniform)]);
    let mut factors = [1.0; 8];
    factors[1..3].copy_from_slice(&[2.0, 0.0]);
    vec![
        of_fit("uniform", Fit::Uniform),
        of_fit("focused", Fit::Focused),
        of_fit("lispsm", Fit::Lispsm),
        of_fit("plane-optimal", Fit::PlaneOptimal),
        of_fit("ogre-uniform", Fit::OgreUniform),
        of_fit("ogre-lispsm", Fit::OgreLispsm),
        Cameras { name: "focused to samples", fit: Fit::Focused, fit_from: FitFrom::Samples, ..one },
        Cameras { name: "lispsm to samples", fit: Fit::Lispsm, fit_from: FitFrom::Samples, ..one },
        Cameras { name: "focused up to a distance", fit: Fit::Focused, shadow_distance: Some(0.4), ..one },
        Cameras { name: "uniform up to a distance", shadow_distance: Some(0.4), ..one },
        cascades("uniform cascades", Fit::Uniform, four),
        cascades("stabilised cascades", Fit::Uniform, Cascades { stabilised: true, blend: 0.2, ..four }),
        cascades("focused cascades, blended", Fit::Focused, Cascades { count: 3, blend: 0.3, ..four }),
        cascades("lispsm cascades, padded", Fit::Lispsm, Cascades { padding: 0.5, scheme: SplitScheme::Logarithmic, ..four }),
        cascades("ogre-lispsm cascades", Fit::OgreLispsm, Cascades { scheme: SplitScheme::Uniform, count: 2, ..four }),
        cascades("cascades of all kinds", Fit::Focused, Cascades { map_sizes: sizes, fits, lispsm_factors: factors, ..four }),
        cascades(
            "contained cascades, blended",
            Fit::Focused,
            Cascades { count: 8, selection: Selection::Containment, blend: 0.25, ..four },
        ),
        cascades("histogram cascades", Fit::Focused, Cascades { scheme: SplitScheme::Histogram, ..four }),
        Cameras { name: "uniform, pancaked", pancake: true, ..one },
        Cameras { name: "focused to samples, pancaked", fit: Fit::Focused, fit_from: FitFrom::Samples, pancake: true, ..one },
        Cameras { name: "lispsm, pancaked", fit: Fit::Lispsm, pancake: true, shadow_distance: Some(0.4), ..one },
        Cameras { name: "plane-optimal, pancaked", fit: Fit::PlaneOptimal, pancake: true, ..one },
        Cameras { name: "ogre-uniform, pancaked", fit: Fit::OgreUniform, pancake: true, ..one },
        Cameras {
            pancake: true,
            ..cascades("stabilised cascades, pancaked", Fit::Uniform, Cascades { stabilised: true, count: 3, ..four })
        },
        Cameras {
            pancake: true,
            ..cascades(
                "contained cascades, pancaked",
                Fit::Focused,
                Cascades { count: 3, selection: Selection::Containment, blend: 0.25, ..four },
            )
        },
    ]
}

impl Cameras {
    /// Settings with these cameras for a light: those that it can have, with a store and a bias that go with them.
    #[must_use]
    pub fn of(&self, settings: ShadowSettings, light: &SceneLight, scene: &Scene) -> ShadowSettings {
        let takes_cube = match light.light.kind {
            LightKind::Directional { .. } => false,
            LightKind::Spot { outer, .. } => outer > MAX_SINGLE_MAP_OUTER_ANGLE,
            LightKind::Point { .. } => true,
        };
        let split = match self.split {
            Split::Cascades(_) if takes_cube => Split::Single,
            Split::Cascades(cascades) if light.light.position().is_some() => {
                Split::Cascades(Cascades { stabilised: false, ..cascades })
            }
            split => split,
        };
        let is_warped = self.fit.is_warped()
            || matches!(split, Split::Cascades(Cascades { fits, .. }) if fits.iter().flatten().any(|fit| fit.is_warped()));
        let is_of_axis = settings.store == Store::Linear || settings.store == Store::Depth16;
        let store = match settings.store {
            _ if is_warped && is_of_axis => Store::Depth32,
            // Two surfaces are not told apart on one plane.
            Store::Second | Store::Midpoint if self.pancake => Store::Depth24,
            store => store,
        };
        let bias = match settings.bias {
            Bias::Parts(BiasParts { ogre_2006: Some(_), .. }) if is_warped => Bias::Automatic,
            bias => bias,
        };
        let shadow_distance = self.shadow_distance.map(|share| (share * scene.bounds().radius()).max(f32::MIN_POSITIVE));
        let Self { fit, fit_from, pancake, .. } = *self;
        ShadowSettings { fit, fit_from, split, shadow_distance, pancake, store, bias, ..settings }
    }

    /// The plan of a picture of a scene under all of its lights.
    ///
    /// # Errors
    ///
    /// What the plan refuses.
    ///
    /// # Panics
    ///
    /// If the camera's pass cannot be drawn.
    pub fn plan(
        &self,
        (renderer, prepared): (&CpuRenderer, &PreparedScene<'_>),
        scene: &Scene,
        settings: &ShadowSettings,
        size: (u32, u32),
    ) -> Result<FramePlan, FramePlanError> {
        let camera = &scene.cameras()[0].camera;
        let feedback = feedback((renderer, prepared), scene, camera, size)?;
        FramePlan::with_feedback(
            scene,
            camera,
            settings.map_size,
            |_, light| self.of(*settings, light, scene),
            size,
            None,
            &feedback,
        )
    }
}

/// What a camera sees of a scene.
///
/// # Errors
///
/// What the plan refuses of the camera.
///
/// # Panics
///
/// If the camera's pass cannot be drawn.
pub fn feedback(
    (renderer, prepared): (&CpuRenderer, &PreparedScene<'_>),
    scene: &Scene,
    camera: &Camera,
    (width, height): (u32, u32),
) -> Result<Feedback, FramePlanError> {
    let plain = ShadowSettings { map_size: MIN_MAP_SIZE, filter: Filter::Hard, ..ShadowSettings::default() };
    let plan = FramePlan::new(scene, camera, &plain, width, height, None)?;
    let seen = renderer.camera(prepared, &plan).expect("the picture is small");
    Ok(Feedback::of(scene, &plan.camera, &seen.triangles))
}
