//! Aliasing: over how many pixels of the picture one texel of a shadow map smears.
//!
//! A texel that sees a surface decides for a patch of it, and the camera sees that patch as some pixels. To first order the texel's image is a parallelogram: the image of a unit square under
//! `J = d(camera pixel) / d(light texel)`, taken in the plane that touches the surface at a visible point. With the derivatives A of pixels and B of texels along that plane, `J = A B^-1`; its
//! singular values are the longest and the shortest radius of the ellipse that a round texel becomes ([`Aliasing`]).
//!
//! The largest one, `m`, is the measure. A shadow's outline in the map is off by at most half a texel's diagonal, so in the picture by at most `m / sqrt(2)` pixels: `m <= 1` bounds the displacement of
//! an outline by 0.71 pixel. Filters blur over `m` pixels for each texel that they reach.
//!
//! Nothing here is once a pixel of a renderer: all is computed in f64, from the plan's rows alone. The rows are taken as those of any projection. Light cameras may be warped, and then the
//! view's w is no distance.
//!
//! Sources: Chong and Gortler 2004, "A lixel for every pixel", and 2006, "Scene optimized shadow mapping"; Lloyd 2007, "Logarithmic perspective shadow maps", where `m` is the worst case over directions.

use glam::{DMat2, DVec2, DVec3, DVec4};

#[cfg(not(feature = "std"))]
use crate::float::FloatFuncs;
use crate::{
    plan::{CameraPlan, ViewPlan},
    spaces::texel_from_ndc,
};

/// How a texel of a view is stretched on its way to the picture: the singular values of `d(camera pixel) / d(light texel)`, in pixels per texel.
///
/// Neither is ever NaN. A surface that the light sees edge-on has a `largest` of infinity; one that the camera sees edge-on a `smallest` of 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aliasing {
    /// m: how many pixels a texel smears over along the direction in which it is longest.
    pub largest: f64,
    /// The same along the direction in which it is shortest.
    pub smallest: f64,
}

impl Aliasing {
    /// The aliasing of a view in a camera's picture at a point of a surface.
    ///
    /// `point` is in metres relative to the scene's origin, `normal` the surface's, of any length above 0 and either sign. `None` where there is no picture or no map of the point: behind the camera
    /// or the light (w <= 0), or where a number is not finite.
    ///
    /// ```
    /// use shadow_math::{Camera, Light, LightKind, Projection, ShadowSettings, aliasing::Aliasing, bounds::Aabb, exposure::Exposure, fit, plan};
    /// use glam::{DVec3, Vec3};
    ///
    /// // A floor of 8 m, a sun overhead, and a camera that looks straight down at 4 m of it with 100 pixels.
    /// let floor = Aabb::new(Vec3::new(-4.0, 0.0, -4.0), Vec3::new(4.0, 0.0, 4.0));
    /// let sun = Light { kind: LightKind::Directional { direction: Vec3::NEG_Y }, color: Vec3::ONE, intensity: 1.0 };
    /// let mut views = [plan::ViewPlan::default(); plan::MAX_VIEWS_PER_LIGHT];
    /// plan::plan_light(&sun, &fit::Subject::unseen(&[floor], floor), &ShadowSettings::default(), [0, 0], &mut views)?;
    /// let projection = Projection::Orthographic { half_height: 2.0, near: 0.0, far: 10.0 };
    /// let camera = Camera::look_at(DVec3::Y * 5.0, DVec3::ZERO, projection)?;
    /// let camera = plan::plan_camera(&camera, 100, 100, Exposure::automatic([&sun], floor), 1)?;
    ///
    /// let aliasing = Aliasing::at(&camera, &views[0], DVec3::ZERO, DVec3::Y).expect("both see the floor");
    /// let pixels_of_texel = f64::from(views[0].texel_metres[0]) / 0.04;
    /// assert!((aliasing.largest / pixels_of_texel - 1.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn at(camera: &CameraPlan, view: &ViewPlan, point: DVec3, normal: DVec3) -> Option<Self> {
        let [a, b] = derivatives(camera, view, point, normal)?;
        // J = A adj(B) / det(B), and its inverse B adj(A) / det(A); the two products are each other's adjugates, and share their singular values. So the largest one of both
        // is taken without a quotient, and what has no inverse is 0 or infinite by itself.
        let largest = largest_singular_value(a * adjugate(b));
        let (det_a, det_b) = (a.determinant().abs(), b.determinant().abs());
        Some(Self {
            largest: if det_b == 0.0 { f64::INFINITY } else { largest / det_b },
            smallest: if det_a == 0.0 { 0.0 } else { det_a / largest },
        })
    }
}

