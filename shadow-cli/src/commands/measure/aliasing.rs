//! How well maps are matched to the picture: the columns and fields of the report.

use serde::Serialize;
use shadow_cpu::measure::AliasingStatistics;

use super::percent;

/// Over how many pixels texels smear (m), and how many texels nobody sees.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct AliasingReport {
    /// Pixels that are counted, once for each light.
    pixels: u64,
    /// Pixels that are not, since the light grazes what they show.
    grazing: u64,
    median: f32,
    percentile_95: f32,
    max: f32,
    share_above_one: f64,
    waste: f64,
    #[serde(skip)]
    statistics: AliasingStatistics,
}

impl From<AliasingStatistics> for AliasingReport {
    fn from(statistics: AliasingStatistics) -> Self {
        let AliasingStatistics { pixels, grazing, median, percentile_95, max, .. } = statistics;
        let (share_above_one, waste) = (statistics.share_above_one(), statistics.waste());
        Self { pixels, grazing, median, percentile_95, max, share_above_one, waste, statistics }
    }
}

impl AliasingReport {
    /// The table's columns: m of 95 % of the pixels, the share of pixels whose m is above 1, and the share of texels that nobody sees.
    pub(super) fn columns(&self) -> [String; 3] {
        let AliasingStatistics { percentile_95, above_one, pixels, texels, seen_texels, .. } = self.statistics;
        [format!("{percentile_95:.2}"), percent(above_one, pixels), percent(texels - seen_texels, texels)]
    }

    /// The same as cells of a row, with what else is known of m while the pointer is on the first.
    pub(super) fn cells(&self) -> String {
        let AliasingStatistics { median, max, grazing, .. } = self.statistics;
        let [percentile_95, above_one, waste] = self.columns();
        format!(
            "<td title=\"median {median:.2}, at most {max:.2}; {grazing} pixels that the light grazes are left out\">{percentile_95}</td><td>{above_one}</td><td>{waste}</td>"
        )
    }
}
