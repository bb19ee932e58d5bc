//! The rasteriser alone: coverage without gaps or overlaps, whatever the triangles and the rules.

use glam::Vec3;
use proptest::prelude::*;
use shadow_cpu::raster::{
    ClipRule, Culling, DepthPlaneRule, NoAlphaTest, Positions, RasterRules, Run, Scratch, SnapRule, Target, rasterize_depth,
};

/// A target whose clip space is the world's x, y, z with w = 1.
fn flat(width: u32, height: u32) -> Target {
    let row = |i: usize| core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 });
    Target { clip_rows: core::array::from_fn(row), width, height }
}

fn covered(positions: &[Vec3], triangles: &[[u32; 3]], target: &Target, rules: &RasterRules) -> Vec<f32> {
    culled(positions, triangles, target, rules, Culling::None)
}

fn culled(positions: &[Vec3], triangles: &[[u32; 3]], target: &Target, rules: &RasterRules, culling: Culling) -> Vec<f32> {
    let run = Run { triangles: 0..triangles.len() as u32, culling, is_masked: false };
    let mut depth = vec![0.0; (target.width * target.height) as usize];
    rasterize_depth(
        &mut Scratch::default(),
        &Positions::new(positions),
        triangles,
        &[run],
        target,
        rules,
        &NoAlphaTest,
        &mut depth,
    );
    depth
}

fn rules() -> impl Strategy<Value = RasterRules> {
    let clip = prop::sample::select(vec![ClipRule::Viewport, ClipRule::NearFirst, ClipRule::GuardBand]);
    let plane = prop::sample::select(vec![DepthPlaneRule::Unsnapped, DepthPlaneRule::Snapped]);
    let snap = prop::sample::select(vec![SnapRule::FromPixels, SnapRule::AtOnce]);
    (4..=8_u32, snap, plane, clip, any::<bool>()).prop_map(|(subpixel_bits, snap, depth_plane, clip, fused)| RasterRules {
        subpixel_bits,
        snap,
        depth_plane,
        clip,
        fused,
    })
}

