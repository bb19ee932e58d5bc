//! Convex bodies as their vertices, each with the planes that it lies on.
//!
//! That is the whole topology, for faces are planes and edges are pairs of vertices that share two planes: cutting such a body needs neither
//! lists of faces nor a heap.

mod shadow;
#[cfg(test)]
mod tests;

pub use shadow::{MAX_SHADOW_PLANES, shadow_planes};

use glam::{DMat4, DVec3, DVec4};

use crate::{bounds::Aabb, frustum::Frustum};

/// The most planes that bound a body: one for each bit of a vertex's mask.
pub const MAX_PLANES: usize = 32;

/// The most vertices of a body that [`MAX_PLANES`] planes bound.
///
/// At least three edges meet at each of a solid's `V` vertices and each edge has two, so its `E` edges number at least `3 V / 2`. With Euler's
/// `V - E + F = 2` for `F` faces that gives `V <= 2 F - 4`, and each face takes a plane of its own. A flat body of as many planes has fewer, as
/// one plane is its own and each other one holds at most one of its edges.
pub const MAX_VERTICES: usize = 2 * MAX_PLANES - 4;

/// The most new vertices of a cut: those of its face, which has at most one edge in common with each other plane.
const MAX_CUTS: usize = MAX_PLANES - 1;

/// How far from a plane a vertex may lie and still count as on it, as a share of the largest coordinate that the body began with.
///
/// A distance to a plane is a sum of four terms, each about as large as that coordinate, of numbers that carry a few roundings of its size: all in all
/// some ten times 2^-53 of it. Planes that were computed in different ways from the same corners differ by several times as much. This is two hundred
/// times the former; and at a kilometre from the origin still not more than a fourth of a nanometre.
const TOLERANCE: f64 = 1.0 / (1_u64 << 42) as f64;

// Sets of vertices are the bits of a word.
const _: () = assert!(MAX_VERTICES < u64::BITS as usize && MAX_PLANES == u32::BITS as usize);

/// A bounded convex body: the hull of its vertices. It can be solid, flat, a segment, a point or empty.
#[derive(Clone, Copy, Debug)]
pub struct Polytope {
    /// The vertices, in metres relative to the scene's origin; the first `len` count.
    points: [DVec3; MAX_VERTICES],
    /// The planes that each vertex lies on. A flat body has exactly one plane in which all of it lies.
    planes: [u32; MAX_VERTICES],
    len: usize,
    /// [`TOLERANCE`] in metres.
    tolerance: f64,
}

impl Polytope {
    /// The body that contains nothing.
    pub const EMPTY: Self = Self { points: [DVec3::ZERO; MAX_VERTICES], planes: [0; MAX_VERTICES], len: 0, tolerance: 0.0 };

    /// The body of a frustum. The near face may have shrunk to a point at the eye.
    #[must_use]
    pub fn from_frustum(frustum: &Frustum) -> Self {
        // In the order of the frustum's corners: top right, top left, bottom left, bottom right, of the near face and then of the far one.
        let faces = |i: usize| {
            let [is_far, is_left, is_bottom] = [i >= 4, matches!(i % 4, 1 | 2), i % 4 >= 2];
            1 << u32::from(is_far) | 4 << u32::from(is_left) | 16 << u32::from(is_bottom)
        };
        Self::from_corners(frustum.corners, core::array::from_fn(faces))
    }

    /// The body of a box, which must be finite where it is not empty. It may be flat, a segment or a point.
    #[must_use]
    pub fn from_bounds(bounds: Aabb) -> Self {
        if bounds.is_empty() {
            return Self::EMPTY;
        }
        Self::from_parallelepiped(bounds.corners().map(|corner| corner.as_dvec3()))
    }

    /// The body of a box whose axes lie anywhere: corners in the order of [`Aabb::corners`], finite.
    #[must_use]
    pub fn from_parallelepiped(corners: [DVec3; 8]) -> Self {
        let faces = |i: usize| 1 << (i & 1) | 4 << (i >> 1 & 1) | 16 << (i >> 2);
        Self::from_corners(corners, core::array::from_fn(faces))
    }

