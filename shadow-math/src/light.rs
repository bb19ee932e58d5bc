//! Lights as the glTF extension KHR_lights_punctual defines them.

use glam::Vec3;

/// The widest cone, as the angle between its axis and its edge in radians, that one map covers: 70 degrees.
///
/// A projection's image grows with the tangent of this angle: at 70 degrees the texels at the rim are already
/// `1 / cos(70)^2 = 8.5` times as fine in angle as those in the middle, and at 90 degrees there is no projection at all.
/// Wider cones take cube faces.
pub const MAX_SINGLE_MAP_OUTER_ANGLE: f32 = 70.0 * core::f32::consts::PI / 180.0;

/// The brightest light, in lux or candela for each channel: beyond it products of f32 with it would overflow near the light.
pub const MAX_BRIGHTNESS: f32 = 1e12;

/// What kind of light it is, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum LightKind {
    /// Parallel rays.
    Directional {
        /// The direction the light travels in; any length above 0.
        direction: Vec3,
    },
    /// A cone from a point.
    Spot {
        /// The apex, in metres relative to the scene's origin.
        position: Vec3,
        /// The cone's axis, in the direction the light travels; any length above 0.
        direction: Vec3,
        /// The angle in radians between the axis and the edge of full brightness; at least 0 and below `outer`.
        inner: f32,
        /// The angle in radians between the axis and the edge of the light; at most pi / 2.
        outer: f32,
        /// The distance in metres beyond which there is no light; `None` for no such limit.
        range: Option<f32>,
    },
    /// All directions from a point.
    Point {
        /// The position, in metres relative to the scene's origin.
        position: Vec3,
        /// The distance in metres beyond which there is no light; `None` for no such limit.
        range: Option<f32>,
    },
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Light {
    /// What kind of light it is, and where.
    pub kind: LightKind,
    /// The colour, linear; each channel at least 0.
    pub color: Vec3,
    /// Illuminance in lux for a directional light, luminous intensity in candela for the others; at least 0.
    pub intensity: f32,
}

/// How large a light is, as seen from what it lights. A light without a size throws hard shadows.
///
/// Shadow maps are drawn for its centre. The size is for those who look at the penumbra.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum LightShape {
    /// No size.
    #[default]
    Point,
    /// A sphere around the position of a spot or point light.
    Sphere {
        /// The radius in metres, above 0.
        radius: f32,
    },
    /// A disc in the sky around the direction of a directional light.
    Disc {
        /// The angle that its diameter is seen under, in radians; above 0 and below pi. The sun's is 0.0093.
        angular_diameter: f32,
    },
    /// A rectangle around the position of a spot light.
    Rectangle {
        /// From the position to the middle of one side, in metres.
        half_width: Vec3,
        /// From the position to the middle of the next side, in metres; not parallel to `half_width`.
        half_height: Vec3,
    },
}

/// Why a light cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LightError {
    /// The direction has no length or is not finite.
    Direction(Vec3),
    /// The position is not finite.
    Position(Vec3),
    /// The cone's angles, in radians, are not `0 <= inner < outer <= pi / 2`.
    Cone {
        /// The angle to the edge of full brightness, in radians.
        inner: f32,
        /// The angle to the edge of the light, in radians.
        outer: f32,
    },
    /// The range is not a positive number of metres.
    Range(f32),
    /// The colour or the intensity is negative or not finite, or their product is above [`MAX_BRIGHTNESS`].
    Brightness,
    /// The light's kind cannot have this shape.
    ShapeOfKind(LightShape),
    /// The radius of a sphere is not a positive number of metres.
    Radius(f32),
    /// The angle of a disc, in radians, is not above 0 and below pi.
    AngularDiameter(f32),
    /// A rectangle has no area, or its sides are not finite.
    Rectangle {
        /// From its centre to the middle of one side, in metres.
        half_width: Vec3,
        /// From its centre to the middle of the next side, in metres.
        half_height: Vec3,
    },
}

