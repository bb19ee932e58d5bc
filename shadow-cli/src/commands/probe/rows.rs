//! Findings as rows: a name and a value for programs, and words for people.

use serde_json::{Value, json};
use shadow_gpu::probe::{
    BiasRules, DepthError, DepthLimits, DepthPlane, DepthStorage, FormatRules, GridRounding, Measured, PlaneRules, RangeOverflow,
    RasterFindings, SlopeRule, Ties, UnitAt, UnitRule,
};

/// What stands in place of a value that could not be measured; the reason is told below the tables.
const NOT_MEASURED: &str = "not measured";

/// A finding.
#[derive(Debug)]
pub(super) struct Row {
    /// Its name for programs.
    pub(super) name: &'static str,
    /// Null if it could not be measured.
    pub(super) value: Value,
    /// The value in words.
    pub(super) text: String,
    /// Why it could not be measured.
    pub(super) reason: Option<String>,
}

impl Row {
    fn new<T>(name: &'static str, finding: &Measured<T>, value: impl Fn(&T) -> Value, text: impl Fn(&T) -> String) -> Self {
        match finding {
            Ok(found) => Self { name, value: value(found), text: text(found), reason: None },
            Err(reason) => Self { name, value: Value::Null, text: NOT_MEASURED.into(), reason: Some(reason.to_string()) },
        }
    }

    /// A finding that is a word.
    fn word<T: Copy>(name: &'static str, finding: &Measured<T>, word: impl Fn(T) -> &'static str) -> Self {
        Self::new(name, finding, |found| json!(word(*found)), |found| word(*found).into())
    }

    /// A finding that is yes or no.
    fn flag(name: &'static str, finding: &Measured<bool>) -> Self {
        Self::new(name, finding, |found| json!(found), |found| if *found { "yes" } else { "no" }.into())
    }

    /// Its name for people.
    pub(super) fn label(&self) -> String {
        self.name.replace('_', " ")
    }
}

/// A power of two as such, and any other share of the depth range as a fraction.
pub(super) fn share(number: f64) -> String {
    /// How near a number must be to a power of two: nearer than `1/65535` is to `1/65536`.
    const TOLERANCE: f64 = 1e-5;
    let power = number.log2().round();
    if (number / power.exp2() - 1.0).abs() < TOLERANCE { format!("2^{power}") } else { format!("1/{:.1}", number.recip()) }
}

fn rounding(rounding: GridRounding) -> &'static str {
    match rounding {
        GridRounding::Nearest(Ties::Even) => "nearest, ties to even",
        GridRounding::Nearest(Ties::Up) => "nearest, ties up",
        GridRounding::Nearest(Ties::Down) => "nearest, ties down",
        GridRounding::Floor => "floor",
        GridRounding::Ceiling => "ceiling",
    }
}

/// Where triangles have samples.
pub(super) fn raster_rows(found: &RasterFindings) -> Vec<Row> {
    let yes = |covers: bool| if covers { "covers" } else { "does not" };
    let rule = |rule: fn(&shadow_gpu::probe::EdgeRule) -> bool| found.edges.as_ref().map(rule).map_err(Clone::clone);
    vec![
        Row::new(
            "subpixel_bits",
            &found.subpixel_bits,
            |bits| json!(bits),
            |bits| format!("{bits}: corners lie on a grid of 1/{} pixel", 1_u64 << bits),
        ),
        Row::new(
            "rounding",
            &found.rounding,
            |[x, y]| json!({ "x": rounding(*x), "y": rounding(*y) }),
            |[x, y]| if x == y { rounding(*x).into() } else { format!("x {}; y {}", rounding(*x), rounding(*y)) },
        ),
        Row::new(
            "sample",
            &found.sample,
            |sample| json!({ "x": sample.x, "y": sample.y, "has_centre": sample.has_centre() }),
            |sample| {
                let place = |[low, high]: [f64; 2]| format!("{low} to {high}");
                let centre = if sample.has_centre() { "which has the centre" } else { "which has not the centre" };
                format!("x {}, y {} of a pixel, {centre}", place(sample.x), place(sample.y))
            },
        ),
        Row::new(
            "edges",
            &found.edges,
            |edges| {
                json!({
                    "left": edges.left, "right": edges.right, "top": edges.top, "bottom": edges.bottom,
                    "left_diagonals": edges.left_diagonals, "right_diagonals": edges.right_diagonals,
                })
            },
            |edges| {
                let [left, top, right, bottom] = [edges.left, edges.top, edges.right, edges.bottom].map(yes);
                format!("a left edge through a sample {left}, a top one {top}, a right one {right}, a bottom one {bottom}")
            },
        ),
        Row::flag("top_left_rule", &rule(shadow_gpu::probe::EdgeRule::is_top_left)),
        Row::flag("covers_shared_edges_once", &rule(shadow_gpu::probe::EdgeRule::covers_once)),
    ]
}

fn depth_error(name: &'static str, error: &Measured<DepthError>) -> Row {
    Row::new(
        name,
        error,
        |error| {
            let DepthError { samples, median_ulp, worst_ulp, worst, worst_of_bound } = error;
            json!({
                "samples": samples, "median_ulp": median_ulp, "worst_ulp": worst_ulp, "worst": worst, "worst_of_bound": worst_of_bound,
            })
        },
        |error| {
            let DepthError { samples, median_ulp, worst_ulp, worst, worst_of_bound } = error;
            let percent = 100.0 * worst_of_bound;
            format!(
                "{median_ulp:.2} ulp off in the median of {samples} samples, at worst {worst_ulp:.1} ({worst:.1e} of the range, {percent:.1} % of the bias's bound)"
            )
        },
    )
}

