//! The view frustum of a camera: corners, planes and slices.

use glam::{DVec2, DVec3, DVec4};

use crate::camera::{Camera, CameraError, Projection};

/// A frustum or an oblong box: the eight corners of what a camera sees, in world space.
///
/// The near face comes first, then the far face; each as top right, top left, bottom left, bottom right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// The corners, in metres relative to the scene's origin.
    pub corners: [DVec3; 8],
}

/// The four corners of each face, counter-clockwise seen from outside: near, far, left, right, top, bottom.
const FACES: [[usize; 4]; 6] = [[0, 1, 2, 3], [4, 7, 6, 5], [1, 5, 6, 2], [0, 3, 7, 4], [0, 4, 5, 1], [3, 2, 6, 7]];

impl Frustum {
    /// The slice of the camera's view between two distances along its axis, in metres.
    ///
    /// # Errors
    ///
    /// [`CameraError::Planes`] unless `0 <= near < far` and both are finite: a view without a far plane has no corners.
    ///
    /// ```
    /// use shadow_math::{Camera, Projection, frustum::Frustum};
    /// use glam::DVec3;
    ///
    /// let projection = Projection::Perspective { vertical_fov: core::f64::consts::FRAC_PI_2, near: 1.0, far: None };
    /// let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, projection)?;
    /// let slice = Frustum::slice(&camera, 1.0, 2.0, 10.0)?;
    /// assert!((slice.corners[0] - DVec3::new(2.0, 2.0, -2.0)).length() < 1e-12);
    /// # Ok::<(), shadow_math::CameraError>(())
    /// ```
    pub fn slice(camera: &Camera, aspect: f64, near: f64, far: f64) -> Result<Self, CameraError> {
        if !(near >= 0.0 && far > near && far.is_finite()) {
            return Err(CameraError::Planes { near, far });
        }
        let half_extent = camera.half_extent(aspect);
        let signs = [DVec2::ONE, DVec2::new(-1.0, 1.0), DVec2::NEG_ONE, DVec2::new(1.0, -1.0)];
        let corner = |i: usize| {
            let distance = if i < 4 { near } else { far };
            let spread = match camera.projection {
                Projection::Perspective { .. } => distance,
                Projection::Orthographic { .. } => 1.0,
            };
            let xy = half_extent * signs[i % 4] * spread;
            camera.eye + camera.orientation * xy.extend(-distance)
        };
        Ok(Self { corners: core::array::from_fn(corner) })
    }

    /// The six planes as `(normal, offset)` with `dot(normal, point) + offset >= 0` inside; normals have unit length.
    ///
    /// A face without area (the near face of a slice that begins at the eye) gives the zero plane, on which every point
    /// counts as inside.
    #[must_use]
    pub fn planes(&self) -> [DVec4; 6] {
        FACES.map(|[a, b, c, d]| {
            // The diagonals' product is the face's normal even where two corners coincide.
            let outward = (self.corners[c] - self.corners[a]).cross(self.corners[d] - self.corners[b]);
            let inward = -outward.normalize_or_zero();
            let middle = 0.25 * (self.corners[a] + self.corners[b] + self.corners[c] + self.corners[d]);
            inward.extend(-inward.dot(middle))
        })
    }

    /// The faces as quadrilaterals, counter-clockwise seen from outside: near, far, left, right, top, bottom.
    #[must_use]
    pub fn faces(&self) -> [[DVec3; 4]; 6] {
        FACES.map(|face| face.map(|corner| self.corners[corner]))
    }

    /// The mean of the corners, which lies inside.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 8.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::ClipDepth;

    fn camera() -> Camera {
        let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.5, far: Some(20.0) };
        Camera::look_at(DVec3::new(3.0, 2.0, -7.0), DVec3::new(0.0, 1.0, 4.0), projection).unwrap()
    }

    #[test]
    fn corners_are_what_the_projection_maps_to_the_cube() {
        let camera = camera();
        let frustum = Frustum::slice(&camera, 1.5, 0.5, 20.0).unwrap();
        let clip_from_world = camera.clip_from_view(1.5, ClipDepth::ZeroToOne) * camera.view_from_world();
        for (i, corner) in frustum.corners.iter().enumerate() {
            let ndc = clip_from_world.project_point3(*corner);
            let x = if matches!(i % 4, 0 | 3) { 1.0 } else { -1.0 };
            let y = if matches!(i % 4, 0 | 1) { 1.0 } else { -1.0 };
            let z = if i < 4 { 0.0 } else { 1.0 };
            // Rounding of f64 through one product and one division.
            assert!((ndc - DVec3::new(x, y, z)).abs().max_element() < 1e-12, "corner {i}: {ndc}");
        }
    }

    #[test]
    fn planes_face_inward() {
        let frustum = Frustum::slice(&camera(), 0.7, 1.0, 9.0).unwrap();
        for plane in frustum.planes() {
            assert!(plane.dot(frustum.center().extend(1.0)) > 0.1, "the middle lies inside {plane}");
            for corner in frustum.corners {
                assert!(plane.dot(corner.extend(1.0)) > -1e-12, "no corner lies outside {plane}");
            }
        }
    }

    #[test]
    fn a_slice_without_a_far_plane_is_refused() {
        assert!(matches!(Frustum::slice(&camera(), 1.0, 1.0, f64::INFINITY), Err(CameraError::Planes { .. })));
        assert!(matches!(Frustum::slice(&camera(), 1.0, 2.0, 2.0), Err(CameraError::Planes { .. })));
    }
}
