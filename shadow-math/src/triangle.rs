//! The surface behind a pixel, rebuilt from its triangle's vertices.
//!
//! A rasteriser says only which triangle a pixel shows. Where the pixel's ray meets the triangle's plane is computed here, the
//! same way on every renderer; no interpolated value and no screen-space derivative takes part.
//!
//! Mirrored by `triangle.wgsl`.

use glam::Vec3;

use crate::plan::PixelRays;

/// A ray. The direction is not normalised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The origin, in metres relative to the scene's origin.
    pub origin: Vec3,
    /// The direction, of any length above 0.
    pub direction: Vec3,
}

/// A point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrianglePoint {
    /// The point, in metres relative to the scene's origin.
    pub point: Vec3,
    /// The geometric normal: the product of the edges, of twice the area's length; the front is counter-clockwise.
    pub normal: Vec3,
    /// The weight of the second vertex.
    pub u: f32,
    /// The weight of the third vertex; the first has `1 - u - v`.
    pub v: f32,
}

/// The ray through pixel coordinates `(x, y)`; pixel centres lie at + 0.5.
#[inline(always)]
#[must_use]
pub fn pixel_ray(rays: &PixelRays, x: f32, y: f32) -> Ray {
    let origin = xyz(rays.origin) + xyz(rays.origin_dx) * x + xyz(rays.origin_dy) * y;
    let direction = xyz(rays.direction) + xyz(rays.direction_dx) * x + xyz(rays.direction_dy) * y;
    Ray { origin, direction }
}

