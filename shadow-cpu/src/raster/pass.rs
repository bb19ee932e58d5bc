//! Whole passes: depth maps and visibility buffers.

use std::ops::Range;

use rayon::prelude::*;

use super::{
    RasterRules,
    bins::{Binner, Bins, TILE_SIZE},
    clip::clip_triangle,
    setup::{Culling, Extent, setup_triangle},
    tile::{DepthTile, Tile, VisibilityTile, draw_triangle},
    transform::{Positions, Transformed, Viewpoint, transform},
};
use crate::kernel::{Kernel, MultiplyAdd, dispatch};

/// The largest width and height of a target in pixels: up to here no edge function leaves 32 bits inside a tile.
pub const MAX_TARGET_SIZE: u32 = 16_384;

/// Whether an alpha-tested triangle is there at a pixel.
pub trait AlphaTest: Sync {
    /// Whether the triangle's alpha at the centre of pixel `(x, y)` reaches its cutoff.
    fn passes(&self, triangle: u32, x: u32, y: u32) -> bool;
}

/// For scenes without alpha-tested triangles: everything is there.
#[derive(Clone, Copy, Debug)]
pub struct NoAlphaTest;

impl AlphaTest for NoAlphaTest {
    fn passes(&self, _triangle: u32, _x: u32, _y: u32) -> bool {
        true
    }
}

/// A run of triangles that are drawn alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Run {
    /// The indices of the triangles.
    pub triangles: Range<u32>,
    /// Whether triangles that wind clockwise on the screen are left out.
    pub culls_back_faces: bool,
    /// Whether the alpha test decides about each sample.
    pub is_masked: bool,
}

/// Where to look from, and the size of the target.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// The x, y, z and w rows of the matrix from world to clip space.
    pub clip_rows: [[f32; 4]; 4],
    /// Width in pixels, from 1 to [`MAX_TARGET_SIZE`].
    pub width: u32,
    /// Height in pixels, from 1 to [`MAX_TARGET_SIZE`].
    pub height: u32,
}

impl Target {
    fn tiles_wide(&self) -> usize {
        (self.width as usize).div_ceil(TILE_SIZE)
    }

    fn tiles_high(&self) -> usize {
        (self.height as usize).div_ceil(TILE_SIZE)
    }
}

/// Renders the nearest depths: 0 at the near plane, 1 where there is nothing. `depth` has one value a pixel.
///
/// # Panics
///
/// If `depth` does not have `width * height` values, or the target is larger than [`MAX_TARGET_SIZE`].
pub fn rasterize_depth(
    positions: &Positions,
    triangles: &[[u32; 3]],
    runs: &[Run],
    target: &Target,
    rules: &RasterRules,
    alpha_test: &impl AlphaTest,
    depth: &mut [f32],
) {
    check_target(target, depth.len());
    let chunks = bin_triangles(positions, triangles, runs, target, rules);
    let width = target.width as usize;
    depth.par_chunks_mut(width * TILE_SIZE).enumerate().for_each_init(DepthTile::default, |tile, (tile_y, band)| {
        for tile_x in 0..target.tiles_wide() {
            draw_tile(tile, &chunks, target, tile_x, tile_y, rules, alpha_test);
            copy_tile(&tile.depth, band, width, tile_x);
        }
    });
}

/// Renders reversed depth, 1 at the near plane and 0 where there is nothing, and the index of the triangle that is seen.
///
/// Of triangles at the same depth the one with the lowest index is seen.
///
/// # Panics
///
/// If `depth` or `seen` does not have `width * height` values, or the target is larger than [`MAX_TARGET_SIZE`].
#[allow(clippy::too_many_arguments, reason = "the scene, the view and the two outputs are each what they are")]
pub fn rasterize_visibility(
    positions: &Positions,
    triangles: &[[u32; 3]],
    runs: &[Run],
    target: &Target,
    rules: &RasterRules,
    alpha_test: &impl AlphaTest,
    depth: &mut [f32],
    seen: &mut [u32],
) {
    check_target(target, depth.len());
    check_target(target, seen.len());
    let chunks = bin_triangles(positions, triangles, runs, target, rules);
    let width = target.width as usize;
    let bands = depth.par_chunks_mut(width * TILE_SIZE).zip(seen.par_chunks_mut(width * TILE_SIZE));
    bands.enumerate().for_each_init(VisibilityTile::default, |tile, (tile_y, (depth_band, seen_band))| {
        for tile_x in 0..target.tiles_wide() {
            draw_tile(tile, &chunks, target, tile_x, tile_y, rules, alpha_test);
            copy_tile(&tile.depth, depth_band, width, tile_x);
            copy_tile(&tile.triangle, seen_band, width, tile_x);
        }
    });
}

