//! The small languages of the command line: sizes, layers, lights, cameras, scenes and backends. Parsing only: nothing here looks at a
//! scene, but for [`Selector::find`], which is lent the names to choose from.

use std::{convert::Infallible, path::PathBuf, str::FromStr};

use clap::ValueEnum;
use glam::{DVec3, Vec3};
use shadow_math::{Camera, CameraError, Light, LightKind, Projection};

use crate::{args::Backend, error::CliError};

/// The largest width and height of a picture in pixels.
const MAX_PICTURE_SIZE: u32 = 16_384;
/// The vertical angle of view of a camera that does not say one, in degrees.
const DEFAULT_FOV_DEGREES: f64 = 45.0;
/// The near plane of a camera of the command line, in metres, in scenes that are not tiny. Reversed depth in floating point is as
/// fine for a near plane of a centimetre as for one of a metre.
const NEAR_METRES: f64 = 0.01;
/// The near plane is never farther than this share of the scene's radius.
const NEAR_SHARE: f64 = 1e-3;

/// Why a value of the command line cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum SpecError {
    /// Not a width and a height.
    #[error("`{0}` is not a size; write width and height in pixels, each from 1 to {MAX_PICTURE_SIZE}, such as 1280x720")]
    Size(String),
    /// Not a layer.
    #[error("there is no layer `{0}`; there are: color, visibility[:LIGHT], depth, shadow-map[:LIGHT[:VIEW]]")]
    Layer(String),
    /// Not the number of a view.
    #[error("`{0}` is not the number of a view; a light's views count from 0")]
    View(String),
    /// Not a kind of light.
    #[error("there is no kind of light `{0}`; there are: directional, spot, point (such as directional:dir=-1,-2,-1;lux=20000)")]
    LightKind(String),
    /// A part without an equals sign.
    #[error("`{part}` is not KEY=VALUE; {what} takes: {}", accepted.join(", "))]
    NotKeyValue {
        /// The part.
        part: String,
        /// What is described.
        what: &'static str,
        /// The keys it takes.
        accepted: &'static [&'static str],
    },
    /// A key that means nothing here.
    #[error("{what} has no `{key}`; it takes: {}", accepted.join(", "))]
    UnknownKey {
        /// What is described.
        what: &'static str,
        /// The key.
        key: String,
        /// The keys it takes.
        accepted: &'static [&'static str],
    },
    /// A key that is given twice.
    #[error("`{key}` is given twice")]
    RepeatedKey {
        /// The key.
        key: String,
    },
    /// A key that must be there.
    #[error("{what} needs `{key}`; it takes: {}", accepted.join(", "))]
    MissingKey {
        /// What is described.
        what: &'static str,
        /// The key.
        key: &'static str,
        /// The keys it takes.
        accepted: &'static [&'static str],
    },
    /// Not a number.
    #[error("`{key}={value}`: `{part}` is not a finite number")]
    Number {
        /// The key.
        key: &'static str,
        /// Its value.
        value: String,
        /// The part that is not a number.
        part: String,
    },
    /// Not three numbers.
    #[error("`{key}={value}` must be three numbers separated by commas, such as {key}=1,2,3")]
    Vector {
        /// The key.
        key: &'static str,
        /// Its value.
        value: String,
    },
    /// Not two backends.
    #[error("`{0}` is not a pair of backends; write exactly two of cpu and gpu, such as cpu,gpu")]
    Backends(String),
    /// The same backend twice.
    #[error("comparing a backend with itself proves nothing; name two different ones, such as cpu,gpu")]
    SameBackend,
}

/// Width and height of a picture in pixels, each from 1 to 16384.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PictureSize {
    /// The width in pixels.
    pub(crate) width: u32,
    /// The height in pixels.
    pub(crate) height: u32,
}

impl FromStr for PictureSize {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let side = |text: &str| text.parse().ok().filter(|side| (1..=MAX_PICTURE_SIZE).contains(side));
        let sides = text.split_once(['x', 'X']).and_then(|(width, height)| Some((side(width)?, side(height)?)));
        let (width, height) = sides.ok_or_else(|| SpecError::Size(text.into()))?;
        Ok(Self { width, height })
    }
}

