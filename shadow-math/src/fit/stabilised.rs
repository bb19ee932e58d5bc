//! Cascades whose texels stand still while the camera moves and turns.
//!
//! A map shimmers when its texels move over the scene. Those of a sphere around the slice, as large whichever way the camera looks, have one size; moved by whole texels alone they fall on the same
//! places of the world in every frame (Valient, "Stable Rendering of Cascaded Shadow Maps", ShaderX 6, 2007).
//!
//! - The sphere's radius comes from the camera's own numbers: angle of view, aspect and the slice's distances, none of which a pose changes. It is not rounded.
//! - Its middle is moved to a whole texel in double precision, counted from the world's origin and not the scene's: a step of 2 cm is a step of 2 cm a planet's radius away.
//! - The map's size is a power of two, so that a whole number of texels is an exact number of clip space, even in single precision.
//! - Depth reaches over all casters, wherever the camera is.

use glam::{DMat4, DVec2, DVec3, DVec4, dcamera::rh};

use super::{
    DepthRange, Eye, LightFrame, MIN_PANCAKE_SHARE, RANGE_MARGIN, Subject, ViewFit, boxed::depth_of_heights, heights_along,
    uniform::rigid_inverse,
};
use crate::{camera::Projection, depth::DepthScale};

/// The sphere around a slice of a camera's view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadeSphere {
    /// How far the middle lies before the camera, along its axis in metres.
    pub distance: f64,
    /// The radius in metres.
    pub radius: f64,
}

impl CascadeSphere {
    /// The smallest sphere around the slice between two distances along a camera's axis, in metres.
    ///
    /// Its middle lies on the axis, as far from the corners of the near face as from those of the far face: at `z = (n + f) (1 + t^2) / 2` where t is the tangent of the angle between axis and corner. For
    /// wide views that lies beyond the far face, whose own circle is then the largest: the middle stays there.
    ///
    /// ```
    /// use shadow_math::{Projection, fit::CascadeSphere};
    ///
    /// let projection = Projection::Perspective { vertical_fov: core::f64::consts::FRAC_PI_2, near: 0.1, far: None };
    /// let sphere = CascadeSphere::around(projection, 1.0, [1.0, 10.0]);
    /// // A square view of 90 degrees: the far face's circle, through its corners at 10 m to both sides.
    /// assert_eq!(sphere.distance, 10.0);
    /// assert!((sphere.radius - 10.0 * 2_f64.sqrt()).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn around(projection: Projection, aspect: f64, [near, far]: [f64; 2]) -> Self {
        #[cfg(not(feature = "std"))]
        use crate::float::FloatFuncs;
        let height = match projection {
            Projection::Perspective { vertical_fov, .. } => (0.5 * vertical_fov).tan(),
            Projection::Orthographic { half_height, .. } => {
                let half = DVec3::new(half_height * aspect, half_height, 0.5 * (far - near));
                return Self { distance: 0.5 * (near + far), radius: half.length() };
            }
        };
        let squared = height * height * (1.0 + aspect * aspect);
        let distance = (0.5 * (near + far) * (1.0 + squared)).min(far);
        let beside = DVec2::new(far * squared.sqrt(), far - distance);
        Self { distance, radius: beside.length() }
    }
}

/// The depths of a stabilised view between which a sphere before the camera lies, to [pancake](ViewFit::pancaked) it; `None` where that is all of the view's depth.
///
/// `before` and `behind` are how many metres stay free on the light's side and on the other. The range has one length whichever way the camera looks, and moves by whole steps of its own, of `steps` to its length, that are counted from the world's origin: what is rounded to
/// these steps is rounded alike in every frame.
#[must_use]
pub fn sphere_depths(
    view: &ViewFit,
    eye: &Eye<'_>,
    sphere: CascadeSphere,
    subject: &Subject<'_>,
    [before, behind]: [f64; 2],
    steps: f64,
) -> Option<[f64; 2]> {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    let whole = view.range.far - view.range.near;
    let toward_light = view.light().truncate();
    let length = ((2.0 * sphere.radius + before + behind) * (1.0 + RANGE_MARGIN)).max(MIN_PANCAKE_SHARE * whole);
    // One step more, by which the range is moved.
    let step = length / (steps - 1.0);
    let length = length + step;
    if length >= whole {
        return None;
    }
    let middle = eye.camera.eye + eye.camera.direction() * sphere.distance;
    let top = toward_light.dot(middle + subject.origin) + sphere.radius + before;
    let top = -(-top / step).floor() * step - toward_light.dot(subject.origin);
    let near_plane = toward_light.dot(view.view_from_world.inverse().w_axis.truncate()) - view.range.near;
    Some([(near_plane - top) / whole, (near_plane - top + length) / whole])
}

/// The view of a sphere before a camera, moved to whole texels of the world.
///
/// `guard` texels of the `size` stay free on every side, and half a texel more, by which the sphere is moved. `size` must be a power of two for texels to stand still to the last bit. Light must be parallel: `frame` is as
/// [`LightFrame::parallel`] gives it.
#[must_use]
pub fn stabilised_view(
    frame: &LightFrame,
    eye: &Eye<'_>,
    sphere: CascadeSphere,
    subject: &Subject<'_>,
    size: u32,
    guard: u32,
) -> ViewFit {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    // The middle moves by up to half a texel on each axis: one texel of the map is left for it.
    let texel = 2.0 * sphere.radius / (f64::from(size) - 2.0 * f64::from(guard) - 1.0);
    let half = 0.5 * texel * f64::from(size);
    let light_from_world = DMat4::from_quat(frame.rotation.inverse());
    let middle = eye.camera.eye + eye.camera.direction() * sphere.distance;
    // In whole texels from the world's origin; the scene's own is taken off again, as exactly.
    let in_world = light_from_world.transform_vector3(middle + subject.origin).truncate() / texel;
    let whole = DVec2::new((in_world.x + 0.5).floor(), (in_world.y + 0.5).floor());
    let origin = light_from_world.transform_vector3(subject.origin).truncate();
    let center = whole * texel - origin;

    let bounds = subject.bounds.transformed(light_from_world);
    let casters = heights_along(frame.rotation * DVec3::Z, subject.casters);
    let [top, bottom] = depth_of_heights(casters, [bounds.0.z, bounds.1.z], sphere.radius);
    let depth = top - bottom;
    let clip_from_view = rh::proj::directx::orthographic(-half, half, -half, half, 0.0, depth);
    let view_from_world = rigid_inverse(frame.rotation, frame.rotation * center.extend(top));
    ViewFit {
        view_from_world,
        clip_from_view,
        range: DepthRange { near: 0.0, far: depth },
        depth_scale: DepthScale::orthographic(depth),
        texel_metres: [texel; 2],
        half_space: DVec4::W,
        ..ViewFit::unwarped(size)
    }
}