    /// The body of eight corners and the faces that each lies on; corners that coincide are made one, which lies on the faces of all.
    fn from_corners(corners: [DVec3; 8], faces: [u32; 8]) -> Self {
        let largest = corners.iter().fold(0.0_f64, |largest, corner| largest.max(corner.abs().max_element()));
        let mut body = Self { tolerance: TOLERANCE * largest, ..Self::EMPTY };
        for (corner, faces) in corners.into_iter().zip(faces) {
            let is_here = |point: &DVec3| point.distance_squared(corner) <= body.tolerance * body.tolerance;
            if let Some(same) = body.vertices().iter().position(is_here) {
                body.planes[same] |= faces;
            } else {
                body.push(corner, faces);
            }
        }
        body.flatten();
        body
    }

    /// The vertices, in metres relative to the scene's origin, in no particular order.
    ///
    /// Their hull is the body. Rounding can make some of them lie in the hull of the others, at the same place even.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.points[..self.len]
    }

    /// Whether the body contains no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The least and the greatest `dot(direction, point)` of the body's points; `(infinity, -infinity)` for the empty body.
    ///
    /// These are metres along `direction`, relative to the scene's origin, if it has unit length.
    #[must_use]
    pub fn extent_along(&self, direction: DVec3) -> (f64, f64) {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        self.vertices().iter().map(|point| direction.dot(*point)).fold(start, |(min, max), at| (min.min(at), max.max(at)))
    }

    /// The bounds of the body in another space, exact for an affine matrix: `(min, max)` of `to_from_world` times each vertex.
    ///
    /// The empty body gives `(infinity, -infinity)`.
    #[must_use]
    pub fn transformed(&self, to_from_world: DMat4) -> (DVec3, DVec3) {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let points = self.vertices().iter().map(|point| to_from_world.transform_point3(*point));
        points.fold(start, |(min, max), point| (min.min(point), max.max(point)))
    }

    /// Keeps what lies in a box; nothing if the box is empty.
    pub fn clip_to_bounds(&mut self, bounds: Aabb) {
        if bounds.is_empty() {
            self.len = 0;
        }
        for plane in box_planes(bounds) {
            self.clip(plane);
        }
    }

    /// Keeps the part where `dot(normal, point) + offset >= 0`, of a plane `(normal, offset)` of any scale.
    ///
    /// A plane without a normal, or one that is not finite, cuts nothing off. One that has no vertex on its outer side changes nothing and takes no place
    /// among the planes.
    ///
    /// A vertex counts as on the plane if it is as near as rounding can bring it (2^-42 of the largest coordinate that the body began with). What is
    /// left lies beyond the plane by no more than that, and what it lacks of the exact part lies no farther from it than a few times that. Where the
    /// planes or the vertices would become more than there is room for, the cut is left out: the body is then larger than it should be, never smaller.
    ///
    /// Without rounding the vertices cannot become too many: a cut that leaves some vertices on either side makes a new face, so that every plane
    /// in use holds a face of its own, and [`MAX_VERTICES`] is enough for [`MAX_PLANES`] faces. A plane that only touches the body is never in use for
    /// long: the places of those that hold less than three vertices of a solid are taken again when there is no other.
    ///
    /// Why masks are enough: two vertices that lie on two planes lie on the line that the planes have in common. Each plane meets the
    /// body in a face of it, the line does so too, and a face with two vertices on a line is the edge between them.
    pub fn clip(&mut self, plane: DVec4) {
        let scale = plane.truncate().abs().max_element();
        if !(scale > 0.0 && plane.is_finite()) {
            return;
        }
        let (normal, offset) = (plane.truncate() / scale, plane.w / scale);
        let on = self.tolerance * normal.length();
        let mut distances = [0.0; MAX_VERTICES];
        // The sets of vertices beyond the plane, and of those on its inner side.
        let (mut out, mut inner) = (0_u64, 0_u64);
        for (i, (point, distance)) in self.points[..self.len].iter().zip(&mut distances).enumerate() {
            *distance = normal.dot(*point) + offset;
            out |= u64::from(*distance < -on) << i;
            inner |= u64::from(*distance > on) << i;
        }
        if out == 0 {
            return;
        }
        let kept = ((1_u64 << self.len) - 1) & !out;
        if kept == 0 {
            self.len = 0;
            return;
        }
        let Some(bit) = self.spare_plane() else { return };
        // A vertex on the plane is where its edges meet the plane, but not where it lies on the inner side, by however little, and one of them runs along
        // the plane so closely that it goes on for more than the tolerance.
        for from in bits(kept & !inner).filter(|from| distances[*from] > 0.0) {
            let goes_on = |to: usize| {
                let share = distances[from] / (distances[from] - distances[to]);
                share * self.points[from].distance(self.points[to]) > self.tolerance
            };
            inner |= u64::from(bits(out).filter(|to| self.is_edge(from, *to)).any(goes_on)) << from;
        }
        let room = (MAX_VERTICES - kept.count_ones() as usize).min(MAX_CUTS);
        let mut cuts = Cuts { vertices: [(DVec3::ZERO, 0); MAX_CUTS], len: 0 };
        if !self.cut_edges(&distances, inner, out, room, &mut cuts) {
            return;
        }
        for i in bits(kept & !inner) {
            self.planes[i] |= bit;
        }
        // New vertices take the places of those that are gone. If these are more, the last ones that stay fill up what is left, from the last
        // place on, so that none that is gone comes last.
        let mut holes = out;
        for &(point, planes) in &cuts.vertices[..cuts.len] {
            if holes == 0 {
                self.push(point, planes | bit);
            } else {
                let hole = holes.trailing_zeros() as usize;
                (self.points[hole], self.planes[hole]) = (point, planes | bit);
                holes &= holes - 1;
            }
        }
        while holes != 0 {
            let hole = holes.ilog2() as usize;
            self.len -= 1;
            (self.points[hole], self.planes[hole]) = (self.points[self.len], self.planes[self.len]);
            holes &= !(1 << hole);
        }
        if inner == 0 {
            self.flatten();
        }
    }

    fn push(&mut self, point: DVec3, planes: u32) {
        (self.points[self.len], self.planes[self.len]) = (point, planes);
        self.len += 1;
    }

    /// Whether two vertices are the ends of an edge.
    fn is_edge(&self, a: usize, b: usize) -> bool {
        // The ends of a segment are an edge whatever they share.
        has_two_bits(self.planes[a] & self.planes[b]) || self.len == 2
    }

    /// Adds where a plane cuts the edges between two sets of vertices; `false` if there is no room for so many.
    fn cut_edges(&self, distances: &[f64; MAX_VERTICES], inner: u64, out: u64, room: usize, cuts: &mut Cuts) -> bool {
        bits(out).all(|to| {
            bits(inner).filter(|from| self.is_edge(*from, to)).all(|from| {
                let share = distances[from] / (distances[from] - distances[to]);
                let point = self.points[from].lerp(self.points[to], share);
                cuts.add(point, self.planes[from] & self.planes[to], self.tolerance, room)
            })
        })
    }

    /// The bit of a plane that is not in use. If all are, those that hold less than three vertices of a solid are given up first: they touch it.
    fn spare_plane(&mut self) -> Option<u32> {
        let mut used = self.planes[..self.len].iter().fold(0, |used, planes| used | planes);
        if used == u32::MAX && self.common_planes() == 0 {
            // The planes of at least one, two and three vertices.
            let (mut one, mut two, mut three) = (0, 0, 0);
            for &planes in &self.planes[..self.len] {
                three |= two & planes;
                two |= one & planes;
                one |= planes;
            }
            self.planes[..self.len].iter_mut().for_each(|planes| *planes &= three);
            used = three;
        }
        (used != u32::MAX).then(|| 1 << used.trailing_ones())
    }

    /// The planes that all vertices lie on: none for a solid.
    fn common_planes(&self) -> u32 {
        self.planes[..self.len].iter().fold(u32::MAX, |common, planes| common & planes)
    }

    /// Gives a body in which all vertices share several planes the form that its dimension asks for.
    ///
    /// A flat body's planes but for one are forgotten, or its diagonals would be taken for edges. Of a segment only the ends are kept, and of a point
    /// only one.
    fn flatten(&mut self) {
        let common = self.common_planes();
        if self.len < 2 || common.count_ones() < 2 {
            return;
        }
        // The point farthest from any one is an end of the segment.
        let farthest = |from: DVec3| {
            let squares = self.vertices().iter().map(|point| point.distance_squared(from)).enumerate();
            squares.fold((0, -1.0), |best, this| if this.1 > best.1 { this } else { best }).0
        };
        let begin = farthest(self.points[0]);
        let end = farthest(self.points[begin]);
        let (origin, axis) = (self.points[begin], (self.points[end] - self.points[begin]).normalize_or_zero());
        let is_near = |point: &DVec3| (*point - origin).cross(axis).length_squared() <= self.tolerance * self.tolerance;
        if self.vertices().iter().all(is_near) {
            let ends = [begin, end].map(|i| (self.points[i], self.planes[i]));
            self.len = 0;
            self.push(ends[0].0, ends[0].1);
            if ends[0].0.distance_squared(ends[1].0) > self.tolerance * self.tolerance {
                self.push(ends[1].0, ends[1].1);
            }
        } else {
            let forgotten = common & (common - 1);
            self.planes[..self.len].iter_mut().for_each(|planes| *planes &= !forgotten);
        }
    }
}