/// One of several things, by its number from 0 or by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Selector {
    /// By its number from 0.
    Index(usize),
    /// By its name.
    Name(String),
}

impl Selector {
    fn new(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Name(text.into()), Self::Index)
    }

    /// The index of the thing among those of these names. A name that several have is the first's.
    pub(crate) fn find(&self, kind: &'static str, names: &[String]) -> Result<usize, CliError> {
        let (found, asked) = match self {
            Self::Index(index) => (Some(*index).filter(|index| *index < names.len()), index.to_string()),
            Self::Name(wanted) => (names.iter().position(|name| name == wanted), format!("`{wanted}`")),
        };
        found.ok_or_else(|| CliError::NoSuch { kind, asked, names: names.to_vec() })
    }
}

/// How many things there are, and their names: the end of a sentence.
pub(crate) fn inventory(kind: &str, names: &[String]) -> String {
    /// Beyond this many names the sentence would be a page.
    const MAX_NAMES: usize = 20;
    let listed: Vec<String> = names
        .iter()
        .take(MAX_NAMES)
        .enumerate()
        .map(|(index, name)| if name.is_empty() { index.to_string() } else { format!("{index} (`{name}`)") })
        .collect();
    let more = if names.len() > MAX_NAMES { ", ..." } else { "" };
    match names.len() {
        0 => format!("there is no {kind} at all"),
        1 => format!("there is 1 {kind}: {}", listed.join(", ")),
        count => format!("there are {count} {kind}s: {}{more}", listed.join(", ")),
    }
}

/// What `render` draws.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Show {
    /// The picture.
    Color,
    /// How much of a light reaches each pixel.
    Visibility(Selector),
    /// How far away each pixel is.
    Depth,
    /// A shadow map: the light and the number of its view.
    ShadowMap(Selector, usize),
}

impl FromStr for Show {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let (layer, rest) = text.split_once(':').map_or((text, None), |(layer, rest)| (layer, Some(rest)));
        Ok(match (layer, rest) {
            ("color", None) => Self::Color,
            ("depth", None) => Self::Depth,
            ("visibility", light) => Self::Visibility(Selector::new(light.unwrap_or("0"))),
            ("shadow-map", rest) => {
                let (light, view) = rest.map_or(("0", "0"), |rest| rest.split_once(':').unwrap_or((rest, "0")));
                Self::ShadowMap(Selector::new(light), view.parse().map_err(|_| SpecError::View(view.into()))?)
            }
            _ => return Err(SpecError::Layer(text.into())),
        })
    }
}

/// The values of a description such as `eye=1,2,3;fov=40`, by their keys.
struct Pairs<'a> {
    what: &'static str,
    accepted: &'static [&'static str],
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Pairs<'a> {
    /// Splits a description of `what`, which takes these keys and no others. Empty parts are skipped, so that it may end in `;`.
    fn parse(text: &'a str, what: &'static str, accepted: &'static [&'static str]) -> Result<Self, SpecError> {
        let mut pairs: Vec<(&str, &str)> = Vec::new();
        for part in text.split(';').map(str::trim).filter(|part| !part.is_empty()) {
            let (key, value) =
                part.split_once('=').ok_or_else(|| SpecError::NotKeyValue { part: part.into(), what, accepted })?;
            let (key, value) = (key.trim(), value.trim());
            if !accepted.contains(&key) {
                return Err(SpecError::UnknownKey { what, key: key.into(), accepted });
            }
            if pairs.iter().any(|(before, _)| *before == key) {
                return Err(SpecError::RepeatedKey { key: key.into() });
            }
            pairs.push((key, value));
        }
        Ok(Self { what, accepted, pairs })
    }

    fn get(&self, key: &str) -> Option<&'a str> {
        self.pairs.iter().find(|(name, _)| *name == key).map(|(_, value)| *value)
    }

    fn missing(&self, key: &'static str) -> SpecError {
        SpecError::MissingKey { what: self.what, key, accepted: self.accepted }
    }

    /// The number of a key, if it is given.
    fn optional_number(&self, key: &'static str) -> Result<Option<f64>, SpecError> {
        self.get(key).map(|value| number(key, value, value)).transpose()
    }

    fn number(&self, key: &'static str) -> Result<f64, SpecError> {
        self.optional_number(key)?.ok_or_else(|| self.missing(key))
    }

    /// The three numbers of a key, if it is given.
    fn optional_vector(&self, key: &'static str) -> Result<Option<DVec3>, SpecError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let numbers = value.split(',').map(|part| number(key, value, part.trim())).collect::<Result<Vec<f64>, _>>();
        match numbers?[..] {
            [x, y, z] => Ok(Some(DVec3::new(x, y, z))),
            _ => Err(SpecError::Vector { key, value: value.into() }),
        }
    }

    fn vector(&self, key: &'static str) -> Result<DVec3, SpecError> {
        self.optional_vector(key)?.ok_or_else(|| self.missing(key))
    }
}

