//! Light on surfaces: ambient, Lambert, Blinn-Phong, spot cones, inverse square with range.
//!
//! Falloff is that of KHR_lights_punctual; the highlight is Blinn-Phong (Blinn 1977), normalised.
//!
//! Mirrored by `shade.wgsl`.

use glam::Vec3;

#[cfg(not(feature = "std"))]
use crate::float::FloatFuncs;
use crate::{
    approx::pow,
    plan::{LIGHT_DIRECTIONAL, LightPlan, TERMINATOR_SOFT, toward_light},
    vector::{normalized, unit_normal},
};

/// 1 / pi: what a matt white surface reflects in each direction of the light that falls on it.
pub const INVERSE_PI: f32 = core::f32::consts::FRAC_1_PI;

/// The share of light that a highlight reflects: that of most non-metals seen head-on (an index of refraction of 1.5).
pub const SPECULAR_REFLECTANCE: f32 = 0.04;

/// The highlight's strength over `n + 8`: `(n + 8) / (8 pi)` normalises it to within 8 %: seen head-on, the most that is reflected of what
/// arrives is 1.075 times the reflectance, at n = 8. One constant, since a shader compiler may join a product of several.
pub const SPECULAR_SCALE: f32 = SPECULAR_REFLECTANCE * 0.125 * INVERSE_PI;

/// A highlight below this, 2^-60, counts as none. It could not be seen; but its product with the rest can become a subnormal number, which
/// some hardware flushes to zero.
pub const MIN_HIGHLIGHT: f32 = 8.673_617_4e-19;

/// What the camera sees where there is nothing: linear colour after exposure, a pale sky.
pub const BACKGROUND: [f32; 3] = [0.42, 0.55, 0.72];

/// A point of a surface that light falls on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, in metres relative to the scene's origin.
    pub point: Vec3,
    /// The shading normal, of unit length.
    pub normal: Vec3,
    /// How far its triangle leans away from the normals at its corners: see [`facet_deviation`]. Lights with a hard terminator do not look at it.
    pub deviation: f32,
    /// The unit vector toward the viewer.
    pub toward_viewer: Vec3,
    /// The share of each colour that is reflected, linear.
    pub base_color: Vec3,
    /// The exponent of the highlight.
    pub shininess: f32,
}

/// How much of what a light sends falls on a point at `toward`, the vector from the point to the light, its distance aside: from 0, beyond the range's window or outside the cone, to 1.
#[inline(always)]
#[must_use]
pub fn light_reach(light: &LightPlan, toward: Vec3) -> f32 {
    if light.kind == LIGHT_DIRECTIONAL {
        return 1.0;
    }
    let squared = toward.x * toward.x + toward.y * toward.y + toward.z * toward.z;
    if squared <= 0.0 {
        return 0.0;
    }
    let distance = squared.sqrt();
    let ratio = distance * light.inverse_range;
    let ratio_squared = ratio * ratio;
    let window = (1.0 - ratio_squared * ratio_squared).max(0.0);
    let cosine = -(light.axis[0] * toward.x + light.axis[1] * toward.y + light.axis[2] * toward.z) / distance;
    let cone = (cosine * light.cone_scale + light.cone_offset).max(0.0).min(1.0);
    window * (cone * cone)
}

/// How much of its intensity a light sends to a point at `toward`, the vector from the point to the light.
///
/// For a directional light 1; for another inverse square in 1 / m^2, the range's window and the cone. Zero at the light itself.
#[inline(always)]
#[must_use]
pub fn attenuation(light: &LightPlan, toward: Vec3) -> f32 {
    if light.kind == LIGHT_DIRECTIONAL {
        return 1.0;
    }
    let squared = toward.x * toward.x + toward.y * toward.y + toward.z * toward.z;
    if squared <= 0.0 {
        return 0.0;
    }
    light_reach(light, toward) / squared
}

/// The largest deviation that is reckoned with: that of a sphere of some ten segments. Meshes that are coarser are left with what is beyond it; twice this cosine is where
/// all light is back.
pub const MAX_DEVIATION: f32 = 1.0 / 3.0;

/// The sine of the largest angle between a triangle's plane normal `facet`, of any length above 0, and the normals at its corners, up to [`MAX_DEVIATION`].
///
/// It does not matter to which side of the triangle the normals point.
#[inline(always)]
#[must_use]
pub fn facet_deviation(facet: Vec3, n0: Vec3, n1: Vec3, n2: Vec3) -> f32 {
    let facet = unit_normal(facet);
    let nearest = n0.dot(facet).abs().min(n1.dot(facet).abs()).min(n2.dot(facet).abs());
    let sine = (1.0 - nearest * nearest).max(0.0).sqrt();
    sine.min(MAX_DEVIATION)
}

