//! The certificate as one page that holds everything it shows.

use super::{BiasReport, HEADINGS, LightReport, Report, cells, length, maps, sentences, verdict};
use crate::{
    page::{escaped, notes},
    plot::{Axis, Plot, short},
};

/// The page.
pub(super) fn html(report: &Report<'_>) -> String {
    let scene = escaped(report.picture.scene);
    let adapter = report.adapter.as_ref().map_or_else(String::new, |adapter| format!(" ({})", escaped(adapter)));
    let class = if report.holds { "holds" } else { "fails" };
    let mut page = format!(
        "<h1>The bias of {scene}'s shadows</h1>\n<p class=\"{class}\">{}</p>\n\
         <p>{} triangles, {} x {} pixels, rendered on {}{adapter} and judged by rays in double precision.</p>\n",
        verdict(report),
        report.picture.triangles,
        report.picture.width,
        report.picture.height,
        report.backend
    );
    page.push_str(&notes(report.picture.notes));
    for (index, light) in report.lights.iter().enumerate() {
        let name = format!("Light {index}, {} “{}”: {}", light.kind, light.name, maps(report, light));
        page.push_str(&format!("<section><h2>{}</h2>\n", escaped(&name)));
        if light.rules.first().is_some_and(|bias| bias.gap.pixels > 0) {
            page.push_str(&plot(light));
            page.push_str(&table(light));
        }
        for sentence in sentences(light) {
            page.push_str(&format!("<p>{}.</p>\n", escaped(&sentence)));
        }
        page.push_str("</section>\n");
    }
    page.push_str(MEANING);
    crate::page::page(&format!("The bias of {}", report.picture.scene), &page)
}

/// What is measured, for those who read the page without the program.
const MEANING: &str = "<section><h2>What is measured</h2>\n\
    <p>Acne are pixels that shadow themselves, though they and all taps of their lookup see the light; what slivers that were drawn wrongly do to a map is told apart. Pixels that are lit wrongly \
    are in shadow themselves, with all taps; beyond twice as many as with the automatic bias that is a failure. \
    The gap is how far from the foot of a wall its shadow would begin, the shift how far outlines of distant casters are moved, both along the surface of a pixel that asks a map. \
    “Wider” and “longer” are the shares of these pixels where they exceed those of the automatic bias by more than 2 %; beyond a share of 5 % a bias fails at it: less would have been \
    enough.</p>\n\
    <p>All biases are tried on the same maps with the same filter. The engines' are their defaults, each in its own units; what an engine does beside it (its filter, fit and \
    cascades) is not part of it; engines with an asterisk are tried on a map of back faces, as they draw it. The constant that was tuned is the least that leaves this picture without acne.</p></section>\n";

/// Acne against the gap: the automatic bias among what others do.
fn plot(light: &LightReport) -> String {
    let all = || light.rules.iter().chain(&light.curves.automatic).chain(&light.curves.constant);
    let place = |bias: &BiasReport| (f64::from(bias.gap.median + bias.shift.median), bias.acne as f64);
    let finite = || all().map(|bias| place(bias).0).filter(|length| length.is_finite());
    let x = Axis::decades("median gap and shift together", finite(), decade);
    let y = Axis::decades("pixels of acne", all().map(|bias| place(bias).1), short);
    let mut plot = Plot::new("acne against the gap", x, y);
    // A bias that reaches back to the light has no place on the axis.
    let is_on_plot = |bias: &&BiasReport| place(bias).0.is_finite();
    for (class, curve) in [("front", &light.curves.automatic), ("other", &light.curves.constant)] {
        plot.line(class, curve.iter().filter(is_on_plot).map(place));
        let dot = if class == "front" { "dot on-front" } else { "dot" };
        for bias in curve.iter().filter(is_on_plot) {
            let amount = f64::from(bias.amount.unwrap_or_default());
            let amount = if class == "front" { format!("{:.1} % of", 100.0 * amount) } else { length(amount) };
            plot.dot(dot, 2.0, place(bias), &format!("{amount} {}: {} pixels of acne", bias.name, bias.acne));
        }
    }
    // The first is the automatic bias: its dot lies on those of others, and its name is nearest to it.
    for (index, bias) in light.rules.iter().enumerate().rev().filter(|(_, bias)| is_on_plot(bias)) {
        plot.dot(if index == 0 { "dot on-front" } else { "dot" }, 5.0, place(bias), &bias.name);
    }
    for bias in light.rules.iter().filter(is_on_plot) {
        plot.name(place(bias), &bias.name);
    }
    plot.finish()
}

/// A power of ten in metres, or 0.
fn decade(metres: f64) -> String {
    length(metres).replace(".00", "").replace(".0", "")
}

fn table(light: &LightReport) -> String {
    let heads: String = HEADINGS.iter().map(|heading| format!("<th>{heading}</th>")).collect();
    let rows: String = light
        .rules
        .iter()
        .map(|bias| {
            let what = bias.what.map_or_else(String::new, |what| format!(" title=\"{}\"", escaped(what)));
            let cells: String = cells(bias).iter().map(|cell| format!("<td>{}</td>", escaped(cell))).collect();
            format!("<tr{what}>{cells}</tr>\n")
        })
        .collect();
    let what: String = light
        .rules
        .iter()
        .filter_map(|bias| bias.what.map(|what| format!("<li>{}: {}</li>\n", escaped(&bias.name), escaped(what))))
        .collect();
    format!(
        "<div class=\"wide\"><table class=\"biases\"><thead><tr>{heads}</tr></thead><tbody>\n{rows}</tbody></table></div>\n\
         <details><summary>What of the engines is tried</summary><ul>\n{what}</ul></details>\n"
    )
}
