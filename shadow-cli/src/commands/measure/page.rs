//! The report as one page that holds everything it shows.

use base64::{Engine, engine::general_purpose::STANDARD};
use shadow_cpu::measure::{Cause, Region};
use shadow_scene::{Layer, LayerName, Pixels};

use super::{CountsReport, MIB, Milliseconds, Report, Shown, TechniqueReport, percent, plot};
use crate::{
    colors::{STRETCH_LEGEND, color_of, heat, stretch_color},
    error::CliError,
    page::{escaped, notes},
    picture::{Picture, encode_color},
};

/// Width and height of a region, in pixels.
const REGION: u32 = 64;
/// How many regions of each technique are shown.
const REGIONS: usize = 4;
/// How many times a region is magnified.
const MAGNIFICATION: u32 = 4;

/// What a cause is, in a few words.
fn meaning_of(cause: Cause) -> &'static str {
    match cause {
        Cause::Coverage => "renderer and rays see different triangles",
        Cause::Terminator => "shading and geometric normal disagree about facing the light",
        Cause::Seam => "a tap leaves its cube face or the map",
        Cause::Filter => "the outline runs between the taps, which are mixed",
        Cause::Aliasing => "the outline runs between the taps, and the lookup is on the wrong side",
        Cause::Acne => "all taps see the light: the surface shadows itself",
        Cause::PeterPanning => "all taps are in shadow, whose caster is nearer than the bias",
        Cause::Leak => "all taps are in shadow, whose caster is farther than the bias",
    }
}

/// A picture in bytes, rows from the top.
struct Pixmap {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl Pixmap {
    fn of_color(width: u32, height: u32, color: &[[f32; 4]]) -> Self {
        Self { width, height, pixels: color.iter().map(|&color| encode_color(color)).collect() }
    }

    /// A part of it.
    fn crop(&self, region: &Region) -> Self {
        let rows = (region.y..region.y + region.height).map(|y| {
            let first = (y * self.width + region.x) as usize;
            &self.pixels[first..first + region.width as usize]
        });
        Self { width: region.width, height: region.height, pixels: rows.flatten().copied().collect() }
    }