#[inline(always)]
fn xyz(v: [f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}

/// The point of a triangle that a ray meets, or the nearest by weights if it passes by.
///
/// The barycentric weights come from Cramer's rule and are clamped to the triangle: a rasteriser covers pixels up to half
/// a sub-pixel step outside. The point is then the weighted sum of the vertices, not a point of the ray, and so lies on the
/// triangle's plane up to the rounding of its coordinates, however obliquely the ray meets it.
/// A ray parallel to the plane, or a triangle without area, gives the first vertex.
#[inline(always)]
#[must_use]
pub fn triangle_point(ray: Ray, v0: Vec3, v1: Vec3, v2: Vec3) -> TrianglePoint {
    let e1 = v1 - v0;
    let e2 = v2 - v0;
    let normal = e1.cross(e2);
    let s = ray.origin - v0;
    let q = s.cross(ray.direction);
    let determinant = -normal.dot(ray.direction);
    let mut inverse = 0.0;
    if determinant != 0.0 {
        inverse = 1.0 / determinant;
    }
    let u = (e2.dot(q) * inverse).max(0.0).min(1.0);
    let v = (-e1.dot(q) * inverse).max(0.0).min(1.0 - u);
    let point = v0 + e1 * u + e2 * v;
    TrianglePoint { point, normal, u, v }
}

/// `v`, a vector on the side of the geometric normal, turned to the side that the ray comes from.
#[inline(always)]
#[must_use]
pub fn turned_to_viewer(v: Vec3, geometric_normal: Vec3, ray: Ray) -> Vec3 {
    if geometric_normal.dot(ray.direction) > 0.0 {
        return -v;
    }
    v
}

/// How far a point of a plane moves from a pixel to the next one on the right and to the next one below, in metres.
///
/// `ray` is the pixel's, which meets the plane of this `normal`, of any length above 0, in `point`. A ray's point moves with its origin and direction by `s = o' + t d'`, which leaves the plane by
/// `n . s`; as much of the ray's direction brings it back: `s - d (n . s) / (n . d)`. Infinite or NaN where the ray runs along the plane.
#[inline(always)]
#[must_use]
pub fn pixel_steps(rays: &PixelRays, ray: Ray, point: Vec3, normal: Vec3) -> [Vec3; 2] {
    let along = normal.dot(ray.direction);
    let distance = normal.dot(point - ray.origin) / along;
    let step = |origin: [f32; 4], direction: [f32; 4]| {
        let moved = xyz(origin) + xyz(direction) * distance;
        moved - ray.direction * (normal.dot(moved) / along)
    };
    [step(rays.origin_dx, rays.direction_dx), step(rays.origin_dy, rays.direction_dy)]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// A ray aimed at a known point of a triangle finds the point and its weights.
        #[test]
        fn the_aimed_at_point_is_found(
            corners in prop::array::uniform9(-10.0..10.0_f32),
            eye in prop::array::uniform3(-20.0..20.0_f32),
            u in 0.0..1.0_f32,
            share in 0.0..1.0_f32,
        ) {
            let [v0, v1, v2] = [0, 3, 6].map(|i| Vec3::from_slice(&corners[i..]));
            let v = (1.0 - u) * share;
            let target = v0 + (v1 - v0) * u + (v2 - v0) * v;
            let ray = Ray { origin: Vec3::from(eye), direction: target - Vec3::from(eye) };
            let normal = (v1 - v0).cross(v2 - v0);
            // Thin triangles and grazing rays amplify the rounding of the ray itself; keep to those that do not.
            let sine = normal.normalize_or_zero().dot(ray.direction.normalize_or_zero()).abs();
            prop_assume!(sine > 0.1 && normal.length() > 10.0);
            let hit = triangle_point(ray, v0, v1, v2);
            // 20 m coordinates round at 2e-6 m; the sine and the area above amplify that at most some forty times.
            prop_assert!((hit.point - target).length() < 1e-4, "{} instead of {target}", hit.point);
        }
    }

    proptest! {
        /// The steps lead to where the neighbouring pixels' rays meet the plane, up to the plane's perspective.
        #[test]
        fn steps_lead_to_the_neighbours(
            tilt in prop::array::uniform2(-1.0..1.0_f32),
            (x, y) in (0.0..640.0_f32, 0.0..360.0_f32),
            is_perspective in any::<bool>(),
        ) {
            let pad = |x: f32, y: f32, z: f32| [x, y, z, 0.0];
            let zero = [0.0; 4];
            let rays = if is_perspective {
                PixelRays {
                    origin: pad(0.0, 0.0, 5.0),
                    direction: pad(-0.64, 0.36, -1.0),
                    direction_dx: pad(0.002, 0.0, 0.0),
                    direction_dy: pad(0.0, -0.002, 0.0),
                    origin_dx: zero,
                    origin_dy: zero,
                }
            } else {
                PixelRays {
                    origin: pad(-3.2, 1.8, 5.0),
                    origin_dx: pad(0.01, 0.0, 0.0),
                    origin_dy: pad(0.0, -0.01, 0.0),
                    direction: pad(0.0, 0.0, -1.0),
                    direction_dx: zero,
                    direction_dy: zero,
                }
            };
            let normal = Vec3::new(tilt[0], tilt[1], 1.0);
            let meets = |x: f32, y: f32| {
                let ray = pixel_ray(&rays, x, y);
                ray.origin - ray.direction * (normal.dot(ray.origin) / normal.dot(ray.direction))
            };
            let point = meets(x, y);
            let steps = pixel_steps(&rays, pixel_ray(&rays, x, y), point, normal);
            // A central difference over two pixels is off by the third derivative, a millionth of a step here, and by the rounding of 7 m coordinates.
            for (step, difference) in steps.into_iter().zip([meets(x + 1.0, y) - meets(x - 1.0, y), meets(x, y + 1.0) - meets(x, y - 1.0)]) {
                prop_assert!((step - 0.5 * difference).length() < 1e-3 * step.length() + 4e-6, "{step} {difference}");
            }
        }
    }

    #[test]
    fn degenerate_triangles_give_a_finite_point() {
        let ray = Ray { origin: Vec3::Z, direction: Vec3::NEG_Z };
        let hit = triangle_point(ray, Vec3::X, Vec3::X, Vec3::X);
        assert_eq!(hit.point, Vec3::X);
        let edge_on = triangle_point(ray, Vec3::ZERO, Vec3::Z, Vec3::X);
        assert_eq!(edge_on.point, Vec3::ZERO);
    }

    #[test]
    fn the_point_never_leaves_the_triangle() {
        let ray = Ray { origin: Vec3::new(5.0, 5.0, 1.0), direction: Vec3::NEG_Z };
        let hit = triangle_point(ray, Vec3::ZERO, Vec3::X, Vec3::Y);
        assert_eq!((hit.u, hit.v), (1.0, 0.0));
        assert_eq!(hit.point, Vec3::X);
    }
}
