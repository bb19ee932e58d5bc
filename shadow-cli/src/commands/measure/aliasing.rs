//! How well maps are matched to the picture: the columns and fields of the report.

use serde::Serialize;
use shadow_cpu::measure::AliasingStatistics;

use super::percent;

/// What stands in place of a number that there is not, since no pixel asks a map.
const NOTHING: &str = "-";

/// Over how many pixels texels smear (m), and how many texels nobody sees.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct AliasingReport {
    /// Pixels that are counted, once for each light.
    pixels: u64,
    /// Pixels that are not, since the light grazes what they show.
    grazing: u64,
    /// None where nothing is counted, and the three below.
    median: Option<f32>,
    percentile_95: Option<f32>,
    max: Option<f32>,
    share_above_one: Option<f64>,
    waste: f64,
    #[serde(skip)]
    statistics: AliasingStatistics,
}

impl From<AliasingStatistics> for AliasingReport {
    fn from(statistics: AliasingStatistics) -> Self {
        let AliasingStatistics { pixels, grazing, median, percentile_95, max, .. } = statistics;
        let known = |number| (pixels > 0).then_some(number);
        let share_above_one = (pixels > 0).then(|| statistics.share_above_one());
        Self {
            pixels,
            grazing,
            median: known(median),
            percentile_95: known(percentile_95),
            max: known(max),
            share_above_one,
            waste: statistics.waste(),
            statistics,
        }
    }
}

impl AliasingReport {
    /// The table's columns: m of 95 % of the pixels, the share of pixels whose m is above 1, and the share of texels that nobody sees.
    pub(super) fn columns(&self) -> [String; 3] {
        let AliasingStatistics { percentile_95, above_one, pixels, texels, seen_texels, .. } = self.statistics;
        let waste = percent(texels - seen_texels, texels);
        if pixels == 0 {
            return [NOTHING.into(), NOTHING.into(), waste];
        }
        [format!("{percentile_95:.2}"), percent(above_one, pixels), waste]
    }

    /// The same as cells of a row, with what else is known of m while the pointer is on the first.
    pub(super) fn cells(&self) -> String {
        let AliasingStatistics { median, max, grazing, pixels, .. } = self.statistics;
        let [percentile_95, above_one, waste] = self.columns();
        let known = if pixels == 0 { "no pixel asks a map".into() } else { format!("median {median:.2}, at most {max:.2}") };
        format!(
            "<td title=\"{known}; of {pixels} pixels, without {grazing} that the light grazes\">{percentile_95}</td><td>{above_one}</td><td>{waste}</td>"
        )
    }
}
