//! The probe of adapters: it finds what is known of drivers from elsewhere, and the program reports all of it.

use std::sync::OnceLock;

use serde_json::Value;
use shadow_cpu::raster::DepthPlaneRule;
use shadow_gpu::{
    DriverRules,
    probe::{
        AdapterRules, ComparisonFilter, DepthFormat, DepthPlane, DepthStorage, FormatRules, GridRounding, RangeOverflow,
        SlopeRule, Ties, UnitRule, probe,
    },
};
use shadow_tests::renderers;

use crate::program::Folder;

/// What the probe finds on the adapter of the tests.
fn rules() -> &'static AdapterRules {
    static RULES: OnceLock<AdapterRules> = OnceLock::new();
    RULES.get_or_init(|| pollster::block_on(probe(None)).expect("the adapter opens"))
}

fn format(wanted: DepthFormat) -> &'static FormatRules {
    rules().formats.iter().find(|rules| rules.format == wanted).expect("every format is probed")
}

/// The rules that the CPU renderer follows on this adapter were found by comparing whole pictures, and the probe's by its own triangles.
#[test]
fn the_probe_finds_the_rules_that_the_renderers_agree_by() {
    if renderers::gpu().adapter().rules == DriverRules::Unknown {
        shadow_tests::report::say("the adapter's rules are not known: nothing to compare a probe with");
        return;
    }
    let known = renderers::rules();
    assert_eq!(rules().adapter, *renderers::gpu().adapter());
    assert_eq!(rules().raster.subpixel_bits, Ok(known.subpixel_bits));
    assert_eq!(rules().raster.rounding, Ok([GridRounding::Nearest(Ties::Even); 2]));
    let plane = match known.depth_plane {
        DepthPlaneRule::Unsnapped => DepthPlane::Unsnapped,
        DepthPlaneRule::Snapped => DepthPlane::Snapped,
    };
    assert_eq!(rules().plane.plane, Ok(plane));
}

/// What WebGPU promises is found too.
#[test]
fn the_probe_finds_what_webgpu_promises() {
    let raster = &rules().raster;
    let edges = raster.edges.as_ref().expect("the edges can be told");
    assert!(edges.is_top_left() && edges.covers_once(), "{edges:?}");
    assert!(raster.sample.as_ref().is_ok_and(|sample| sample.has_centre()), "{:?}", raster.sample);
    assert_eq!((&rules().limits.near_clips, &rules().limits.far_clips), (&Ok(true), &Ok(true)));
    assert_eq!(format(DepthFormat::Depth16Unorm).depth.storage, Ok(DepthStorage::Unorm { bits: 16 }));
    assert_eq!(format(DepthFormat::Depth32Float).depth.storage, Ok(DepthStorage::Float));
    for rules in &rules().formats {
        assert_eq!(rules.depth.written, Ok(RangeOverflow::Clamped), "{:?}", rules.format);
        assert_eq!(rules.comparison.compares_first, Ok(true), "{:?}", rules.format);
        assert_eq!(rules.comparison.filter, Ok(ComparisonFilter::Bilinear), "{:?}", rules.format);
    }
}

/// The unit of a bias of single precision is the last place of the triangle's greatest depth, as Vulkan's text has it.
#[test]
fn the_unit_of_a_float_bias_is_the_last_place_of_the_greatest_depth() {
    let bias = &format(DepthFormat::Depth32Float).bias;
    let units = bias.units.as_ref().expect("the units can be measured");
    assert_eq!(units.iter().map(|at| at.depth).collect::<Vec<_>>(), [0.75, 0.375, 0.1875, 0.046_875, 0.005_859_375]);
    for at in units {
        let last_place = f64::from((at.depth as f32).next_up()) - at.depth;
        assert_eq!(at.unit, last_place, "at {}", at.depth);
    }
    assert_eq!(bias.depends_on, Ok(UnitRule::Triangle));
    assert_eq!(bias.slope, Ok(SlopeRule::Maximum));
    // OpenGL through wgpu has no clamp.
    let has_clamp = renderers::gpu().adapter().backend != "gl";
    assert!(if has_clamp { bias.clamps == Ok(true) } else { bias.clamps.is_err() }, "{:?}", bias.clamps);
}

/// Lavapipe's own choices: Mesa 22.3 takes two steps of a format with whole numbers as its unit, and has 24 bits of them.
#[test]
fn lavapipes_units_are_two_steps_of_whole_numbers() {
    if renderers::gpu().adapter().rules != DriverRules::Lavapipe22 {
        shadow_tests::report::say("the adapter is not lavapipe of Mesa 22.3: its units are not known");
        return;
    }
    for (wanted, bits) in [(DepthFormat::Depth16Unorm, 16), (DepthFormat::Depth24Plus, 24)] {
        let found = format(wanted);
        assert_eq!(found.depth.storage, Ok(DepthStorage::Unorm { bits }));
        assert_eq!(found.bias.depends_on, Ok(UnitRule::Fixed));
        let step = 1.0 / (f64::from(bits).exp2() - 1.0);
        for at in found.bias.units.as_ref().expect("the units can be measured") {
            assert!((at.unit / step - 2.0).abs() < 1e-4, "{} steps at {}", at.unit / step, at.depth);
        }
    }
}

