//! Pictures that a spot light projects, as a slide projector does.
//!
//! The matrix that takes a point of the world to the picture is that of the lecture on projective textures (Everitt, "Projective Texture Mapping", 2001): scale and offset by a half, times the light's projection, times its view.
//! The picture fills the square around the light's outer cone. Its colours, decoded to linear, multiply the light's: one that darkens outwards is the light's falloff.
//!
//! [`picture_color`] is mirrored by `picture.wgsl`.

use glam::{DMat4, DVec3, Vec2, Vec3};

use crate::{
    camera::world_from_view_rotation,
    light::{Light, LightKind, MAX_SINGLE_MAP_OUTER_ANGLE},
    material::{TextureData, WRAP_CLAMP, sample_texture},
    plan::{LightPlan, PlanError},
    vector::row_times_point,
};

/// The rows x, y and w of the matrix from world space to a picture: `(x / w, y / w)` runs from (0, 0) at its upper left corner to (1, 1) at its lower right.
///
/// `position` is in metres, `direction` of unit length, `outer` the angle between the axis and the middle of an edge, in radians, above 0 and below a right angle.
#[must_use]
pub fn picture_from_world(position: DVec3, direction: DVec3, outer: f64) -> [[f64; 4]; 3] {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    let rotation = world_from_view_rotation(direction);
    let view_from_world = DMat4::from_rotation_translation(rotation, position).inverse();
    let slope = outer.tan();
    let row = |index: usize| view_from_world.row(index);
    // The view looks along -z: w is the distance, and rows of a picture count downward.
    let w = -row(2);
    let x = row(0) * (0.5 / slope) + w * 0.5;
    let y = row(1) * (-0.5 / slope) + w * 0.5;
    [x, y, w].map(|row| row.to_array())
}

/// Writes a picture into a spot light's plan: where its texels begin among the scene's words, and its size in texels.
///
/// # Errors
///
/// [`PlanError::PictureOfOtherLight`]: only a spot light of at most [`MAX_SINGLE_MAP_OUTER_ANGLE`] has a square that a picture could fill.
pub fn plan_picture(plan: &mut LightPlan, light: &Light, first_word: u32, width: u32, height: u32) -> Result<(), PlanError> {
    let LightKind::Spot { position, direction, outer, .. } = light.kind else { return Err(PlanError::PictureOfOtherLight) };
    if outer > MAX_SINGLE_MAP_OUTER_ANGLE {
        return Err(PlanError::PictureOfOtherLight);
    }
    let rows = picture_from_world(position.as_dvec3(), direction.as_dvec3().normalize(), f64::from(outer));
    [plan.picture_x, plan.picture_y, plan.picture_w] = rows.map(|row| row.map(|number| number as f32));
    (plan.picture_first_word, plan.picture_width, plan.picture_height) = (first_word, width, height);
    Ok(())
}

/// What a light's picture multiplies its colour by at a point: linear; 1 for a light without one, 0 beside the picture and behind the light.
///
/// `words` are the scene's texels; the point is in metres relative to the scene's origin.
#[inline(always)]
#[must_use]
pub fn picture_color(words: &[u32], light: &LightPlan, point: Vec3) -> Vec3 {
    if light.picture_width == 0 {
        return Vec3::ONE;
    }
    let w = row_times_point(light.picture_w, point);
    if w <= 0.0 {
        return Vec3::ZERO;
    }
    let u = row_times_point(light.picture_x, point) / w;
    let v = row_times_point(light.picture_y, point) / w;
    if u < 0.0 || v < 0.0 || u > 1.0 || v > 1.0 {
        return Vec3::ZERO;
    }
    let texture = TextureData {
        first_word: light.picture_first_word,
        width: light.picture_width,
        height: light.picture_height,
        wrap_u: WRAP_CLAMP,
        wrap_v: WRAP_CLAMP,
    };
    let color = sample_texture(words, &texture, Vec2::new(u, v));
    Vec3::new(color.x, color.y, color.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The middle of the picture lies on the axis, and the middles of its edges where the outer cone touches them.
    #[test]
    fn the_square_touches_the_outer_cone() {
        let (position, direction, outer) = (DVec3::new(1.0, 5.0, 2.0), DVec3::new(0.3, -0.9, 0.1).normalize(), 0.5_f64);
        let rows = picture_from_world(position, direction, outer);
        let place = |point: DVec3| {
            let [x, y, w] = rows.map(|row| glam::DVec4::from_array(row).dot(point.extend(1.0)));
            (x / w, y / w)
        };
        let on_axis = place(position + direction * 3.0);
        assert!((on_axis.0 - 0.5).abs() < 1e-12 && (on_axis.1 - 0.5).abs() < 1e-12);
        let rotation = world_from_view_rotation(direction);
        for (offset, expected) in
            [(DVec3::X, (1.0, 0.5)), (DVec3::NEG_X, (0.0, 0.5)), (DVec3::Y, (0.5, 0.0)), (DVec3::NEG_Y, (0.5, 1.0))]
        {
            let (u, v) = place(position + 7.0 * (direction + rotation * offset * outer.tan()));
            assert!((u - expected.0).abs() < 1e-12 && (v - expected.1).abs() < 1e-12, "{offset}: {u} {v}");
        }
    }
}
