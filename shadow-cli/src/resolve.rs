//! From what was typed to what is to be done: the scene, its camera and lights, and the plan of the frame.

use std::path::Path;

use glam::DVec4;
use shadow_cpu::trace::Sampling;
use shadow_math::{Camera, Composition, LightKind, ShadowSettings, settings::OGRE_SHADOW_COLOR};
use shadow_scene::{
    FramePlan, Image, ImportError, ImportOptions, LayerName, LightPasses, Request, Scene, SceneLight, builder::SUN_LUX, builtin,
    import_with,
};

use crate::{
    args::{BiasArgs, FilterName, LightSettings, PictureArgs, SceneArgs, ShadowArgs},
    backend::Place,
    bias::Meaningless,
    console::Console,
    error::CliError,
    feedback::feedback,
    light_camera::LightCameraError,
    memory::Limit,
    settings_file,
    shadowing::Shadowing,
    specs::{ByteSize, CameraChoice, LightSpec, SceneSource, Selector, Show},
};

/// The faces of a cube, in the order of its views.
const CUBE_FACE_NAMES: [&str; 6] = ["+x", "-x", "+y", "-y", "+z", "-z"];

/// A picture that is ready to be rendered.
pub(crate) struct Job {
    /// What the scene is called: its path as it was typed, or `builtin:NAME`.
    pub(crate) scene_name: String,
    /// The scene, under the lights that were chosen.
    pub(crate) scene: Scene,
    /// What the person should know: what of the scene was left out, and which defaults stand in for what it lacks.
    pub(crate) notes: Vec<String>,
    /// The camera's name; empty for one without a name.
    pub(crate) camera_name: String,
    /// The camera.
    pub(crate) camera: Camera,
    /// How lights are shadowed.
    pub(crate) shadowing: Shadowing,
    /// How each light is shadowed, in order: as the above has it, but for those with a file of their own.
    pub(crate) of_lights: Vec<ShadowSettings>,
    /// How the picture is made.
    pub(crate) plan: FramePlan,
    /// The plane that most pixels show, as `(normal, offset)` from the world's origin; `None` where nothing asked for it.
    pub(crate) plane: Option<DVec4>,
    /// How the tracer samples lights that have a size; `None` as it does by itself.
    pub(crate) light_samples: Option<Sampling>,
    /// The most memory that it may take.
    pub(crate) limit: Limit,
}

impl Job {
    /// Loads the scene and plans the picture for the renderers of a place. Notes about the scene are told.
    ///
    /// What does not need the scene is checked first.
    pub(crate) fn resolve(args: &PictureArgs, bias: &BiasArgs, place: Place<'_>, console: &Console) -> Result<Self, CliError> {
        let settings = settings(args, bias)?;
        let subpixel_bits = args.shadows.subpixel_bits.map_or_else(|| place.subpixel_bits(), Ok)?;
        let (scene_name, scene, limit) = load(&args.scene, console)?;
        let scene = with_casters(with_chosen_lights(scene, &args.lights)?, &args.shadows)?;
        let shadowing = match bias.preset {
            None => Shadowing::alike(settings),
            Some(engine) => Shadowing::preset(engine, &scene).with(|settings| with_cameras(settings, args))?,
        };
        let shadowing = shadowing.on_grid(subpixel_bits);
        let mut notes = notes(&scene, args.camera.is_none());
        let (camera_name, camera) = camera(&scene, args.camera.as_ref())?;
        let of_lights = settings_of_lights(&scene, &shadowing, &args.shadows)?;
        let size = (args.size.width, args.size.height);
        let map_size = shadowing.map_size();
        let feedback = feedback(&scene, &camera, &of_lights, size, Some((scene_name.as_str(), limit)))?;
        let plan =
            FramePlan::with_feedback(&scene, &camera, map_size, |light, _| of_lights[light], size, args.exposure, &feedback)?;
        let plan = composed(plan, &args.shadows)?;
        let plane = feedback.plane.map(|plane| plane.with_w(plane.w - plane.truncate().dot(scene.origin())));
        notes.extend(plan.notes.iter().cloned());
        notes.extend(shadowing.notes(&scene));
        tell_notes(&notes, console);
        Ok(Self { scene_name, scene, notes, camera_name, camera, shadowing, of_lights, plan, plane, light_samples: None, limit })
    }