/// `d(camera pixel) / d(light texel)` itself, on the plane through a point with this normal: rows are pixel x and y, columns texel x and y.
///
/// Arguments and `None` as for [`Aliasing::at`]; infinite or NaN where the light sees the plane edge-on.
#[must_use]
pub fn pixel_from_texel(camera: &CameraPlan, view: &ViewPlan, point: DVec3, normal: DVec3) -> Option<DMat2> {
    let [a, b] = derivatives(camera, view, point, normal)?;
    Some(a * adjugate(b) * (1.0 / b.determinant()))
}

/// The lecture's measure of aliasing, `d = d_s (r_s / r_i) (cos beta / cos alpha)`, in its two parts.
///
/// Where texels and pixels are squares across their rays, d and the perspective part lie between the two singular values of [`Aliasing`], whose product is theirs; where light, camera and normal
/// lie in a plane they are the singular values. Elsewhere d is less than `m`: see erratum 9.
///
/// Source: Stamminger and Drettakis 2002, "Perspective shadow maps", section 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AliasingParts {
    /// `d_s r_s / r_i`: the width of a texel over that of a pixel, both across their own rays where they meet the surface.
    pub perspective: f64,
    /// `cos beta / cos alpha`: how much the surface leans away from the light, over how much it leans away from the viewer. Infinite where the light sees it edge-on.
    pub projective: f64,
}

impl AliasingParts {
    /// From the widths, in metres, of a texel and of a pixel across their rays, and from the cosines of the normal with the vectors toward the viewer (beta) and the light (alpha), of either sign.
    ///
    /// A texel has the width `d_s r_s` at the distance r_s from a light whose texels are d_s wide at a distance of 1; a pixel likewise `r_i` in units of its own width there.
    #[must_use]
    pub fn new(texel_metres: f64, pixel_metres: f64, cos_beta: f64, cos_alpha: f64) -> Self {
        let projective = if cos_alpha == 0.0 { f64::INFINITY } else { (cos_beta / cos_alpha).abs() };
        Self { perspective: texel_metres / pixel_metres, projective }
    }

    /// From plans, at a point of a surface; arguments and `None` as for [`Aliasing::at`].
    ///
    /// A texel's width is the square root of its area across its ray: what d was made for are plain views, whose texels are squares there, or nearly so.
    #[must_use]
    pub fn at(camera: &CameraPlan, view: &ViewPlan, point: DVec3, normal: DVec3) -> Option<Self> {
        let normal = normal.try_normalize()?;
        // A ray is where neither coordinate changes: across both gradients. How long their product is says how many texels there are to a square metre across the ray.
        let across = |[x, y]: [DVec3; 2]| {
            let ray = x.cross(y);
            let density = ray.length();
            (density > 0.0).then(|| ((1.0 / density).sqrt(), normal.dot(ray) / density))
        };
        let (pixel, cos_beta) = across(pixel_gradients(camera, point)?)?;
        let (texel, cos_alpha) = across(texel_gradients(view, point)?)?;
        Some(Self::new(texel, pixel, cos_beta, cos_alpha))
    }

    /// d: both parts together, in pixels per texel.
    #[must_use]
    pub fn product(self) -> f64 {
        self.perspective * self.projective
    }
}