    /// An image element; `class` and `alt` are plain words.
    fn element(self, class: &str, alt: &str) -> Result<String, CliError> {
        let (width, height) = (self.width, self.height);
        let mut png = Vec::new();
        let failed = |source| CliError::Write { path: "index.html".into(), source };
        Picture::of_pixels(width, height, self.pixels).write_png(&mut png).map_err(failed)?;
        let data = STANDARD.encode(png);
        Ok(format!(
            "<img class=\"{class}\" width=\"{width}\" height=\"{height}\" alt=\"{alt}\" src=\"data:image/png;base64,{data}\">"
        ))
    }
}

/// The page. `truth` are the colours that the picture would have with true visibilities.
pub(super) fn html(report: &Report<'_>, shown: &[Shown], truth: &[[f32; 4]]) -> Result<String, CliError> {
    let (width, height) = (report.picture.width, report.picture.height);
    let scene = escaped(report.picture.scene);
    let adapter = report.adapter.as_ref().map_or_else(String::new, |adapter| format!(" ({})", escaped(adapter)));
    let mut page = format!(
        "<h1>Shadows of {scene}, measured against the truth</h1>\n\
         <p>{} triangles, {width} x {height} pixels, rendered on {}{adapter}. The truth is traced in double precision{}.</p>\n",
        report.picture.triangles,
        report.backend,
        report.light_samples.map_or_else(String::new, |count| format!("; lights that have a size take {count} rays a pixel"))
    );
    page.push_str(&notes(report.picture.notes));
    page.push_str(&legend());
    page.push_str(&table(report));
    let dots: Vec<_> = report
        .techniques
        .iter()
        .map(|technique| plot::Dot {
            name: technique.settings.name(),
            cost: technique.milliseconds.total,
            error: technique.counts.rmse,
        })
        .collect();
    page.push_str(
        "<h2>Error against cost</h2>\n<p>The line joins the techniques that no other is both cheaper and better than.</p>\n",
    );
    page.push_str(&plot::svg(&dots));
    let truth = Pixmap::of_color(width, height, truth);
    for (number, (technique, shown)) in report.techniques.iter().zip(shown).enumerate() {
        page.push_str(&technique_section(number, technique, shown, &truth)?);
    }
    Ok(crate::page::page(&format!("Shadows of {}, measured", report.picture.scene), &page))
}

fn legend() -> String {
    let entries: String = Cause::ALL
        .iter()
        .rev()
        .map(|&cause| {
            let [r, g, b] = color_of(cause);
            format!(
                "<div><dt><i style=\"background:rgb({r},{g},{b})\"></i>{}</dt><dd>{}</dd></div>\n",
                cause.name().replace('_', " "),
                meaning_of(cause)
            )
        })
        .collect();
    format!("<h2>Causes</h2>\n<dl class=\"legend\">\n{entries}</dl>\n")
}

fn table(report: &Report<'_>) -> String {
    let heads: String = Cause::ALL.iter().rev().map(|cause| format!("<th>{}</th>", cause.name().replace('_', " "))).collect();
    let mut table = format!(
        "<h2>Techniques</h2>\n<div class=\"wide\"><table><thead><tr><th>technique</th><th>settings</th><th>wrong</th>{heads}<th>RMSE</th>\
         <th>unstable</th><th>m 95 %</th><th>m &gt; 1</th><th>waste</th><th>maps</th><th>camera</th><th>shading</th><th>frame</th><th>memory</th></tr></thead><tbody>\n"
    );
    for (number, technique) in report.techniques.iter().enumerate() {
        let TechniqueReport { settings, summary, counts, milliseconds, map_bytes, stability, aliasing, lights } = technique;
        let Milliseconds { shadow_maps, camera, shading, total } = milliseconds;
        let motions: Vec<String> =
            stability.named().iter().map(|(name, share)| format!("{name} {}", super::share(*share))).collect();
        table.push_str(&format!(
            "<tr><td><a href=\"#technique-{number}\">{}</a></td><td>{}</td>{}<td title=\"{}\">{}</td>{}\
             <td>{shadow_maps:.1} ms</td><td>{camera:.1} ms</td><td>{shading:.1} ms</td><td>{total:.1} ms</td><td>{:.0} MiB</td></tr>\n",
            escaped(settings.name()),
            escaped(summary),
            cells(counts),
            motions.join(", "),
            super::share(stability.worst_of_camera()),
            aliasing.cells(),
            *map_bytes as f64 / MIB,
        ));
        for light in lights.iter().filter(|_| lights.len() > 1) {
            table.push_str(&format!(
                "<tr class=\"light\"><td></td><td>{}</td>{}<td></td>{}<td colspan=\"5\"></td></tr>\n",
                escaped(&light.name),
                cells(&light.counts),
                light.aliasing.cells()
            ));
        }
    }
    table.push_str("</tbody></table></div>\n");
    if let Some(first) = report.techniques.first() {
        let CountsReport { pixels, at_terminator, .. } = first.counts;
        table.push_str(&format!(
            "<p>Of {pixels} pixels that a light can reach, counted once for each light, {at_terminator} lie where smooth normals and flat faces disagree about facing the \
             light: there a smooth mesh shows its facets whatever casts shadows (the terminator).</p>\n"
        ));
    }
    table.push_str(
        "<p>m is over how many pixels one texel of a map smears where it is longest; outlines are off by at most 0.71 m pixels. Of the pixels that the light does not graze, 95 % have at most \
         <em>m 95 %</em>, and the share <em>m &gt; 1</em> has texels longer than pixels. <em>waste</em> is the share of the maps' texels that no pixel sees.</p>\n",
    );
    table
}

/// The cells from `wrong` to `RMSE`.
fn cells(counts: &CountsReport) -> String {
    let causes: String = Cause::ALL
        .iter()
        .rev()
        .map(|&cause| match counts.causes.0.count(cause) {
            0 => "<td class=\"none\">0</td>".into(),
            count => format!("<td>{count}</td>"),
        })
        .collect();
    format!("<td>{}</td>{causes}<td>{:.4}</td>", percent(counts.wrong, counts.pixels), counts.rmse)
}

fn technique_section(number: usize, technique: &TechniqueReport, shown: &Shown, truth: &Pixmap) -> Result<String, CliError> {
    let name = escaped(technique.settings.name());
    let judgement = &shown.judgement;
    let (width, height) = (judgement.width, judgement.height);
    let color = Pixmap::of_color(width, height, color_layer(shown)?);
    let causes = cause_map(&color, &judgement.causes());
    let errors = Pixmap { width, height, pixels: judgement.errors().into_iter().map(heat).collect() };
    let stretches = shown.aliasing.worst().into_iter().map(stretch_color).collect();
    let stretches = Pixmap { width, height, pixels: stretches };
    let regions = judgement.worst_regions(REGION, REGIONS);
    let mut section = format!(
        "<section><h2 id=\"technique-{number}\">{name}</h2>\n<p>{}</p>\n<div class=\"pictures\">\n",
        escaped(&technique.summary)
    );
    let mut figure = |element: String, caption: &str| {
        section.push_str(&format!("<figure>{element}<figcaption>{caption}</figcaption></figure>\n"));
    };
    let crops: Vec<_> =
        regions.iter().map(|region| (region, color.crop(region), truth.crop(region), causes.crop(region))).collect();
    let flip = format!(
        "<div class=\"flip\" tabindex=\"0\">{}{}</div>",
        Pixmap { width, height, pixels: truth.pixels.clone() }.element("under", "the truth")?,
        color.element("over", "the technique")?
    );
    figure(flip, "the technique; the truth while the pointer is on it");
    figure(causes.element("", "wrong pixels by cause")?, "wrong pixels, coloured by cause");
    figure(
        errors.element("", "how far visibility is off")?,
        "how far visibility is off: from black, right, over red to white, wrong altogether",
    );
    figure(stretches.element("", "pixels that a texel smears over")?, &format!("m, the largest of all lights: {STRETCH_LEGEND}"));
    section.push_str("</div>\n");
    if crops.is_empty() {
        section.push_str("<p>Nothing is wrong.</p>\n");
    } else {
        section.push_str("<h3>Where it is wrong most</h3>\n<div class=\"regions\">\n");
        for (region, technique, truth, causes) in crops {
            let cause = region.cause.map_or("the light's size", Cause::name).replace('_', " ");
            section.push_str(&format!(
                "<figure><div class=\"row\" style=\"--times:{MAGNIFICATION}\">{}{}{}</div><figcaption>at ({}, {}): mostly {cause}; technique, truth, causes</figcaption></figure>\n",
                technique.element("crop", "technique")?,
                truth.element("crop", "truth")?,
                causes.element("crop", "causes")?,
                region.x,
                region.y
            ));
        }
        section.push_str("</div>\n");
    }
    section.push_str(&format!("<h3>Its light cameras</h3>\n<div class=\"wide\">{}</div>\n</section>\n", inline(&shown.drawing)));
    Ok(section)
}

/// A drawing as a page has it: without the name of its language, which files need.
fn inline(svg: &str) -> String {
    svg.replace(" xmlns=\"http://www.w3.org/2000/svg\"", "")
}

/// The colour layer of what is shown.
fn color_layer(shown: &Shown) -> Result<&[[f32; 4]], CliError> {
    let missing = CliError::Layer { backend: "measured", layer: LayerName::Color };
    match shown.frame.layer(LayerName::Color) {
        Some(Layer { pixels: Pixels::Rgba(color), .. }) => Ok(color),
        _ => Err(missing),
    }
}

/// The picture in dim grey, with wrong pixels in the colour of their cause.
fn cause_map(color: &Pixmap, causes: &[u8]) -> Pixmap {
    let pixels = color.pixels.iter().zip(causes).map(|(&[r, g, b], &cause)| match Cause::of_number(cause) {
        Some(cause) => color_of(cause),
        None => {
            // A third of the mean brightness leaves the colours of causes the brightest.
            let grey = ((u16::from(r) + u16::from(g) + u16::from(b)) / 9) as u8;
            [grey; 3]
        }
    });
    Pixmap { width: color.width, height: color.height, pixels: pixels.collect() }
}
