//! Pixels side by side: the surface behind each, taken apart into arrays.
//!
//! The loops over a span call the same functions of `shadow-math` as one pixel does; they are written over arrays of a fixed length, without anything
//! that would keep the compiler from turning them into vectors.

use shadow_math::{
    Receiver,
    glam::Vec3,
    plan::PixelRays,
    triangle::{pixel_ray, pixel_steps, triangle_point, turned_to_viewer},
};
use shadow_scene::{NO_TRIANGLE, Vertices};

use super::SceneView;
use crate::kernel::{
    LANES,
    lanes::{Floats, Lanes},
};

/// How many pixels a span has: enough to spread the cost of a loop, and few enough that all its arrays stay in the first cache.
pub(crate) const SPAN: usize = 64;

/// A number of every pixel of a span.
pub(crate) type Numbers = [f32; SPAN];

/// A vector of every pixel of a span, coordinate by coordinate.
#[derive(Clone, Copy)]
pub(crate) struct Vectors(pub(crate) [Numbers; 3]);

impl Vectors {
    pub(crate) const ZERO: Self = Self([[0.0; SPAN]; 3]);

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, v: Vec3) {
        self.0[0][i] = v.x;
        self.0[1][i] = v.y;
        self.0[2][i] = v.z;
    }
}

/// The vertices in the form that shading reads: what belongs together lies together.
#[derive(Debug)]
pub(crate) struct ShadingVertices {
    /// Position and u; normal and v.
    rows: Vec<[[f32; 4]; 2]>,
    /// Whether any vertex has a colour of its own. Where none has, interpolating them gives exactly 1.
    pub(crate) has_colors: bool,
}

impl ShadingVertices {
    pub(crate) fn new(vertices: &Vertices) -> Self {
        let streams = vertices.positions.iter().zip(&vertices.normals).zip(&vertices.uvs);
        let rows = streams.map(|((p, n), uv)| [[p.x, p.y, p.z, uv.x], [n.x, n.y, n.z, uv.y]]).collect();
        Self { rows, has_colors: vertices.colors.iter().any(|color| color.to_array() != [1.0; 4]) }
    }
}

/// The triangles behind a span's pixels, corner by corner.
pub(crate) struct Corners {
    /// The triangle of each pixel; where there is none, that of some other pixel of the span.
    pub(crate) triangle: [u32; SPAN],
    /// The vertices' indices.
    index: [[u32; SPAN]; 3],
    position: [Vectors; 3],
    normal: [Vectors; 3],
    u: [Numbers; 3],
    v: [Numbers; 3],
}

impl Corners {
    pub(crate) const EMPTY: Self = Self {
        triangle: [0; SPAN],
        index: [[0; SPAN]; 3],
        position: [Vectors::ZERO; 3],
        normal: [Vectors::ZERO; 3],
        u: [[0.0; SPAN]; 3],
        v: [[0.0; SPAN]; 3],
    };

    /// Fetches the positions, and with `attributes` normals and texture coordinates too, of what `seen` shows: at most [`SPAN`] pixels, of which
    /// one at least shows a triangle.
    #[inline(always)]
    pub(crate) fn fetch<L: Lanes>(&mut self, view: SceneView<'_>, seen: &[u32], attributes: bool) {
        let mut some = seen.iter().copied().find(|&triangle| triangle != NO_TRIANGLE).unwrap_or(0);
        for i in 0..SPAN {
            if let Some(&triangle) = seen.get(i)
                && triangle != NO_TRIANGLE
            {
                some = triangle;
            }
            self.triangle[i] = some;
            let corners = view.scene.triangles()[some as usize];
            for corner in 0..3 {
                self.index[corner][i] = corners[corner];
            }
        }
        for corner in 0..3 {
            for first in (0..SPAN).step_by(LANES) {
                let index = &self.index[corner][first..first + LANES];
                let mut rows = [&[0.0; 4]; LANES];
                for lane in 0..LANES {
                    rows[lane] = &view.vertices.rows[index[lane] as usize][0];
                }
                let [x, y, z, u] = L::F::columns(rows);
                let position = &mut self.position[corner].0;
                store::<L>(x, &mut position[0], first);
                store::<L>(y, &mut position[1], first);
                store::<L>(z, &mut position[2], first);
                store::<L>(u, &mut self.u[corner], first);
                if attributes {
                    for lane in 0..LANES {
                        rows[lane] = &view.vertices.rows[index[lane] as usize][1];
                    }
                    let [x, y, z, v] = L::F::columns(rows);
                    let normal = &mut self.normal[corner].0;
                    store::<L>(x, &mut normal[0], first);
                    store::<L>(y, &mut normal[1], first);
                    store::<L>(z, &mut normal[2], first);
                    store::<L>(v, &mut self.v[corner], first);
                }
            }
        }
    }

