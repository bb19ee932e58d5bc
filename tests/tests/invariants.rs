//! What must be absent from the renderers, read from their sources.

use std::{fs, path::Path};

use shadow_gpu::shaders::{ALL, COLOR_MODULE, join};

/// Every line of code, without comments, of the sources below a folder: `(file, line)`.
fn code_below(folder: &str, extension: &str) -> Vec<(String, String)> {
    let mut lines = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the folder can be read") {
            let path = entry.expect("the folder can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                let text = fs::read_to_string(&path).expect("the file can be read");
                let code = text.lines().map(|line| line.split("//").next().unwrap_or_default().to_string());
                lines.extend(code.map(|line| (path.display().to_string(), line)));
            }
        }
    }
    assert!(lines.len() > 100, "only {} lines were found below {folder}", lines.len());
    lines
}

/// Without the probe, which is there to find what drivers do where the renderer asks nothing of them.
fn without_probe(lines: Vec<(String, String)>) -> Vec<(String, String)> {
    let is_probe = |file: &str| file.contains("/probe/") || file.contains("/probe_") || file.ends_with("/probe.rs");
    lines.into_iter().filter(|(file, _)| !is_probe(file)).collect()
}

fn assert_absent(lines: &[(String, String)], words: &[&str]) {
    for (file, line) in lines {
        for word in words {
            assert!(!line.contains(word), "{file} has `{word}`: {}", line.trim());
        }
    }
}

#[test]
fn no_renderer_derives_a_matrix() {
    for folder in ["shadow-cpu/src", "shadow-gpu/src"] {
        assert_absent(&code_below(folder, "rs"), &["Mat3", "Mat4", "Affine", ".inverse()", "::rh::", "look_to", "perspective("]);
    }
}

#[test]
fn no_varying_is_interpolated_and_no_derivative_is_taken() {
    let lines = without_probe(code_below("shadow-gpu/src/shaders", "wgsl"));
    assert_absent(&lines, &["dpdx", "dpdy", "fwidth", "textureSample", "textureGather", "fma("]);
    let varyings: Vec<_> = lines.iter().filter(|(_, line)| line.contains("@location") && line.contains(',')).collect();
    assert!(!varyings.is_empty(), "the passes that pull vertices hand their triangle on");
    for (file, line) in varyings {
        // A vertex attribute is an argument of its entry point, and stands on a line with `fn`.
        assert!(line.contains("@interpolate(flat") || line.contains("fn "), "{file}: {}", line.trim());
    }
}

#[test]
fn bias_is_never_the_pipelines() {
    let lines = without_probe(code_below("shadow-gpu/src", "rs"));
    let uses: Vec<_> = lines.into_iter().filter(|(_, line)| line.contains("DepthBiasState")).collect();
    assert!(!uses.is_empty(), "the pipelines state their bias");
    assert!(uses.iter().all(|(_, line)| line.contains("DepthBiasState::default()")), "{uses:?}");
}

#[test]
fn shading_reads_no_map() {
    assert!(!join(COLOR_MODULE).contains("fetch_texel"), "the colour pass reads visibility alone");
    let shade = ALL.iter().find(|file| file.stem == "shade").expect("there is a file of shading");
    assert!(!shade.source.contains("views["), "shading knows no view");
    let lines = code_below("shadow-math/src", "rs");
    let of_shade: Vec<_> = lines.into_iter().filter(|(file, _)| file.ends_with("shade.rs")).collect();
    assert!(!of_shade.is_empty(), "there is a module of shading");
    assert_absent(&of_shade, &["MapAccess", "ViewPlan", "fetch_texel"]);
}

/// A plan that both renderers share can be wrong, and they would still agree: only what knows nothing of it can tell.
#[test]
fn the_truth_knows_no_shadow_map() {
    let all = code_below("shadow-cpu/src", "rs");
    let is_of_trace = |file: &str| file.ends_with("src/trace.rs") || file.contains("src/trace/");
    let of_trace: Vec<_> = all.into_iter().filter(|(file, _)| is_of_trace(file) && !file.ends_with("tests.rs")).collect();
    assert!(of_trace.len() > 500, "{} lines of the tracer", of_trace.len());
    let modules = [
        "plan",
        "bias",
        "filter",
        "fit",
        "depth",
        "rounding",
        "visibility",
        "settings",
        "polytope",
        "rectangle",
        "splits",
        "aliasing",
        "frustum",
    ];
    for module in modules {
        assert_absent(&of_trace, &[&format!("shadow_math::{module}"), &format!("    {module}::"), &format!("{{{module}::")]);
    }
    let types =
        ["ViewPlan", "LightPlan", "CameraPlan", "FramePlan", "MapAccess", "ShadowSettings", "Receiver", "Filter", "Bias", "Mat4"];
    assert_absent(&of_trace, &types);
    assert_absent(&of_trace, &["crate::raster", "crate::resolve", "crate::measure"]);
}

#[test]
fn every_tap_goes_through_one_function() {
    let lines = code_below("shadow-gpu/src/shaders", "wgsl");
    let loads: Vec<_> = lines.iter().filter(|(_, line)| line.contains("textureLoad(maps")).collect();
    assert_eq!(loads.len(), 1, "{loads:?}");
}
