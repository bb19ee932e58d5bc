//! OGRE's own light cameras, for comparison: the default setup, and the warp of its LiSPSM.
//!
//! What OGRE 1.12 does, by its matrices: see [`OgreSetup`] for what it needs to be told. Its depth ranges are not followed: without a far distance, a directional light of OGRE's has no more than a millionth of its
//! depth for a metre. Views here reach from the highest caster down, as other fits do.

use glam::{DVec2, DVec3};

use super::{
    LightFrame, LispsmWarp, Rectangle, ViewFit,
    boxed::rectangle_view,
};
use crate::{bounds::Aabb, camera::Camera};

/// What OGRE's setups are told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OgreSetup {
    /// The distance up to which there are shadows, in metres: half the width of a directional light's box. By itself OGRE takes 300 near planes' distances.
    pub far_distance: f64,
    /// How far before the camera a light aims, as a share of that distance.
    pub offset: f64,
    /// From how far away, against the light, a directional light's camera looks, in metres.
    pub extrusion: f64,
}

impl OgreSetup {
    /// OGRE's defaults for a camera; `far_distance` is the scene's, 0 for none.
    #[must_use]
    pub fn of_camera(camera: &Camera, far_distance: f64) -> Self {
        /// Near planes' distances that shadows reach where nothing is said.
        const NEARS: f64 = 300.0;
        let near = match camera.projection {
            crate::Projection::Perspective { near, .. } | crate::Projection::Orthographic { near, .. } => near,
        };
        let far_distance = if far_distance > 0.0 { far_distance } else { NEARS * near };
        Self { far_distance, offset: 0.6, extrusion: 10_000.0 }
    }
}

/// The uniform view of OGRE's default setup.
///
/// Parallel light: a square of twice the far distance around a point before the camera, moved to whole texels toward zero. A light at a place: what its frame reaches, which for a point light is aimed at that point by the
/// caller. `guard` is none: OGRE has no such band.
#[must_use]
pub fn ogre_uniform_view(frame: &LightFrame, camera: &Camera, setup: &OgreSetup, casters: &[Aabb], lowest: DVec3, size: u32) -> ViewFit {
    if frame.is_perspective {
        let image = Rectangle { min: DVec2::splat(-frame.reach), max: DVec2::splat(frame.reach) };
        return rectangle_view(frame, image, &[lowest], casters, size, 0);
    }
    let target = camera.eye + camera.direction() * (setup.far_distance * setup.offset);
    let texel = 2.0 * setup.far_distance / f64::from(size);
    let light_from_world = frame.view_from_world();
    let back = frame.rotation * DVec3::Z;
    let center = light_from_world.transform_point3(target + back * setup.extrusion).truncate();
    // As C's fmod: what is left over has the sign of what is divided.
    let snapped = center - center % texel;
    let half = DVec2::splat(setup.far_distance);
    let image = Rectangle { min: snapped - half, max: snapped + half };
    rectangle_view(frame, image, &[lowest], casters, size, 0)
}

/// The parameter of OGRE's LiSPSM in its simple form: `(|z_e| + sqrt(n f)) a t`.
///
/// `near_distance` is the distance from the camera of the nearest visible point, `planes` are the camera's near and far distances with 0 for no far plane, `adjust` is a (0.1 by itself). The tweak t is 1 but where the
/// camera looks along the light within 25.84 degrees (`cosine`, the absolute one between both, from cos 0.451 on): there it grows to 21, in place of the sine that the literature divides by.
#[must_use]
pub fn ogre_warp(near_distance: f64, planes: [f64; 2], adjust: f64, cosine: f64) -> f64 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    /// The angle in radians within which OGRE warps less.
    const THRESHOLD: f64 = 0.451;
    /// By how much at most, less one.
    const MOST: f64 = 20.0;
    let least = THRESHOLD.cos();
    let tweak = if cosine >= least { 1.0 + MOST * (cosine - least) / (1.0 - least) } else { 1.0 };
    (near_distance.abs() + (planes[0] * planes[1]).sqrt()) * adjust * tweak
}
