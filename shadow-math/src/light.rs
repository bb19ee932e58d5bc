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
}