/// Which depth samples get.
pub(super) fn plane_rows(found: &PlaneRules) -> Vec<Row> {
    let plane = |plane| match plane {
        DepthPlane::Unsnapped => "unsnapped corners",
        DepthPlane::Snapped => "snapped corners",
    };
    vec![
        Row::word("goes_through", &found.plane, plane),
        depth_error("parallel", &found.parallel),
        depth_error("perspective", &found.perspective),
    ]
}

fn overflow(overflow: RangeOverflow) -> &'static str {
    match overflow {
        RangeOverflow::Clamped => "clamped",
        RangeOverflow::Kept => "kept",
    }
}

/// What becomes of triangles that reach beyond the near and far planes.
pub(super) fn limit_rows(found: &DepthLimits) -> Vec<Row> {
    vec![
        Row::flag("near_clips", &found.near_clips),
        Row::flag("far_clips", &found.far_clips),
        Row::word("unclipped_depth", &found.unclipped, overflow),
    ]
}

/// Units in words: one if they are all alike, else one for each depth.
fn units_text(units: &[UnitAt]) -> String {
    /// How far units may be from each other, as a share, and still be called alike: what is left of the rounding of depths.
    const TOLERANCE: f64 = 1e-5;
    match units.last() {
        Some(last) if units.iter().all(|at| (at.unit / last.unit - 1.0).abs() < TOLERANCE) => share(last.unit),
        _ => units.iter().map(|at| format!("{} at {}", share(at.unit), at.depth)).collect::<Vec<_>>().join("\n"),
    }
}

fn bias_rows(found: &BiasRules) -> Vec<Row> {
    let depends_on = |unit| match unit {
        UnitRule::Fixed => "nothing",
        UnitRule::Triangle => "the triangle's greatest depth",
        UnitRule::Sample => "each sample's depth",
    };
    let slope = |rule| match rule {
        SlopeRule::Maximum => "max(|dz/dx|, |dz/dy|)",
        SlopeRule::Hypotenuse => "hypot(dz/dx, dz/dy)",
        SlopeRule::Sum => "|dz/dx| + |dz/dy|",
    };
    let clamps = |clamps| if clamps { "bounds the bias" } else { "is ignored" };
    vec![
        Row::new(
            "bias_units",
            &found.units,
            |units| Value::Array(units.iter().map(|at| json!({ "depth": at.depth, "unit": at.unit })).collect()),
            |units| units_text(units),
        ),
        Row::word("bias_unit_depends_on", &found.depends_on, depends_on),
        Row::word("bias_slope", &found.slope, slope),
        Row::word("bias_clamp", &found.clamps, clamps),
        Row::word("bias_beyond_1", &found.overflow, overflow),
    ]
}

/// What depends on the format of depths.
pub(super) fn format_rows(found: &FormatRules) -> Vec<Row> {
    let mut rows = vec![
        Row::new(
            "storage",
            &found.depth.storage,
            |storage| match storage {
                DepthStorage::Unorm { bits } => json!({ "kind": "unorm", "bits": bits }),
                DepthStorage::Float => json!({ "kind": "float", "bits": f32::MANTISSA_DIGITS + 8 }),
            },
            |storage| match storage {
                DepthStorage::Unorm { bits } => format!("{bits}-bit whole numbers"),
                DepthStorage::Float => "single precision".into(),
            },
        ),
        Row::word("written_beyond_0_to_1", &found.depth.written, overflow),
    ];
    rows.extend(bias_rows(&found.bias));
    let comparison = &found.comparison;
    rows.extend([
        Row::new(
            "comparison_taps",
            &comparison.filter,
            |filter| json!(filter.taps()),
            |filter| match filter.taps() {
                1 => "1, the nearest texel".into(),
                taps => format!("{taps}, bilinear weights"),
            },
        ),
        Row::flag("compares_first", &comparison.compares_first),
        Row::new(
            "weight_steps",
            &comparison.steps,
            |steps| json!({ "bits": steps.bits, "or_finer": steps.or_finer }),
            |steps| format!("2^-{}{}", steps.bits, if steps.or_finer { " or finer" } else { "" }),
        ),
        Row::new("worst_weight_error", &comparison.worst_weight_error, |error| json!(error), |error| format!("{error:.1e}")),
    ]);
    rows
}

#[cfg(test)]
mod tests {
    use shadow_gpu::probe::Unmeasured;

    use super::*;

    #[test]
    fn shares_are_powers_of_two_only_if_they_are() {
        assert_eq!(share(1.0 / 65_536.0), "2^-16");
        assert_eq!(share(1.0 / 65_535.0), "1/65535.0");
        assert_eq!(share(1.5 / 1024.0), "1/682.7");
    }

    #[test]
    fn units_are_told_once_where_they_are_alike() {
        let at = |depth, unit| UnitAt { depth, unit };
        assert_eq!(units_text(&[at(0.75, 0.25), at(0.5, 0.25)]), "2^-2");
        assert_eq!(units_text(&[at(0.75, 0.25), at(0.5, 0.125)]), "2^-2 at 0.75\n2^-3 at 0.5");
    }

    /// What was not measured has no value, and its reason.
    #[test]
    fn what_was_not_measured_is_null_with_its_reason() {
        let row = Row::flag("far_clips", &Err(Unmeasured("nothing was drawn".into())));
        assert_eq!((row.value, row.text.as_str()), (Value::Null, NOT_MEASURED));
        assert_eq!(row.reason.as_deref(), Some("nothing was drawn"));
    }
}
