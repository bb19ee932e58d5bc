//! The plane-optimal fit: camera and light agree on every point of a plane.
//!
//! Let S be the planar projection along the light L onto the plane pi, `S = (pi . L) I - L pi^T` (Blinn 1988). The rows x, y and w of the light's matrix are those of the camera's matrix times S: a point of
//! space goes where the camera sees its shadow on the plane. On the plane S is a multiple of the identity, so that the image of each point is the camera's own, and each texel is a pixel.
//!
//! Depth is `0.99 + k (pi . X) / w`: the same all over the plane, and smaller the higher a point is over it. The factor k, which is negative, puts the highest caster at 0. What lies below the plane, by a
//! hundredth of that range, is deeper than the map, and no caster.
//!
//! Points above a light at a place (`pi . X >= pi . L`) can have a w above 0, too: they are left out by a half-space.
//!
//! Source: Chong and Gortler, "A Lixel for Every Pixel" (2004), whose construction by corresponding points (Chong 2006; OGRE) this closed form replaces.

use glam::{DMat4, DVec3, DVec4};

use super::{DepthRange, Eye, FallBack, FitOutcome, RANGE_MARGIN, ViewFit, uniform::rigid_inverse};
use crate::{
    bounds::Aabb, camera::world_from_view_rotation, depth::DepthScale, frustum::Frustum, polytope::Polytope, spaces::ClipDepth,
};

/// The depth of the plane. What receivers on it need for rounding has room behind it.
const PLANE_DEPTH: f64 = 0.99;

/// The least distance from a perspective camera of a shadow on the plane over the height of its caster: lower ones would take all of the depth from the others.
const MIN_HEIGHT_RATIO: f64 = 1e-6;

/// The least sine of the angle at which a camera is taken to look down on a plane, for the size of texels that is told of a view.
const LEAST_DOWNWARD: f64 = 1.0 / 6.0;

/// The rows of a plane-optimal matrix but for its depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneOptimal {
    /// The x row of the matrix from world to clip space.
    pub clip_x: DVec4,
    /// The y row.
    pub clip_y: DVec4,
    /// The w row: above 0 for what casts its shadow before the camera, and 1 on the camera's near plane.
    pub clip_w: DVec4,
    /// The plane, `(normal, offset)` with a unit normal toward the light's side.
    pub plane: DVec4,
    /// The height of a light at a place over the plane, in metres; the cosine of the angle between light and normal for parallel light.
    pub light_height: f64,
    /// The light as a homogeneous point: a unit vector with a 0, or a position with a 1.
    pub light: DVec4,
    /// The camera's w on its near plane, by which the rows are divided, in metres; 1 for a camera with parallel rays.
    pub near: f64,
}