/// A finite number.
fn number(key: &'static str, value: &str, part: &str) -> Result<f64, SpecError> {
    let failed = || SpecError::Number { key, value: value.into(), part: part.into() };
    part.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(failed)
}

/// A light as it was typed: positions in metres of the file's world space, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LightSpec {
    /// What was typed, for messages.
    pub(crate) text: String,
    kind: LightSpecKind,
    /// The colour, linear.
    color: DVec3,
    /// Lux for a directional light, candela for the others.
    intensity: f64,
}

/// What kind of light was typed.
#[derive(Clone, Debug, PartialEq)]
enum LightSpecKind {
    Directional { direction: DVec3 },
    Spot { position: DVec3, direction: DVec3, inner_degrees: f64, outer_degrees: f64, range: Option<f64> },
    Point { position: DVec3, range: Option<f64> },
}

impl FromStr for LightSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        let (pairs, kind, intensity) = match kind.trim() {
            "directional" => {
                let pairs = Pairs::parse(rest, "a directional light", &["dir", "lux", "color"])?;
                let kind = LightSpecKind::Directional { direction: pairs.vector("dir")? };
                (pairs, kind, "lux")
            }
            "spot" => {
                let pairs = Pairs::parse(rest, "a spot light", &["pos", "dir", "inner", "outer", "cd", "range", "color"])?;
                let kind = LightSpecKind::Spot {
                    position: pairs.vector("pos")?,
                    direction: pairs.vector("dir")?,
                    inner_degrees: pairs.optional_number("inner")?.unwrap_or(0.0),
                    outer_degrees: pairs.number("outer")?,
                    range: pairs.optional_number("range")?,
                };
                (pairs, kind, "cd")
            }
            "point" => {
                let pairs = Pairs::parse(rest, "a point light", &["pos", "cd", "range", "color"])?;
                let kind = LightSpecKind::Point { position: pairs.vector("pos")?, range: pairs.optional_number("range")? };
                (pairs, kind, "cd")
            }
            other => return Err(SpecError::LightKind(other.into())),
        };
        let color = pairs.optional_vector("color")?.unwrap_or(DVec3::ONE);
        Ok(Self { text: text.into(), kind, color, intensity: pairs.number(intensity)? })
    }
}