/// Depths are as near to their planes as the automatic bias has to take for granted, and not exact: then nothing would have been measured.
#[test]
fn depths_are_off_by_less_than_the_automatic_bias_allows() {
    for error in [&rules().plane.parallel, &rules().plane.perspective] {
        let error = error.as_ref().expect("the depth plane is known");
        assert!(error.samples > 50_000, "{error:?}");
        assert!(error.worst_of_bound > 0.0 && error.worst_of_bound < 1.0, "{error:?}");
        assert!(error.median_ulp > 0.0 && error.median_ulp < error.worst_ulp, "{error:?}");
    }
}

#[test]
fn an_adapter_that_does_not_exist_is_not_probed() {
    let error = pollster::block_on(probe(Some("no such adapter"))).expect_err("there is none");
    let sentence = error.to_string();
    assert!(sentence.contains("no such adapter") && sentence.contains(&rules().adapter.name), "{sentence}");
}

/// Everything that programs are told, people are told too, and the file is the same report.
#[test]
fn the_table_names_every_finding() {
    let folder = Folder::new("probe");
    let report = folder.json(&["probe", "--json", "--output", "probe.json"]);
    assert_eq!(report["adapter"]["name"].as_str(), Some(rules().adapter.name.as_str()));
    assert_eq!(
        report["raster"]["subpixel_bits"].as_u64(),
        rules().raster.subpixel_bits.as_ref().ok().map(|bits| u64::from(*bits))
    );
    let file = std::fs::read(folder.path().join("probe.json")).expect("the file was written");
    assert_eq!(serde_json::from_slice::<Value>(&file).expect("it is JSON"), report);

    let output = folder.run(&["probe"]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let formats = report["formats"].as_object().expect("the formats have names");
    let groups = ["raster", "depth_plane", "limits"].map(|name| report[name].as_object().expect("a group of findings"));
    let mut names = 0;
    for group in groups.into_iter().chain(formats.values().map(|format| format.as_object().expect("a group of findings"))) {
        for name in group.keys() {
            let label = format!("\n  {} ", name.replace('_', " "));
            assert!(text.contains(&label), "`{label}` is not in:\n{text}");
            names += 1;
        }
    }
    assert!(names > 30, "only {names} findings are reported");
    for name in formats.keys() {
        assert!(text.contains(name.as_str()), "`{name}` is not in:\n{text}");
    }
    for warning in report["warnings"].as_array().expect("a list") {
        let warning = warning.as_str().expect("a sentence");
        assert!(text.contains(&format!("warning: {warning}\n")), "`{warning}` is not in:\n{text}");
    }
}

/// What is null has a reason, and nothing else has one.
#[test]
fn what_could_not_be_measured_has_a_reason() {
    let folder = Folder::new("probe-reasons");
    let report = folder.json(&["probe", "--json"]);
    let mut nulls = Vec::new();
    for group in ["raster", "depth_plane", "limits"] {
        collect_nulls(group, &report[group], &mut nulls);
    }
    for (name, format) in report["formats"].as_object().expect("the formats have names") {
        collect_nulls(&format!("formats.{name}"), format, &mut nulls);
    }
    let reasons: Vec<_> = report["reasons"].as_object().expect("an object").keys().cloned().collect();
    nulls.sort();
    assert_eq!(nulls, reasons);
}

fn collect_nulls(path: &str, group: &Value, nulls: &mut Vec<String>) {
    let findings = group.as_object().expect("a group of findings");
    nulls.extend(findings.iter().filter(|(_, value)| value.is_null()).map(|(name, _)| format!("{path}.{name}")));
}

#[test]
fn wrong_probes_are_refused_with_a_sentence() {
    let folder = Folder::new("probe-refusals");
    let unknown = folder.refusal(&["probe", "--adapter", "no such adapter"]);
    assert!(unknown.contains("no such adapter") && unknown.contains(&rules().adapter.name), "{unknown}");
    let ending = folder.refusal(&["probe", "--output", "probe.txt"]);
    assert!(ending.contains("probe.txt") && ending.contains(".json"), "{ending}");
    assert!(folder.refusal(&["probe", "--output", "nowhere/probe.json"]).contains("nowhere"));
    assert!(folder.files().is_empty(), "and nothing is written");
}