/// The derivatives of pixels (A) and of texels (B) along two vectors of the tangent plane, of unit length and at right angles: one a column.
fn derivatives(camera: &CameraPlan, view: &ViewPlan, point: DVec3, normal: DVec3) -> Option<[DMat2; 2]> {
    let (u, v) = normal.try_normalize()?.any_orthonormal_pair();
    let along = |[x, y]: [DVec3; 2]| DMat2::from_cols(DVec2::new(x.dot(u), y.dot(u)), DVec2::new(x.dot(v), y.dot(v)));
    Some([along(pixel_gradients(camera, point)?), along(texel_gradients(view, point)?)])
}

/// How pixel x and y change in space at a point, in pixels per metre.
fn pixel_gradients(camera: &CameraPlan, point: DVec3) -> Option<[DVec3; 2]> {
    let (scale, _) = texel_from_ndc(DVec2::ZERO, DVec2::new(f64::from(camera.width), f64::from(camera.height)));
    gradients([camera.clip_x, camera.clip_y, camera.clip_w], scale, point)
}

/// How texel x and y change in space at a point, in texels per metre.
fn texel_gradients(view: &ViewPlan, point: DVec3) -> Option<[DVec3; 2]> {
    gradients([view.clip_x, view.clip_y, view.clip_w], DVec2::from(view.texel_scale.map(f64::from)), point)
}

/// The gradients of `scale * (r_x . p, r_y . p) / (r_w . p)` at a point, with the rows r of a projection: `(r_x - x r_w) / w`, where x is the coordinate there. The quotient rule.
fn gradients(rows: [[f32; 4]; 3], scale: DVec2, point: DVec3) -> Option<[DVec3; 2]> {
    let [x, y, w] = rows.map(|row| DVec4::from_array(row.map(f64::from)));
    let at = |row: DVec4| row.dot(point.extend(1.0));
    let w_at = at(w);
    // What is behind has no image. NaN fails too.
    if !(w_at > 0.0) {
        return None;
    }
    let gradient = |row: DVec4, scale: f64| (row - w * (at(row) / w_at)).truncate() * (scale / w_at);
    let gradients = [gradient(x, scale.x), gradient(y, scale.y)];
    gradients.iter().all(|gradient| gradient.is_finite()).then_some(gradients)
}

/// The matrix that times the given one is its determinant.
fn adjugate(m: DMat2) -> DMat2 {
    DMat2::from_cols(DVec2::new(m.y_axis.y, -m.x_axis.y), DVec2::new(-m.y_axis.x, m.x_axis.x))
}

