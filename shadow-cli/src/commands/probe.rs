//! `shadow probe`: what an adapter really does where WebGPU leaves it a choice.

mod advice;
mod rows;

use std::path::Path;

use serde::{Serialize, Serializer};
use shadow_gpu::{AdapterSummary, probe::probe};

use self::{
    advice::warnings,
    rows::{Row, format_rows, limit_rows, plane_rows, raster_rows},
};
use super::Verdict;
use crate::{
    args::ProbeArgs,
    console::{Console, print, print_json, table, to_json},
    error::CliError,
    output::{check_folder_of, write_text},
};

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report {
    adapter: Adapter,
    raster: Rows,
    depth_plane: Rows,
    limits: Rows,
    formats: Formats,
    /// Why values are null, by the path of their names.
    #[serde(serialize_with = "as_map")]
    reasons: Vec<(String, String)>,
    warnings: Vec<String>,
    output: Option<String>,
}

/// The adapter that was measured.
#[derive(Debug, Serialize)]
struct Adapter {
    name: String,
    backend: &'static str,
    kind: &'static str,
    driver: String,
    driver_info: String,
}

impl From<AdapterSummary> for Adapter {
    fn from(adapter: AdapterSummary) -> Self {
        let AdapterSummary { name, backend, kind, driver, driver_info, .. } = adapter;
        Self { name, backend, kind, driver, driver_info }
    }
}

/// Findings that belong together: an object with their values.
#[derive(Debug)]
struct Rows(Vec<Row>);

impl Serialize for Rows {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|row| (row.name, &row.value)))
    }
}

/// The findings of each depth format: an object of objects.
#[derive(Debug)]
struct Formats(Vec<(&'static str, Rows)>);

impl Serialize for Formats {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(format, rows)| (format, rows)))
    }
}

/// Pairs as an object, in their order.
fn as_map<S: Serializer>(pairs: &[(String, String)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().map(|(name, value)| (name, value)))
}

/// Measures an adapter.
pub(super) fn run(args: &ProbeArgs) -> Result<Verdict, CliError> {
    if let Some(output) = &args.output {
        check_report_path(output)?;
    }
    let console = Console::new(args.json);
    console.stage("measuring what the adapter does");
    let rules = pollster::block_on(probe(args.adapter.as_deref()))?;
    console.finish();
    let warnings = warnings(&rules);
    let formats = rules.formats.iter().map(|format| (format.format.name(), Rows(format_rows(format)))).collect();
    let mut report = Report {
        raster: Rows(raster_rows(&rules.raster)),
        depth_plane: Rows(plane_rows(&rules.plane)),
        limits: Rows(limit_rows(&rules.limits)),
        formats: Formats(formats),
        reasons: Vec::new(),
        warnings,
        output: args.output.as_ref().map(|output| output.display().to_string()),
        adapter: rules.adapter.into(),
    };
    report.reasons = reasons(&report);
    if let Some(output) = &args.output {
        write_text(output, &to_json(&report).map_err(CliError::Stdout)?)?;
    }
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(Verdict::Done)
}

/// Checks, before any work is done, that the report can be written there.
fn check_report_path(path: &Path) -> Result<(), CliError> {
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        return Err(CliError::ReportFormat { path: path.into() });
    }
    check_folder_of(path)
}

/// Why values are null, by the path of their names.
fn reasons(report: &Report) -> Vec<(String, String)> {
    let groups = [("raster", &report.raster), ("depth_plane", &report.depth_plane), ("limits", &report.limits)];
    let groups = groups.into_iter().map(|(name, rows)| (name.to_string(), rows));
    let formats = report.formats.0.iter().map(|(name, rows)| (format!("formats.{name}"), rows));
    let all =
        groups.chain(formats).flat_map(|(group, rows)| rows.0.iter().map(move |row| (format!("{group}.{}", row.name), row)));
    all.filter_map(|(path, row)| Some((path, row.reason.clone()?))).collect()
}

/// The report for people.
fn text(report: &Report) -> String {
    let Adapter { name, backend, driver, driver_info, .. } = &report.adapter;
    let mut text = format!("{}\n", format!("{name} through {backend}: {driver} {driver_info}").trim());
    for (title, rows) in
        [("rasterisation", &report.raster), ("depth of samples", &report.depth_plane), ("near and far", &report.limits)]
    {
        let rows: Vec<_> = rows.0.iter().map(|row| vec![format!("  {}", row.label()), row.text.clone()]).collect();
        text.push_str(&format!("\n{title}\n{}", table(&rows, |_| true)));
    }
    text.push_str(&format!("\n{}", format_table(&report.formats)));
    for (path, reason) in &report.reasons {
        text.push_str(&format!("\nnot measured: {}: {reason}", path.replace('_', " ")));
    }
    for warning in &report.warnings {
        text.push_str(&format!("\nwarning: {warning}"));
    }
    if !report.reasons.is_empty() || !report.warnings.is_empty() {
        text.push('\n');
    }
    if let Some(output) = &report.output {
        text.push_str(&format!("wrote {output}\n"));
    }
    text
}

/// The formats beside each other: a column each.
fn format_table(formats: &Formats) -> String {
    let heading = std::iter::once("depth formats".to_string()).chain(formats.0.iter().map(|(name, _)| (*name).to_string()));
    let mut rows = vec![heading.collect::<Vec<_>>()];
    let count = formats.0.iter().map(|(_, rows)| rows.0.len()).max().unwrap_or(0);
    for index in 0..count {
        let of_formats: Vec<_> = formats.0.iter().filter_map(|(_, rows)| rows.0.get(index)).collect();
        let label = of_formats.first().map(|row| format!("  {}", row.label())).unwrap_or_default();
        // A text of several lines has as many rows, of which the first bears the name.
        let lines: Vec<Vec<&str>> = of_formats.iter().map(|row| row.text.split('\n').collect()).collect();
        for line in 0..lines.iter().map(Vec::len).max().unwrap_or(0) {
            let label = if line == 0 { label.clone() } else { String::new() };
            let cells = lines.iter().map(|lines| lines.get(line).copied().unwrap_or_default().to_string());
            rows.push(std::iter::once(label).chain(cells).collect());
        }
    }
    table(&rows, |_| true)
}
