//! The renderers that tests share, and the scenes that they find outside the repository.

use std::{env, path::PathBuf, sync::OnceLock};

use shadow_cpu::{CpuRenderer, RasterRules};
use shadow_gpu::{DriverRules, GpuRenderer};

/// A CPU renderer with one thread a core and the rules of the adapter under test, as far as they are known.
///
/// # Panics
///
/// If the threads cannot be started.
pub fn cpu() -> &'static CpuRenderer {
    static RENDERER: OnceLock<CpuRenderer> = OnceLock::new();
    RENDERER.get_or_init(|| {
        let rules = match gpu().adapter().rules {
            DriverRules::SwiftShader => RasterRules::SWIFTSHADER,
            DriverRules::Lavapipe22 | DriverRules::Unknown => RasterRules::default(),
        };
        CpuRenderer::new(0, rules).expect("the threads start")
    })
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
#[allow(clippy::print_stderr, reason = "a test that does not run says so where its result is read")]
pub fn scenes(test: &str) -> Option<PathBuf> {
    match env::var_os("SHADOW_SCENES") {
        Some(folder) => {
            let folder = PathBuf::from(folder);
            assert!(folder.is_dir(), "SHADOW_SCENES names {}, which is no folder", folder.display());
            Some(folder)
        }
        None => {
            eprintln!("{test} did not run: SHADOW_SCENES does not name a folder of scenes");
            None
        }
    }
}
