//! Axis-aligned boxes in world space.

use glam::{DMat4, DVec3, Vec3};

/// An axis-aligned box, closed, in metres relative to the scene's origin.
///
/// The empty box has `min` greater than `max`; it is what folding over nothing gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box between two corners. Corners given the wrong way round make an empty box.
    #[must_use]
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around some points; empty for none.
    #[must_use]
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// Whether the box contains no point.
    #[must_use]
    pub fn is_empty(self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// The smallest box that also contains `point`.
    #[must_use]
    pub fn including(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether `point` lies in the box, its surface included.
    #[must_use]
    pub fn contains(self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// The midpoint.
    #[must_use]
    pub fn center(self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Half the diagonal: the radius of the sphere around the box, in metres. Zero for the empty box.
    #[must_use]
    pub fn radius(self) -> f32 {
        if self.is_empty() { 0.0 } else { 0.5 * (self.max - self.min).length() }
    }

    /// The largest absolute coordinate on each axis.
    #[must_use]
    pub fn abs_max(self) -> Vec3 {
        self.min.abs().max(self.max.abs())
    }

    /// The eight corners; bit 0 of the index chooses x, bit 1 y, bit 2 z.
    #[must_use]
    pub fn corners(self) -> [Vec3; 8] {
        core::array::from_fn(|i| {
            let pick = |bit: usize, low: f32, high: f32| if i & bit == 0 { low } else { high };
            Vec3::new(pick(1, self.min.x, self.max.x), pick(2, self.min.y, self.max.y), pick(4, self.min.z, self.max.z))
        })
    }

    /// The bounds, in another space, of the box's corners: `(min, max)` of `to_from_world` times each corner.
    ///
    /// Exact for an affine matrix, since the corners are then the extremes of the whole box. The empty box gives
    /// `(infinity, -infinity)`.
    #[must_use]
    pub fn transformed(self, to_from_world: DMat4) -> (DVec3, DVec3) {
        let mut min = DVec3::INFINITY;
        let mut max = DVec3::NEG_INFINITY;
        if !self.is_empty() {
            for corner in self.corners() {
                let point = to_from_world.transform_point3(corner.as_dvec3());
                min = min.min(point);
                max = max.max(point);
            }
        }
        (min, max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_box_is_the_unit_of_union() {
        let unit = Aabb::new(Vec3::ZERO, Vec3::ONE);
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert!(Aabb::EMPTY.is_empty());
        assert_eq!(Aabb::EMPTY.radius(), 0.0);
        assert!(Aabb::new(Vec3::NAN, Vec3::NAN).is_empty(), "a box of NaN contains nothing");
    }

    #[test]
    fn transformed_bounds_contain_every_point_of_the_box() {
        let bounds = Aabb::new(Vec3::new(-1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 9.0));
        let turn = DMat4::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7);
        let (min, max) = bounds.transformed(turn);
        for step in 0..1000_u32 {
            let t = Vec3::new((step % 10) as f32, (step / 10 % 10) as f32, (step / 100) as f32) / 9.0;
            let point = turn.transform_point3((bounds.min + t * (bounds.max - bounds.min)).as_dvec3());
            // One part in a million of the box's size covers the f32 interpolation above.
            assert!((point - min).min_element() > -1e-5 && (max - point).min_element() > -1e-5, "{point}");
        }
    }
}
