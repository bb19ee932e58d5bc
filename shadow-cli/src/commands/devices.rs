//! `shadow devices`: which graphics adapters there are.

use serde::Serialize;
use shadow_gpu::{AdapterSummary, list_adapters};

use super::Verdict;
use crate::{
    args::DevicesArgs,
    console::{Console, print, print_json, table},
    error::CliError,
};

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report {
    devices: Vec<Device>,
}

/// One adapter.
#[derive(Debug, Serialize)]
struct Device {
    name: String,
    backend: &'static str,
    kind: &'static str,
    driver: String,
    driver_info: String,
    /// The contract that a comparison on it is held to: `exact` where the driver's rules are known, else `tolerance`.
    contract: &'static str,
    /// The largest width and height of a texture in texels.
    max_texture_size: u32,
    /// The most layers of a texture.
    max_texture_layers: u32,
}

impl From<AdapterSummary> for Device {
    fn from(adapter: AdapterSummary) -> Self {
        let contract = super::compare::contract_for(adapter.rules);
        let AdapterSummary { name, backend, kind, driver, driver_info, rules: _, max_texture_size, max_texture_layers } = adapter;
        Self { name, backend, kind, driver, driver_info, contract: contract.name(), max_texture_size, max_texture_layers }
    }
}

/// Lists the adapters.
pub(super) fn run(args: &DevicesArgs) -> Result<Verdict, CliError> {
    let console = Console::new(args.json);
    console.stage("looking for graphics adapters");
    let devices = pollster::block_on(list_adapters()).into_iter().map(Device::from).collect();
    console.finish();
    let report = Report { devices };
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(Verdict::Done)
}

/// The report for people.
fn text(report: &Report) -> String {
    if report.devices.is_empty() {
        return "there is no graphics adapter; install a driver (on Debian and Ubuntu the package mesa-vulkan-drivers has one in software) or \
                use the cpu backend\n"
            .into();
    }
    let heading = ["name", "interface", "kind", "driver", "largest texture", "layers", "comparison"].map(String::from).to_vec();
    let rows = report.devices.iter().map(|device| {
        let driver = format!("{} {}", device.driver, device.driver_info);
        vec![
            device.name.clone(),
            device.backend.into(),
            device.kind.into(),
            driver.trim().into(),
            device.max_texture_size.to_string(),
            device.max_texture_layers.to_string(),
            device.contract.into(),
        ]
    });
    let rows: Vec<_> = std::iter::once(heading).chain(rows).collect();
    table(&rows, |column| !(4..=5).contains(&column))
}
