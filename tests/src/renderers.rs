//! The renderers that tests share, and the scenes that they find outside the repository.

use std::{
    env,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use shadow_cpu::{CpuRenderer, RasterRules, raster::DepthPlaneRule};
use shadow_gpu::{
    DriverRules, GpuRenderer,
    probe::{DepthPlane, probe_raster},
};
use shadow_math::ShadowSettings;
use shadow_scene::compare::Contract;

use crate::report::say;

/// What the adapter under test is held to.
pub fn contract() -> Contract {
    if gpu().adapter().rules.are_complete() { Contract::Exact } else { Contract::Tolerance }
}

/// The rules of the adapter under test, for CPU renderers that are compared with it: its driver's where they are known, and else what a probe finds.
///
/// # Panics
///
/// If the adapter cannot be probed.
pub fn rules() -> RasterRules {
    static PROBED: OnceLock<RasterRules> = OnceLock::new();
    match gpu().adapter().rules {
        DriverRules::Lavapipe22 => RasterRules::default(),
        DriverRules::SwiftShader => RasterRules::SWIFTSHADER,
        DriverRules::Unknown => *PROBED.get_or_init(|| {
            let (raster, plane) = pollster::block_on(probe_raster(None)).expect("the adapter draws");
            let depth_plane = plane.plane.ok().map(|plane| match plane {
                DepthPlane::Snapped => DepthPlaneRule::Snapped,
                DepthPlane::Unsnapped => DepthPlaneRule::Unsnapped,
            });
            RasterRules::measured(raster.subpixel_bits.ok(), depth_plane)
        }),
    }
}

/// The default settings, for the sub-pixel grid of the adapter under test.
pub fn settings() -> ShadowSettings {
    ShadowSettings { subpixel_bits: rules().subpixel_bits, ..ShadowSettings::default() }
}

/// A CPU renderer with one thread a core and the default rules, whatever the adapter under test.
///
/// # Panics
///
/// If the threads cannot be started.
pub fn cpu() -> &'static CpuRenderer {
    static RENDERER: OnceLock<CpuRenderer> = OnceLock::new();
    RENDERER.get_or_init(|| CpuRenderer::new(0, RasterRules::default()).expect("the threads start"))
}

/// A CPU renderer with one thread a core and the [`rules`] of the adapter under test, to be compared with it.
///
/// # Panics
///
/// If the threads cannot be started.
pub fn counterpart() -> &'static CpuRenderer {
    static RENDERER: OnceLock<CpuRenderer> = OnceLock::new();
    RENDERER.get_or_init(|| CpuRenderer::new(0, rules()).expect("the threads start"))
}

/// The GPU renderer on the adapter that the environment chooses.
///
/// # Panics
///
/// If there is no adapter: a comparison that silently did not happen would be a pass.
pub fn gpu() -> &'static GpuRenderer {
    static RENDERER: OnceLock<GpuRenderer> = OnceLock::new();
    RENDERER.get_or_init(|| {
        pollster::block_on(GpuRenderer::new(None))
            .unwrap_or_else(|error| panic!("the tests need a graphics adapter: {error}; `tests/run` installs a software one"))
    })
}

/// The folder of real scenes that the environment variable `SHADOW_SCENES` names; a test without it says that it did not run.
pub fn scenes(test: &str) -> Option<PathBuf> {
    match env::var_os("SHADOW_SCENES") {
        Some(folder) => {
            let folder = PathBuf::from(folder);
            assert!(folder.is_dir(), "SHADOW_SCENES names {}, which is no folder", folder.display());
            Some(folder)
        }
        None => {
            say(&format!("{test} did not run: SHADOW_SCENES does not name a folder of scenes"));
            None
        }
    }
}

/// Whether real scenes are rendered at full size, as `tests/run --full` asks for; they are small otherwise.
pub fn is_full() -> bool {
    env::var_os("SHADOW_TESTS_FULL").is_some()
}

/// Every `.gltf` and `.glb` file below a folder, relative to it and in order.
///
/// # Panics
///
/// If the folder cannot be read.
#[must_use]
pub fn scene_files(folder: &Path) -> Vec<String> {
    let mut files = Vec::new();
    let mut pending = vec![folder.to_path_buf()];
    while let Some(next) = pending.pop() {
        for entry in next.read_dir().unwrap_or_else(|error| panic!("{}: {error}", next.display())) {
            let path = entry.expect("the folder can be read").path();
            if path.is_dir() {
                pending.push(path);
            } else if path.extension().is_some_and(|extension| extension == "gltf" || extension == "glb") {
                let relative = path.strip_prefix(folder).expect("it is below the folder");
                files.push(relative.to_string_lossy().replace('\\', "/"));
            }
        }
    }
    files.sort();
    files
}