impl LightSpec {
    /// The kind, which is also the light's name.
    pub(crate) fn name(&self) -> &'static str {
        match self.kind {
            LightSpecKind::Directional { .. } => "directional",
            LightSpecKind::Spot { .. } => "spot",
            LightSpecKind::Point { .. } => "point",
        }
    }

    /// The light relative to `origin`, a point in metres of the file's world space. It is not yet validated.
    pub(crate) fn to_light(&self, origin: DVec3) -> Light {
        let range = |range: Option<f64>| range.map(|metres| metres as f32);
        let relative = |position: DVec3| (position - origin).as_vec3();
        let kind = match self.kind {
            LightSpecKind::Directional { direction } => LightKind::Directional { direction: narrow_direction(direction) },
            LightSpecKind::Spot { position, direction, inner_degrees, outer_degrees, range: limit } => LightKind::Spot {
                position: relative(position),
                direction: narrow_direction(direction),
                inner: inner_degrees.to_radians() as f32,
                outer: outer_degrees.to_radians() as f32,
                range: range(limit),
            },
            LightSpecKind::Point { position, range: limit } => {
                LightKind::Point { position: relative(position), range: range(limit) }
            }
        };
        Light { kind, color: self.color.as_vec3(), intensity: self.intensity as f32 }
    }
}

/// A direction as f32, scaled so that it fits whatever its length is; one without a length stays so and is refused later.
fn narrow_direction(direction: DVec3) -> Vec3 {
    let largest = direction.abs().max_element();
    if largest > 0.0 { (direction / largest).as_vec3() } else { Vec3::ZERO }
}

/// A camera as it was typed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CameraChoice {
    /// One of the scene's.
    Selected(Selector),
    /// A camera of its own.
    Placed(CameraSpec),
}

impl FromStr for CameraChoice {
    type Err = SpecError;

    /// A text with an equals sign is a place; any other is a number or a name.
    fn from_str(text: &str) -> Result<Self, SpecError> {
        if !text.contains('=') {
            return Ok(Self::Selected(Selector::new(text)));
        }
        let pairs = Pairs::parse(text, "a camera", &["eye", "target", "fov"])?;
        Ok(Self::Placed(CameraSpec {
            text: text.into(),
            eye: pairs.vector("eye")?,
            target: pairs.vector("target")?,
            fov_degrees: pairs.optional_number("fov")?.unwrap_or(DEFAULT_FOV_DEGREES),
        }))
    }
}

/// A camera that was placed on the command line: points in metres of the file's world space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CameraSpec {
    /// What was typed, for messages.
    pub(crate) text: String,
    eye: DVec3,
    target: DVec3,
    /// The vertical angle of view in degrees.
    fov_degrees: f64,
}

impl CameraSpec {
    /// The camera relative to `origin`, a point in metres of the file's world space, for a scene of that radius in metres. It has no far
    /// plane.
    pub(crate) fn to_camera(&self, origin: DVec3, scene_radius: f64) -> Result<Camera, CameraError> {
        let near = (scene_radius * NEAR_SHARE).clamp(f64::from(f32::MIN_POSITIVE), NEAR_METRES);
        let projection = Projection::Perspective { vertical_fov: self.fov_degrees.to_radians(), near, far: None };
        let camera = Camera::look_at(self.eye - origin, self.target - origin, projection)?;
        camera.validate()?;
        Ok(camera)
    }
}

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum SceneSource {
    /// The built-in scene of that name.
    Builtin(String),
    /// A file.
    File(PathBuf),
}

impl FromStr for SceneSource {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.strip_prefix("builtin:") {
            Some(name) => Self::Builtin(name.into()),
            None => Self::File(text.into()),
        })
    }
}

/// Two different backends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BackendPair {
    /// The first.
    pub(crate) first: Backend,
    /// The second, not the same.
    pub(crate) second: Backend,
}