/// The largest singular value. A matrix of two rows is a similarity plus a similarity that mirrors, and stretches by both where they point the same way.
fn largest_singular_value(m: DMat2) -> f64 {
    let (x, y) = (m.x_axis, m.y_axis);
    let turns = DVec2::new(x.x + y.y, x.y - y.x).length();
    let mirrors = DVec2::new(x.x - y.y, x.y + y.x).length();
    0.5 * (turns + mirrors)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_1_SQRT_2, PI};

    use glam::{DMat4, DQuat, Vec3, dcamera::rh};
    use proptest::prelude::*;

    use super::*;
    use crate::{
        Camera, Light, LightKind, Projection, ShadowSettings,
        bounds::Aabb,
        exposure::Exposure,
        fit::Subject,
        plan::{MAX_VIEWS_PER_LIGHT, plan_camera, plan_light},
    };

    /// How far results may be off that hold for exact rows, as a share: rows are rounded to f32, by `2^-24` of terms that are some times larger than what they add up to.
    const ROUNDING: f64 = 1e-5;

    const SIZE: u32 = 256;

    /// A camera in `direction` from a point, at which it looks, turned about its axis.
    fn camera_at(point: DVec3, direction: DVec3, distance: f64, roll: f64, is_perspective: bool) -> CameraPlan {
        let projection = if is_perspective {
            Projection::Perspective { vertical_fov: 0.8, near: 0.1, far: None }
        } else {
            Projection::Orthographic { half_height: 2.0, near: 0.0, far: 100.0 }
        };
        let camera = Camera::look_at(point + direction * distance, point, projection).expect("the points differ");
        let camera = Camera { orientation: camera.orientation * DQuat::from_rotation_z(roll), ..camera };
        let sun = Light { kind: LightKind::Directional { direction: Vec3::NEG_Y }, color: Vec3::ONE, intensity: 1.0 };
        let exposure = Exposure::automatic([&sun], Aabb::new(Vec3::NEG_ONE, Vec3::ONE));
        plan_camera(&camera, 320, 200, exposure, 1).expect("the camera can be planned")
    }

    /// A view made of a matrix from world to clip space, with these texels to its width and height.
    fn view_of(clip_from_world: DMat4, size: DVec2) -> ViewPlan {
        let [clip_x, clip_y, clip_z, clip_w] =
            clip_from_world.transpose().to_cols_array_2d().map(|row| row.map(|element| element as f32));
        let (scale, offset) = texel_from_ndc(DVec2::ZERO, size);
        ViewPlan {
            clip_x,
            clip_y,
            clip_z,
            clip_w,
            texel_scale: scale.as_vec2().to_array(),
            texel_offset: offset.as_vec2().to_array(),
            ..ViewPlan::default()
        }
    }

    /// A light's view in `direction` from a point, at which it looks, turned about its axis: of parallel rays over 6 m, or of rays from a point that see as much at 1 m.
    fn light_at(point: DVec3, direction: DVec3, distance: f64, roll: f64, is_perspective: bool, size: DVec2) -> ViewPlan {
        let up = direction.any_orthonormal_vector();
        let view = DMat4::from_rotation_z(roll) * rh::view::look_at_mat4(point + direction * distance, point, up);
        let half = if is_perspective { 0.3 } else { 3.0 };
        let projection = if is_perspective {
            rh::proj::directx::frustum(-half, half, -half, half, 0.1, 100.0)
        } else {
            rh::proj::directx::orthographic(-half, half, -half, half, 0.0, 100.0)
        };
        view_of(projection * view, size)
    }

    /// The views of a sun, a spot light and a point light over a box.
    fn planned_views() -> impl Iterator<Item = ViewPlan> {
        let bounds = Aabb::new(Vec3::splat(-5.0), Vec3::splat(5.0));
        let kinds = [
            LightKind::Directional { direction: Vec3::new(0.3, -1.0, 0.5) },
            LightKind::Spot { position: Vec3::new(2.0, 12.0, 1.0), direction: Vec3::NEG_Y, inner: 0.0, outer: 0.7, range: None },
            LightKind::Point { position: Vec3::new(0.5, 1.0, -0.5), range: None },
        ];
        kinds.into_iter().flat_map(move |kind| {
            let light = Light { kind, color: Vec3::ONE, intensity: 1.0 };
            let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
            let settings = ShadowSettings { map_size: SIZE, ..ShadowSettings::default() };
            let plan = plan_light(&light, &Subject::unseen(&[bounds], bounds), &settings, [0, 0], &mut views)
                .expect("the light can be planned");
            views.into_iter().take(plan.view_count as usize)
        })
    }

    /// The same view with its map bent by a homography, as warped light cameras are: w then changes from place to place, even of parallel rays.
    fn warped(view: ViewPlan, bend: [f64; 2]) -> ViewPlan {
        let [x, y, w] = [view.clip_x, view.clip_y, view.clip_w].map(|row| DVec4::from_array(row.map(f64::from)));
        ViewPlan { clip_w: (w + x * bend[0] + y * bend[1]).as_vec4().to_array(), ..view }
    }

    /// Where rows of a projection see a point, by nothing but their definition.
    fn seen(rows: [[f32; 4]; 3], scale: DVec2, point: DVec3) -> Option<DVec2> {
        let [x, y, w] = rows.map(|row| DVec4::from_array(row.map(f64::from)).dot(point.extend(1.0)));
        (w > 0.5).then(|| DVec2::new(x, y) / w * scale)
    }

    /// A unit vector from two numbers from 0 to 1.
    fn unit([height, turn]: [f64; 2]) -> DVec3 {
        let y = 2.0 * height - 1.0;
        let (s, c) = (2.0 * PI * turn).sin_cos();
        DVec3::new(c * (1.0 - y * y).sqrt(), y, s * (1.0 - y * y).sqrt())
    }

    /// A unit vector at `angle` from a normal, in the plane of it and of a tangent.
    fn leaning(normal: DVec3, tangent: DVec3, angle: f64) -> DVec3 {
        normal * angle.cos() + tangent * angle.sin()
    }

    proptest! {
        /// With light, camera and normal in one plane and squares for texels, the singular values are d and its perspective part, whatever way the view is turned.
        #[test]
        fn in_one_plane_the_singular_values_are_the_lectures(
            point in prop::array::uniform3(-3.0..3.0_f64),
            normal in prop::array::uniform2(0.0..1.0_f64),
            angles in prop::array::uniform2(-1.4..1.4_f64),
            rolls in prop::array::uniform2(0.0..6.0_f64),
            distances in prop::array::uniform2(2.0..9.0_f64),
            of_point in prop::array::uniform2(any::<bool>()),
        ) {
            let (point, normal) = (DVec3::from(point), unit(normal));
            let tangent = normal.any_orthonormal_vector();
            let [beta, alpha] = angles;
            let camera = camera_at(point, leaning(normal, tangent, beta), distances[0], rolls[0], of_point[0]);
            let size = DVec2::splat(f64::from(SIZE));
            let view = light_at(point, leaning(normal, tangent, alpha), distances[1], rolls[1], of_point[1], size);
            // Widths by hand: what is seen over how many there are, at the distance of the point.
            let texel = 6.0 / size.x * if of_point[1] { distances[1] } else { 1.0 };
            let pixel = if of_point[0] { 2.0 * 0.4_f64.tan() * distances[0] } else { 4.0 } / 200.0;
            let parts = AliasingParts::new(texel, pixel, beta.cos(), alpha.cos());
            let found = Aliasing::at(&camera, &view, point, normal).expect("both see the point");
            let (d, across) = (parts.product(), parts.perspective);
            prop_assert!((found.largest / d.max(across) - 1.0).abs() < ROUNDING, "{found:?} {parts:?}");
            prop_assert!((found.smallest / d.min(across) - 1.0).abs() < ROUNDING, "{found:?} {parts:?}");
            let of_plans = AliasingParts::at(&camera, &view, point, normal).expect("both see the point");
            prop_assert!((of_plans.perspective / parts.perspective - 1.0).abs() < ROUNDING, "{of_plans:?} {parts:?}");
            prop_assert!((of_plans.projective / parts.projective - 1.0).abs() < ROUNDING, "{of_plans:?} {parts:?}");
        }

        /// Texels that are no squares have a width in the plane and one across it, if the view's axes lie so.
        #[test]
        fn along_the_axes_each_width_counts_by_itself(
            angles in prop::array::uniform2(-1.4..1.4_f64),
            size in prop::array::uniform2(50.0..900.0_f64),
        ) {
            let [beta, alpha] = angles;
            let camera = camera_at(DVec3::ZERO, leaning(DVec3::Y, DVec3::X, beta), 5.0, 0.0, false);
            // Looking along the leaning direction with z up, the map's y is across the plane of x and y.
            let direction = leaning(DVec3::Y, DVec3::X, alpha);
            let view = rh::view::look_at_mat4(direction * 5.0, DVec3::ZERO, DVec3::Z);
            let view = view_of(rh::proj::directx::orthographic(-3.0, 3.0, -3.0, 3.0, 0.0, 10.0) * view, DVec2::from(size));
            let in_plane = AliasingParts::new(6.0 / size[0], 4.0 / 200.0, beta.cos(), alpha.cos()).product();
            let across = 6.0 / size[1] / (4.0 / 200.0);
            let found = Aliasing::at(&camera, &view, DVec3::ZERO, DVec3::Y).expect("both see the point");
            prop_assert!((found.largest / in_plane.max(across) - 1.0).abs() < ROUNDING, "{found:?}");
            prop_assert!((found.smallest / in_plane.min(across) - 1.0).abs() < ROUNDING, "{found:?}");
        }

        /// With light, camera and normal anywhere, d and its perspective part lie between the singular values, whose product is theirs.
        #[test]
        fn d_lies_between_the_singular_values(
            directions in prop::array::uniform3(prop::array::uniform2(0.0..1.0_f64)),
            rolls in prop::array::uniform2(0.0..6.0_f64),
            of_point in prop::array::uniform2(any::<bool>()),
        ) {
            let [normal, to_camera, to_light] = directions.map(unit);
            // Nearly edge-on, the rounding of rows is magnified.
            prop_assume!(normal.dot(to_camera).abs() > 0.02 && normal.dot(to_light).abs() > 0.02);
            let camera = camera_at(DVec3::ZERO, to_camera, 4.0, rolls[0], of_point[0]);
            let view = light_at(DVec3::ZERO, to_light, 5.0, rolls[1], of_point[1], DVec2::splat(f64::from(SIZE)));
            let found = Aliasing::at(&camera, &view, DVec3::ZERO, normal).expect("both see the point");
            let parts = AliasingParts::at(&camera, &view, DVec3::ZERO, normal).expect("both see the point");
            let range = found.smallest * (1.0 - ROUNDING)..=found.largest * (1.0 + ROUNDING);
            prop_assert!(range.contains(&parts.product()) && range.contains(&parts.perspective), "{found:?} {parts:?}");
            let product = parts.product() * parts.perspective;
            prop_assert!((found.largest * found.smallest / product - 1.0).abs() < ROUNDING, "{found:?} {parts:?}");
        }

        /// J is what two projections say of a small step on the plane, and no texel becomes longer or shorter than the singular values.
        #[test]
        fn the_matrix_is_the_difference_of_two_projections(
            point in prop::array::uniform3(-4.0..4.0_f64),
            normal in prop::array::uniform2(0.0..1.0_f64),
            eye in prop::array::uniform2(0.0..1.0_f64),
            roll in 0.0..6.0_f64,
            turn in 0.0..6.0_f64,
            is_perspective in any::<bool>(),
            bend in prop::array::uniform2(-0.3..0.3_f64),
        ) {
            let (point, normal) = (DVec3::from(point), unit(normal));
            let camera = camera_at(DVec3::ZERO, unit(eye), 9.0, roll, is_perspective);
            let (scale, _) = texel_from_ndc(DVec2::ZERO, DVec2::new(320.0, 200.0));
            let pixel = |point| seen([camera.clip_x, camera.clip_y, camera.clip_w], scale, point);
            let step = DQuat::from_axis_angle(normal, turn) * normal.any_orthonormal_vector() * 1e-4;
            for view in planned_views().flat_map(|view| [view, warped(view, bend)]) {
                let texel_scale = DVec2::from(view.texel_scale.map(f64::from));
                let texel = |point| seen([view.clip_x, view.clip_y, view.clip_w], texel_scale, point);
                let (Some(p0), Some(p1), Some(t0), Some(t1)) =
                    (pixel(point - step), pixel(point + step), texel(point - step), texel(point + step))
                else {
                    continue;
                };
                let matrix = pixel_from_texel(&camera, &view, point, normal).expect("both see the point");
                let Aliasing { largest, smallest } = Aliasing::at(&camera, &view, point, normal).expect("both see the point");
                // Edge-on to the light J has no bound, and with it the share of a difference that rounding is.
                if largest > 1e3 {
                    continue;
                }
                let (moved, expected) = (matrix * (t1 - t0), p1 - p0);
                // Central differences are off by the third derivative: with w at least 0.5 m and steps of 1e-4 m by less than 1e-6 of what is moved; places of up to 1e6 texels
                // or pixels are rounded by 1e-10.
                let tolerance = (largest + 1.0) * (1e-6 * ((t1 - t0).length() + (p1 - p0).length()) + 1e-9);
                prop_assert!((moved - expected).length() < tolerance, "{moved} instead of {expected}");
                // The tolerances are those of f64 in a product and a quotient.
                let stretch = matrix.mul_vec2(DVec2::new(turn.cos(), turn.sin())).length();
                prop_assert!((smallest * (1.0 - 1e-6)..=largest * (1.0 + 1e-6)).contains(&stretch), "{smallest} {stretch} {largest}");
                prop_assert!((largest * smallest / matrix.determinant().abs() - 1.0).abs() < 1e-6);
                // An outline in the map is off by up to half a texel along both axes.
                let corner = matrix.mul_vec2(DVec2::new(0.5, if turn < 3.0 { 0.5 } else { -0.5 })).length();
                prop_assert!(corner <= largest * FRAC_1_SQRT_2 * (1.0 + 1e-9));
            }
        }
    }

    /// What is edge-on has a stretch that is infinite or none, and never one that is no number.
    #[test]
    fn edge_on_there_is_an_answer() {
        let size = DVec2::splat(f64::from(SIZE));
        let from_above = light_at(DVec3::ZERO, DVec3::Y, 4.0, 0.0, false, size);
        let leaning = camera_at(DVec3::ZERO, DVec3::new(0.8, 0.6, 0.0), 4.0, 0.0, false);
        let found = Aliasing::at(&leaning, &from_above, DVec3::ZERO, DVec3::X).expect("both see the point");
        assert!(found.largest == f64::INFINITY && found.smallest > 0.0 && found.smallest.is_finite(), "{found:?}");
        let parts = AliasingParts::at(&leaning, &from_above, DVec3::ZERO, DVec3::X).expect("both see the point");
        assert!(parts.product() == f64::INFINITY && parts.perspective.is_finite(), "{parts:?}");

        let above = camera_at(DVec3::ZERO, DVec3::Y, 4.0, 0.0, false);
        let from_the_side = light_at(DVec3::ZERO, DVec3::new(0.6, 0.8, 0.0), 4.0, 0.0, false, size);
        let found = Aliasing::at(&above, &from_the_side, DVec3::ZERO, DVec3::X).expect("both see the point");
        assert!(found.smallest == 0.0 && found.largest > 0.0 && found.largest.is_finite(), "{found:?}");

        // Both look along z, with rows that are exact: nothing is left of a texel in one direction, nor of a pixel.
        let along_z = view_of(DMat4::IDENTITY, size);
        let ViewPlan { clip_x, clip_y, clip_w, .. } = along_z;
        let camera = CameraPlan { clip_x, clip_y, clip_w, width: SIZE, height: SIZE, ..CameraPlan::default() };
        let both = Aliasing::at(&camera, &along_z, DVec3::ZERO, DVec3::X).expect("both see the point");
        assert_eq!(both, Aliasing { largest: f64::INFINITY, smallest: 0.0 });
        let parts = AliasingParts::at(&camera, &along_z, DVec3::ZERO, DVec3::X).expect("both see the point");
        assert_eq!(parts.product(), f64::INFINITY, "{parts:?}");
    }

    /// Behind the camera or the light, and for what is no number, there is no measure.
    #[test]
    fn what_is_not_seen_has_no_aliasing() {
        let camera = camera_at(DVec3::ZERO, DVec3::Y, 4.0, 0.0, true);
        let view = light_at(DVec3::ZERO, DVec3::Y, 6.0, 0.0, true, DVec2::splat(64.0));
        let at = |point, normal| {
            let parts = AliasingParts::at(&camera, &view, point, normal);
            assert_eq!(Aliasing::at(&camera, &view, point, normal).is_some(), parts.is_some());
            parts.is_some()
        };
        assert!(at(DVec3::ZERO, DVec3::Y) && at(DVec3::ZERO, DVec3::NEG_Y * 1e-30));
        assert!(!at(DVec3::Y * 5.0, DVec3::Y), "behind the camera");
        assert!(!at(DVec3::Y * 7.0, DVec3::Y), "behind both");
        assert!(!at(DVec3::Y * 4.0, DVec3::Y), "at the eye");
        assert!(!at(DVec3::ZERO, DVec3::ZERO), "without a normal");
        assert!(!at(DVec3::NAN, DVec3::Y) && !at(DVec3::ZERO, DVec3::NAN) && !at(DVec3::NEG_Y * f64::INFINITY, DVec3::Y));
    }
}