    /// The layer that is to be shown, once it is known that there is one.
    /// A debug view is made of the picture.
    pub(crate) fn layer(&self, show: &Show) -> Result<LayerName, CliError> {
        let light_index = |selector: &Selector| selector.find("light", &self.light_names());
        Ok(match show {
            Show::Color | Show::Debug(..) => LayerName::Color,
            Show::Depth => LayerName::Depth,
            Show::Visibility(light) => LayerName::Visibility { light: light_index(light)? as u32 },
            Show::ShadowMap(light, view) => {
                let light = light_index(light)?;
                let views = view_names(self.plan.views_of(light).len());
                let view = Selector::Index(*view).find("view", &views)?;
                if !self.plan.views_of(light)[view].has_map() {
                    return Err(CliError::ViewOfNothing { light: Selector::Index(light), view });
                }
                LayerName::ShadowMap { light: light as u32, view: view as u32 }
            }
        })
    }

    /// The names of the lights, in order.
    fn light_names(&self) -> Vec<String> {
        light_names(&self.scene)
    }
}

/// The names of a scene's lights, in order.
pub(crate) fn light_names(scene: &Scene) -> Vec<String> {
    scene.lights().iter().map(|light| light.name.clone()).collect()
}

/// The scene's notes, and a sentence for each default of its that is used.
fn notes(scene: &Scene, uses_own_camera: bool) -> Vec<String> {
    let mut notes = scene.notes().to_vec();
    if uses_own_camera && scene.has_default_camera() {
        notes.push("the scene has no camera: it is seen from one that frames its bounds (--camera chooses another)".into());
    }
    if scene.has_default_light() {
        notes.push(format!("the scene has no light: it is lit by a sun of {SUN_LUX} lux (--light chooses another)"));
    }
    notes
}

/// The request that asks for one layer.
pub(crate) fn request_for(layer: LayerName) -> Request {
    let nothing = Request::default();
    match layer {
        LayerName::Triangle | LayerName::Depth => Request { camera: true, ..nothing },
        LayerName::ShadowMap { .. } => Request { shadow_maps: true, ..nothing },
        LayerName::Visibility { .. } => Request { visibility: true, ..nothing },
        LayerName::Color => Request::COLOR,
    }
}

/// The names of a light's views: those of cube faces where there are six.
pub(crate) fn view_names(count: usize) -> Vec<String> {
    if count == CUBE_FACE_NAMES.len() { CUBE_FACE_NAMES.map(String::from).to_vec() } else { vec![String::new(); count] }
}

/// The name of a kind of light in reports.
pub(crate) fn kind_name(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Directional { .. } => "directional",
        LightKind::Spot { .. } => "spot",
        LightKind::Point { .. } => "point",
    }
}

/// How lights are shadowed.
fn settings(args: &PictureArgs, bias: &BiasArgs) -> Result<ShadowSettings, CliError> {
    let bias = bias.bias.with(&bias.numbers()).map_err(|Meaningless { key, use_with }| CliError::BiasNumber {
        key,
        bias: bias.bias.to_string(),
        use_with,
    })?;
    let ShadowArgs { map_size, filter: FilterName(filter), filter_radius, store, texels, terminator, .. } = args.shadows;
    let settings =
        ShadowSettings { bias, filter, filter_radius, store, texels, terminator, map_size, ..ShadowSettings::default() };
    with_cameras(settings, args)
}

/// Settings with the light cameras that were chosen.
pub(crate) fn with_cameras(settings: ShadowSettings, args: &PictureArgs) -> Result<ShadowSettings, CliError> {
    args.shadows.cameras.of(settings).map_err(|error| match error {
        LightCameraError::Meaningless(Meaningless { key, use_with }) => CliError::CameraNumber { key, use_with },
        LightCameraError::Value { key, problem } => CliError::CameraValue { key, problem },
    })
}

/// The scene with the lights and objects that cast shadows as they are wanted.
fn with_casters(scene: Scene, args: &ShadowArgs) -> Result<Scene, CliError> {
    let mut lights = scene.lights().to_vec();
    let names: Vec<String> = lights.iter().map(|light| light.name.clone()).collect();
    for selector in &args.no_shadow {
        for index in selector.find_all("light", &names)? {
            lights[index].casts_shadows = false;
        }
    }
    let objects: Vec<String> = scene.instances().iter().map(|instance| instance.name.clone()).collect();
    let mut left_out = Vec::new();
    for selector in &args.no_cast {
        left_out.extend(selector.find_all("object", &objects)?);
    }
    let scene = if args.no_shadow.is_empty() { scene } else { scene.with_lights(lights) };
    Ok(if left_out.is_empty() { scene } else { scene.with_casters(|index, _| !left_out.contains(&index)) })
}

