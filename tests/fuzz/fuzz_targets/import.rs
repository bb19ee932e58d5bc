//! Any bytes as a glTF file: the import ends with a scene whose frame can be planned or with an error, within its memory.
//!
//! The mutator takes files apart, so that inputs differ in what they say and not only in that they are no JSON any more.

#![no_main]
#![forbid(unsafe_code)]

#[path = "shared/finite.rs"]
mod finite;
#[path = "shared/glb.rs"]
mod glb;
#[path = "shared/random.rs"]
mod random;

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use serde_json::{Value, json};
use shadow_math::{PlanError, ShadowSettings};
use shadow_scene::{FramePlan, FramePlanError, ImportOptions, Scene, import::import_slice_with};

use crate::{finite::assert_finite_plan, glb::Parts, random::Random};

/// The most memory that an import may claim, in bytes: far more than an input has, and little enough for a run to see a
/// reservation that was not claimed (`-malloc_limit_mb`).
const MEMORY_LIMIT: u64 = 16 << 20;

/// A time within the animations of the seeds, in seconds: between keys, so that poses are interpolated.
const TIME: f64 = 0.4;

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions { time: TIME, memory_limit: MEMORY_LIMIT, ..ImportOptions::default() };
    match import_slice_with("input", bytes, &options) {
        Ok(scene) => assert_usable(&scene),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});

/// What every scene promises, and that a frame of it can be planned.
fn assert_usable(scene: &Scene) {
    let vertices = scene.vertices();
    let count = vertices.positions.len();
    assert!([vertices.normals.len(), vertices.uvs.len(), vertices.colors.len()].iter().all(|&len| len == count));
    let is_finite = vertices.positions.iter().chain(&vertices.normals).all(|vector| vector.is_finite())
        && vertices.uvs.iter().all(|uv| uv.is_finite())
        && vertices.colors.iter().all(|color| color.is_finite());
    assert!(is_finite, "a vertex has a number that is not finite");
    assert!(scene.triangles().as_flattened().iter().all(|&vertex| (vertex as usize) < count));
    assert_eq!(scene.triangle_materials().len(), scene.triangles().len());
    assert!(scene.triangle_materials().iter().all(|&material| (material as usize) < scene.materials().len()));
    for instance in scene.instances() {
        assert!(!instance.bounds.is_empty());
    }
    for camera in scene.cameras() {
        match FramePlan::new(scene, &camera.camera, &ShadowSettings::default(), 64, 36, None) {
            Ok(plan) => assert_finite_plan(&plan),
            // A file may place a camera or a light where single precision ends.
            Err(
                FramePlanError::Camera(PlanError::CameraOverflow)
                | FramePlanError::Light { source: PlanError::LightOverflow, .. },
            ) => {}
            Err(error) => panic!("the scene of a file cannot be planned: {error}"),
        }
    }
}

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let mut random = Random::new(seed);
    // One in four stays without understanding of the format.
    let parts = if random.below(4) == 0 { None } else { Parts::split(&data[..size]) };
    let Some(mut parts) = parts else { return fuzzer_mutate(data, size, max_size) };
    if parts.bin.is_empty() || random.below(3) > 0 {
        for _ in 0..=random.below(3) {
            mutate_json(&mut parts.json, &mut random);
        }
    } else {
        let len = parts.bin.len();
        parts.bin.resize(len + 16, 0);
        let len = fuzzer_mutate(&mut parts.bin, len, len + 16);
        parts.bin.truncate(len);
    }
    let bytes = parts.join();
    if bytes.len() > max_size {
        return fuzzer_mutate(data, size, max_size);
    }
    data[..bytes.len()].copy_from_slice(&bytes);
    bytes.len()
});

/// Changes one value somewhere in the document.
fn mutate_json(root: &mut Value, random: &mut Random) {
    let donor = pick(root, random).clone();
    let value = pick(root, random);
    match (random.below(6), value) {
        (0, Value::Array(elements)) if !elements.is_empty() => {
            let element = elements[random.below(elements.len())].clone();
            elements.push(element);
        }
        (1, Value::Array(elements)) if !elements.is_empty() => {
            elements.remove(random.below(elements.len()));
        }
        (0 | 1, Value::Object(members)) if !members.is_empty() => {
            let key = members.keys().nth(random.below(members.len())).cloned().unwrap_or_default();
            members.remove(&key);
        }
        (2, Value::Object(members)) => {
            let key = glb::KEYS[random.below(glb::KEYS.len())];
            members.insert(key.into(), number(random));
        }
        (3, value) => *value = donor,
        (_, value @ Value::String(_)) => *value = glb::WORDS[random.below(glb::WORDS.len())].into(),
        (_, value) => *value = number(random),
    }
}

/// A value somewhere in the document: each level goes deeper with a likelihood that reaches leaves often.
fn pick<'a>(value: &'a mut Value, random: &mut Random) -> &'a mut Value {
    let count = match value {
        Value::Array(elements) => elements.len(),
        Value::Object(members) => members.len(),
        _ => 0,
    };
    if count == 0 || random.below(6) == 0 {
        return value;
    }
    let chosen = random.below(count);
    match value {
        Value::Array(elements) => pick(&mut elements[chosen], random),
        Value::Object(members) => match members.values_mut().nth(chosen) {
            Some(member) => pick(member, random),
            None => unreachable!("the number is below the count"),
        },
        _ => unreachable!("only lists and objects have a count"),
    }
}

/// A number of the kinds that files have, or that break them.
fn number(random: &mut Random) -> Value {
    const ODD: [f64; 12] = [0.0, -1.0, 0.5, 1e-300, 1e-40, 1e12, 1e30, 3.5e38, -3.5e38, 1e300, 4_294_967_295.0, 2_147_483_648.0];
    match random.below(4) {
        0 => json!(random.below(8)),
        1 => json!(ODD[random.below(ODD.len())]),
        2 => json!(random.below(usize::MAX) as u64 >> random.below(64)),
        _ => json!(5120 + random.below(7)),
    }
}