/// How much is left of the light on a smooth surface that is made of flat facets: from 0, wherever a facet may have turned away from the light, to 1.
///
/// A mesh with smooth normals is lit where these face the light, but a facet that faces away is in its own shadow: at the terminator, where day becomes night, the
/// facets' edges cut the light off. A facet whose normal is within an angle of the smooth one can only have turned away where the smooth `cosine` is at most the sine of
/// that angle, its `deviation`. So light that fades out from twice the deviation to the deviation itself has left every facet before it turns away, and nothing is cut off. Between
/// them it follows the cubic `3 s^2 - 2 s^3`, which begins and ends flat. Flat surfaces, without a deviation, keep all of their light.
///
/// That the terminator moves toward the light is the price, and the idea of Blender's "shading terminator offset" (Cycles 2.90), which has one offset for a whole object.
#[inline(always)]
#[must_use]
pub fn softened_terminator(cosine: f32, deviation: f32) -> f32 {
    if !(deviation > 0.0) {
        return 1.0;
    }
    let share = ((cosine - deviation) / deviation).max(0.0).min(1.0);
    share * share * (3.0 - 2.0 * share)
}

/// The radiance that a light adds to a surface seen by the viewer, in candela per square metre.
///
/// `visibility` is from 0 to 1.
#[inline(always)]
#[must_use]
pub fn shade_light(light: &LightPlan, surface: &Surface, visibility: f32) -> Vec3 {
    let toward = toward_light(light, surface.point);
    let direction = normalized(toward);
    let mut cosine = surface.normal.dot(direction).max(0.0);
    if light.terminator == TERMINATOR_SOFT {
        cosine *= softened_terminator(cosine, surface.deviation);
    }
    let illuminance = attenuation(light, toward) * cosine * visibility;
    let half_way = normalized(direction + surface.toward_viewer);
    let mut highlight = pow(surface.normal.dot(half_way).max(0.0), surface.shininess);
    if highlight < MIN_HIGHLIGHT {
        highlight = 0.0;
    }
    // A constant factor comes before the variable ones: shader compilers move it there.
    let specular = (surface.shininess + 8.0) * SPECULAR_SCALE * highlight;
    let reflected = surface.base_color * INVERSE_PI + Vec3::new(specular, specular, specular);
    let intensity = Vec3::new(light.intensity[0], light.intensity[1], light.intensity[2]);
    intensity * reflected * illuminance
}

/// What a light's shadow multiplies the picture by: the shadow's colour where nothing of the light is seen, and 1 where all of it is. `reach` is the light's [`light_reach`]: where a light does not shine it has
/// no shadow either, and at the rim of a cone its shadow ends as softly as its light.
#[inline(always)]
#[must_use]
pub fn shadow_factor(shadow_color: Vec3, visibility: f32, reach: f32) -> Vec3 {
    let hidden = (1.0 - visibility) * reach;
    Vec3::ONE - (Vec3::ONE - shadow_color) * hidden
}

/// The radiance of a surface under light from everywhere, in candela per square metre; `ambient` in lux.
#[inline(always)]
#[must_use]
pub fn shade_ambient(ambient: Vec3, surface: &Surface) -> Vec3 {
    surface.base_color * INVERSE_PI * ambient
}

/// The exponent of the highlight that looks like a microfacet surface of this perceptual roughness, 0 to 1.
///
/// `2 / alpha^2 - 2` with `alpha = roughness^2` (Karis 2013), kept between 1 and [`MAX_SHININESS`].
#[must_use]
pub fn shininess_of_roughness(roughness: f32) -> f32 {
    let alpha = roughness * roughness;
    (2.0 / (alpha * alpha) - 2.0).max(1.0).min(MAX_SHININESS)
}

