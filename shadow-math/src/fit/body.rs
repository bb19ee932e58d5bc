//! What there is to be fitted: the convex body of all points that the camera sees and something can shadow.

use glam::{DVec2, DVec3, DVec4, Vec3};

use super::{LightFrame, MIN_NEAR_SHARE, ViewFit, depth_range::touching_distance};
use crate::{
    bounds::Aabb,
    camera::{Camera, Projection},
    frustum::Frustum,
    polytope::{Polytope, shadow_planes},
    rounding::UNIT_ROUNDOFF,
};

/// What there is to be shadowed, and who looks at it.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The bounds of what can cast a shadow, in metres relative to the scene's origin.
    pub casters: &'a [Aabb],
    /// The bounds of everything that is drawn.
    pub bounds: Aabb,
    /// The scene's own origin in the world, in metres: what stabilised texels are counted from.
    pub origin: DVec3,
    /// Who looks at it; `None` where nobody does, for fits that do not ask.
    pub eye: Option<Eye<'a>>,
}

/// A camera, and what is known of what it sees.
#[derive(Clone, Copy, Debug)]
pub struct Eye<'a> {
    /// The camera.
    pub camera: Camera,
    /// Width over height of its picture.
    pub aspect: f64,
    /// Points of the surfaces that it sees, in metres relative to the scene's origin, by which fits are narrowed; none for what the frustum has.
    pub samples: &'a [Vec3],
    /// The largest plane that it sees, as `(normal, offset)` with `normal . point + offset = 0`.
    pub plane: Option<DVec4>,
}

impl<'a> Subject<'a> {
    /// Casters within bounds, at which nobody looks.
    #[must_use]
    pub const fn unseen(casters: &'a [Aabb], bounds: Aabb) -> Self {
        Self { casters, bounds, origin: DVec3::ZERO, eye: None }
    }

    /// The bounds of all casters together.
    #[must_use]
    pub fn caster_bounds(&self) -> Aabb {
        self.casters.iter().fold(Aabb::EMPTY, |all, caster| all.union(*caster))
    }
}

impl Eye<'_> {
    /// The row that takes points to their distance along the camera's axis, in metres.
    #[must_use]
    pub fn distance_row(&self) -> DVec4 {
        let axis = self.camera.direction();
        axis.extend(-axis.dot(self.camera.eye))
    }

    /// The distances of the camera's own near and far planes, in metres; infinite for no far plane.
    #[must_use]
    pub fn planes(&self) -> [f64; 2] {
        match self.camera.projection {
            Projection::Perspective { near, far, .. } => [near, far.unwrap_or(f64::INFINITY)],
            Projection::Orthographic { near, far, .. } => [near, far],
        }
    }
}

/// Between which distances from the camera, along its axis in metres, there is anything to be seen; `None` where there is nothing.
///
/// `shadow_distance` is where shadows end, infinite for nowhere. The distances are those of the bounds' corners, of the samples if there are any, and of the camera's planes, whichever are narrower; widened by
/// what rounding can do to them ([`widened_slice`]).
#[must_use]
pub fn visible_range(eye: &Eye<'_>, bounds: Aabb, shadow_distance: f64) -> Option<[f64; 2]> {
    if bounds.is_empty() {
        return None;
    }
    let row = eye.distance_row();
    let [mut near, mut far] = eye.planes();
    far = far.min(shadow_distance);
    let mut narrow = |points: &mut dyn Iterator<Item = Vec3>| {
        let range = points.map(|point| row.dot(point.as_dvec3().extend(1.0)));
        let [least, most] = range.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], d| [least.min(d), most.max(d)]);
        near = near.max(least);
        far = far.min(most);
    };
    narrow(&mut bounds.corners().into_iter());
    if !eye.samples.is_empty() {
        // Receivers are these points and no others: nothing is added but rounding, below.
        narrow(&mut eye.samples.iter().copied());
    }
    // A surface that faces the camera has one distance alone: rounding gives it a second one.
    let range = widened_slice(eye, bounds, [near, far]);
    (range[0] < range[1]).then_some(range)
}

/// By what share of themselves a slice's distances are widened: distances are rounded to single precision, and so are the sums and products of a few of them.
const SLICE_MARGIN: f64 = 1e-6;

/// A slice of a camera's view, widened so that receivers within it stay within it in single precision, in which they measure their distances. The nearer distance is at least 0.
///
/// A distance is a row times a point: four products that may cancel, so that what they lose goes by how far the bounds and the camera are from the scene's origin, not by the distance.
#[must_use]
pub fn widened_slice(eye: &Eye<'_>, bounds: Aabb, slice: [f64; 2]) -> [f64; 2] {
    widened_by(slice, eye.distance_row().abs().dot(bounds.abs_max().as_dvec3().extend(1.0)))
}

/// The same, where the products add up to no more than `largest` metres.
#[must_use]
pub fn widened_by([near, far]: [f64; 2], largest: f64) -> [f64; 2] {
    /// The four roundings of the [row](crate::rounding), one of its numbers, one of the point's, and as many again to spare.
    const ROUNDINGS: f64 = 12.0;
    let margin = ROUNDINGS * UNIT_ROUNDOFF * largest;
    [(near * (1.0 - SLICE_MARGIN) - margin).max(0.0), far * (1.0 + SLICE_MARGIN) + margin]
}