proptest! {
    /// Every triangle is a front face or a back face and never both: what either culling leaves is, together, what none leaves. Turned around, it is the other.
    #[test]
    fn each_triangle_faces_one_way(
        corners in prop::array::uniform9(-1.2..1.2_f32),
        size in (1..150_u32, 1..150_u32),
        rules in rules(),
    ) {
        let target = flat(size.0, size.1);
        let positions: Vec<Vec3> = corners.chunks_exact(3).map(|xyz| Vec3::new(xyz[0], xyz[1], 0.5 + 0.3 * xyz[2])).collect();
        let drawn = |triangle, culling| culled(&positions, &[triangle], &target, &rules, culling);
        let [all, fronts, backs] = [Culling::None, Culling::Back, Culling::Front].map(|culling| drawn([0, 1, 2], culling));
        let nothing = vec![1.0; all.len()];
        prop_assert!(fronts == nothing || backs == nothing);
        let together: Vec<f32> = fronts.iter().zip(&backs).map(|(&front, &back)| f32::min(front, back)).collect();
        prop_assert_eq!(&together, &all);
        let is_covered = |depths: &[f32]| depths.iter().map(|&depth| depth < 1.0).collect::<Vec<_>>();
        prop_assert_eq!(is_covered(&drawn([0, 2, 1], Culling::Front)), is_covered(&fronts));
    }

    /// A fan of triangles that share a vertex covers every pixel of the square around it exactly once: the top-left rule.
    #[test]
    fn shared_edges_are_covered_once(
        center in prop::array::uniform2(-0.9..0.9_f32),
        size in (1..150_u32, 1..150_u32),
        rules in rules(),
    ) {
        let target = flat(size.0, size.1);
        let z = 0.25;
        let rim = [(-1.0, -1.0), (0.1, -1.0), (1.0, -1.0), (1.0, 0.3), (1.0, 1.0), (-0.2, 1.0), (-1.0, 1.0), (-1.0, -0.4)];
        let mut positions = vec![Vec3::new(center[0], center[1], z)];
        positions.extend(rim.map(|(x, y)| Vec3::new(x, y, z)));
        let mut times = vec![0; (size.0 * size.1) as usize];
        for i in 0..8 {
            let triangle = [0, 1 + i, 1 + (i + 1) % 8];
            for (times, depth) in times.iter_mut().zip(covered(&positions, &[triangle], &target, &rules)) {
                *times += i32::from(depth < 1.0);
            }
        }
        prop_assert!(times.iter().all(|&times| times == 1), "{:?}", times.iter().max());
    }

    /// Each pixel has the nearest of the depths that the triangles have alone: what is skipped as hidden is hidden.
    #[test]
    fn nothing_but_what_is_hidden_is_left_out(
        corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-1.5..1.5_f32)), 1..12),
        size in (1..150_u32, 1..150_u32),
        rules in rules(),
    ) {
        let target = flat(size.0, size.1);
        // Half of the corners lie on the near plane, where depths are equal.
        let depth = |z: f32| (z / 3.0).max(0.0);
        let positions: Vec<Vec3> = corners.as_flattened().iter().map(|&[x, y, z]| Vec3::new(x, y, depth(z))).collect();
        let triangles: Vec<[u32; 3]> = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut nearest = vec![1.0_f32; (size.0 * size.1) as usize];
        for &triangle in &triangles {
            for (nearest, depth) in nearest.iter_mut().zip(covered(&positions, &[triangle], &target, &rules)) {
                *nearest = nearest.min(depth);
            }
        }
        prop_assert_eq!(covered(&positions, &triangles, &target, &rules), nearest);
    }

    /// A square of cells that are hardly larger than a pixel, or much smaller, beyond all sides of the target: every pixel is covered once.
    #[test]
    fn fine_meshes_cover_every_pixel_once(
        cells in (20..60_usize, 20..60_usize),
        size in (8..60_u32, 8..60_u32),
        shear in -0.3..0.3_f32,
        rules in rules(),
    ) {
        let target = flat(size.0, size.1);
        let corner = |i: usize, j: usize| {
            let (u, v) = (i as f32 / cells.0 as f32, j as f32 / cells.1 as f32);
            Vec3::new(3.0 * u - 1.5 + shear * (v - 0.5), 3.0 * v - 1.5 + shear * (u - 0.5), 0.5)
        };
        let positions: Vec<Vec3> = (0..=cells.1).flat_map(|j| (0..=cells.0).map(move |i| corner(i, j))).collect();
        let index = |i: usize, j: usize| (j * (cells.0 + 1) + i) as u32;
        let mut times = vec![0; (size.0 * size.1) as usize];
        // Triangles of one half of all cells meet in corners alone: four sets, in each of which a sample can be covered once at most.
        for half in 0..2 {
            for parity in 0..2 {
                let mut triangles = Vec::new();
                for j in 0..cells.1 {
                    for i in (0..cells.0).filter(|i| (i + j) % 2 == parity) {
                        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i, j + 1), index(i + 1, j + 1)];
                        triangles.push(if half == 0 { [a, b, c] } else { [b, d, c] });
                    }
                }
                for (times, depth) in times.iter_mut().zip(covered(&positions, &triangles, &target, &rules)) {
                    *times += u32::from(depth < 1.0);
                }
            }
        }
        prop_assert!(times.iter().all(|&times| times == 1), "{:?}", times);
    }

    /// Clipping changes where a triangle ends, never what it covers inside: a large one covers the pixels that its edges enclose.
    #[test]
    fn a_triangle_beyond_the_view_covers_what_its_edges_enclose(
        corners in prop::array::uniform6(-6.0..6.0_f32),
        rules in rules(),
    ) {
        let target = flat(61, 43);
        let corner = |i: usize| Vec3::new(corners[2 * i], corners[2 * i + 1], 0.5);
        let positions = [corner(0), corner(1), corner(2)];
        let depths = covered(&positions, &[[0, 1, 2]], &target, &rules);
        for (i, depth) in depths.iter().enumerate() {
            let center = Vec3::new(
                ((i % 61) as f32 + 0.5) / 30.5 - 1.0,
                1.0 - ((i / 61) as f32 + 0.5) / 21.5,
                0.5,
            );
            // Signed distances from the edges, in units of the view's half size.
            let distances: Vec<f32> = (0..3)
                .map(|i| {
                    let edge = positions[(i + 1) % 3] - positions[i];
                    edge.cross(center - positions[i]).z / edge.length().max(1e-6)
                })
                .collect();
            let (least, most) = distances.iter().fold((f32::MAX, f32::MIN), |(a, b), &d| (a.min(d), b.max(d)));
            // A step of the coarsest grid, 1/16 pixel of 43, in the same units; clipping moves an edge by as much again.
            let step = 2.0 * 2.0 / 16.0 / 43.0;
            if least > step || most < -step {
                prop_assert!(*depth < 1.0, "pixel {i} is inside by {least} or {most}");
            } else if least < -step && most > step {
                prop_assert!(*depth == 1.0, "pixel {i} is outside: {least} to {most}");
            }
        }
    }
}

/// The depth of a tilted plane is what its equation says at every pixel centre.
#[test]
fn depth_is_the_planes() {
    let target = flat(200, 100);
    let plane = |x: f32, y: f32| 0.5 + 0.2 * x - 0.15 * y;
    let corner = |x: f32, y: f32| Vec3::new(x, y, plane(x, y));
    let positions = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let depths = covered(&positions, &[[0, 1, 2], [0, 2, 3]], &target, &RasterRules::default());
    for (i, depth) in depths.iter().enumerate() {
        let (x, y) = (((i % 200) as f32 + 0.5) / 100.0 - 1.0, 1.0 - ((i / 200) as f32 + 0.5) / 50.0);
        // A dozen roundings of numbers up to 1.
        assert!((depth - plane(x, y)).abs() < 1e-6, "pixel {i}: {depth} instead of {}", plane(x, y));
    }
}