/// New vertices, each with the planes that it lies on besides the one that made it.
struct Cuts {
    vertices: [(DVec3, u32); MAX_CUTS],
    len: usize,
}

impl Cuts {
    /// Adds a vertex, unless it adds nothing to the hull of the others; `false` if there is no room for it.
    ///
    /// Without rounding no two of these share two planes: that would be two edges on one line. Where rounding has put several vertices in the place of one
    /// and where planes are closer than the tolerance, several pairs do, and would become twice as many with every cut. They are made one if they lie in the
    /// same place. Of three on a line only the ends are kept.
    fn add(&mut self, point: DVec3, planes: u32, tolerance: f64, room: usize) -> bool {
        for i in 0..self.len {
            let (other, shared) = (self.vertices[i].0, self.vertices[i].1 & planes);
            if !has_two_bits(shared) {
                continue;
            }
            if is_between(point, other, other, tolerance) {
                self.vertices[i].1 |= planes;
                return true;
            }
            for j in i + 1..self.len {
                if has_two_bits(self.vertices[j].1 & shared) {
                    let third = self.vertices[j].0;
                    if is_between(point, other, third, tolerance) {
                        return true;
                    }
                    for (middle, end, at) in [(other, third, i), (third, other, j)] {
                        if is_between(middle, end, point, tolerance) {
                            self.vertices[at] = (point, planes);
                            return true;
                        }
                    }
                }
            }
        }
        if self.len == room {
            return false;
        }
        self.vertices[self.len] = (point, planes);
        self.len += 1;
        true
    }
}

/// Whether a point lies on a segment, but for a tolerance in metres.
fn is_between(point: DVec3, begin: DVec3, end: DVec3, tolerance: f64) -> bool {
    let way = end - begin;
    let share = ((point - begin).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    // Zero over zero, where the ends coincide.
    let share = if share.is_nan() { 0.0 } else { share };
    point.distance_squared(begin + share * way) <= tolerance * tolerance
}

fn has_two_bits(planes: u32) -> bool {
    planes & planes.wrapping_sub(1) != 0
}

/// The places of a word's bits, in ascending order.
fn bits(mut word: u64) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros() as usize);
        word &= word.wrapping_sub(1);
        bit
    })
}

/// The planes of a box, `(normal, offset)` with `dot(normal, point) + offset >= 0` inside: of each axis in turn, the lower one and the upper one.
fn box_planes(bounds: Aabb) -> [DVec4; 6] {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    core::array::from_fn(|i| {
        let axis = DVec3::AXES[i / 2];
        if i % 2 == 0 { axis.extend(-axis.dot(min)) } else { (-axis).extend(axis.dot(max)) }
    })
}