/// How each light is shadowed.
fn settings_of_lights(scene: &Scene, shadowing: &Shadowing, args: &ShadowArgs) -> Result<Vec<ShadowSettings>, CliError> {
    let names: Vec<String> = scene.lights().iter().map(|light| light.name.clone()).collect();
    let mut of_lights: Vec<ShadowSettings> = scene.lights().iter().map(|light| shadowing.of(&light.light.kind)).collect();
    for LightSettings { light, path } in &args.light_settings {
        let own = settings_file::read(path)?.settings;
        for index in light.find_all("light", &names)? {
            of_lights[index] = ShadowSettings { subpixel_bits: of_lights[index].subpixel_bits, ..own };
        }
    }
    Ok(of_lights)
}

/// The plan with its composition, within the budget.
pub(crate) fn composed(plan: FramePlan, args: &ShadowArgs) -> Result<FramePlan, CliError> {
    let composition = match (args.composition.as_str(), args.shadow_color) {
        ("modulative", color) => Composition::Modulative(color.unwrap_or(OGRE_SHADOW_COLOR)),
        (_, None) => Composition::Additive,
        (_, Some(_)) => return Err(CliError::ShadowColor),
    };
    let mut plan = plan.with_composition(composition)?;
    if args.light_passes == "each" {
        plan.light_passes = LightPasses::Each;
    }
    if let Some(ByteSize(bytes)) = args.shadow_budget {
        plan.check_budget(bytes)?;
    }
    Ok(plan)
}

/// Tells the notes about a scene.
pub(crate) fn tell_notes(notes: &[String], console: &Console) {
    for note in notes {
        console.note(note);
    }
}

/// What the scene is called, the scene, and the memory that everything about it may take.
pub(crate) fn load(args: &SceneArgs, console: &Console) -> Result<(String, Scene, Limit), CliError> {
    let limit = Limit::new(args.memory_limit);
    let name = match &args.source {
        None => "demo",
        Some(SceneSource::Builtin(name)) => name,
        Some(SceneSource::File(path)) => {
            console.stage(format!("reading {}", path.display()));
            let options = ImportOptions {
                scene: args.part.clone(),
                animation: args.animation.clone(),
                time: args.time.unwrap_or(0.0),
                memory_limit: limit.bytes,
            };
            let scene = import_with(path, &options).map_err(|error| match error {
                error @ ImportError::Memory { .. } => CliError::ImportMemory(error),
                error => error.into(),
            })?;
            return Ok((path.display().to_string(), scene, limit));
        }
    };
    // Ignoring a choice silently would draw something other than what was asked for.
    let choices = [("--scene", args.part.is_some()), ("--animation", args.animation.is_some()), ("--time", args.time.is_some())];
    if let Some((option, _)) = choices.iter().find(|(_, is_given)| *is_given) {
        return Err(CliError::NotAFile { option, name: name.into() });
    }
    let scene = builtin::by_name(name).ok_or_else(|| CliError::Builtin { name: name.into(), names: builtin::NAMES })?;
    Ok((format!("builtin:{name}"), scene, limit))
}

/// The scene under the lights of the command line, if there are any.
pub(crate) fn with_chosen_lights(mut scene: Scene, specs: &[LightSpec]) -> Result<Scene, CliError> {
    if specs.is_empty() {
        return Ok(scene);
    }
    let mut lights = Vec::with_capacity(specs.len());
    for spec in specs {
        let (light, shape) = (spec.to_light(scene.origin()), spec.shape());
        light
            .validate()
            .and_then(|()| shape.validate(&light.kind))
            .map_err(|source| CliError::Light { spec: spec.text.clone(), source })?;
        let mut picture = None;
        if let Some(path) = &spec.picture {
            let index;
            (scene, index) = scene.with_image(read_picture(path)?);
            picture = Some(index);
        }
        lights.push(SceneLight { shape, picture, ..SceneLight::new(spec.name(), light) });
    }
    Ok(scene.with_lights(lights))
}

/// Reads a picture for a light to project.
fn read_picture(path: &Path) -> Result<Image, CliError> {
    let picture = image::open(path).map_err(|source| CliError::ReadPicture { path: path.into(), source })?.to_rgba8();
    let (width, height) = picture.dimensions();
    Ok(Image { width, height, texels: picture.pixels().map(|pixel| pixel.0).collect() })
}

