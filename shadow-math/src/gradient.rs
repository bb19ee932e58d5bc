//! How fast depth changes over the image of a plane, from texel to texel.
//!
//! Depth z / w is an affine function of the texel coordinates over the whole of a plane's image, so its gradient `g = (du3/du1, du3/du2)` is one pair of numbers. It is computed three
//! ways, which agree:
//! - [`gradient_by_plane`], the transformed plane: `-pi'_j / pi'_3` with `pi' = A^-T pi`;
//! - [`gradient_by_jacobian`], equations (3) to (5) of "Shadow Mapping in Ogre" (Chong 2006), with the sign that equation (5) lacks;
//! - [`depth_gradient`], the same in f32 from the plan's columns, which is what renderers use. It is mirrored by `gradient.wgsl`.

use glam::{DMat4, DVec2, DVec3, DVec4, Vec2, Vec3};

use crate::plan::ViewPlan;

/// The depth gradient of a plane, from the plane itself: `(du3/du1, du3/du2)` in depth per texel.
///
/// `texel_from_world` maps world points to (texel x, texel y, depth) after the division by w; `plane` is `(n, -n.x)` in world
/// space, of any scale. Depth is affine over a plane's image, so the gradient holds for all of the plane. A plane that the
/// light sees edge-on has none, and gives infinities or NaN.
///
/// Source: a row vector of plane coefficients transforms by the inverse of the matrix that transforms points.
#[must_use]
pub fn gradient_by_plane(texel_from_world: DMat4, plane: DVec4) -> DVec2 {
    let transformed = texel_from_world.inverse().transpose() * plane;
    DVec2::new(-transformed.x / transformed.z, -transformed.y / transformed.z)
}

/// The depth gradient at a point, from equations (3) to (5) of Chong 2006: `(du3/du1, du3/du2)` in depth per texel.
///
/// `point` and the plane's `normal`, of any length, are in world space.
/// Equation (5) as printed, in the article and on OGRE's pages, lacks the minus sign; the article's shader has it.
///
/// ```
/// use shadow_math::gradient::{gradient_by_jacobian, gradient_by_plane};
/// use glam::{DMat4, DVec3};
///
/// let texel_from_world = DMat4::from_scale(DVec3::new(100.0, -100.0, -0.1));
/// let (point, normal) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, 0.6, 0.8));
/// let a = gradient_by_jacobian(texel_from_world, point, normal);
/// let b = gradient_by_plane(texel_from_world, normal.extend(-normal.dot(point)));
/// assert!((a - b).length() < 1e-15);
/// ```
#[must_use]
pub fn gradient_by_jacobian(texel_from_world: DMat4, point: DVec3, normal: DVec3) -> DVec2 {
    let world_from_texel = texel_from_world.inverse();
    let w = (texel_from_world * point.extend(1.0)).w;
    // Equation (4): the derivative of x, from that of x q with q = 1 / w.
    let derivative = |column: DVec4| w * (column.truncate() - point * column.w);
    let along_depth = normal.dot(derivative(world_from_texel.z_axis));
    let along = |column: DVec4| -normal.dot(derivative(column)) / along_depth;
    DVec2::new(along(world_from_texel.x_axis), along(world_from_texel.y_axis))
}

/// How much depth changes per metre that a point moves along the view's z axis, toward the light: equations (6) and (7) of Chong 2006.
///
/// `ndc_z` and `w` are the point's. View z grows toward the light, so the value is negative, and a push away from the light is its
/// negative.
#[must_use]
pub fn depth_per_view_z(clip_from_view: DMat4, ndc_z: f64, w: f64) -> f64 {
    let column = clip_from_view.z_axis;
    (column.z - ndc_z * column.w) / w
}

/// The depth gradient of a receiver's plane in a view: `(du3/du1, du3/du2)` in depth per texel.
///
/// `point` is in metres relative to the scene's origin, `normal` in world space and of any length above 0. A plane
/// that the view sees edge-on gives a gradient of `f32::MAX` or beyond, never NaN.
#[inline(always)]
#[must_use]
pub fn depth_gradient(view: &ViewPlan, point: Vec3, normal: Vec3) -> Vec2 {
    let along_x = normal_derivative(view.world_from_texel_x, point, normal);
    let along_y = normal_derivative(view.world_from_texel_y, point, normal);
    let along_depth = normal_derivative(view.world_from_depth, point, normal);
    if along_depth == 0.0 {
        return Vec2::new(f32::MAX, f32::MAX);
    }
    Vec2::new(-(along_x / along_depth), -(along_y / along_depth))
}