#[test]
fn what_lies_behind_the_eye_or_is_no_number_covers_nothing() {
    let target = Target {
        // w = z: a perspective view along +z.
        clip_rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.5, 0.0], [0.0, 0.0, 1.0, 0.0]],
        width: 32,
        height: 32,
    };
    let behind = [Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, -1.0, -1.0), Vec3::new(0.0, 1.0, -2.0)];
    let huge = [Vec3::new(3e38, -1.0, 1.0), Vec3::new(1.0, -3e38, 1.0), Vec3::new(0.0, 1.0, 3e38)];
    for positions in [behind, huge] {
        let _ = covered(&positions, &[[0, 1, 2]], &target, &RasterRules::default());
    }
    assert!(covered(&behind, &[[0, 1, 2]], &target, &RasterRules::default()).iter().all(|&depth| depth == 1.0));
    let crossing = [Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, -1.0, 3.0), Vec3::new(0.0, 1.0, 3.0)];
    let depths = covered(&crossing, &[[0, 1, 2]], &target, &RasterRules::default());
    assert!(depths.iter().any(|&depth| depth < 1.0) && depths.iter().all(|depth| (0.0..=1.0).contains(depth)));
}

/// A point whose w is 0 or subnormal has no place in the window.
#[test]
fn a_triangle_with_a_vertex_in_the_eye_covers_nothing_here() {
    let target = Target {
        // w = z, and depth is 0 everywhere.
        clip_rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0; 4], [0.0, 0.0, 1.0, 0.0]],
        width: 10,
        height: 1,
    };
    let tiny = f32::from_bits(1);
    let step = -9.536_743e-7;
    let behind = [Vec3::new(0.0, step, step), Vec3::new(1e-38, step, step)];
    let before = Vec3::new(0.75, 0.0, 26.5);
    let rules = RasterRules { clip: ClipRule::GuardBand, ..RasterRules::default() };
    for at_eye in [Vec3::ZERO, Vec3::new(tiny, 1e-38, 0.0), Vec3::splat(tiny), Vec3::new(-tiny, tiny, 2.0 * tiny)] {
        for positions in [[at_eye, behind[0], before], [behind[0], behind[1], at_eye], [at_eye, at_eye * 2.0, behind[1]]] {
            let depths = covered(&positions, &[[0, 1, 2]], &target, &rules);
            assert!(depths.iter().all(|&depth| depth == 1.0), "{positions:?} cover {depths:?}");
        }
    }
}

/// A point whose clip coordinates are infinite lies inside every plane by comparison, and has no place in the window either.
#[test]
fn a_triangle_with_an_infinite_vertex_covers_nothing_here() {
    let rows = [[2.0, 2.0, 2.0, 0.0], [2.0, 2.0, 2.0, 0.0], [1.0, 1.0, 1.0, 0.0], [2.0, 2.0, 2.0, 1.0]];
    let target = Target { clip_rows: rows, width: 64, height: 64 };
    let (near, middle) = (Vec3::new(0.1, 0.0, 0.0), Vec3::new(0.0, 0.2, 0.1));
    let rules =
        [RasterRules::default(), RasterRules { clip: ClipRule::GuardBand, ..RasterRules::default() }, RasterRules::SWIFTSHADER];
    for rules in rules {
        for far in [Vec3::X * 3e38, Vec3::Y * 1.6e38, Vec3::Z * 1e37] {
            for positions in [[far, near, middle], [far, middle, far], [far, far * 0.5, near]] {
                let depths = covered(&positions, &[[0, 1, 2]], &target, &rules);
                assert!(depths.iter().all(|&depth| depth == 1.0), "{positions:?}");
            }
        }
    }
}

/// The largest coordinates that the rules allow: overflow checks are on where this runs unoptimised.
#[test]
fn the_largest_triangles_stay_within_32_bits() {
    let far = ClipRule::GUARD_BAND;
    let corner = |x: f32, y: f32| Vec3::new(x * far, y * far, 0.5);
    let positions = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0), corner(-0.9, 0.99)];
    let rules = RasterRules { clip: ClipRule::GuardBand, ..RasterRules::default() };
    for (width, height) in [(16_384, 70), (70, 16_384)] {
        let target = flat(width, height);
        let depths = covered(&positions, &[[0, 1, 2], [0, 2, 3], [1, 3, 4]], &target, &rules);
        assert!(depths.iter().all(|&depth| depth == 0.5), "the square covers all of {width} x {height}");
    }
}
