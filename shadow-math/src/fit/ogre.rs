//! OGRE's own light cameras, for comparison: the default setup, and the light space, the warps and the matrix of its focused and LiSPSM setups.
//!
//! What OGRE 1.12.10 does, by its matrices, to which tests hold all of this: see [`OgreSetup`] for what it needs to be told. The depth ranges of its default setup are not followed: without a far distance, a
//! directional light of OGRE's has no more than a millionth of its depth for a metre. Views here reach from the highest caster down, as other fits do.

use glam::{DMat3, DMat4, DQuat, DVec2, DVec3, DVec4, Vec4Swizzles};

use super::{
    FallBack, LightFrame, Subject, ViewFit, Window,
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
    /// The distance of the light's own far plane, in metres, which takes the place of the far distance as half the width of a directional light's box, but not in where lights aim; 0 for none.
    pub far_clip: f64,
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
        Self { far_distance, far_clip: 0.0, offset: 0.6, extrusion: 10_000.0 }
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
    // In single precision, as OGRE asks: its directions within 2^-12.5 of the vertical are vertical.
    let up = if back.y.abs() as f32 >= 1.0 { DVec3::Z } else { DVec3::Y };
    LightFrame { rotation: look_rotation(back, up), ..frame }
}

/// The rotation whose z axis is the unit vector `back`, and whose x axis is across both that and `up`.
fn look_rotation(back: DVec3, up: DVec3) -> DQuat {
    let x = up.cross(back).normalize_or(back.any_orthonormal_vector());
    DQuat::from_mat3(&DMat3::from_cols(x, back.cross(x), back)).normalize()
}

/// The uniform view of OGRE's default setup.
///
/// Parallel light: a square of twice the far distance, or far clip, around a place before the camera, moved to whole texels toward zero. A light at a place: all that its [frame](ogre_frame) reaches. There is no guard band.
#[must_use]
pub fn ogre_uniform_view(light: &Light, camera: &Camera, setup: &OgreSetup, subject: &Subject<'_>, size: u32) -> ViewFit {
    let frame = ogre_frame(light, camera, setup);
    let corners = subject.bounds.corners().map(|corner| corner.as_dvec3());
    let image = if frame.is_perspective {
        Window { min: DVec2::splat(-frame.reach), max: DVec2::splat(frame.reach) }
    } else {
        let half_width = if setup.far_clip > 0.0 { setup.far_clip } else { setup.far_distance };
        let texel = 2.0 * half_width / f64::from(size);
        let back = frame.rotation * DVec3::Z;
        let light_from_world = frame.view_from_world();
        let center = light_from_world.transform_point3(setup.target(camera) + back * setup.extrusion).truncate();
        // As C's fmod: what is left over has the sign of what is divided.
        let snapped = center - center % texel;
        let half = DVec2::splat(half_width);
        Window { min: snapped - half, max: snapped + half }
    };
    rectangle_view(&frame, image, &Content::new(&corners, subject.casters), size, 0)
}

/// The angle between view and light, in radians, within which OGRE's LiSPSM warps less by itself: 25.84 degrees.
pub const OGRE_THRESHOLD: f64 = 0.451;

/// By what OGRE multiplies the parameters of its LiSPSM: 1, but where the camera looks along the light within the angle `threshold`, in radians. There it grows to 21, in place of the sine that the
/// literature divides by. `cosine` is the absolute one of the angle between both.
#[must_use]
pub fn ogre_tweak(cosine: f64, threshold: f64) -> f64 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    /// By how much at most, less one.
    const MOST: f64 = 20.0;
    let least = threshold.cos();
    if cosine >= least { 1.0 + MOST * (cosine - least) / (1.0 - least) } else { 1.0 }
}

/// The parameter of OGRE's LiSPSM in its simple form: `(|z_e| + sqrt(n f)) a t`.
///
/// `near_distance` is the distance from the camera of the nearest visible point, `planes` are the camera's near and far distances with 0 for no far plane, `adjust` is a (0.1 by itself) and `tweak` is t, the
/// [tweak](ogre_tweak).
#[must_use]
pub fn ogre_warp(near_distance: f64, planes: [f64; 2], adjust: f64, tweak: f64) -> f64 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    (near_distance.abs() + (planes[0] * planes[1]).sqrt()) * adjust * tweak
}

