//! What tests say, and what a failed comparison leaves behind: expected, difference and actual as one picture, and the numbers.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use shadow_math::srgb::encode_pixel;
use shadow_scene::{Frame, Layer, NO_TRIANGLE, Pixels, compare::Comparison};

use crate::known::beyond_known;

/// Where reports go: a folder that is not under version control.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../failures")
}

/// Says a line where the results of tests are read, also if the test passes: the harness of tests keeps what `print!` and `eprint!` say, but
/// not what is written to the stream itself.
pub fn say(line: &str) {
    // A line that nobody reads is no reason to fail.
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Asserts that two frames agree; if not, writes a report for every layer that does not and panics with its paths.
///
/// # Panics
///
/// If the frames do not agree.
pub fn assert_agreement(case: &str, comparison: &Comparison, expected: &Frame, actual: &Frame) {
    if let Some(disagreement) = disagreement(case, comparison, expected, actual) {
        panic!("{disagreement}");
    }
}

/// What there is to say if two frames do not agree: a line for every layer that does not, with the paths of a report on it. Layers are in the
/// order of the stages, so the first is where to look. What is known of the adapter is nothing to say.
#[must_use]
pub fn disagreement(case: &str, comparison: &Comparison, expected: &Frame, actual: &Frame) -> Option<String> {
    let text = (!comparison.agree()).then(|| text_of(case, comparison, expected, actual));
    beyond_known(case, text)
}

fn text_of(case: &str, comparison: &Comparison, expected: &Frame, actual: &Frame) -> String {
    let mut lines = Vec::new();
    for layer in comparison.layers.iter().filter(|layer| !layer.within_contract) {
        // File systems have names of 255 bytes, of which the endings take some.
        let case: String = case.chars().take(200).collect();
        let stem = format!("{case}-{}", layer.name).replace([':', ' ', '/'], "-");
        let numbers = serde_json::json!({
            "layer": layer.name.to_string(),
            "contract": comparison.contract.name(),
            "pixels": layer.pixels,
            "differing": layer.differing,
            "violations": layer.violations,
            "left_out": { "camera_coverage": layer.left_out.camera_coverage, "map_coverage": layer.left_out.map_coverage, "tie": layer.left_out.tie },
            "max_difference": layer.max_difference,
        });
        let written = match (expected.layer(layer.name), actual.layer(layer.name)) {
            (Some(expected), Some(actual)) => write(&stem, &numbers, expected, actual),
            _ => Err("a layer is missing".into()),
        };
        let where_to = written.unwrap_or_else(|error| format!("(no report: {error})"));
        lines.push(format!(
            "{}: {} pixels differ, {} break the contract; {where_to}",
            layer.name, layer.differing, layer.violations
        ));
    }
    format!("{case}: the frames disagree\n{}", lines.join("\n"))
}

fn write(
    stem: &str,
    numbers: &serde_json::Value,
    expected: &Layer,
    actual: &Layer,
) -> Result<String, Box<dyn std::error::Error>> {
    let folder = folder();
    fs::create_dir_all(&folder)?;
    let (width, height) = (expected.width, expected.height);
    let mut picture = image::RgbImage::new(3 * width, height);
    for y in 0..height {
        for x in 0..width {
            let index = (y * width + x) as usize;
            let (a, b) = (pixel(expected, index), pixel(actual, index));
            let size = expected.pixels.as_bytes().len() / expected.pixels.len();
            let bytes = |layer: &Layer| layer.pixels.as_bytes()[index * size..][..size].to_vec();
            // Any differing bit is red, however small it is.
            let mask = if bytes(expected) == bytes(actual) { [0, 0, 0] } else { [255, 0, 0] };
            picture.put_pixel(x, y, image::Rgb(a));
            picture.put_pixel(width + x, y, image::Rgb(mask));
            picture.put_pixel(2 * width + x, y, image::Rgb(b));
        }
    }
    let png = folder.join(format!("{stem}.png"));
    picture.save(&png)?;
    let json = folder.join(format!("{stem}.json"));
    fs::write(&json, serde_json::to_string_pretty(numbers)?)?;
    Ok(format!("expected | difference | actual in {}, numbers in {}", png.display(), json.display()))
}

/// A pixel of a layer as something to look at.
fn pixel(layer: &Layer, index: usize) -> [u8; 3] {
    match &layer.pixels {
        Pixels::Rgba(values) => {
            let [r, g, b, _] = encode_pixel(values[index].into());
            [r, g, b]
        }
        Pixels::Float(values) => [(values[index] * 255.0) as u8; 3],
        Pixels::Id(values) if values[index] == NO_TRIANGLE => [0; 3],
        // A multiplication that scatters neighbouring numbers over the colours.
        Pixels::Id(values) => values[index].wrapping_mul(2_654_435_761).to_le_bytes()[1..].try_into().unwrap_or([0; 3]),
    }
}