/// The chosen camera and its name; the scene's first if none is chosen.
fn camera(scene: &Scene, choice: Option<&CameraChoice>) -> Result<(String, Camera), CliError> {
    let first = Selector::Index(0);
    let selector = match choice {
        Some(CameraChoice::Placed(spec)) => {
            let camera = spec
                .to_camera(scene.origin(), f64::from(scene.bounds().radius()))
                .map_err(|source| CliError::Camera { spec: spec.text.clone(), source })?;
            return Ok((spec.text.clone(), camera));
        }
        Some(CameraChoice::Selected(selector)) => selector,
        None => &first,
    };
    let names: Vec<String> = scene.cameras().iter().map(|camera| camera.name.clone()).collect();
    let camera = &scene.cameras()[selector.find("camera", &names)?];
    Ok((camera.name.clone(), camera.camera))
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use glam::Vec3;
    use shadow_math::{Bias, settings::BiasParts};

    use super::*;
    use crate::args::{Args, Command};

    fn job(options: &str) -> Result<Job, CliError> {
        let line = format!("shadow plan {options}");
        let Some(Command::Plan(args)) = Args::try_parse_from(line.split_whitespace()).unwrap().command else {
            panic!("not plan")
        };
        Job::resolve(&args.picture, &args.bias, Place::NOWHERE, &Console::new(true))
    }

    fn message(options: &str) -> String {
        job(options).err().map(|error| crate::error::chain(&error)).unwrap()
    }

    #[test]
    fn the_bias_takes_its_default_length_from_its_kind() {
        let bias =
            |options: &str| job(options).map(|job| job.shadowing.of_first(&job.scene).bias).expect("the options make a job");
        assert_eq!(bias(""), Bias::Automatic);
        assert_eq!(bias("--bias slope"), Bias::Parts(BiasParts { slope: Some(1.0), ..BiasParts::NONE }));
        assert_eq!(bias("--bias slope --bias-constant 0.5"), Bias::slope(1.0, 0.5));
        assert_eq!(bias("--bias constant"), Bias::constant(0.01));
        assert_eq!(bias("--bias none"), Bias::NONE);
        assert!(message("--bias none --bias-constant 0").contains("--bias slope"));
        assert!(message("--bias-constant 0.01").contains("--bias slope"));
        assert!(message("--bias slope --bias-constant -1").contains("-1 m"));
    }

    #[test]
    fn lights_of_the_command_line_replace_those_of_the_scene() {
        let job = job("--light point:pos=0,2,0;cd=10 --light directional:dir=0,-1,0;lux=1").unwrap();
        assert_eq!(job.light_names(), ["point", "directional"]);
        assert_eq!(job.plan.views.len(), 7);
        assert_eq!(job.scene.lights()[0].light.position(), Some(Vec3::new(0.0, 2.0, 0.0)));
        assert!(message("--light point:pos=0,2,0;cd=-1").starts_with("--light `point:pos=0,2,0;cd=-1`: "));
    }

    #[test]
    fn layers_that_do_not_exist_are_told_which_do() {
        let job = job("--light point:pos=0,2,0;cd=10").unwrap();
        let face = Show::ShadowMap(Selector::Name("point".into()), 5);
        assert_eq!(job.layer(&face).unwrap(), LayerName::ShadowMap { light: 0, view: 5 });
        let error = job.layer(&Show::ShadowMap(Selector::Index(0), 6)).unwrap_err().to_string();
        assert!(error.contains("no view 6") && error.contains("6 views") && error.contains("`-z`"), "{error}");
        let error = job.layer(&Show::Visibility(Selector::Index(1))).unwrap_err().to_string();
        assert!(error.contains("no light 1") && error.contains("`point`"), "{error}");
    }

    #[test]
    fn unknown_scenes_and_cameras_are_told_which_there_are() {
        assert!(message("builtin:moon").contains("box-on-plane"));
        let error = message("--camera 7");
        assert!(error.contains("no camera 7") && error.contains("1 camera"), "{error}");
        assert!(message("missing.glb").contains("missing.glb"));
        assert!(message("--exposure 99").contains("99"));
        for option in ["--scene 0", "--animation Run", "--time 0"] {
            let error = message(option);
            let name = option.split(' ').next().unwrap();
            assert!(error.contains(name) && error.contains("builtin:demo") && error.contains(".glb"), "{error}");
        }
    }
}
