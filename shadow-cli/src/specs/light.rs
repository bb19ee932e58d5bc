//! Lights as `--light` describes them.

use std::{path::PathBuf, str::FromStr};

use glam::{DVec3, Vec3};
use shadow_math::{Light, LightKind, LightShape};

use super::{SpecError, pairs::Pairs};

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
    size: LightSizeSpec,
    /// The file of the picture that a spot light projects.
    pub(crate) picture: Option<PathBuf>,
}

/// How large a light was typed to be.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LightSizeSpec {
    /// Nothing: it has no size.
    None,
    /// The diameter of a disc in the sky, in degrees.
    Diameter(f64),
    /// The radius of a sphere, in metres.
    Radius(f64),
    /// The width and height of a rectangle across a spot light's axis, in metres.
    Rectangle(f64, f64),
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
                let pairs = Pairs::parse(rest, "a directional light", &["dir", "lux", "diameter", "color"])?;
                let kind = LightSpecKind::Directional { direction: pairs.vector("dir")? };
                (pairs, kind, "lux")
            }
            "spot" => {
                let keys = &["pos", "dir", "inner", "outer", "cd", "range", "radius", "width", "height", "color", "picture"];
                let pairs = Pairs::parse(rest, "a spot light", keys)?;
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
                let pairs = Pairs::parse(rest, "a point light", &["pos", "cd", "range", "radius", "color"])?;
                let kind = LightSpecKind::Point { position: pairs.vector("pos")?, range: pairs.optional_number("range")? };
                (pairs, kind, "cd")
            }
            other => return Err(SpecError::LightKind(other.into())),
        };
        let color = pairs.optional_vector("color")?.unwrap_or(DVec3::ONE);
        let picture = pairs.optional_text("picture").map(PathBuf::from);
        Ok(Self {
            text: text.into(),
            picture,
            kind,
            color,
            intensity: pairs.number(intensity)?,
            size: LightSizeSpec::of(&pairs)?,
        })
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

    /// How large the light is. It is not yet validated.
    pub(crate) fn shape(&self) -> LightShape {
        match self.size {
            LightSizeSpec::None => LightShape::Point,
            LightSizeSpec::Diameter(degrees) => LightShape::Disc { angular_diameter: degrees.to_radians() as f32 },
            LightSizeSpec::Radius(metres) => LightShape::Sphere { radius: metres as f32 },
            LightSizeSpec::Rectangle(width, height) => {
                let (right, up) = self.across();
                LightShape::Rectangle { half_width: (right * 0.5 * width).as_vec3(), half_height: (up * 0.5 * height).as_vec3() }
            }
        }
    }

    /// The directions of a rectangle's width, which is level, and of its height; both across the light's direction, of length 1.
    fn across(&self) -> (DVec3, DVec3) {
        let direction = match self.kind {
            LightSpecKind::Directional { direction } | LightSpecKind::Spot { direction, .. } => direction.normalize_or_zero(),
            LightSpecKind::Point { .. } => DVec3::NEG_Y,
        };
        // Straight up or down no direction is more level than another.
        let right = direction.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
        (right, right.cross(direction))
    }
}

impl LightSizeSpec {
    /// The size among the keys that the kind of light takes.
    fn of(pairs: &Pairs<'_>) -> Result<Self, SpecError> {
        let number = |key| pairs.optional_number(key);
        Ok(match (number("diameter")?, number("radius")?, number("width")?, number("height")?) {
            (Some(diameter), ..) => Self::Diameter(diameter),
            (None, Some(radius), None, None) => Self::Radius(radius),
            (None, Some(_), ..) => return Err(SpecError::TwoSizes),
            (None, None, None, None) => Self::None,
            (None, None, ..) => Self::Rectangle(pairs.number("width")?, pairs.number("height")?),
        })
    }
}

/// A direction as f32, scaled so that it fits whatever its length is; one without a length stays so and is refused later.
fn narrow_direction(direction: DVec3) -> Vec3 {
    let largest = direction.abs().max_element();
    if largest > 0.0 { (direction / largest).as_vec3() } else { Vec3::ZERO }
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
        assert_eq!(light_error("directional:dir=0,-1,0"), "a directional light needs `lux`; it takes: dir, lux, diameter, color");
        assert_eq!(
            light_error("directional:dir=0,-1,0;cd=1"),
            "a directional light has no `cd`; it takes: dir, lux, diameter, color"
        );
        assert_eq!(light_error("point"), "a point light needs `pos`; it takes: pos, cd, range, radius, color");
        assert_eq!(light_error("point:pos=1,2,3;pos=1,2,3;cd=1"), "`pos` is given twice");
        assert_eq!(light_error("point:pos=1,2;cd=1"), "`pos=1,2` must be three numbers separated by commas, such as pos=1,2,3");
        assert_eq!(light_error("point:pos=1,2,z;cd=1"), "`pos=1,2,z`: `z` is not a finite number");
        assert_eq!(light_error("point:pos=1,2,3;cd=inf"), "`cd=inf`: `inf` is not a finite number");
        assert_eq!(
            light_error("point:pos=0,250cm,0;cd=1"),
            "`pos=0,250cm,0`: write the number without a unit; pos is in metres, here 2.5"
        );
        assert!(light_error("spot:pos=0,1,0;dir=0,-1,0;outer=30deg;cd=1").ends_with("outer is in degrees, here 30"));
        assert!(light_error("directional:dir=0,-1m,0;lux=1").contains("dir has no unit"));
        assert_eq!(
            light_error("point:pos=1,2,3;bright"),
            "`bright` is not KEY=VALUE; a point light takes: pos, cd, range, radius, color"
        );
    }

    #[test]
    fn a_light_can_have_a_size() {
        let shape = |text: &str| light(text).expect(text).shape();
        assert_eq!(shape("point:pos=0,1,2;cd=1"), LightShape::Point);
        assert_eq!(shape("point:pos=0,1,2;cd=1;radius=0.05"), LightShape::Sphere { radius: 0.05 });
        let sun = shape("directional:dir=0,-1,0;lux=1;diameter=0.53");
        assert_eq!(sun, LightShape::Disc { angular_diameter: 0.53_f64.to_radians() as f32 });
        let panel = shape("spot:pos=0,3,0;dir=0,0,-2;outer=60;cd=1;width=2;height=1");
        assert_eq!(panel, LightShape::Rectangle { half_width: Vec3::X, half_height: 0.5 * Vec3::Y });
        let below = shape("spot:pos=0,3,0;dir=0,-1,0;outer=60;cd=1;width=2;height=1");
        assert_eq!(below, LightShape::Rectangle { half_width: Vec3::X, half_height: 0.5 * Vec3::NEG_Z });
        let spot = "spot:pos=0,3,0;dir=0,-1,0;outer=60;cd=1";
        assert_eq!(light_error(&format!("{spot};width=2;height=1;radius=1")), SpecError::TwoSizes.to_string());
        assert!(light_error(&format!("{spot};width=2")).starts_with("a spot light needs `height`"));
        assert!(light_error("point:pos=0,1,2;cd=1;width=2").starts_with("a point light has no `width`"));
        assert!(light_error("point:pos=0,1,2;cd=1;radius=5cm").ends_with("radius is in metres, here 0.05"));
    }
}
