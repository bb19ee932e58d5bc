//! `shadow info`: what is in a scene.

use glam::DVec3;
use serde::Serialize;
use shadow_math::{LightKind, Projection};
use shadow_scene::{Alpha, Scene, SourceFacts};

use super::Verdict;
use crate::{
    args::InfoArgs,
    console::{Console, count, print, print_json, table},
    error::CliError,
    resolve::{load, tell_notes},
};

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    scene: &'a str,
    notes: &'a [String],
    generator: Option<&'a str>,
    /// What is drawn, with every instance counted.
    triangles: usize,
    vertices: usize,
    instances: usize,
    /// Every instance, by the number and name that `--no-cast` has for it.
    objects: Vec<Object<'a>>,
    /// How many meshes the file has, each counted once.
    meshes: usize,
    primitives: usize,
    materials: Materials,
    textures: usize,
    images: Vec<Image<'a>>,
    lights: Vec<Light<'a>>,
    cameras: Vec<Camera<'a>>,
    /// The names of the scenes of the file; the number of the one that is drawn.
    scenes: &'a [String],
    drawn_scene: Option<usize>,
    animations: Vec<Animation<'a>>,
    /// The number of the animation whose pose is drawn, and the pose's time in seconds.
    drawn_animation: Option<usize>,
    time: f64,
    skins: usize,
    /// Null if nothing is drawn.
    bounds: Option<Bounds>,
    units_guess: Option<UnitsGuess>,
    extensions_used: &'a [String],
    extensions_ignored: &'a [String],
}

/// The materials that are drawn, by their alpha.
#[derive(Debug, Serialize)]
struct Materials {
    opaque: usize,
    mask: usize,
    blend: usize,
}

/// An instance of a mesh.
#[derive(Debug, Serialize)]
struct Object<'a> {
    name: &'a str,
    triangles: u32,
}

/// An image of the file.
#[derive(Debug, Serialize)]
struct Image<'a> {
    name: &'a str,
    /// In texels; null if nothing that is drawn uses it.
    size: Option<[u32; 2]>,
}

/// A light of the scene's own.
#[derive(Debug, Serialize)]
struct Light<'a> {
    name: &'a str,
    kind: &'static str,
    intensity: f32,
    /// `lux` or `candela`.
    unit: &'static str,
}

/// A camera of the scene's own.
#[derive(Debug, Serialize)]
struct Camera<'a> {
    name: &'a str,
    projection: &'static str,
    /// The vertical angle of view; null for parallel rays.
    fov_degrees: Option<f64>,
}

/// An animation of the file.
#[derive(Debug, Serialize)]
struct Animation<'a> {
    name: &'a str,
    seconds: f64,
    channels: usize,
}

/// The bounds of all triangles, in metres of the file's world space.
#[derive(Debug, Serialize)]
struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
    size: [f64; 3],
    diagonal: f64,
}

/// What the file's numbers may be in: see [`UnitsGuess::of`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum UnitsGuess {
    Kilometres,
    Metres,
    MetresOrCentimetres,
    Centimetres,
    Millimetres,
}

impl UnitsGuess {
    /// Guesses from the diagonal of the bounds in metres, which is what glTF's numbers should be in.
    ///
    /// Scenes are commonly between a toy (1 cm) and a town (1 km) in size. What is larger than a town is more likely a room or a
    /// building in centimetres, up to 200 m of them; what is larger than that, in millimetres. What is smaller than a toy was made in a
    /// larger unit. Between 100 m and 1 km lies a person or a car in centimetres as well as a street in metres.
    fn of(diagonal: f64) -> Self {
        match diagonal {
            _ if diagonal < 0.01 => Self::Kilometres,
            _ if diagonal <= 100.0 => Self::Metres,
            _ if diagonal <= 1e3 => Self::MetresOrCentimetres,
            _ if diagonal <= 2e4 => Self::Centimetres,
            _ => Self::Millimetres,
        }
    }

    fn sentence(self) -> &'static str {
        match self {
            Self::Kilometres => "looks like kilometres, or a model scaled down: smaller than 1 cm as metres",
            Self::Metres => "metres are plausible",
            Self::MetresOrCentimetres => {
                "metres if it is a street or a park, centimetres if it is a person, a car or a piece of furniture"
            }
            Self::Centimetres => "looks like centimetres: larger than 1 km as metres",
            Self::Millimetres => "looks like millimetres: larger than 20 km as metres",
        }
    }
}

/// Loads the scene and reports.
pub(super) fn run(args: &InfoArgs) -> Result<Verdict, CliError> {
    let console = Console::new(args.json);
    let (name, scene, _) = load(&args.scene, &console)?;
    let notes = scene.notes().to_vec();
    tell_notes(&notes, &console);
    console.finish();
    let report = Report::of(&name, &scene, &notes);
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(Verdict::Done)
}

