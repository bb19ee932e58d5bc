//! Any triangles under any matrix: no panic, depths from 0 to 1, and every pixel has the nearest of what each triangle alone has there.

#![no_main]
#![forbid(unsafe_code)]

#[path = "shared/number.rs"]
mod number;

use arbitrary::Arbitrary;
use glam::Vec3;
use libfuzzer_sys::fuzz_target;
use shadow_cpu::raster::{
    AlphaTest, ClipRule, Culling, DepthPlaneRule, MAX_TARGET_SIZE, Positions, RasterRules, Run, Scratch, SnapRule, Target,
    rasterize_depth, rasterize_visibility,
};
use shadow_scene::NO_TRIANGLE;

use crate::number::{Number, Vector};

/// The most triangles of an input: several vectors of small ones with large ones in between.
const MAX_TRIANGLES: usize = 40;

/// The largest side of most targets, in pixels: more than a tile, so that triangles lie in several.
const MAX_SIDE: u32 = 150;

#[derive(Arbitrary, Debug)]
struct Input {
    matrix: Matrix,
    size: Size,
    positions: Vec<Vector>,
    triangles: Vec<[u8; 3]>,
    /// Where the second run begins.
    split: u8,
    culls: [Option<bool>; 2],
    is_masked: [bool; 2],
    alpha: u32,
    subpixel_bits: u8,
    is_snapped_at_once: bool,
    is_snapped: bool,
    clip: u8,
    is_fused: bool,
}

#[derive(Arbitrary, Debug)]
enum Matrix {
    /// Clip space is the world with w = 1.
    Flat,
    /// A perspective view along +z from the origin, with reversed depth and without a far plane.
    Reversed {
        near: Number,
    },
    /// A perspective view along +z from the origin.
    Perspective {
        near: Number,
        far: Number,
    },
    Any([[Number; 4]; 4]),
}

#[derive(Arbitrary, Debug)]
enum Size {
    Small { width: u8, height: u8 },
    Wide { height: bool },
    High { width: bool },
}

/// Holes that depend on nothing but the triangle and the pixel.
struct Holes(u32);

impl AlphaTest for Holes {
    fn passes(&self, triangle: u32, x: u32, y: u32) -> bool {
        let mixed = (self.0 ^ triangle.wrapping_mul(0x9e37_79b9) ^ (x << 16 | y)).wrapping_mul(0x85eb_ca6b);
        mixed >> 30 != 0
    }
}

fn clip_rows(matrix: &Matrix) -> [[f32; 4]; 4] {
    let (depth_scale, depth_offset) = match matrix {
        Matrix::Flat => return core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 })),
        Matrix::Any(rows) => return rows.map(|row| row.map(Number::f32)),
        Matrix::Reversed { near } => (0.0, near.f32()),
        Matrix::Perspective { near, far } => {
            let (near, far) = (near.f32(), far.f32());
            (far / (far - near), -far * near / (far - near))
        }
    };
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, depth_scale, depth_offset], [0.0, 0.0, 1.0, 0.0]]
}

fn size(size: &Size) -> (u32, u32) {
    match *size {
        Size::Small { width, height } => (1 + u32::from(width) % MAX_SIDE, 1 + u32::from(height) % MAX_SIDE),
        Size::Wide { height } => (MAX_TARGET_SIZE, 1 + u32::from(height)),
        Size::High { width } => (1 + u32::from(width), MAX_TARGET_SIZE),
    }
}

/// The same triangles, drawn in both ways.
struct Scene<'a> {
    positions: Positions,
    triangles: &'a [[u32; 3]],
    target: Target,
    rules: RasterRules,
    holes: Holes,
    scratch: Scratch,
}

impl Scene<'_> {
    fn depth(&mut self, runs: &[Run]) -> Vec<f32> {
        let mut depth = vec![f32::NAN; (self.target.width * self.target.height) as usize];
        let Self { positions, triangles, target, rules, holes, scratch } = self;
        rasterize_depth(scratch, positions, triangles, runs, target, rules, holes, &mut depth);
        depth
    }

    fn visibility(&mut self, runs: &[Run]) -> (Vec<f32>, Vec<u32>) {
        let mut depth = vec![f32::NAN; (self.target.width * self.target.height) as usize];
        let mut seen = vec![0; depth.len()];
        let Self { positions, triangles, target, rules, holes, scratch } = self;
        rasterize_visibility(scratch, positions, triangles, runs, target, rules, holes, &mut depth, &mut seen);
        (depth, seen)
    }
}