impl core::fmt::Display for LightError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Direction(d) => write!(f, "the light's direction {d} has no length or is not finite"),
            Self::Position(p) => write!(f, "the light's position {p} is not finite"),
            Self::Cone { inner, outer } => write!(
                f,
                "the spot light's cone is {:.2} degrees inside and {:.2} degrees outside; the inner angle must be at least 0 and below the outer one, the outer one at most 90 (angles are measured from the axis)",
                inner.to_degrees(),
                outer.to_degrees()
            ),
            Self::Range(range) => {
                write!(
                    f,
                    "the light's range is {range} m; it must be a positive number (leave it out for a light without a limit)"
                )
            }
            Self::ShapeOfKind(shape) => f.write_str(match shape {
                LightShape::Disc { .. } => {
                    "only a directional light can be a disc in the sky; give a spot or point light a radius"
                }
                LightShape::Rectangle { .. } => {
                    "only a spot light can be a rectangle; give a point light a radius and a directional one an angular diameter"
                }
                LightShape::Sphere { .. } | LightShape::Point => {
                    "a directional light has no position that a sphere could surround; give it an angular diameter"
                }
            }),
            Self::Radius(radius) => {
                write!(
                    f,
                    "the light's radius is {radius} m; it must be a positive number (leave it out for a light without a size)"
                )
            }
            Self::AngularDiameter(angle) => write!(
                f,
                "the light's angular diameter is {} degrees; it must lie between 0 and 180 (the sun's is 0.53)",
                angle.to_degrees()
            ),
            Self::Rectangle { half_width, half_height } => write!(
                f,
                "the light is a rectangle of {} x {} m; both must be positive numbers",
                2.0 * half_width.length(),
                2.0 * half_height.length()
            ),
            Self::Brightness => write!(
                f,
                "the light's colour and intensity must be finite and not negative, and their product at most {MAX_BRIGHTNESS:e} (a clear day has 1e5 lux, a lighthouse 1e7 candela)"
            ),
        }
    }
}

impl core::error::Error for LightError {}

impl Light {
    /// The position of a spot or point light; `None` for a directional one.
    #[must_use]
    pub fn position(&self) -> Option<Vec3> {
        match self.kind {
            LightKind::Directional { .. } => None,
            LightKind::Spot { position, .. } | LightKind::Point { position, .. } => Some(position),
        }
    }

    /// The distance in metres beyond which there is no light; infinite where there is no limit.
    #[must_use]
    pub fn range(&self) -> f32 {
        match self.kind {
            LightKind::Directional { .. } => f32::INFINITY,
            LightKind::Spot { range, .. } | LightKind::Point { range, .. } => range.unwrap_or(f32::INFINITY),
        }
    }

    /// Checks every value that could not be used.
    ///
    /// # Errors
    ///
    /// The first [`LightError`] that applies.
    pub fn validate(&self) -> Result<(), LightError> {
        let check_direction = |direction: Vec3| {
            if direction.is_finite() && direction.as_dvec3().length_squared() > 0.0 {
                Ok(())
            } else {
                Err(LightError::Direction(direction))
            }
        };
        let brightness = self.color * self.intensity;
        let is_positive = self.color.min_element() >= 0.0 && self.intensity >= 0.0;
        if !(self.color.is_finite() && self.intensity.is_finite() && is_positive && brightness.max_element() <= MAX_BRIGHTNESS) {
            return Err(LightError::Brightness);
        }
        if let Some(position) = self.position()
            && !position.is_finite()
        {
            return Err(LightError::Position(position));
        }
        let range = self.range();
        if !(range > 0.0) {
            return Err(LightError::Range(range));
        }
        match self.kind {
            LightKind::Directional { direction } => check_direction(direction),
            LightKind::Spot { direction, inner, outer, .. } => {
                check_direction(direction)?;
                // Half a turn in f32 is rounded up, so 90 degrees exactly must still pass.
                if inner >= 0.0 && inner < outer && outer <= core::f32::consts::FRAC_PI_2 {
                    Ok(())
                } else {
                    Err(LightError::Cone { inner, outer })
                }
            }
            LightKind::Point { .. } => Ok(()),
        }
    }
}