/// `n . (c - x c_w)`: how fast the plane is left along a column of the inverse, up to the common factor w.
#[inline(always)]
fn normal_derivative(column: [f32; 4], point: Vec3, normal: Vec3) -> f32 {
    let x = column[0] - point.x * column[3];
    let y = column[1] - point.y * column[3];
    let z = column[2] - point.z * column[3];
    normal.x * x + normal.y * y + normal.z * z
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use proptest::prelude::*;

    use super::*;
    use crate::{
        bounds::Aabb,
        fit::{ViewFit, directional_view, spot_view},
        spaces::texel_from_clip,
    };

    const SIZE: u32 = 512;

    fn views() -> [ViewFit; 2] {
        let bounds = Aabb::new(Vec3::splat(-5.0), Vec3::splat(5.0));
        [
            directional_view(Vec3::new(0.3, -1.0, 0.5), bounds, SIZE, 2),
            spot_view(Vec3::new(2.0, 12.0, 1.0), Vec3::new(-0.1, -1.0, 0.0), 0.7, f64::INFINITY, &[bounds], SIZE, 2),
        ]
    }

    fn texel_from_world(view: &ViewFit) -> DMat4 {
        texel_from_clip(DVec2::ZERO, DVec2::splat(f64::from(SIZE))) * view.clip_from_world()
    }

    /// Depth at a texel coordinate on a plane, found by intersecting the texel's ray with the plane: no derivative anywhere.
    fn depth_on_plane(texel_from_world: DMat4, point: DVec3, normal: DVec3, texel: DVec2) -> f64 {
        let world_from_texel = texel_from_world.inverse();
        let near = world_from_texel.project_point3(texel.extend(0.0));
        let far = world_from_texel.project_point3(texel.extend(1.0));
        let share = normal.dot(point - near) / normal.dot(far - near);
        texel_from_world.project_point3(near + (far - near) * share).z
    }

    proptest! {
        /// The plane form, Chong's equations with the corrected sign, and a finite difference are one gradient; the sign as
        /// printed is its opposite.
        #[test]
        fn equation_5_needs_a_minus_sign(
            turn in prop::array::uniform3(-3.0..3.0_f64),
            point in prop::array::uniform3(-4.0..4.0_f64),
        ) {
            let normal = DQuat::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]) * DVec3::Y;
            let point = DVec3::from(point);
            for view in views() {
                let matrix = texel_from_world(&view);
                let to_light = view.view_from_world.inverse().w_axis.truncate() - point;
                // Edge-on planes have no finite gradient.
                prop_assume!(normal.dot(to_light.normalize()).abs() > 0.05);
                let by_plane = gradient_by_plane(matrix, normal.extend(-normal.dot(point)));
                let by_jacobian = gradient_by_jacobian(matrix, point, normal);
                let texel = matrix.project_point3(point).truncate();
                let step = 0.5;
                let difference = |axis: DVec2| {
                    let at = |offset: f64| depth_on_plane(matrix, point, normal, texel + axis * offset);
                    (at(step) - at(-step)) / (2.0 * step)
                };
                let by_difference = DVec2::new(difference(DVec2::X), difference(DVec2::Y));
                // Rounding of f64 through an inverse whose entries span four orders of magnitude.
                let tolerance = 1e-9 * by_plane.length() + 1e-13;
                prop_assert!((by_plane - by_jacobian).length() < tolerance, "{by_plane} {by_jacobian}");
                prop_assert!((by_plane - by_difference).length() < tolerance, "{by_plane} {by_difference}");
                prop_assert!(by_plane.length() < 1e-12 || (by_plane + by_difference).length() > by_plane.length());
            }
        }

        /// Equation (7) is the derivative of depth along the view's axis.
        #[test]
        fn equation_7_is_the_derivative_of_depth(distance in 1.5..20.0_f64) {
            for view in views() {
                let depth = |z: f64| {
                    let clip = view.clip_from_view * DVec4::new(0.3, -0.2, z, 1.0);
                    (clip.z / clip.w, clip.w)
                };
                let (z, w) = depth(-distance);
                let step = 1e-4;
                let difference = (depth(-distance + step).0 - depth(-distance - step).0) / (2.0 * step);
                let derivative = depth_per_view_z(view.clip_from_view, z, w);
                // A central difference is off by the third derivative times step^2 / 6.
                prop_assert!((difference - derivative).abs() < 1e-6 * derivative.abs() + 1e-11, "{difference} {derivative}");
            }
        }
    }
}