/// The matrix from world to clip space, z from -1 to 1, that OGRE's focused setups of 1.12 begin with.
///
/// Parallel light has the camera's place and up vector and no projection: clip space is metres, but for z, which grows along the light. A light at a place has a perspective as wide as 4 to 3, whatever the map's form: 120
/// degrees high for a point light, aimed as [`ogre_frame`] does, and 1.2 times its cone but at most 90 degrees for a spot light. `planes` are its near and far distances in metres, 0 for no far plane.
#[must_use]
pub fn ogre_standard_matrix(light: &Light, camera: &Camera, setup: &OgreSetup, planes: [f64; 2]) -> DMat4 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    /// Width over height.
    const ASPECT: f64 = 4.0 / 3.0;
    /// Half of 90 degrees: what a spot light's camera sees at most.
    const WIDEST_SPOT: f64 = core::f64::consts::FRAC_PI_4;
    let frame = ogre_frame(light, camera, setup);
    let rotation = look_rotation(frame.rotation * DVec3::Z, camera.orientation * DVec3::Y);
    if !frame.is_perspective {
        let view = super::uniform::rigid_inverse(rotation, camera.eye);
        return DMat4::from_diagonal(DVec4::new(1.0, 1.0, -1.0, 1.0)) * view;
    }
    let reach = if let LightKind::Spot { .. } = light.kind { frame.reach.min(WIDEST_SPOT.tan()) } else { frame.reach };
    let [near, far] = planes;
    // From -1 at the near plane to 1 at the far one.
    let [scale, offset] =
        if far > 0.0 { [-(far + near) / (far - near), -2.0 * far * near / (far - near)] } else { [-1.0, -2.0 * near] };
    let projection = DMat4::from_cols(
        DVec4::X / (reach * ASPECT),
        DVec4::Y / reach,
        DVec4::new(0.0, 0.0, scale, -1.0),
        DVec4::new(0.0, 0.0, offset, 0.0),
    );
    projection * super::uniform::rigid_inverse(rotation, frame.eye)
}

/// The space in which OGRE's focused setups warp and fit: light travels along -y, and the camera looks along -z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OgreLightSpace {
    /// From world to light space, homogeneous.
    light_from_world: DMat4,
    /// The visible point nearest to the camera, in world space: the perspective's axis goes through it.
    nearest: DVec3,
    /// The rows that take points to their distance along the camera's axis, in metres.
    distance_row: DVec4,
}

impl OgreLightSpace {
    /// The light space of a [standard matrix](ogre_standard_matrix), or of any other of the kind, for a camera whose nearest visible point is `nearest`.
    ///
    /// OGRE takes the camera's direction in it from two points a metre apart, which leaves rounding alone where the camera looks along the light. This takes the derivative.
    ///
    /// # Errors
    ///
    /// [`FallBack::LightAlongView`] where the camera's direction in the light's image is none.
    pub fn new(standard: DMat4, camera: &Camera, nearest: DVec3) -> Result<Self, FallBack> {
        /// The sine of the least angle between view and light that has a direction: single precision, in which lights are given, tells no less.
        const MIN_SINE: f64 = 4.0 * f32::EPSILON as f64;
        let [x, y, z, w] = [0, 1, 2, 3].map(|row| standard.row(row));
        let axis = camera.direction();
        let (point, step) = (nearest.extend(1.0), axis.extend(0.0));
        // The numerator of the quotient's derivative.
        let along = DVec2::new(
            x.dot(step) * w.dot(point) - x.dot(point) * w.dot(step),
            y.dot(step) * w.dot(point) - y.dot(point) * w.dot(step),
        );
        // What it could be, were the camera to look across.
        let most = [x, y].map(|row| (row.xyz() * w.dot(point) - w.xyz() * row.dot(point)).length());
        let length = along.length();
        if !(length > MIN_SINE * most[0].max(most[1])) {
            return Err(FallBack::LightAlongView);
        }
        let d = along / length;
        // Light space before the turn is (x, -z, y); then -z becomes the direction.
        let turned = [x * -d.y + y * d.x, -z, x * -d.x + y * -d.y, w];
        let light_from_world = DMat4::from_cols(turned[0], turned[1], turned[2], turned[3]).transpose();
        Ok(Self { light_from_world, nearest, distance_row: axis.extend(-axis.dot(camera.eye)) })
    }

