//! Vectors, with every sum written out.
//!
//! Mirrored by `vector.wgsl`, together with the products that glam has under the same definition: `dot` sums in ascending order, and
//! `cross` is `(a.y b.z - b.y a.z, ...)`.

use glam::Vec3;

#[cfg(not(feature = "std"))]
use crate::float::FloatFuncs;

/// A row of a matrix times a point.
#[inline(always)]
#[must_use]
pub fn row_times_point(row: [f32; 4], point: Vec3) -> f32 {
    row[0] * point.x + row[1] * point.y + row[2] * point.z + row[3]
}

/// The first three terms of a row times a vector, which has no place.
#[inline(always)]
#[must_use]
pub fn row_times_vector(row: [f32; 4], vector: Vec3) -> f32 {
    row[0] * vector.x + row[1] * vector.y + row[2] * vector.z
}

/// `v` over its length; zero stays zero.
#[inline(always)]
#[must_use]
pub fn normalized(v: Vec3) -> Vec3 {
    let squared = v.x * v.x + v.y * v.y + v.z * v.z;
    if squared <= 0.0 {
        return v;
    }
    v / squared.sqrt()
}

/// A normal of unit length, of one of any length above 0 that f32 can hold: scaled first, so that its square can be taken.
#[inline(always)]
#[must_use]
pub fn unit_normal(normal: Vec3) -> Vec3 {
    let largest = normal.x.abs().max(normal.y.abs()).max(normal.z.abs());
    normalized(normal / largest)
}