    /// The texture coordinates and the normal, of any length, of pixel `i` at the place (`u`, `v`) of its triangle.
    #[inline(always)]
    pub(crate) fn texture_coordinates(&self, i: usize, u: f32, v: f32) -> (f32, f32) {
        let mix = |a: f32, b: f32, c: f32| a + (b - a) * u + (c - a) * v;
        (mix(self.u[0][i], self.u[1][i], self.u[2][i]), mix(self.v[0][i], self.v[1][i], self.v[2][i]))
    }

    /// The interpolated normal, of any length, of pixel `i` at the place (`u`, `v`) of its triangle.
    #[inline(always)]
    pub(crate) fn normal(&self, i: usize, u: f32, v: f32) -> Vec3 {
        let [n0, n1, n2] = [self.normal[0].get(i), self.normal[1].get(i), self.normal[2].get(i)];
        n0 + (n1 - n0) * u + (n2 - n0) * v
    }

    /// The vertices of pixel `i`.
    #[inline(always)]
    pub(crate) fn indices(&self, i: usize) -> [usize; 3] {
        [self.index[0][i] as usize, self.index[1][i] as usize, self.index[2][i] as usize]
    }
}

#[inline(always)]
fn store<L: Lanes>(lanes: L::F, numbers: &mut Numbers, first: usize) {
    if let Some(place) = numbers[first..].first_chunk_mut::<LANES>() {
        lanes.store(place);
    }
}

/// Where the rays of a span's pixels meet their triangles.
pub(crate) struct Hits {
    pub(crate) point: Vectors,
    /// The geometric normal turned to the viewer, of any length.
    pub(crate) normal: Vectors,
    /// -1 where the triangle is seen from behind, else 1.
    pub(crate) side: Numbers,
    pub(crate) u: Numbers,
    pub(crate) v: Numbers,
    /// The first pixel.
    pixel: [u32; 2],
}

impl Hits {
    pub(crate) const EMPTY: Self =
        Self { point: Vectors::ZERO, normal: Vectors::ZERO, side: [0.0; SPAN], u: [0.0; SPAN], v: [0.0; SPAN], pixel: [0; 2] };

    /// Intersects the span that begins at pixel (`x`, `y`).
    #[inline(always)]
    pub(crate) fn intersect(&mut self, corners: &Corners, rays: &PixelRays, x: usize, y: usize) {
        let rays = *rays;
        self.pixel = [x as u32, y as u32];
        let [p0, p1, p2] = &corners.position;
        let y = y as f32 + 0.5;
        for i in 0..SPAN {
            let ray = pixel_ray(&rays, (x + i) as i32 as f32 + 0.5, y);
            let hit = triangle_point(ray, p0.get(i), p1.get(i), p2.get(i));
            self.point.set(i, hit.point);
            self.normal.set(i, turned_to_viewer(hit.normal, hit.normal, ray));
            self.side[i] = turned_to_viewer(Vec3::ONE, hit.normal, ray).x;
            self.u[i] = hit.u;
            self.v[i] = hit.v;
        }
    }

    #[inline(always)]
    pub(crate) fn receiver(&self, i: usize) -> Receiver {
        let [x, y] = self.pixel;
        Receiver { pixel: [x + i as u32, y], ..Receiver::new(self.point.get(i), self.normal.get(i)) }
    }

    /// The same with what a footprint is made of.
    #[inline(always)]
    pub(crate) fn receiver_with_steps(&self, rays: &PixelRays, i: usize) -> Receiver {
        let receiver = self.receiver(i);
        let [x, y] = receiver.pixel;
        let ray = pixel_ray(rays, x as i32 as f32 + 0.5, y as i32 as f32 + 0.5);
        Receiver { steps: pixel_steps(rays, ray, receiver.point, receiver.normal), ..receiver }
    }
}