/// Whether a vertex lies inside the clip volume, so that no triangle is clipped because of it.
fn is_inside(scene: &Scene<'_>, position: Vec3) -> bool {
    let [x, y, z, w] = scene.target.clip_rows.map(|row| row[0] * position.x + row[1] * position.y + row[2] * position.z + row[3]);
    let side = match scene.rules.clip {
        ClipRule::Viewport => w,
        ClipRule::GuardBand => ClipRule::GUARD_BAND * w,
    };
    x.abs() <= side && y.abs() <= side && (0.0..=w).contains(&z)
}

fuzz_target!(|input: Input| {
    if input.positions.is_empty() {
        return;
    }
    let positions: Vec<Vec3> = input.positions.iter().map(|position| position.vec3()).collect();
    let corner = |corner: u8| u32::from(corner) % positions.len() as u32;
    let triangles: Vec<[u32; 3]> = input.triangles.iter().take(MAX_TRIANGLES).map(|corners| corners.map(corner)).collect();
    let count = triangles.len() as u32;
    let split = u32::from(input.split).min(count);
    let run = |range: core::ops::Range<u32>, which: usize| Run {
        triangles: range,
        culling: match input.culls[which] {
            None => Culling::None,
            Some(false) => Culling::Back,
            Some(true) => Culling::Front,
        },
        is_masked: input.is_masked[which],
    };
    let (width, height) = size(&input.size);
    let mut scene = Scene {
        positions: Positions::new(&positions),
        triangles: &triangles,
        target: Target { clip_rows: clip_rows(&input.matrix), width, height },
        rules: RasterRules {
            subpixel_bits: 4 + u32::from(input.subpixel_bits) % 5,
            snap: if input.is_snapped_at_once { SnapRule::AtOnce } else { SnapRule::FromPixels },
            depth_plane: if input.is_snapped { DepthPlaneRule::Snapped } else { DepthPlaneRule::Unsnapped },
            clip: [ClipRule::Viewport, ClipRule::NearFirst, ClipRule::GuardBand][usize::from(input.clip) % 3],
            fused: input.is_fused,
        },
        holes: Holes(input.alpha),
        scratch: Scratch::default(),
    };

    let runs = [run(0..split, 0), run(split..count, 1)];
    let depth = scene.depth(&runs);
    let (reversed, seen) = scene.visibility(&runs);
    assert!(depth.iter().chain(&reversed).all(|depth| (0.0..=1.0).contains(depth)), "a depth beyond 0 and 1");

    let mut nearest = vec![1.0_f32; depth.len()];
    let mut nearest_reversed = vec![0.0_f32; depth.len()];
    let mut nearest_seen = vec![NO_TRIANGLE; depth.len()];
    for id in 0..count {
        let alone = [run(id..id + 1, usize::from(id >= split))];
        let depth = scene.depth(&alone);
        let (reversed, seen) = scene.visibility(&alone);
        let is_whole = triangles[id as usize].iter().all(|&corner| is_inside(&scene, positions[corner as usize]));
        for pixel in 0..depth.len() {
            let (depth, reversed) = (depth[pixel], reversed[pixel]);
            // Both passes take the same samples. What lies on the near plane of one is nothing to the other. Where a triangle is clipped, its
            // pieces can overlap by a sample; a map then has the depth of the one and the camera that of the other.
            let is_same =
                if reversed == 0.0 { depth == 0.0 || depth == 1.0 } else { depth == reversed || (!is_whole && depth < reversed) };
            assert!(is_same, "triangle {id} at pixel {pixel} has depth {depth} in a map and {reversed} to the camera");
            assert_eq!(seen[pixel] == NO_TRIANGLE, reversed == 0.0, "triangle {id} at pixel {pixel}");
            nearest[pixel] = nearest[pixel].min(depth);
            if reversed > nearest_reversed[pixel] {
                nearest_reversed[pixel] = reversed;
                nearest_seen[pixel] = id;
            }
        }
    }
    for pixel in 0..depth.len() {
        // A map has the smallest of the triangles' depths. The camera sees the largest, and of triangles at the same depth the one with
        // the lowest index.
        assert_eq!(depth[pixel], nearest[pixel], "a map's pixel {pixel}");
        let (found, expected) = ((reversed[pixel], seen[pixel]), (nearest_reversed[pixel], nearest_seen[pixel]));
        assert_eq!(found, expected, "the camera's pixel {pixel}");
    }
});