/// The rows x, y and w that take points to where the camera sees their shadows on a plane.
///
/// `plane` is `(normal, offset)` with `normal . point + offset = 0`, of any scale above 0; `light` the homogeneous light: the vector toward it, with a 0, or its position, with a 1. All in world space, metres.
///
/// # Errors
///
/// [`FallBack::LightInPlane`] and [`FallBack::CameraInPlane`]: the plane's image is then a line. [`FallBack::NoExtent`] for numbers that are not finite.
///
/// ```
/// use shadow_math::{Camera, Projection, fit::{Eye, plane_optimal}, spaces::ClipDepth};
/// use glam::{DVec3, DVec4};
///
/// let projection = Projection::Perspective { vertical_fov: 0.8, near: 0.1, far: None };
/// let camera = Camera::look_at(DVec3::new(0.0, 2.0, 5.0), DVec3::ZERO, projection)?;
/// let eye = Eye { camera, aspect: 1.0, samples: &[], plane: None };
/// let floor = DVec4::new(0.0, 1.0, 0.0, 0.0);
/// let rows = plane_optimal(&eye, floor, DVec3::new(0.4, 1.0, 0.2).extend(0.0)).expect("neither lies in the floor");
/// let point = DVec4::new(0.7, 0.0, -3.0, 1.0);
/// let seen = camera.clip_from_view(1.0, ClipDepth::Reversed) * camera.view_from_world() * point;
/// assert!((rows.clip_x.dot(point) / rows.clip_w.dot(point) - seen.x / seen.w).abs() < 1e-12);
/// # Ok::<(), shadow_math::CameraError>(())
/// ```
pub fn plane_optimal(eye: &Eye<'_>, plane: DVec4, light: DVec4) -> Result<PlaneOptimal, FallBack> {
    /// The sine of the least angle under which a plane is seen.
    const MIN_SINE: f64 = 1e-6;
    let light = light / if light.w == 0.0 { light.truncate().length() } else { light.w };
    let length = plane.truncate().length();
    let mut plane = plane / length;
    if plane.dot(light) < 0.0 {
        plane = -plane;
    }
    let light_height = plane.dot(light);
    if !(plane.is_finite() && light.is_finite()) {
        return Err(FallBack::NoExtent);
    }
    let eye_height = plane.dot(eye.camera.eye.extend(1.0));
    let scale = eye.camera.eye.distance(light.truncate()) + eye.planes()[0];
    if !(light_height > MIN_SINE * if light.w == 0.0 { 1.0 } else { scale }) {
        return Err(FallBack::LightInPlane);
    }
    let is_perspective = matches!(eye.camera.projection, crate::Projection::Perspective { .. });
    // Parallel rays of a camera lie in the plane by their direction, others by where they begin.
    let is_in_plane = if is_perspective {
        !(eye_height.abs() > MIN_SINE * eye.planes()[0])
    } else {
        !(plane.truncate().dot(eye.camera.direction()).abs() > MIN_SINE)
    };
    if is_in_plane {
        return Err(FallBack::CameraInPlane);
    }
    let clip_from_world = eye.camera.clip_from_view(eye.aspect, ClipDepth::Reversed) * eye.camera.view_from_world();
    // The row times S, over the camera's w on its near plane: on the plane S is the light's height times the identity.
    let near = if is_perspective { eye.planes()[0] } else { 1.0 };
    let projected = |row: DVec4| (row * light_height - plane * row.dot(light)) / (light_height * near);
    Ok(PlaneOptimal {
        clip_x: projected(clip_from_world.row(0)),
        clip_y: projected(clip_from_world.row(1)),
        clip_w: projected(clip_from_world.row(3)),
        plane,
        light_height,
        light,
        near,
    })
}

/// How fast depth falls with the height over the plane: the factor k of `0.99 + k (pi . X) / w`, at most 0.
///
/// It comes from the bounds of the casters, as far as their shadows fall into the picture. Points that are a million times higher than their shadow is away from the camera would take all of the depth; they are left out of the map.
#[must_use]
pub fn plane_depth_factor(rows: &PlaneOptimal, casters: &[Aabb]) -> f64 {
    let mut least = f64::INFINITY;
    for caster in casters.iter().filter(|caster| !caster.is_empty()) {
        // Over the plane and before the camera w over height is least at a corner: what is not less there is not less anywhere.
        let mut bound = f64::INFINITY;
        for corner in caster.corners() {
            let point = corner.as_dvec3().extend(1.0);
            let (w, height) = (rows.clip_w.dot(point), rows.plane.dot(point));
            let ratio = if w >= 0.0 && height >= 0.0 { w / height } else { f64::NEG_INFINITY };
            bound = bound.min(ratio);
        }
        if bound >= least {
            continue;
        }
        let mut body = Polytope::from_bounds(*caster);
        for plane in rows.half_spaces() {
            body.clip(plane);
        }
        for vertex in body.vertices() {
            let point = vertex.extend(1.0);
            let (w, height) = (rows.clip_w.dot(point), rows.plane.dot(point));
            if height > 0.0 {
                least = least.min(w / height);
            }
        }
    }
    // Without a caster any depth will do.
    let least = if least.is_finite() { least.max(MIN_HEIGHT_RATIO / rows.near) } else { 1.0 / rows.near };
    -PLANE_DEPTH * least * (1.0 - RANGE_MARGIN)
}

