//! OGRE's own light cameras, for comparison: the default setup, and the warp of its LiSPSM.
//!
//! What OGRE 1.12 does, by its matrices: see [`OgreSetup`] for what it needs to be told. Its depth ranges are not followed: without a far distance, a directional light of OGRE's has no more than a millionth of its
//! depth for a metre. Views here reach from the highest caster down, as other fits do.

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::{
    LightFrame, Subject, ViewFit, Window,
    boxed::{Content, rectangle_view},
};
use crate::{
    camera::Camera,
    light::{Light, LightKind},
};

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

    /// The place before the camera that lights aim at.
    fn target(&self, camera: &Camera) -> DVec3 {
        camera.eye + camera.direction() * (self.far_distance * self.offset)
    }
}

/// The frame of OGRE's default setup: y is up, or z where the light shines straight up or down. A spot light sees 1.2 times its cone, at most 175 degrees; a point light 120 degrees, aimed at a place before the camera.
#[must_use]
pub fn ogre_frame(light: &Light, camera: &Camera, setup: &OgreSetup) -> LightFrame {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    /// The angle that a spot light's camera sees, over that of its cone.
    const SPOT_MARGIN: f64 = 1.2;
    /// Half of 175 and of 120 degrees.
    const WIDEST_SPOT: f64 = 87.5 * core::f64::consts::PI / 180.0;
    const POINT: f64 = core::f64::consts::FRAC_PI_3;
    let limit = f64::from(light.range());
    let frame = match light.kind {
        LightKind::Directional { direction } => LightFrame::parallel(direction),
        LightKind::Spot { position, direction, outer, .. } => {
            let reach = (SPOT_MARGIN * f64::from(outer)).min(WIDEST_SPOT).tan();
            LightFrame::perspective(position, direction.as_dvec3(), reach, limit)
        }
        LightKind::Point { position, .. } => {
            let toward = setup.target(camera) - position.as_dvec3();
            let direction = if toward.length_squared() > 0.0 { toward } else { camera.direction() };
            LightFrame::perspective(position, direction, POINT.tan(), limit)
        }
    };
    let back = frame.rotation * DVec3::Z;
    let up = if back.y.abs() >= 1.0 { DVec3::Z } else { DVec3::Y };
    let x = up.cross(back).normalize_or(DVec3::X);
    LightFrame { rotation: DQuat::from_mat3(&DMat3::from_cols(x, back.cross(x), back)).normalize(), ..frame }
}

/// The uniform view of OGRE's default setup.
///
/// Parallel light: a square of twice the far distance around a place before the camera, moved to whole texels toward zero. A light at a place: all that its [frame](ogre_frame) reaches. There is no guard band.
#[must_use]
pub fn ogre_uniform_view(light: &Light, camera: &Camera, setup: &OgreSetup, subject: &Subject<'_>, size: u32) -> ViewFit {
    let frame = ogre_frame(light, camera, setup);
    let corners = subject.bounds.corners().map(|corner| corner.as_dvec3());
    let image = if frame.is_perspective {
        Window { min: DVec2::splat(-frame.reach), max: DVec2::splat(frame.reach) }
    } else {
        let texel = 2.0 * setup.far_distance / f64::from(size);
        let back = frame.rotation * DVec3::Z;
        let light_from_world = frame.view_from_world();
        let center = light_from_world.transform_point3(setup.target(camera) + back * setup.extrusion).truncate();
        // As C's fmod: what is left over has the sign of what is divided.
        let snapped = center - center % texel;
        let half = DVec2::splat(setup.far_distance);
        Window { min: snapped - half, max: snapped + half }
    };
    rectangle_view(&frame, image, &Content::new(&corners, subject.casters), size, 0)
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
