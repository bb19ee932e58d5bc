//! The six faces of a cube around a light.

use glam::{DVec3, Vec3};

use super::{
    DepthRange, ViewFit, guard_scale,
    uniform::{perspective_view, rigid_inverse},
};
use crate::camera::world_from_view_rotation;

/// The direction each face looks in, in the order of the views: +x, -x, +y, -y, +z, -z.
pub const CUBE_FACES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

/// The camera of one cube face around `position`.
///
/// The face sees a little more than its quarter turn: `guard` texels of the `size` on every side lie beyond it, so that the taps
/// of a receiver at the face's edge find depths of their own.
///
/// # Panics
///
/// If `face` is not below 6.
#[must_use]
pub fn cube_face_view(position: Vec3, face: usize, range: DepthRange, size: u32, guard: u32) -> ViewFit {
    let rotation = world_from_view_rotation(CUBE_FACES[face]);
    perspective_view(rigid_inverse(rotation, position.as_dvec3()), guard_scale(size, guard), range, size)
}

/// The face of [`CUBE_FACES`] that a vector from the light points to: that of its largest coordinate.
///
/// Between equal coordinates x comes before y and y before z. Mirrored by `visibility.wgsl`.
#[inline(always)]
#[must_use]
pub fn cube_face_of(v: Vec3) -> u32 {
    let ax = v.x.abs();
    let ay = v.y.abs();
    let az = v.z.abs();
    if ax >= ay && ax >= az {
        return u32::from(v.x < 0.0);
    }
    if ay >= az {
        return 2 + u32::from(v.y < 0.0);
    }
    4 + u32::from(v.z < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_falls_into_the_face_that_is_chosen_for_it() {
        let range = DepthRange { near: 0.1, far: 10.0 };
        let position = Vec3::new(1.0, -2.0, 0.5);
        for i in 0..1000_u32 {
            // A spiral over the sphere, uneven enough to avoid symmetric ties.
            let z = 1.0 - (2 * i + 1) as f32 / 1000.0;
            let (s, c) = (2.399_963 * i as f32).sin_cos();
            let v = Vec3::new(c * (1.0 - z * z).sqrt(), s * (1.0 - z * z).sqrt(), z) * 3.0;
            let face = cube_face_of(v);
            let view = cube_face_view(position, face as usize, range, 64, 2);
            let ndc = view.clip_from_world().project_point3((position + v).as_dvec3());
            // The guard band begins at 1 - 2 * 2 / 64; a direction on the face's rim lies on it up to f32's rounding.
            assert!(ndc.x.abs() < 0.937_501 && ndc.y.abs() < 0.937_501, "{v} on face {face}: {ndc}");
            assert!(ndc.z > 0.0 && ndc.z < 1.0);
        }
    }
}
