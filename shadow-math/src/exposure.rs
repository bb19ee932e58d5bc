//! Exposure: what radiance becomes white, by a fixed rule from the lights.

use glam::Vec3;

use crate::{bounds::Aabb, light::Light};

/// The luminance that saturates a sensor at EV 0 and ISO 100, in candela per square metre (Lagarde and de Rousiers 2014, section 5.1.2).
const WHITE_AT_EV_0: f32 = 1.2;

/// The share of white that a matt white surface facing the reference light has: the rest is headroom for highlights and second lights.
const WHITE_SURFACE_SHARE: f32 = 0.85;

/// Ambient light as a share of the reference illuminance: shadows stay readable.
const AMBIENT_SHARE: f32 = 0.12;

/// The colour of ambient light: a little bluer than the lights, as skylight is.
const AMBIENT_COLOR: Vec3 = Vec3::new(0.9, 0.97, 1.1);

/// A light is taken to be no nearer to the scene's middle than this share of the scene's radius.
const MIN_DISTANCE_SHARE: f32 = 0.3;

/// How radiance becomes colour, and how much light comes from everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// What radiance, in candela per square metre, is multiplied by; 1 is white.
    pub scale: f32,
    /// Ambient illuminance in lux, linear colour.
    pub ambient: Vec3,
}

impl Default for Exposure {
    /// For a reference illuminance of 1 lux.
    fn default() -> Self {
        Self::of_illuminance(1.0)
    }
}

impl Exposure {
    /// The exposure under which a matt white surface that receives `illuminance` lux is nearly white. Zero lux, or so little that the
    /// scale would be infinite, gives that of 1 lux, so that an unlit scene is dark and not undefined.
    #[must_use]
    pub fn of_illuminance(illuminance: f32) -> Self {
        let illuminance = if illuminance >= f32::MIN_POSITIVE && illuminance.is_finite() { illuminance } else { 1.0 };
        let white = illuminance * crate::shade::INVERSE_PI / WHITE_SURFACE_SHARE;
        Self { scale: 1.0 / white, ambient: AMBIENT_COLOR * (AMBIENT_SHARE * illuminance) }
    }

    /// The fixed rule: the exposure for the [reference illuminance](reference_illuminance) of these lights.
    #[must_use]
    pub fn automatic<'a>(lights: impl IntoIterator<Item = &'a Light>, bounds: Aabb) -> Self {
        Self::of_illuminance(reference_illuminance(lights, bounds))
    }

    /// The same ambient light under a given exposure value: at EV 15 a sunny day is well exposed, at EV 5 a lit room.
    #[must_use]
    pub fn with_ev(self, ev: f32) -> Self {
        #[cfg(not(feature = "std"))]
        use crate::float::FloatFuncs;
        Self { scale: 1.0 / (WHITE_AT_EV_0 * ev.exp2()), ..self }
    }

    /// The exposure value (EV at ISO 100) that this scale amounts to.
    #[must_use]
    pub fn ev(self) -> f32 {
        #[cfg(not(feature = "std"))]
        use crate::float::FloatFuncs;
        (1.0 / (WHITE_AT_EV_0 * self.scale)).log2()
    }
}

/// The illuminance, in lux, that the scene's lights are taken to give it together.
///
/// A directional light counts with its illuminance. Any other counts with its intensity over the square of its distance from the
/// middle of `bounds`, which is taken to be at least 0.3 of their radius. Each counts by its brightest channel.
#[must_use]
pub fn reference_illuminance<'a>(lights: impl IntoIterator<Item = &'a Light>, bounds: Aabb) -> f32 {
    lights
        .into_iter()
        .map(|light| {
            let brightness = light.intensity * light.color.max_element();
            match light.position() {
                None => brightness,
                Some(position) => {
                    let nearest = MIN_DISTANCE_SHARE * bounds.radius();
                    let distance = (position - bounds.center()).length().max(nearest);
                    if distance > 0.0 { brightness / (distance * distance) } else { brightness }
                }
            }
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_white_surface_in_the_reference_light_is_nearly_white() {
        let exposure = Exposure::of_illuminance(5000.0);
        let radiance = 5000.0 * crate::shade::INVERSE_PI;
        assert!((radiance * exposure.scale - WHITE_SURFACE_SHARE).abs() < 1e-5);
    }

    #[test]
    fn exposure_values_count_in_stops() {
        let exposure = Exposure::of_illuminance(5000.0);
        let ev = exposure.ev();
        assert!((exposure.with_ev(ev).scale / exposure.scale - 1.0).abs() < 1e-5);
        assert!((exposure.with_ev(ev + 1.0).scale / exposure.scale - 0.5).abs() < 1e-5);
    }

    #[test]
    fn darkness_has_an_exposure() {
        let dark = Exposure::of_illuminance(1.0);
        assert_eq!(Exposure::automatic([], Aabb::EMPTY), dark);
        assert_eq!(Exposure::of_illuminance(1e-44), dark);
        assert!(Exposure::of_illuminance(f32::MIN_POSITIVE).scale.is_finite());
    }
}