    /// The bounds of some points of the world in this space: the least and greatest coordinates.
    #[must_use]
    pub fn bounds(&self, body: &[DVec3]) -> [DVec3; 2] {
        bounds_under(self.light_from_world, body)
    }

    /// The parameter of OGRE's LiSPSM in its general form: `z_n + sqrt(z_0 z_1) a t`; 0 for no warp.
    ///
    /// `z_0` is the distance from the camera of the nearest visible point. The plane across the view through it meets, in light space, the line along the light at the near end of the body; `z_1` is the distance of the
    /// point as far behind where it does as the far end of the body. Where the light shines across the view, the line is in the plane or beside it, and OGRE's own search for the point fails; this takes
    /// the limit, which has no need of the point. `near` is the distance of the camera's near plane.
    #[must_use]
    pub fn general_warp(&self, body: &[DVec3], near: f64, adjust: f64, tweak: f64) -> f64 {
        #[cfg(not(feature = "std"))]
        use crate::float::FloatFuncs;
        let [min, max] = self.bounds(body);
        let world_from_light = self.light_from_world.inverse();
        let z_0 = self.distance_row.dot(self.nearest.extend(1.0));
        // Rows over light space: the distance from the plane across the view, and what it is divided by.
        let in_light = |row: DVec4| world_from_light.transpose() * row;
        let (plane, weight) = (in_light(self.distance_row - DVec4::W * z_0), in_light(DVec4::W));
        // The point where line and plane meet, moved to the far end, times the plane's y.
        let start = DVec4::new(self.bounds(&[self.nearest])[0].x, 0.0, max.z, 1.0);
        let moved = DVec4::new(0.0, 0.0, min.z - max.z, 0.0);
        let share = if weight.y == 0.0 {
            1.0 / weight.dot(start + moved)
        } else {
            plane.y / (weight.dot(start + moved) * plane.y - weight.y * plane.dot(start))
        };
        let z_1 = z_0 + plane.dot(moved) * share;
        if z_0 * z_1 < 0.0 { 0.0 } else { near + (z_0 * z_1).sqrt() * adjust * tweak }
    }

    /// The matrix from world to clip space, z from -1 to 1, that fits the box around a body, after a warp with this parameter; none for a parameter of 0 or less.
    ///
    /// The body must have an extent along each axis of light space, or some of the map stays empty. y is 1 at the end of the body nearest to the camera, and z grows along the light.
    #[must_use]
    pub fn clip_from_world(&self, body: &[DVec3], parameter: f64) -> DMat4 {
        let mut light_from_world = self.light_from_world;
        if parameter > 0.0 {
            let [min, max] = self.bounds(body);
            let nearest = self.bounds(&[self.nearest])[0];
            let center = DVec3::new(nearest.x, nearest.y, max.z + parameter);
            // A perspective as wide and high as 2 at the distance of the body's far end, which is its near plane: so z stays the right way round.
            let [far_end, near_end] = [parameter + (max.z - min.z), parameter];
            let warp = DMat4::from_cols(
                DVec4::X * far_end,
                DVec4::Y * far_end,
                DVec4::new(0.0, 0.0, (near_end + far_end) / (far_end - near_end), -1.0),
                DVec4::new(0.0, 0.0, 2.0 * near_end * far_end / (far_end - near_end), 0.0),
            );
            light_from_world = warp * DMat4::from_translation(-center) * light_from_world;
        }
        let [min, max] = bounds_under(light_from_world, body);
        let half = 0.5 * (max - min);
        let scale = half.map(|half| if half > 0.0 { 1.0 / half } else { 1.0 });
        let cube = DMat4::from_scale(scale) * DMat4::from_translation(-0.5 * (min + max));
        let clip_from_light = DMat4::from_cols(DVec4::X, DVec4::NEG_Z, DVec4::Y, DVec4::W);
        clip_from_light * cube * light_from_world
    }
}

/// The least and greatest coordinates of points under a homogeneous matrix.
fn bounds_under(matrix: DMat4, points: &[DVec3]) -> [DVec3; 2] {
    let images = points.iter().map(|point| matrix.project_point3(*point));
    images.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], point| [min.min(point), max.max(point)])
}
