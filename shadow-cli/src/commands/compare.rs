//! `shadow compare`: whether two backends agree, layer by layer.

use std::path::Path;

use serde::Serialize;
use shadow_cpu::RasterRules;
use shadow_gpu::DriverRules;
use shadow_scene::{
    Request,
    compare::{Comparison, Contract, LayerComparison, LeftOut, compare},
};

use super::Verdict;
use crate::{
    args::{Backend, CompareArgs},
    backend::{Place, RenderedFrame, rules_of},
    console::{Console, print, print_json, table, to_json},
    error::CliError,
    memory::{self, Work},
    output::{file_name, make_folder, write_picture, write_text},
    picture::{difference, pictures},
    resolve::Job,
};

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    scene: &'a str,
    notes: &'a [String],
    agree: bool,
    /// `exact` or `tolerance`.
    contract: &'static str,
    backends: [&'static str; 2],
    /// The graphics adapter's name.
    adapter: Option<&'a str>,
    triangles: usize,
    width: u32,
    height: u32,
    layers: Vec<LayerReport>,
    /// The folder that pictures were written to, if any.
    output: Option<String>,
}

/// How one layer compares.
#[derive(Debug, Serialize)]
struct LayerReport {
    name: String,
    pixels: usize,
    /// How many pixels differ in any bit.
    differing: usize,
    left_out: LeftOutReport,
    /// Null where one of the values is not a number and the other is: JSON has no infinity.
    max_difference: Option<f64>,
    violations: usize,
    within_contract: bool,
}

/// Pixels where the tolerance contract promises nothing, by the reason.
#[derive(Debug, Serialize)]
struct LeftOutReport {
    camera_coverage: usize,
    map_coverage: usize,
    tie: usize,
}

impl From<LeftOut> for LeftOutReport {
    fn from(left_out: LeftOut) -> Self {
        let LeftOut { camera_coverage, map_coverage, tie } = left_out;
        Self { camera_coverage, map_coverage, tie }
    }
}

impl From<&LayerComparison> for LayerReport {
    fn from(layer: &LayerComparison) -> Self {
        Self {
            name: layer.name.to_string(),
            pixels: layer.pixels,
            differing: layer.differing,
            left_out: layer.left_out.into(),
            max_difference: Some(layer.max_difference).filter(|difference| difference.is_finite()),
            violations: layer.violations,
            within_contract: layer.within_contract,
        }
    }
}

/// The contract that a comparison on an adapter of these rules is held to. The CPU backend follows them as far as they are known.
pub(super) fn contract_for(rules: DriverRules) -> Contract {
    if rules.are_complete() { Contract::Exact } else { Contract::Tolerance }
}

/// Renders with both backends, compares and reports.
pub(super) fn run(args: &CompareArgs) -> Result<Verdict, CliError> {
    let console = Console::new(args.json);
    let backends = [args.backends.first, args.backends.second];
    let rules = if backends.contains(&Backend::Gpu) {
        rules_of(args.machine.adapter.as_deref(), &console)?
    } else {
        RasterRules::default()
    };
    let place = Place { subpixel_bits: Some(rules.subpixel_bits), ..Place::new(&backends, &args.machine) };
    let job = Job::resolve(&args.picture, &args.bias, place, &console)?;
    memory::check(&job, Work::Compare(backends))?;
    if let Some(folder) = &args.output {
        make_folder(folder)?;
    }

    let render = |backend: Backend| backend.render(&job, Request::ALL, &args.machine, rules, &console);
    let (first, second) = (render(args.backends.first)?, render(args.backends.second)?);
    let adapter = first.adapter.as_ref().or(second.adapter.as_ref());
    let contract = adapter.map_or(Contract::Tolerance, |adapter| contract_for(adapter.rules));
    console.stage("comparing");
    let comparison = compare(&first.frame, &second.frame, &job.scene, &job.plan, contract)?;

    let report = Report {
        scene: &job.scene_name,
        notes: &job.notes,
        agree: comparison.agree(),
        contract: contract.name(),
        backends: backends.map(|backend| backend.name()),
        adapter: adapter.map(|adapter| adapter.name.as_str()),
        triangles: job.scene.triangles().len(),
        width: job.plan.camera.width,
        height: job.plan.camera.height,
        layers: comparison.layers.iter().map(LayerReport::from).collect(),
        output: args.output.as_ref().map(|folder| folder.display().to_string()),
    };
    if let Some(folder) = &args.output {
        console.stage(format!("writing pictures to {}", folder.display()));
        write_pictures(folder, &comparison, &job, [&first, &second])?;
        let path = folder.join("comparison.json");
        let json = to_json(&report).map_err(|source| CliError::Write { path: path.clone(), source })?;
        write_text(&path, &json)?;
    }
    console.finish();
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(if report.agree { Verdict::Done } else { Verdict::NotSo })
}