impl<'a> Report<'a> {
    fn of(name: &'a str, scene: &'a Scene, notes: &'a [String]) -> Self {
        let source: &SourceFacts = scene.source();
        let bounds = (!scene.triangles().is_empty()).then(|| Bounds::of(scene));
        // What stands in for what the scene lacks is not the scene's.
        let lights = if scene.has_default_light() { &[] } else { scene.lights() };
        let cameras = if scene.has_default_camera() { &[] } else { scene.cameras() };
        let mask = scene.materials().iter().filter(|material| matches!(material.alpha, Alpha::Mask { .. })).count();
        let blend = source.blended_materials;
        Self {
            scene: name,
            notes,
            generator: source.generator.as_deref(),
            triangles: scene.triangles().len(),
            vertices: scene.vertices().positions.len(),
            instances: scene.instances().len(),
            objects: scene
                .instances()
                .iter()
                .map(|object| Object { name: &object.name, triangles: object.triangle_count })
                .collect(),
            meshes: source.meshes,
            primitives: source.primitives,
            materials: Materials { opaque: scene.materials().len().saturating_sub(mask + blend), mask, blend },
            textures: source.textures,
            images: source.images.iter().map(|image| Image { name: &image.name, size: image.size }).collect(),
            lights: lights.iter().map(|light| Light::of(&light.name, &light.light)).collect(),
            cameras: cameras.iter().map(|camera| Camera::of(&camera.name, &camera.camera)).collect(),
            scenes: &source.scenes,
            drawn_scene: source.scene,
            animations: source
                .animations
                .iter()
                .map(|animation| Animation { name: &animation.name, seconds: animation.seconds, channels: animation.channels })
                .collect(),
            drawn_animation: source.animation,
            time: source.time,
            skins: source.skins,
            units_guess: bounds.as_ref().map(|bounds| UnitsGuess::of(bounds.diagonal)),
            bounds,
            extensions_used: &source.extensions_used,
            extensions_ignored: &source.extensions_ignored,
        }
    }
}

impl Bounds {
    fn of(scene: &Scene) -> Self {
        let bounds = scene.bounds();
        let [min, max] = [bounds.min, bounds.max].map(|corner| corner.as_dvec3() + scene.origin());
        let size = max - min;
        Self { min: min.to_array(), max: max.to_array(), size: size.to_array(), diagonal: DVec3::length(size) }
    }
}

impl<'a> Light<'a> {
    fn of(name: &'a str, light: &shadow_math::Light) -> Self {
        let (kind, unit) = match light.kind {
            LightKind::Directional { .. } => ("directional", "lux"),
            LightKind::Spot { .. } => ("spot", "candela"),
            LightKind::Point { .. } => ("point", "candela"),
        };
        Self { name, kind, intensity: light.intensity, unit }
    }
}

impl<'a> Camera<'a> {
    fn of(name: &'a str, camera: &shadow_math::Camera) -> Self {
        match camera.projection {
            Projection::Perspective { vertical_fov, .. } => {
                Self { name, projection: "perspective", fov_degrees: Some(vertical_fov.to_degrees()) }
            }
            Projection::Orthographic { .. } => Self { name, projection: "orthographic", fov_degrees: None },
        }
    }
}

/// How many objects the report for people names: those of a large scene would hide all else.
const SHOWN_OBJECTS: usize = 20;