impl FromStr for BackendPair {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let failed = || SpecError::Backends(text.into());
        let backends = text.split(',').map(|name| Backend::from_str(name.trim(), false)).collect::<Result<Vec<_>, _>>();
        match backends.map_err(|_| failed())?[..] {
            [first, second] if first == second => Err(SpecError::SameBackend),
            [first, second] => Ok(Self { first, second }),
            _ => Err(failed()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(text: &str) -> Result<LightSpec, SpecError> {
        text.parse()
    }

    /// The message of a light that cannot be read.
    fn light_error(text: &str) -> String {
        light(text).unwrap_err().to_string()
    }

    #[test]
    fn sizes() {
        assert_eq!("1280x720".parse(), Ok(PictureSize { width: 1280, height: 720 }));
        assert_eq!("1X16384".parse(), Ok(PictureSize { width: 1, height: 16_384 }));
        for bad in ["", "x", "1280", "0x720", "1280x0", "16385x1", "-1x5", "1x2x3", "1.5x2", "99999999999x1"] {
            assert_eq!(bad.parse::<PictureSize>(), Err(SpecError::Size(bad.into())));
        }
    }

    #[test]
    fn layers() {
        let first = Selector::Index(0);
        assert_eq!("color".parse(), Ok(Show::Color));
        assert_eq!("depth".parse(), Ok(Show::Depth));
        assert_eq!("visibility".parse(), Ok(Show::Visibility(first.clone())));
        assert_eq!("visibility:sun".parse(), Ok(Show::Visibility(Selector::Name("sun".into()))));
        assert_eq!("shadow-map".parse(), Ok(Show::ShadowMap(first, 0)));
        assert_eq!("shadow-map:2".parse(), Ok(Show::ShadowMap(Selector::Index(2), 0)));
        assert_eq!("shadow-map:2:5".parse(), Ok(Show::ShadowMap(Selector::Index(2), 5)));
        assert_eq!("shadow-map:0:x".parse::<Show>(), Err(SpecError::View("x".into())));
        for bad in ["", "colour", "color:1", "depth:0"] {
            assert_eq!(bad.parse::<Show>(), Err(SpecError::Layer(bad.into())));
        }
    }

    #[test]
    fn selecting_says_what_there_is() {
        let names = ["sun", "", "lamp"].map(String::from);
        assert_eq!(Selector::Index(2).find("light", &names).unwrap(), 2);
        assert_eq!(Selector::Name("lamp".into()).find("light", &names).unwrap(), 2);
        let error = Selector::Index(3).find("light", &names).unwrap_err().to_string();
        assert_eq!(error, "there is no light 3; there are 3 lights: 0 (`sun`), 1, 2 (`lamp`)");
        let error = Selector::Name("moon".into()).find("light", &names[..1]).unwrap_err().to_string();
        assert_eq!(error, "there is no light `moon`; there is 1 light: 0 (`sun`)");
    }

    #[test]
    fn a_directional_light() {
        let light = light("directional:dir=1,-2,0.5;lux=20000").unwrap().to_light(DVec3::splat(100.0));
        assert_eq!(light.kind, LightKind::Directional { direction: Vec3::new(0.5, -1.0, 0.25) });
        assert_eq!((light.color, light.intensity), (Vec3::ONE, 20_000.0));
    }

    #[test]
    fn a_spot_light_is_relative_to_the_origin_and_in_radians() {
        let spec = light("spot: pos=1e6,2,3 ; dir=0,-1,0; outer=90; cd=800; range=12; color=1,0.5,0;").unwrap();
        let light = spec.to_light(DVec3::new(999_990.0, 0.0, 0.0));
        light.validate().unwrap();
        let LightKind::Spot { position, direction, inner, outer, range } = light.kind else { panic!("not a spot light") };
        assert_eq!((position, direction), (Vec3::new(10.0, 2.0, 3.0), Vec3::NEG_Y));
        assert_eq!((inner, outer, range), (0.0, core::f32::consts::FRAC_PI_2, Some(12.0)));
        assert_eq!((light.color, light.intensity), (Vec3::new(1.0, 0.5, 0.0), 800.0));
    }

    #[test]
    fn a_point_light_needs_no_range() {
        let light = light("point:cd=5;pos=0,1,2").unwrap().to_light(DVec3::ZERO);
        assert_eq!(light.kind, LightKind::Point { position: Vec3::new(0.0, 1.0, 2.0), range: None });
    }

    #[test]
    fn directions_keep_their_meaning_at_any_length() {
        for length in [1e-300, 1.0, 1e300] {
            let light = light(&format!("directional:dir=0,-{length},0;lux=1")).unwrap().to_light(DVec3::ZERO);
            light.validate().unwrap();
            let LightKind::Directional { direction } = light.kind else { panic!("not a directional light") };
            assert_eq!(direction, Vec3::NEG_Y);
        }
        assert!(light("directional:dir=0,0,0;lux=1").unwrap().to_light(DVec3::ZERO).validate().is_err());
    }

    #[test]
    fn wrong_lights_are_told_what_a_light_takes() {
        assert_eq!(light_error("sun:lux=1"), SpecError::LightKind("sun".into()).to_string());
        assert_eq!(light_error("directional:dir=0,-1,0"), "a directional light needs `lux`; it takes: dir, lux, color");
        assert_eq!(light_error("directional:dir=0,-1,0;cd=1"), "a directional light has no `cd`; it takes: dir, lux, color");
        assert_eq!(light_error("point"), "a point light needs `pos`; it takes: pos, cd, range, color");
        assert_eq!(light_error("point:pos=1,2,3;pos=1,2,3;cd=1"), "`pos` is given twice");
        assert_eq!(light_error("point:pos=1,2;cd=1"), "`pos=1,2` must be three numbers separated by commas, such as pos=1,2,3");
        assert_eq!(light_error("point:pos=1,2,z;cd=1"), "`pos=1,2,z`: `z` is not a finite number");
        assert_eq!(light_error("point:pos=1,2,3;cd=inf"), "`cd=inf`: `inf` is not a finite number");
        assert_eq!(
            light_error("point:pos=1,2,3;bright"),
            "`bright` is not KEY=VALUE; a point light takes: pos, cd, range, color"
        );
    }

    #[test]
    fn cameras_are_chosen_or_placed() {
        assert_eq!("1".parse(), Ok(CameraChoice::Selected(Selector::Index(1))));
        assert_eq!("main".parse(), Ok(CameraChoice::Selected(Selector::Name("main".into()))));
        let Ok(CameraChoice::Placed(spec)) = "eye=1001,2,3;target=1001,2,0".parse() else { panic!("not placed") };
        let camera = spec.to_camera(DVec3::new(1000.0, 0.0, 0.0), 1.0).unwrap();
        assert_eq!(camera.eye, DVec3::new(1.0, 2.0, 3.0));
        assert!((camera.direction() - DVec3::NEG_Z).length() < 1e-12);
        let Projection::Perspective { vertical_fov, near, far } = camera.projection else { panic!("not perspective") };
        assert!((vertical_fov - core::f64::consts::FRAC_PI_4).abs() < 1e-12);
        assert_eq!((near, far), (1e-3, None));
    }

    #[test]
    fn wrong_cameras_are_told_what_a_camera_takes() {
        let error = |text: &str| text.parse::<CameraChoice>().unwrap_err().to_string();
        assert_eq!(error("eye=1,2,3"), "a camera needs `target`; it takes: eye, target, fov");
        assert_eq!(error("eye=1,2,3;at=0,0,0"), "a camera has no `at`; it takes: eye, target, fov");
        let place = |text: &str| match text.parse() {
            Ok(CameraChoice::Placed(spec)) => spec.to_camera(DVec3::ZERO, 1.0),
            other => panic!("{other:?}"),
        };
        assert_eq!(place("eye=1,2,3;target=1,2,3"), Err(CameraError::Direction));
        assert!(matches!(place("eye=1,2,3;target=0,0,0;fov=180"), Err(CameraError::FieldOfView(_))));
    }

    #[test]
    fn backends_come_in_different_pairs() {
        assert_eq!("gpu,cpu".parse(), Ok(BackendPair { first: Backend::Gpu, second: Backend::Cpu }));
        assert_eq!("gpu,gpu".parse::<BackendPair>(), Err(SpecError::SameBackend));
        for bad in ["cpu", "cpu,gpu,cpu", "cpu,trace", ""] {
            assert_eq!(bad.parse::<BackendPair>(), Err(SpecError::Backends(bad.into())));
        }
    }
}
