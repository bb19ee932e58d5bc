//! Whole passes: depth maps and visibility buffers.

use std::ops::Range;

use rayon::prelude::*;

use super::{
    DepthPlaneRule, RasterRules,
    bins::{Binned, Bins, TILE_SIZE},
    clip::clip_triangle,
    plane::WholeTriangle,
    sample::{Corner, Part, draw_large, draw_masked, draw_small},
    setup::{Culling, Extent, look_at, setup_large, setup_small},
    tile::{DepthTile, STRIDE, Tile, VisibilityTile},
    transform::{Positions, Transformed, Viewpoint, WindowVertex},
};
use crate::kernel::{Kernel, LANES, MultiplyAdd, dispatch, lanes::Lanes};

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
    /// Which of them are left out by how they wind on the screen.
    pub culling: Culling,
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
    pub(super) fn tiles_wide(&self) -> usize {
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
#[allow(clippy::too_many_arguments, reason = "the scene, the view and the output are each what they are")]
pub fn rasterize_depth(
    scratch: &mut Scratch,
    positions: &Positions,
    triangles: &[[u32; 3]],
    runs: &[Run],
    target: &Target,
    rules: &RasterRules,
    alpha_test: &impl AlphaTest,
    depth: &mut [f32],
) {
    check_target(target, depth.len());
    let chunks = scratch.bin(positions, triangles, runs, target, rules);
    let width = target.width as usize;
    depth.par_chunks_mut(width * TILE_SIZE).enumerate().for_each_init(DepthTile::<false>::default, |tile, (tile_y, band)| {
        for tile_x in 0..target.tiles_wide() {
            draw_tile(tile, chunks, target, tile_x, tile_y, rules, alpha_test);
            copy_tile(&tile.depth, band, width, tile_x, |depth| depth);
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
    scratch: &mut Scratch,
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
    let chunks = scratch.bin(positions, triangles, runs, target, rules);
    let width = target.width as usize;
    let bands = depth.par_chunks_mut(width * TILE_SIZE).zip(seen.par_chunks_mut(width * TILE_SIZE));
    bands.enumerate().for_each_init(VisibilityTile::default, |tile, (tile_y, (depth_band, seen_band))| {
        for tile_x in 0..target.tiles_wide() {
            draw_tile(tile, chunks, target, tile_x, tile_y, rules, alpha_test);
            copy_tile(&tile.depth, depth_band, width, tile_x, |depth| depth);
            copy_tile(&tile.triangle, seen_band, width, tile_x, |id| id as u32);
        }
    });
}

pub(super) fn check_target(target: &Target, len: usize) {
    assert_eq!(len, target.width as usize * target.height as usize, "the target's memory must fit its size");
    assert!(
        target.width.max(target.height) <= MAX_TARGET_SIZE,
        "{} x {} is larger than the rasteriser's limit of {MAX_TARGET_SIZE}",
        target.width,
        target.height
    );
}

/// Copies a tile to its place in a band of rows.
#[inline(always)]
fn copy_tile<T: Copy, U>(tile: &[T], band: &mut [U], width: usize, tile_x: usize, convert: impl Fn(T) -> U) {
    let left = tile_x * TILE_SIZE;
    let columns = TILE_SIZE.min(width - left);
    for (pixels, row) in band.chunks_exact_mut(width).zip(tile.chunks_exact(STRIDE)) {
        for (pixel, &value) in pixels[left..left + columns].iter_mut().zip(row) {
            *pixel = convert(value);
        }
    }
}

/// How many triangles one task sets up. A fixed number, so that the chunks do not depend on the threads.
const TRIANGLES_PER_CHUNK: u32 = 16_384;

/// Memory that passes work in. It is kept from pass to pass: memory that is new to a process costs more time than what is written into it.
#[derive(Debug, Default)]
pub struct Scratch {
    vertices: Transformed,
    chunks: Vec<Bins>,
}

impl Scratch {
    /// Transforms the vertices and bins the triangles; the chunks in order.
    pub(super) fn bin(
        &mut self,
        positions: &Positions,
        triangles: &[[u32; 3]],
        runs: &[Run],
        target: &Target,
        rules: &RasterRules,
    ) -> &[Bins] {
        let view = Viewpoint { rows: target.clip_rows, width: target.width, height: target.height };
        self.vertices.transform(positions, &view, rules);
        let pieces: Vec<Run> = runs
            .iter()
            .flat_map(|run| {
                run.triangles
                    .clone()
                    .step_by(TRIANGLES_PER_CHUNK as usize)
                    .map(|first| Run { triangles: first..run.triangles.end.min(first + TRIANGLES_PER_CHUNK), ..run.clone() })
            })
            .collect();
        if self.chunks.len() < pieces.len() {
            self.chunks.resize_with(pieces.len(), Bins::default);
        }
        let chunks = &mut self.chunks[..pieces.len()];
        let vertices = &self.vertices;
        pieces.into_par_iter().zip(chunks.par_iter_mut()).for_each(|(run, bins)| {
            bins.begin(target.tiles_wide(), target.tiles_high(), run.is_masked);
            let kernel = BinKernel { positions, vertices, triangles, run, view: &view, target, rules, bins };
            dispatch(rules.fused, kernel);
        });
        chunks
    }
}

struct BinKernel<'a> {
    positions: &'a Positions,
    vertices: &'a Transformed,
    triangles: &'a [[u32; 3]],
    run: Run,
    view: &'a Viewpoint,
    target: &'a Target,
    rules: &'a RasterRules,
    bins: &'a mut Bins,
}

impl Kernel for BinKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes, M: MultiplyAdd>(self) {
        let Self { positions, vertices, triangles, run, view, target, rules, bins } = self;
        let culling = run.culling;
        let extent = Extent { width: target.width, height: target.height };
        let mut waiting = Waiting::default();
        let ids = run.triangles;
        for first in ids.clone().step_by(LANES) {
            let count = (ids.end - first).min(LANES as u32) as usize;
            let here = &triangles[first as usize..first as usize + count];
            let mut corners = [here[0]; LANES];
            corners[..count].copy_from_slice(here);
            let look = look_at::<L>(vertices, &corners, culling, extent, rules);
            let mut left = (look.small | look.rest) & ((1 << count) - 1);
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let id = first + lane as u32;
                if look.small >> lane & 1 != 0 {
                    waiting.push(id, corners[lane]);
                    if waiting.count == LANES {
                        waiting.flush::<L>(vertices, extent, rules, bins);
                    }
                } else {
                    // What came before goes before it: triangles stay in order.
                    waiting.flush::<L>(vertices, extent, rules, bins);
                    let codes = corners[lane].map(|corner| vertices.grid(corner).outcode());
                    let codes = codes[0] | codes[1] | codes[2];
                    let in_clip_space = || {
                        corners[lane].map(|corner| {
                            let position = positions.get(corner);
                            view.clip(position.x, position.y, position.z)
                        })
                    };
                    let whole = match rules.depth_plane {
                        DepthPlaneRule::Unsnapped => None,
                        DepthPlaneRule::Snapped => Some(WholeTriangle::new::<M>(in_clip_space(), view, rules)),
                    };
                    let mut emit = |v0: WindowVertex, v1: WindowVertex, v2: WindowVertex| {
                        if let Some(triangle) = setup_large(id, [&v0, &v1, &v2], whole.as_ref(), culling, extent, rules) {
                            bins.push_large(triangle);
                        }
                    };
                    if codes == 0 {
                        let [v0, v1, v2] = corners[lane].map(|corner| vertices.vertex(corner));
                        emit(v0, v1, v2);
                    } else {
                        clip_triangle::<M>(in_clip_space(), codes, view, rules, emit);
                    }
                }
            }
        }
        waiting.flush::<L>(vertices, extent, rules, bins);
        bins.finish();
    }
}

/// Small triangles that wait until there are eight.
#[derive(Default)]
struct Waiting {
    count: usize,
    ids: [u32; LANES],
    corners: [[u32; 3]; LANES],
}

impl Waiting {
    #[inline(always)]
    fn push(&mut self, id: u32, corners: [u32; 3]) {
        self.ids[self.count] = id;
        self.corners[self.count] = corners;
        self.count += 1;
    }

    #[inline(always)]
    fn flush<L: Lanes>(&mut self, vertices: &Transformed, extent: Extent, rules: &RasterRules, bins: &mut Bins) {
        if self.count > 0 {
            // Lanes that nothing waits in hold triangles of earlier times, or the first one.
            let emit = |triangle| bins.push_small(triangle);
            setup_small::<L>(vertices, &self.ids, &self.corners, self.count, extent, rules, emit);
            self.count = 0;
        }
    }
}

pub(super) fn draw_tile<T: Tile, A: AlphaTest>(
    tile: &mut T,
    chunks: &[Bins],
    target: &Target,
    tile_x: usize,
    tile_y: usize,
    rules: &RasterRules,
    alpha_test: &A,
) {
    let index = tile_y * target.tiles_wide() + tile_x;
    let corner = Corner { left: tile_x * TILE_SIZE, top: tile_y * TILE_SIZE };
    match rules.depth_plane {
        DepthPlaneRule::Unsnapped => dispatch(rules.fused, TileKernel::<_, _, false> { tile, chunks, index, corner, alpha_test }),
        DepthPlaneRule::Snapped => dispatch(rules.fused, TileKernel::<_, _, true> { tile, chunks, index, corner, alpha_test }),
    }
}

/// `SNAPPED` is for [`DepthPlaneRule::Snapped`].
struct TileKernel<'a, T, A, const SNAPPED: bool> {
    tile: &'a mut T,
    chunks: &'a [Bins],
    index: usize,
    corner: Corner,
    alpha_test: &'a A,
}

impl<T: Tile, A: AlphaTest, const SNAPPED: bool> Kernel for TileKernel<'_, T, A, SNAPPED> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes, M: MultiplyAdd>(self) {
        let Self { tile, chunks, index, corner, alpha_test } = self;
        tile.clear();
        for chunk in chunks {
            if chunk.is_masked {
                for triangle in chunk.of_tile(index) {
                    let part = match triangle {
                        Binned::Small(triangle) => Part::of_small(triangle, corner),
                        Binned::Large(triangle) => Part::of_large(triangle, corner),
                    };
                    draw_masked::<L, M, T, SNAPPED>(tile, corner, &part, alpha_test);
                }
            } else {
                for triangle in chunk.of_tile(index) {
                    match triangle {
                        Binned::Small(triangle) => draw_small::<L, M, T, SNAPPED>(tile, corner, triangle),
                        Binned::Large(triangle) => draw_large::<L, M, T, SNAPPED>(tile, corner, triangle),
                    }
                }
            }
        }
    }
}
