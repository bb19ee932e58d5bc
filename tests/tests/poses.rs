//! Poses of animated and skinned files against those of three.js, node by node and vertex by vertex.
//!
//! `data/poses.json` was written by `data/poses.mjs` with three.js 0.187.0, which shares no code with the importer.

use std::{path::Path, sync::OnceLock};

use glam::{DAffine3, DMat3, DVec3};
use serde_json::Value;
use shadow_scene::{Choice, ImportOptions, import::node_poses, import_with};
use shadow_tests::renderers::scenes;

/// three.js rounds every interpolated number to single precision, 2^-24 of it. The place of a joint is a sum over its
/// parents, at most 16 of them in these files, and each part of it turns with all rotations above it: 2^-19 of the size of the
/// model leaves twice that sum.
const RELATIVE_TOLERANCE: f64 = 1.0 / (1 << 19) as f64;

fn expected() -> &'static [Value] {
    static EXPECTED: OnceLock<Vec<Value>> = OnceLock::new();
    EXPECTED.get_or_init(|| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/poses.json");
        let text = std::fs::read_to_string(file).expect("the poses are in the repository");
        serde_json::from_str(&text).expect("the poses are JSON")
    })
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let numbers: Vec<f64> = value.as_array().expect("a list").iter().filter_map(Value::as_f64).collect();
    numbers.try_into().expect("a list of the right length")
}

fn options(case: &Value) -> ImportOptions {
    let animation = case["animation"].as_u64().expect("a number") as usize;
    let time = case["time"].as_f64().expect("a time");
    ImportOptions { animation: Some(Choice::Index(animation)), time, ..ImportOptions::default() }
}

/// The largest coordinate of anything in a case, in metres, and at least 1 for what only turns.
fn size(case: &Value) -> f64 {
    let nodes = case["nodes"].as_object().expect("the nodes").values().map(numbers::<12>);
    let vertices = case["vertices"].as_array().expect("the vertices").iter().map(numbers::<4>);
    let largest = nodes.flatten().fold(1.0, |largest: f64, number| largest.max(number.abs()));
    vertices.flat_map(|[_, x, y, z]| [x, y, z]).fold(largest, |largest, number| largest.max(number.abs()))
}

#[test]
fn every_node_stands_where_three_js_puts_it() {
    let Some(folder) = scenes("every_node_stands_where_three_js_puts_it") else { return };
    let mut compared = 0;
    for case in expected() {
        let name = format!("{} of {}, {} s", case["animation"], case["file"], case["time"]);
        let file = folder.join(case["file"].as_str().expect("a file"));
        let nodes = node_poses(&file, &options(case)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let tolerance = RELATIVE_TOLERANCE * size(case);
        for (index, matrix) in case["nodes"].as_object().expect("the nodes") {
            let node = &nodes[index.parse::<usize>().expect("a number")];
            let [xx, xy, xz, yx, yy, yz, zx, zy, zz, tx, ty, tz] = numbers::<12>(matrix);
            let wanted = DAffine3 {
                matrix3: DMat3::from_cols_array(&[xx, xy, xz, yx, yy, yz, zx, zy, zz]),
                translation: DVec3::new(tx, ty, tz),
            };
            let found = node.world_from_node.unwrap_or_else(|| panic!("{name}: node {index} has no place"));
            assert!(
                found.abs_diff_eq(wanted, tolerance),
                "animation {name}: node {index} `{}` is {found}, not {wanted}",
                node.name
            );
            compared += 1;
        }
    }
    assert!(compared > 500, "only {compared} nodes were compared");
}

#[test]
fn skinned_and_morphed_vertices_lie_where_three_js_puts_them() {
    let Some(folder) = scenes("skinned_and_morphed_vertices_lie_where_three_js_puts_them") else { return };
    let mut compared = 0;
    for case in expected() {
        let vertices = case["vertices"].as_array().expect("the vertices");
        if vertices.is_empty() {
            continue;
        }
        let name = format!("{} of {}, {} s", case["animation"], case["file"], case["time"]);
        let file = folder.join(case["file"].as_str().expect("a file"));
        let scene = import_with(&file, &options(case)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let positions: Vec<DVec3> =
            scene.vertices().positions.iter().map(|position| position.as_dvec3() + scene.origin()).collect();
        // The scene's own rounding to single precision comes on top.
        let tolerance = 2.0 * RELATIVE_TOLERANCE * size(case);
        for [index, x, y, z] in vertices.iter().map(numbers::<4>) {
            let wanted = DVec3::new(x, y, z);
            // Where every vertex of the file is one of the scene they are in the same order; else it must be among them.
            let is_close = |position: &DVec3| position.abs_diff_eq(wanted, tolerance);
            let found = if case["count"] == positions.len() {
                is_close(&positions[index as usize])
            } else {
                positions.iter().any(is_close)
            };
            assert!(found, "animation {name}: vertex {index} is not at {wanted}");
            compared += 1;
        }
    }
    assert!(compared > 120, "only {compared} vertices were compared");
}