impl LightShape {
    /// Checks the shape of a light of this kind.
    ///
    /// # Errors
    ///
    /// [`LightError::ShapeOfKind`], [`LightError::Radius`], [`LightError::AngularDiameter`] and [`LightError::Rectangle`].
    pub fn validate(&self, kind: &LightKind) -> Result<(), LightError> {
        match (*self, kind) {
            (Self::Point, _) => Ok(()),
            (Self::Sphere { radius }, LightKind::Spot { .. } | LightKind::Point { .. }) => {
                if radius > 0.0 && radius.is_finite() {
                    Ok(())
                } else {
                    Err(LightError::Radius(radius))
                }
            }
            (Self::Disc { angular_diameter }, LightKind::Directional { .. }) => {
                let is_usable = angular_diameter > 0.0 && angular_diameter < core::f32::consts::PI;
                if is_usable { Ok(()) } else { Err(LightError::AngularDiameter(angular_diameter)) }
            }
            (Self::Rectangle { half_width, half_height }, LightKind::Spot { .. }) => {
                let area = half_width.as_dvec3().cross(half_height.as_dvec3()).length_squared();
                let is_usable = area > 0.0 && area.is_finite();
                if is_usable { Ok(()) } else { Err(LightError::Rectangle { half_width, half_height }) }
            }
            (shape, _) => Err(LightError::ShapeOfKind(shape)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_without_a_meaning_are_refused() {
        let light = |kind, intensity| Light { kind, color: Vec3::new(10.0, 1.0, 0.0), intensity }.validate();
        let point = |range| LightKind::Point { position: Vec3::ZERO, range };
        assert_eq!(light(point(None), 100.0), Ok(()));
        for brightness in [-1.0, f32::NAN, f32::INFINITY, 3e38] {
            assert_eq!(light(point(None), brightness), Err(LightError::Brightness), "{brightness}");
        }
        assert_eq!(light(point(Some(0.0)), 1.0), Err(LightError::Range(0.0)));
        assert!(matches!(light(LightKind::Directional { direction: Vec3::ZERO }, 1.0), Err(LightError::Direction(_))));
        let spot = |inner, outer| LightKind::Spot { position: Vec3::ZERO, direction: Vec3::X, inner, outer, range: None };
        assert_eq!(light(spot(0.0, core::f32::consts::FRAC_PI_2), 1.0), Ok(()), "90 degrees exactly");
        for (inner, outer) in [(0.5, 0.5), (-0.1, 0.5), (0.1, 1.6), (0.1, f32::NAN)] {
            assert!(matches!(light(spot(inner, outer), 1.0), Err(LightError::Cone { .. })), "{inner} to {outer}");
        }
    }

    #[test]
    fn a_shape_that_the_kind_cannot_have_is_refused() {
        let sun = LightKind::Directional { direction: Vec3::NEG_Y };
        let lamp = LightKind::Point { position: Vec3::ZERO, range: None };
        let spot = LightKind::Spot { position: Vec3::ZERO, direction: Vec3::X, inner: 0.0, outer: 0.5, range: None };
        let (sphere, disc) = (LightShape::Sphere { radius: 0.1 }, LightShape::Disc { angular_diameter: 0.0093 });
        let rectangle = LightShape::Rectangle { half_width: Vec3::X, half_height: Vec3::Z };
        for (kind, fitting) in [(sun, vec_of([disc])), (lamp, vec_of([sphere])), (spot, vec_of([sphere, rectangle]))] {
            for shape in [sphere, disc, rectangle] {
                let expected = if fitting.contains(&Some(shape)) { Ok(()) } else { Err(LightError::ShapeOfKind(shape)) };
                assert_eq!(shape.validate(&kind), expected, "{shape:?} of {kind:?}");
            }
            assert_eq!(LightShape::Point.validate(&kind), Ok(()));
        }
        assert_eq!(LightShape::Sphere { radius: 0.0 }.validate(&lamp), Err(LightError::Radius(0.0)));
        assert!(LightShape::Disc { angular_diameter: 3.2 }.validate(&sun).is_err());
        let flat = LightShape::Rectangle { half_width: Vec3::X, half_height: 2.0 * Vec3::X };
        assert!(matches!(flat.validate(&spot), Err(LightError::Rectangle { .. })));
    }

    /// Up to two shapes, in an array, since this crate has no heap.
    fn vec_of<const N: usize>(shapes: [LightShape; N]) -> [Option<LightShape>; 2] {
        core::array::from_fn(|i| shapes.get(i).copied())
    }
}