/// All points that the camera sees between two distances along its axis, in metres, that lie within the bounds, and that a caster can shadow: the slice of its frustum, cut by the planes of the bounds, of the shadow
/// volume of all casters' bounds and of what the light reaches. Empty where that is nothing.
///
/// The planes are at most 6 of the frustum, 6 of the bounds, 9 of the shadow volume and 6 of the light: fewer than a [`Polytope`] has room for. The 16 of the samples may find none: the body is then larger than it
/// need be. Without a caster there is no body.
#[must_use]
pub fn visible_body(eye: &Eye<'_>, [near, far]: [f64; 2], subject: &Subject<'_>, frame: &LightFrame) -> Polytope {
    let casters = subject.caster_bounds();
    if casters.is_empty() {
        return Polytope::EMPTY;
    }
    let Ok(slice) = Frustum::slice(&eye.camera, eye.aspect, near.max(0.0), far) else { return Polytope::EMPTY };
    let mut body = Polytope::from_frustum(&slice);
    body.clip_to_bounds(subject.bounds);
    let (planes, count) = shadow_planes(casters, frame.light());
    for plane in &planes[..count] {
        body.clip(*plane);
    }
    if frame.is_perspective {
        let view_from_world = frame.view_from_world();
        let [x, y, z] = [0, 1, 2].map(|row| view_from_world.row(row));
        for plane in [z * -frame.reach - x, z * -frame.reach + x, z * -frame.reach - y, z * -frame.reach + y] {
            body.clip(plane);
        }
        if frame.limit.is_finite() {
            body.clip(z + DVec4::W * frame.limit);
        }
        // The near rule goes by what is left and by the casters: those that it drops must not be missed by receivers that it keeps.
        let farthest = farthest_of(&body, frame).min(farthest_of(&Polytope::from_bounds(casters), frame));
        if !(farthest > touching_distance(frame.eye, f64::from(subject.bounds.abs_max().length()))) {
            return Polytope::EMPTY;
        }
        body.clip(-z - DVec4::W * (MIN_NEAR_SHARE * farthest));
    }
    if !eye.samples.is_empty() {
        clip_to_samples(&mut body, eye, [near, far], frame);
    }
    body
}

/// All points that the camera sees between two distances along its axis, in metres, that lie within the bounds, that a caster can shadow and that a light's view has: what can ask its map. Empty where that is nothing.
///
/// `rim` is by how many texels a lookup can lie from its receiver: those beyond the map's sides by as much may ask.
///
/// The planes are at most 6 of the frustum, 6 of the bounds, 9 of the shadow volume, 4 of the map and 1 of its half-space.
#[must_use]
pub fn visible_in_view(eye: &Eye<'_>, [near, far]: [f64; 2], subject: &Subject<'_>, view: &ViewFit, rim: f64) -> Polytope {
    let casters = subject.caster_bounds();
    let Ok(slice) = Frustum::slice(&eye.camera, eye.aspect, near.max(0.0), far) else { return Polytope::EMPTY };
    if casters.is_empty() {
        return Polytope::EMPTY;
    }
    let mut body = Polytope::from_frustum(&slice);
    body.clip_to_bounds(subject.bounds);
    let (planes, count) = shadow_planes(casters, view.light());
    for plane in planes[..count].iter().chain(&view.sides_widened_by(rim)).chain([&view.half_space]) {
        body.clip(*plane);
    }
    body
}

/// Directions of a light's image in which samples are bounded: eight, of both signs, leave at most a fiftieth of a round outline's width on each side.
const SAMPLE_DIRECTIONS: usize = 8;

/// Cuts a body by the planes through the light that bound the image of the samples between two distances from the camera. A body without samples becomes empty.
fn clip_to_samples(body: &mut Polytope, eye: &Eye<'_>, [near, far]: [f64; 2], frame: &LightFrame) {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    let directions: [DVec2; SAMPLE_DIRECTIONS] = core::array::from_fn(|i| {
        let angle = core::f64::consts::PI * i as f64 / SAMPLE_DIRECTIONS as f64;
        DVec2::new(angle.cos(), (core::f64::consts::FRAC_PI_2 - angle).cos())
    });
    let (row, view_from_world) = (eye.distance_row(), frame.view_from_world());
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; SAMPLE_DIRECTIONS];
    // How far single precision, in which samples are given and receivers are computed again, moves one in the image.
    let mut margin = 0.0_f64;
    for point in eye.samples {
        let point = point.as_dvec3();
        let distance = row.dot(point.extend(1.0));
        let seen = view_from_world.transform_point3(point);
        let is_reached = !frame.is_perspective || seen.z < 0.0 && frame.image(seen).abs().max_element() <= frame.reach;
        if distance < near || distance > far || !is_reached {
            continue;
        }
        let image = frame.image(seen);
        let metres = 2.0 * f64::from(f32::EPSILON) * point.length();
        margin = margin.max(if frame.is_perspective { metres * (1.0 + image.length()) / -seen.z } else { metres });
        for (range, direction) in ranges.iter_mut().zip(&directions) {
            let at = direction.dot(image);
            *range = [range[0].min(at), range[1].max(at)];
        }
    }
    let [x, y, z] = [0, 1, 2].map(|row| view_from_world.row(row));
    // What an image's coordinate is divided by.
    let divisor = if frame.is_perspective { -z } else { DVec4::W };
    for ([least, most], direction) in ranges.into_iter().zip(directions) {
        if least > most {
            *body = Polytope::EMPTY;
            return;
        }
        let along = x * direction.x + y * direction.y;
        body.clip(along - divisor * (least - margin));
        body.clip(divisor * (most + margin) - along);
    }
}

/// The greatest distance of a body's vertices along a light's axis, in metres, at most the light's limit.
fn farthest_of(body: &Polytope, frame: &LightFrame) -> f64 {
    let row = -frame.view_from_world().row(2);
    body.vertices().iter().map(|vertex| row.dot(vertex.extend(1.0))).fold(0.0, f64::max).min(frame.limit)
}
