//! Real files: compressed ones against their uncompressed twins, and scenes in which there is nothing to draw.

use std::collections::HashMap;

use glam::{DVec3, IVec3, Vec3};
use serde_json::Value;
use shadow_math::ShadowSettings;
use shadow_scene::{
    FramePlan, ImportOptions, LayerName, NO_TRIANGLE, Pixels, Request, Scene, SceneBuilder, import, import::import_slice_with,
};
use shadow_tests::renderers::{self, scenes};

fn corners(scene: &Scene, triangle: usize) -> [Vec3; 3] {
    scene.triangles()[triangle].map(|vertex| scene.vertices().positions[vertex as usize])
}

/// The middles of the triangles of a scene, by the cell of a grid that they lie in.
struct Middles {
    cell: f32,
    cells: HashMap<IVec3, Vec<Vec3>>,
}

impl Middles {
    fn new(scene: &Scene, cell: f32) -> Self {
        let mut cells = HashMap::<_, Vec<_>>::new();
        for triangle in 0..scene.triangles().len() {
            let middle = corners(scene, triangle).into_iter().sum::<Vec3>() / 3.0;
            cells.entry((middle / cell).floor().as_ivec3()).or_default().push(middle);
        }
        Self { cell, cells }
    }

    /// Whether there is one within a cell's size of a point.
    fn has(&self, point: Vec3) -> bool {
        let center = (point / self.cell).floor().as_ivec3();
        let offsets = (0..27).map(|i| IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        let near = offsets.filter_map(|offset| self.cells.get(&(center + offset))).flatten();
        near.into_iter().any(|middle| middle.distance(point) <= self.cell)
    }
}

/// Asserts that two scenes are of the same triangles, in whatever order, to within `tolerance` metres.
fn assert_same_triangles(name: &str, a: &Scene, b: &Scene, tolerance: f32) {
    assert_eq!(a.triangles().len(), b.triangles().len(), "{name}");
    for (from, to) in [(a, b), (b, a)] {
        let middles = Middles::new(to, tolerance);
        for triangle in 0..from.triangles().len() {
            let middle = corners(from, triangle).into_iter().sum::<Vec3>() / 3.0;
            assert!(middles.has(middle), "{name}: there is no triangle at {middle}");
        }
    }
}

#[test]
fn compressed_files_are_what_their_twins_are() {
    let Some(folder) = scenes("compressed_files_are_what_their_twins_are") else { return };
    // The tolerance is the compressor's step: a millimetre for the garden, whose positions were kept to 15 bits of 11 m and
    // reordered; 2^-10 m for the box of Draco, which has 11 bits.
    for (compressed, twin, tolerance) in [
        ("bridge_garden/bridge_garden_meshopt_specgloss.glb", "bridge_garden/bridge_garden.glb", 1e-3),
        ("features/Box/BoxDraco.gltf", "features/Box/Box.glb", 1.0 / 1024.0),
        ("features/BoxMeshopt/BoxMeshopt.glb", "features/Box/Box.glb", 1.0 / 1024.0),
    ] {
        let [a, b] = [compressed, twin].map(|file| import(&folder.join(file)).unwrap_or_else(|error| panic!("{error}")));
        assert_same_triangles(compressed, &a, &b, tolerance);
        // Of every triangle the normals of its corners face to the front.
        for triangle in 0..a.triangles().len() {
            let [p, q, r] = corners(&a, triangle);
            let front = (q - p).cross(r - p);
            let normals: Vec3 = a.triangles()[triangle].iter().map(|&v| a.vertices().normals[v as usize]).sum();
            let is_sliver = front.length() < 1e-6;
            assert!(is_sliver || compressed.contains("garden") || normals.dot(front) > 0.0, "{compressed}: triangle {triangle}");
        }
        let color = |scene: &Scene| scene.materials().first().map(|material| material.base_color);
        assert_eq!(color(&a), color(&b), "{compressed}");
    }
}

/// No damage to a Draco stream does more than end in an error, or in another box.
#[test]
fn damaged_draco_streams_do_no_harm() {
    let Some(folder) = scenes("damaged_draco_streams_do_no_harm") else { return };
    let folder = folder.join("features/Box");
    let text = std::fs::read_to_string(folder.join("BoxDraco.gltf")).expect("the box can be read");
    let stream = std::fs::read(folder.join("Box.bin")).expect("its stream can be read");
    let import = |stream: &[u8]| {
        let mut json: Value = serde_json::from_str(&text).expect("the box is JSON");
        let encoded: String = stream.iter().map(|byte| format!("%{byte:02x}")).collect();
        json["buffers"][0]["uri"] = format!("data:,{encoded}").into();
        let length = json["bufferViews"][0]["byteLength"].as_u64().expect("a length").min(stream.len() as u64);
        json["buffers"][0]["byteLength"] = stream.len().into();
        json["bufferViews"][0]["byteLength"] = length.into();
        let options = ImportOptions { memory_limit: 1 << 26, ..ImportOptions::default() };
        import_slice_with("box", json.to_string().as_bytes(), &options)
    };
    assert_eq!(import(&stream).expect("the box itself is sound").triangles().len(), 12);
    let mut refused = 0;
    for i in 0..stream.len() {
        for damage in [0x01, 0x10, 0x80, 0xff] {
            let mut damaged = stream.clone();
            damaged[i] ^= damage;
            refused += usize::from(import(&damaged).is_err());
        }
        refused += usize::from(i > 0 && import(&stream[..i]).is_err());
    }
    assert!(refused > stream.len(), "only {refused} of the damaged streams are refused");
}

/// A scene of points or lines has no triangles, and is a picture of the background on both renderers.
#[test]
fn a_scene_without_triangles_is_an_empty_picture() {
    let scene = SceneBuilder::new(DVec3::ZERO).build().expect("a scene may be empty");
    let camera = scene.cameras()[0].camera;
    let settings = ShadowSettings { map_size: 64, ..ShadowSettings::default() };
    let plan = FramePlan::new(&scene, &camera, &settings, 33, 17, None).expect("an empty scene can be planned");
    let prepared = renderers::counterpart().prepare(&scene);
    let cpu = renderers::counterpart().render(&prepared, &plan, Request::ALL).expect("the CPU renders nothing").frame;
    let gpu = renderers::gpu();
    let gpu = pollster::block_on(async {
        let uploaded = gpu.upload(&scene).await.expect("the GPU takes nothing");
        gpu.render(&uploaded, &plan, Request::ALL).await.expect("the GPU renders nothing").frame
    });
    for frame in [&cpu, &gpu] {
        let triangles = frame.layer(LayerName::Triangle).expect("the layer was asked for");
        let Pixels::Id(triangles) = &triangles.pixels else { panic!("triangles are numbers") };
        assert!(triangles.iter().all(|&triangle| triangle == NO_TRIANGLE));
    }
    for (a, b) in cpu.layers.iter().zip(&gpu.layers) {
        assert!(a.name == b.name && a.pixels == b.pixels, "{} differs", a.name);
    }
}

/// Rounding to single precision, of a vertex and of the node's matrix in three.js (which keeps instances' in it too): 2^-20 of the largest coordinate is eight
/// times what one rounding leaves.
const BOUNDS_TOLERANCE: f64 = 1.0 / (1 << 20) as f64;

/// The truth takes its triangles from the same importer as the renderers, and so cannot tell when that is wrong. three.js shares no code with either:
/// `data/bounds.json` was written by `data/bounds.mjs` with three.js 0.187.0.
#[test]
fn scenes_have_the_triangles_and_bounds_that_three_js_gives_them() {
    let Some(folder) = scenes("scenes_have_the_triangles_and_bounds_that_three_js_gives_them") else { return };
    let text = include_str!("../data/bounds.json");
    let expected: Value = serde_json::from_str(text).expect("the bounds are JSON");
    let expected = expected.as_object().expect("an object of files");
    assert!(expected.len() > 100, "{} files", expected.len());
    let mut failures = Vec::new();
    for (file, facts) in expected {
        let scene = match import(&folder.join(file)) {
            Ok(scene) => scene,
            Err(error) => {
                failures.push(format!("{file}: {error}"));
                continue;
            }
        };
        let triangles = scene.triangles().len() as u64;
        if facts["triangles"].as_u64() != Some(triangles) {
            failures.push(format!("{file}: {triangles} triangles instead of {}", facts["triangles"]));
        }
        let corner = |name: &str| {
            let numbers: Vec<f64> = facts[name].as_array().expect("three numbers").iter().filter_map(Value::as_f64).collect();
            DVec3::from_slice(&numbers)
        };
        let (min, max) = (corner("min"), corner("max"));
        let tolerance = BOUNDS_TOLERANCE * min.abs().max(max.abs()).max_element();
        let bounds = scene.bounds();
        let (ours_min, ours_max) = (scene.origin() + bounds.min.as_dvec3(), scene.origin() + bounds.max.as_dvec3());
        let off = (ours_min - min).abs().max((ours_max - max).abs()).max_element();
        if !(off <= tolerance) {
            failures.push(format!("{file}: from {ours_min} to {ours_max} instead of from {min} to {max}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