fn check_target(target: &Target, len: usize) {
    assert_eq!(len, target.width as usize * target.height as usize, "the target's memory must fit its size");
    assert!(
        target.width.max(target.height) <= MAX_TARGET_SIZE,
        "{} x {} is larger than the rasteriser's limit of {MAX_TARGET_SIZE}",
        target.width,
        target.height
    );
}

/// Copies a tile to its place in a band of rows.
fn copy_tile<T: Copy>(tile: &[T], band: &mut [T], width: usize, tile_x: usize) {
    let left = tile_x * TILE_SIZE;
    let columns = TILE_SIZE.min(width - left);
    for (row, pixels) in band.chunks_exact_mut(width).enumerate() {
        pixels[left..left + columns].copy_from_slice(&tile[row * TILE_SIZE..][..columns]);
    }
}

/// How many triangles one task sets up. A fixed number, so that the chunks do not depend on the threads.
const TRIANGLES_PER_CHUNK: u32 = 16_384;

/// The binned triangles of one chunk.
struct Chunk {
    is_masked: bool,
    bins: Bins,
}

fn bin_triangles(
    positions: &Positions,
    triangles: &[[u32; 3]],
    runs: &[Run],
    target: &Target,
    rules: &RasterRules,
) -> Vec<Chunk> {
    let view = Viewpoint { rows: target.clip_rows, width: target.width, height: target.height };
    let vertices = transform(positions, &view, rules);
    let pieces: Vec<Run> = runs
        .iter()
        .flat_map(|run| {
            run.triangles
                .clone()
                .step_by(TRIANGLES_PER_CHUNK as usize)
                .map(|first| Run { triangles: first..run.triangles.end.min(first + TRIANGLES_PER_CHUNK), ..run.clone() })
        })
        .collect();
    pieces
        .into_par_iter()
        .map(|run| {
            let is_masked = run.is_masked;
            let kernel = BinKernel { positions, vertices: &vertices, triangles, run, view: &view, target, rules };
            Chunk { is_masked, bins: dispatch(rules.fused, kernel) }
        })
        .collect()
}

struct BinKernel<'a> {
    positions: &'a Positions,
    vertices: &'a Transformed,
    triangles: &'a [[u32; 3]],
    run: Run,
    view: &'a Viewpoint,
    target: &'a Target,
    rules: &'a RasterRules,
}

impl Kernel for BinKernel<'_> {
    type Output = Bins;

    #[inline(always)]
    fn run<M: MultiplyAdd>(self) -> Bins {
        let Self { positions, vertices, triangles, run, view, target, rules } = self;
        let culling = if run.culls_back_faces { Culling::Back } else { Culling::None };
        let extent = Extent { width: target.width, height: target.height };
        let mut binner = Binner::new(target.tiles_wide(), target.tiles_high(), run.triangles.len());
        for id in run.triangles {
            let corners = triangles[id as usize];
            let [v0, v1, v2] = corners.map(|corner| vertices.get(corner));
            if v0.outcode & v1.outcode & v2.outcode != 0 {
                continue;
            }
            let codes = v0.outcode | v1.outcode | v2.outcode;
            if codes == 0 {
                if let Some(triangle) = setup_triangle(id, v0, v1, v2, culling, extent, rules) {
                    binner.push(triangle);
                }
            } else {
                let clip = corners.map(|corner| {
                    let position = positions.get(corner);
                    view.clip(position.x, position.y, position.z)
                });
                clip_triangle::<M>(clip, codes, view, rules, |v0, v1, v2| {
                    if let Some(triangle) = setup_triangle(id, &v0, &v1, &v2, culling, extent, rules) {
                        binner.push(triangle);
                    }
                });
            }
        }
        binner.finish()
    }
}

fn draw_tile<T: Tile, A: AlphaTest>(
    tile: &mut T,
    chunks: &[Chunk],
    target: &Target,
    tile_x: usize,
    tile_y: usize,
    rules: &RasterRules,
    alpha_test: &A,
) {
    let index = tile_y * target.tiles_wide() + tile_x;
    dispatch(rules.fused, TileKernel { tile, chunks, index, left: tile_x * TILE_SIZE, top: tile_y * TILE_SIZE, alpha_test });
}

struct TileKernel<'a, T, A> {
    tile: &'a mut T,
    chunks: &'a [Chunk],
    index: usize,
    left: usize,
    top: usize,
    alpha_test: &'a A,
}

impl<T: Tile, A: AlphaTest> Kernel for TileKernel<'_, T, A> {
    type Output = ();

    #[inline(always)]
    fn run<M: MultiplyAdd>(self) {
        self.tile.clear();
        for chunk in self.chunks {
            for triangle in chunk.bins.of_tile(self.index) {
                let alpha_test = chunk.is_masked.then_some(self.alpha_test);
                draw_triangle::<M, T>(self.tile, self.left, self.top, triangle, alpha_test);
            }
        }
    }
}