/// The sharpest highlight: beyond it a highlight of a punctual light is smaller than a pixel of most pictures.
pub const MAX_SHININESS: f32 = 2048.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{LIGHT_POINT, TERMINATOR_HARD};

    fn surface() -> Surface {
        Surface {
            point: Vec3::ZERO,
            normal: Vec3::Y,
            deviation: 0.0,
            toward_viewer: Vec3::Y,
            base_color: Vec3::ONE,
            shininess: 10.0,
        }
    }

    #[test]
    fn a_matt_white_plane_reflects_what_lambert_says() {
        let sun = LightPlan { position: [0.6, 0.8, 0.0], intensity: [1000.0; 3], cone_offset: 1.0, ..LightPlan::default() };
        let matt = Surface { toward_viewer: -Vec3::Y, ..surface() };
        let radiance = shade_light(&sun, &matt, 1.0).x;
        // Seen from below no highlight is possible: 1000 lux at cosine 0.8 over pi.
        assert!((radiance - 800.0 * INVERSE_PI).abs() < 1e-2, "{radiance}");
        assert_eq!(shade_light(&sun, &matt, 0.0), Vec3::ZERO);
    }

    #[test]
    fn a_highlight_reflects_about_its_share_of_what_arrives() {
        for shininess in [1.0_f32, 8.0, 20.0, 200.0] {
            // Integrates the highlight over all directions the light can come from, for a viewer straight above.
            let mut reflected = 0.0;
            let steps = 4000;
            for i in 0..steps {
                let theta = (i as f32 + 0.5) / steps as f32 * core::f32::consts::FRAC_PI_2;
                let light = LightPlan {
                    position: [theta.sin(), theta.cos(), 0.0],
                    intensity: [1.0; 3],
                    cone_offset: 1.0,
                    ..LightPlan::default()
                };
                let shiny = Surface { base_color: Vec3::ZERO, shininess, ..surface() };
                let ring = core::f32::consts::TAU * theta.sin() * core::f32::consts::FRAC_PI_2 / steps as f32;
                reflected += shade_light(&light, &shiny, 1.0).x * ring;
            }
            // 1.075 at n = 8 is the maximum of the exact integral over this normalisation; the sum of 4000 rings is off by less than 1e-3.
            let share = reflected / SPECULAR_REFLECTANCE;
            assert!((0.9..1.077).contains(&share), "{share} at {shininess}");
        }
    }

    #[test]
    fn light_has_left_every_facet_before_it_turns_away() {
        let sun = |cosine: f32, terminator: u32| LightPlan {
            position: [(1.0 - cosine * cosine).sqrt(), cosine, 0.0],
            intensity: [1.0; 3],
            cone_offset: 1.0,
            terminator,
            ..LightPlan::default()
        };
        for degrees in [0.0_f32, 5.0, 15.0] {
            // A facet that leans away from the light by an angle, under a light that sinks. Its normal may have any length, and either side.
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let facet = Vec3::new(-sine, cosine, 0.0);
            let deviation = facet_deviation(facet * -1e-25, Vec3::Y, Vec3::Y, facet);
            assert!((deviation - sine).abs() < 1e-3, "{deviation} at {degrees} degrees");
            let matt = Surface { toward_viewer: -Vec3::Y, deviation, ..surface() };
            let mut before = f32::INFINITY;
            for step in 0..=200_u8 {
                let height = 1.0 - f32::from(step) / 200.0;
                let radiance = shade_light(&sun(height, TERMINATOR_SOFT), &matt, 1.0).x;
                let lambert = shade_light(&sun(height, TERMINATOR_HARD), &matt, 1.0).x;
                assert!(radiance <= lambert && radiance <= before, "{degrees} degrees, {height}: {radiance} {lambert}");
                if degrees == 0.0 || height >= 2.0 * deviation {
                    assert_eq!(radiance, lambert);
                }
                if facet.dot(Vec3::from(sun(height, TERMINATOR_SOFT).position)) <= 0.0 {
                    assert_eq!(radiance, 0.0, "{degrees} degrees, {height}");
                }
                before = radiance;
            }
        }
        assert_eq!(facet_deviation(Vec3::Y, Vec3::X, Vec3::Y, Vec3::Y), MAX_DEVIATION);
    }

    #[test]
    fn a_point_light_falls_off_by_the_square_and_ends_at_its_range() {
        let light = LightPlan { kind: LIGHT_POINT, inverse_range: 0.1, cone_offset: 1.0, ..LightPlan::default() };
        assert!((attenuation(&light, Vec3::Y) / attenuation(&light, Vec3::Y * 2.0) - 4.0).abs() < 0.01);
        assert_eq!(attenuation(&light, Vec3::Y * 10.0), 0.0);
        assert_eq!(attenuation(&light, Vec3::ZERO), 0.0);
    }
}