/// Writes both pictures of every layer and that of their difference.
fn write_pictures(folder: &Path, comparison: &Comparison, job: &Job, frames: [&RenderedFrame; 2]) -> Result<(), CliError> {
    for LayerComparison { name, .. } in &comparison.layers {
        let [first, second] = frames;
        let layers = [first.layer(*name)?, second.layer(*name)?];
        for (frame, picture) in frames.iter().zip(pictures(layers, &job.plan)) {
            write_picture(&folder.join(file_name(*name, frame.backend.name())), &picture)?;
        }
        write_picture(&folder.join(file_name(*name, "difference")), &difference(layers[0], layers[1]))?;
    }
    Ok(())
}

/// The report for people.
fn text(report: &Report<'_>) -> String {
    let heading = ["layer", "pixels", "differing", "left out", "max difference", "verdict"].map(String::from).to_vec();
    let rows = report.layers.iter().map(|layer| {
        let LeftOutReport { camera_coverage, map_coverage, tie } = layer.left_out;
        vec![
            layer.name.clone(),
            layer.pixels.to_string(),
            layer.differing.to_string(),
            (camera_coverage + map_coverage + tie).to_string(),
            layer.max_difference.map_or_else(|| "not a number".into(), difference_text),
            verdict_text(layer),
        ]
    });
    let rows: Vec<_> = std::iter::once(heading).chain(rows).collect();
    let mut text = table(&rows, |column| matches!(column, 0 | 5));
    let [first, second] = report.backends;
    let adapter = report.adapter.unwrap_or("no adapter");
    let agree = if report.agree { "agree" } else { "do NOT agree" };
    let kept = report.layers.iter().filter(|layer| layer.within_contract).count();
    text.push_str(&format!(
        "{first} and {second} ({adapter}) {agree} on {}: {kept} of {} layers keep the contract, which is {}\n",
        report.scene,
        report.layers.len(),
        report.contract
    ));
    if let Some(output) = &report.output {
        text.push_str(&format!("wrote pictures of every layer and comparison.json to {output}\n"));
    }
    text
}

/// A difference in three digits.
fn difference_text(difference: f64) -> String {
    if difference == 0.0 { "0".into() } else { format!("{difference:.2e}") }
}

fn verdict_text(layer: &LayerReport) -> String {
    match (layer.within_contract, layer.differing) {
        (true, 0) => "equal".into(),
        (true, _) => "within tolerance".into(),
        (false, _) => format!("BROKEN at {} pixels", layer.violations),
    }
}

#[cfg(test)]
mod tests {
    use shadow_scene::LayerName;

    use super::*;

    fn layer(max_difference: f64, violations: usize) -> LayerReport {
        LayerReport::from(&LayerComparison {
            name: LayerName::ShadowMap { light: 0, view: 1 },
            pixels: 100,
            differing: 7,
            left_out: LeftOut { camera_coverage: 1, map_coverage: 2, tie: 3 },
            max_difference,
            violations,
            within_contract: violations == 0,
        })
    }

    #[test]
    fn an_infinite_difference_is_null_in_json() {
        let json = serde_json::to_value(layer(f64::INFINITY, 5)).unwrap();
        assert!(json["max_difference"].is_null());
        assert_eq!((&json["name"], &json["left_out"]["tie"]), (&"shadow-map:0:1".into(), &3.into()));
        assert_eq!(serde_json::to_value(layer(0.25, 0)).unwrap()["max_difference"], 0.25);
    }

    #[test]
    fn a_broken_contract_stands_out() {
        let report = Report {
            scene: "builtin:demo",
            notes: &[],
            agree: false,
            contract: "tolerance",
            backends: ["cpu", "gpu"],
            adapter: Some("a driver"),
            triangles: 1,
            width: 10,
            height: 10,
            layers: vec![layer(0.25, 0), layer(f64::INFINITY, 5)],
            output: None,
        };
        let text = text(&report);
        assert!(text.contains("2.50e-1  within tolerance\n") && text.contains("not a number  BROKEN at 5 pixels\n"), "{text}");
        assert!(text.contains("do NOT agree on builtin:demo: 1 of 2 layers keep the contract, which is tolerance"), "{text}");
    }

    #[test]
    fn only_known_rules_are_held_to_the_bit() {
        assert_eq!(contract_for(DriverRules::Lavapipe22), Contract::Exact);
        assert_eq!(contract_for(DriverRules::SwiftShader), Contract::Exact);
        assert_eq!(contract_for(DriverRules::Unknown), Contract::Tolerance);
    }
}