impl PlaneOptimal {
    /// The half-spaces in which a caster shadows a point of the plane that the camera sees.
    fn half_spaces(&self) -> [DVec4; 6] {
        let Self { clip_x, clip_y, clip_w, plane, .. } = *self;
        [clip_w + clip_x, clip_w - clip_x, clip_w + clip_y, clip_w - clip_y, plane, self.half_space()]
    }

    /// What lies below a light at a place; everything for parallel light.
    fn half_space(&self) -> DVec4 {
        // A caster that touches the light would have no depth.
        let below = 1.0 - RANGE_MARGIN;
        if self.light.w == 0.0 { DVec4::W } else { DVec4::W * (self.light_height * below) - self.plane }
    }

    /// The view with this depth factor, whose map has `size` texels on a side. It has no guard band: its texels are the picture's pixels, where map and picture have one size.
    #[must_use]
    pub fn view(&self, eye: &Eye<'_>, depth_factor: f64, size: u32) -> ViewFit {
        let Self { clip_x, clip_y, clip_w, plane, light_height, light, near } = *self;
        let is_perspective = light.w != 0.0;
        let normal = plane.truncate();
        // The axis of a light at a place is the one across the plane: distances along it are its height less the point's.
        let (axis, position) = if is_perspective { (-normal, light.truncate()) } else { (-light.truncate(), DVec3::ZERO) };
        let rotation = world_from_view_rotation(axis);
        let view_from_world = rigid_inverse(rotation, position);
        let world_from_view = DMat4::from_rotation_translation(rotation, position);
        let clip_z = clip_w * PLANE_DEPTH + plane * depth_factor;
        let clip_from_world = DMat4::from_cols(clip_x, clip_y, clip_z, clip_w).transpose();
        // On the plane a texel is as wide as a pixel where the camera's axis meets it; an axis that does not meet it is taken to look down by a sixth.
        let distance = if matches!(eye.camera.projection, crate::Projection::Orthographic { .. }) {
            1.0
        } else {
            let downward = -normal.dot(eye.camera.direction()) * plane.dot(eye.camera.eye.extend(1.0)).signum();
            plane.dot(eye.camera.eye.extend(1.0)).abs() / downward.max(LEAST_DOWNWARD)
        };
        let texel = 2.0 * distance * eye.camera.half_extent(eye.aspect) / f64::from(size);
        // A caster is highest there where depth is 0: at so many times w, which is the distance over the near plane's.
        let highest = PLANE_DEPTH * distance / near / -depth_factor;
        let range = if is_perspective {
            DepthRange { near: light_height * RANGE_MARGIN, far: light_height }
        } else {
            DepthRange { near: 0.0, far: highest }
        };
        ViewFit {
            view_from_world,
            clip_from_view: clip_from_world * world_from_view,
            range,
            depth_scale: DepthScale { factor: -depth_factor * light_height, w_per_metre: if is_perspective { 1.0 } else { 0.0 } },
            texel_metres: texel.to_array(),
            is_warped: true,
            half_space: self.half_space(),
            outcome: FitOutcome::Fitted,
            ..ViewFit::unwarped(size)
        }
    }

    /// Whether the camera sees the side of the plane that the light shines on. From the other side nothing of the plane is lit, and the map would be a mirror image.
    #[must_use]
    pub fn faces(&self, eye: &Eye<'_>) -> bool {
        if matches!(eye.camera.projection, crate::Projection::Perspective { .. }) {
            self.plane.dot(eye.camera.eye.extend(1.0)) > 0.0
        } else {
            self.plane.truncate().dot(eye.camera.direction()) < 0.0
        }
    }

    /// Whether the camera sees any of the plane between two distances along its axis, in metres.
    #[must_use]
    pub fn is_seen(&self, eye: &Eye<'_>, [near, far]: [f64; 2]) -> bool {
        let Ok(slice) = Frustum::slice(&eye.camera, eye.aspect, near.max(0.0), far) else { return false };
        let heights = slice.corners.map(|corner| self.plane.dot(corner.extend(1.0)));
        heights.iter().any(|&height| height >= 0.0) && heights.iter().any(|&height| height <= 0.0)
    }
}