/// The report for people.
fn text(report: &Report<'_>) -> String {
    let Materials { opaque, mask, blend } = report.materials;
    let mut rows: Vec<(&str, String)> = vec![
        ("scene", report.scene.into()),
        ("made by", report.generator.unwrap_or_default().into()),
        ("geometry", geometry_text(report)),
        ("meshes", format!("{} of {}, {}", report.meshes, count(report.primitives, "primitive"), count(report.skins, "skin"))),
        ("materials", format!("{opaque} opaque, {mask} masked, {blend} blended")),
        ("textures", format!("{} of {}", report.textures, count(report.images.len(), "image"))),
        ("bounds", report.bounds.as_ref().map(bounds_text).unwrap_or_default()),
        ("units", report.units_guess.map(|guess| format!("{} (a guess by the diagonal)", guess.sentence())).unwrap_or_default()),
    ];
    let image = |image: &Image<'_>| match image.size {
        Some([width, height]) => format!("{}, {width} x {height} texels", quoted(image.name)),
        None => format!("{}, not used", quoted(image.name)),
    };
    let drawn = |is_drawn: bool| if is_drawn { ", drawn" } else { "" };
    let object = |object: &Object<'_>| format!("{}, {}", quoted(object.name), count(object.triangles as usize, "triangle"));
    rows.extend(numbered("object", report.objects.iter().take(SHOWN_OBJECTS).map(object)));
    if let Some(more) = report.objects.len().checked_sub(SHOWN_OBJECTS).filter(|&more| more > 0) {
        rows.push(("objects", format!("and {more} more (--json lists all)")));
    }
    rows.extend(numbered("image", report.images.iter().map(image)));
    let lights = report.lights.iter();
    rows.extend(numbered(
        "light",
        lights.map(|light| format!("{}, {}, {} {}", quoted(light.name), light.kind, light.intensity, light.unit)),
    ));
    let camera = |camera: &Camera<'_>| match camera.fov_degrees {
        Some(fov) => format!("{}, {}, {fov:.1} degrees", quoted(camera.name), camera.projection),
        None => format!("{}, {}", quoted(camera.name), camera.projection),
    };
    rows.extend(numbered("camera", report.cameras.iter().map(camera)));
    let scene = |(index, name): (usize, &String)| format!("{}{}", quoted(name), drawn(report.drawn_scene == Some(index)));
    rows.extend(numbered("scene of the file", report.scenes.iter().enumerate().map(scene)));
    let animation = |(index, animation): (usize, &Animation<'_>)| {
        let drawn = if report.drawn_animation == Some(index) { format!(", drawn at {} s", report.time) } else { String::new() };
        format!("{}, {:.3} s, {}{drawn}", quoted(animation.name), animation.seconds, count(animation.channels, "channel"))
    };
    rows.extend(numbered("animation", report.animations.iter().enumerate().map(animation)));
    rows.push(("extensions", report.extensions_used.join(", ")));
    rows.push(("left out", report.extensions_ignored.join(", ")));
    let rows = rows.into_iter().map(|(what, text)| vec![what.into(), if text.is_empty() { "none".into() } else { text }]);
    table(&rows.collect::<Vec<_>>(), |_| true)
}

fn geometry_text(report: &Report<'_>) -> String {
    let Report { triangles, vertices, instances, .. } = report;
    format!(
        "{}, {vertices} {}, {}",
        count(*triangles, "triangle"),
        if *vertices == 1 { "vertex" } else { "vertices" },
        count(*instances, "instance")
    )
}

fn bounds_text(bounds: &Bounds) -> String {
    let Bounds { min, max, size, diagonal } = bounds;
    let three = |numbers: &[f64; 3], between: &str| numbers.map(|number| format!("{number:.3}")).join(between);
    format!("from {} to {} m: {} m, diagonal {diagonal:.3} m", three(min, ", "), three(max, ", "), three(size, " x "))
}

/// A name in quotes, or that there is none.
fn quoted(name: &str) -> String {
    if name.is_empty() { "without a name".into() } else { format!("`{name}`") }
}

/// A row for each thing, with its number; one that says so where there is none.
fn numbered(what: &str, things: impl Iterator<Item = String>) -> Vec<(&str, String)> {
    let rows: Vec<_> = things.enumerate().map(|(number, thing)| (what, format!("{number} {thing}"))).collect();
    if rows.is_empty() { vec![(what, String::new())] } else { rows }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_guessed_by_the_diagonal() {
        for (diagonal, guess) in [
            (0.005, UnitsGuess::Kilometres),
            (0.3, UnitsGuess::Metres),
            (100.0, UnitsGuess::Metres),
            (190.0, UnitsGuess::MetresOrCentimetres),
            (3_700.0, UnitsGuess::Centimetres),
            (50_000.0, UnitsGuess::Millimetres),
        ] {
            assert_eq!(UnitsGuess::of(diagonal), guess, "{diagonal} m");
        }
    }

    #[test]
    fn bounds_are_those_of_the_files_world() {
        let mut builder = shadow_scene::SceneBuilder::new(DVec3::new(1e6, 0.0, 0.0));
        let material = builder.add_material(shadow_scene::Material::white());
        let vertices = shadow_scene::Vertices {
            positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y],
            normals: vec![glam::Vec3::Z; 3],
            uvs: vec![glam::Vec2::ZERO; 3],
            colors: vec![glam::Vec4::ONE; 3],
        };
        builder.add_instance("triangle", material, shadow_scene::Mesh { vertices, triangles: vec![[0, 1, 2]] }).unwrap();
        let bounds = Bounds::of(&builder.build().unwrap());
        assert_eq!((bounds.min[0], bounds.max[0], bounds.size), (1e6, 1e6 + 1.0, [1.0, 1.0, 0.0]));
    }
}
