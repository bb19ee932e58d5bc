//! What the findings mean for this project: a sentence for each that one of its techniques would depend on.

use shadow_cpu::{RasterRules, raster::DepthPlaneRule};
use shadow_gpu::probe::{
    AdapterRules, ComparisonRules, DepthFormat, DepthPlane, DepthStorage, FormatRules, GridRounding, Measured, PlaneRules,
    RangeOverflow, RasterFindings, SlopeRule, Ties, UnitRule,
};
use shadow_math::settings::SUBPIXEL_BITS;
use shadow_scene::compare::tolerance;

use super::rows::share;

/// How far a unit of bias may be from the usual one, as a share, and still be called that.
const UNIT_TOLERANCE: f64 = 0.001;

/// Whether something was measured, and is so.
fn holds<T>(finding: &Measured<T>, is_so: impl Fn(&T) -> bool) -> bool {
    finding.as_ref().is_ok_and(is_so)
}

/// A share of a pixel as a fraction of one.
fn fraction(share: f64) -> String {
    format!("1/{}", share.recip().round())
}

/// Half a step of a grid of so many bits, in pixels.
fn half_step(bits: u32) -> f64 {
    0.5 / f64::from(bits).exp2()
}

/// What to know before relying on this adapter.
pub(super) fn warnings(rules: &AdapterRules) -> Vec<String> {
    let mut warnings = Vec::new();
    of_raster(&rules.raster, &mut warnings);
    let planned_bits = rules.adapter.rules.subpixel_bits().unwrap_or(*SUBPIXEL_BITS.end());
    of_plane(&rules.plane, &rules.raster, planned_bits, &mut warnings);
    if holds(&rules.limits.near_clips, |clips| !clips) || holds(&rules.limits.far_clips, |clips| !clips) {
        warnings.push(
            "casters beyond the near or far plane are drawn although nothing asks for it: maps hold what the plan leaves out"
                .into(),
        );
    }
    for format in &rules.formats {
        of_format(format, &mut warnings);
    }
    warnings
}

fn of_raster(found: &RasterFindings, warnings: &mut Vec<String>) {
    let usual = RasterRules::default();
    if let Ok(bits) = found.subpixel_bits.as_ref()
        && *bits != usual.subpixel_bits
    {
        warnings.push(format!(
            "corners are snapped to 1/{} pixel, and to 1/{} by the CPU renderer's default rules: pictures of both backends differ at \
             edges, but for `shadow compare`, which follows the adapter",
            1_u64 << bits,
            1_u64 << usual.subpixel_bits
        ));
    }
    if holds(&found.rounding, |rounding| *rounding != [GridRounding::Nearest(Ties::Even); 2]) {
        warnings.push(
            "corners are not snapped to the nearest grid line with ties to even, as by the CPU renderer: the two renderers' maps differ where a \
             corner is half-way between two lines"
                .into(),
        );
    }
    if holds(&found.sample, |sample| !sample.has_centre()) {
        warnings.push("samples are not at pixel centres, which WebGPU promises: every lookup is off by their distance".into());
    }
    if holds(&found.edges, |edges| !edges.covers_once()) {
        warnings.push("triangles with a common edge leave samples on it out, or draw them twice: maps have holes".into());
    } else if holds(&found.edges, |edges| !edges.is_top_left()) {
        warnings.push(
            "edges through samples do not follow the top-left rule, which WebGPU promises: the two renderers' maps differ where an edge goes \
             exactly through a texel's centre"
                .into(),
        );
    }
}

/// `planned_bits` is the grid that plans leave half a step to.
fn of_plane(found: &PlaneRules, raster: &RasterFindings, planned_bits: u32, warnings: &mut Vec<String>) {
    let usual = RasterRules::default().depth_plane;
    if holds(&found.plane, |plane| (*plane == DepthPlane::Snapped) != (usual == DepthPlaneRule::Snapped)) {
        warnings.push(
            "depth planes do not go through the corners that the CPU renderer's default rules have: their depths differ by up to a \
             sub-pixel step times the slope, but for `shadow compare`, which follows the adapter"
                .into(),
        );
    }
    // The nearest line is at most half a step away, and the next one, where corners are not rounded to the nearest, a whole one.
    let steps = match &raster.rounding {
        Ok(rounding) if rounding.iter().all(|rounding| matches!(rounding, GridRounding::Nearest(_))) => 0.5,
        _ => 1.0,
    };
    if let (Ok(DepthPlane::Snapped), Ok(bits)) = (&found.plane, &raster.subpixel_bits)
        && let moved = steps / f64::from(*bits).exp2()
        && moved > half_step(planned_bits)
    {
        let enough = SUBPIXEL_BITS.rev().find(|&bits| half_step(bits) >= moved);
        let what_to_do = enough.map_or_else(
            || {
                format!(
                    "and no more than {} can be left to that: `--bias automatic` may leave acne",
                    fraction(half_step(*SUBPIXEL_BITS.start()))
                )
            },
            |bits| format!("which `--bias automatic` leaves room for with `--subpixel-bits {bits}`"),
        );
        warnings.push(format!(
            "depth planes go through corners that are moved by up to {} pixel first, {what_to_do}",
            fraction(moved)
        ));
    }
    let errors = [&found.parallel, &found.perspective].into_iter().filter_map(|error| error.as_ref().ok());
    let worst = errors.map(|error| error.worst_of_bound).fold(0.0, f64::max);
    if worst > 1.0 {
        warnings.push(format!(
            "depths are off by up to {worst:.1} times what the automatic bias leaves to rounding: it does not hold here, and `--bias \
             automatic` may leave acne"
        ));
    }
}

fn of_format(found: &FormatRules, warnings: &mut Vec<String>) {
    let name = found.format.name();
    if found.format == DepthFormat::Depth24Plus
        && holds(&found.depth.storage, |storage| *storage != DepthStorage::Unorm { bits: 24 })
    {
        warnings.push(format!(
            "{name} is not 24-bit whole numbers here: a map of 24 bits cannot be made of it, and its rounding is another"
        ));
    }
    if holds(&found.depth.written, |overflow| *overflow == RangeOverflow::Kept) {
        warnings.push(format!(
            "{name} keeps depths outside of 0 to 1 that a fragment writes: a shader that writes depth must clamp it itself"
        ));
    }
    if let Some(unit) = unusual_unit(found) {
        warnings.push(format!("{name}: {unit}; a bias in the pipeline's units would not be the same shadow on another adapter"));
    }
    if holds(&found.bias.slope, |slope| *slope != SlopeRule::Maximum) {
        warnings.push(format!(
            "{name}: a slope-scaled bias does not multiply the greater derivative, as on most adapters; a bias in the pipeline's units would not \
             be the same shadow on another adapter"
        ));
    }
    of_comparison(name, &found.comparison, warnings);
}

/// In words, a unit of the constant bias that is not what Vulkan's and Direct3D's texts have.
fn unusual_unit(found: &FormatRules) -> Option<String> {
    let greatest = *found.bias.units.as_ref().ok()?.first()?;
    let storage = *found.depth.storage.as_ref().ok()?;
    let (usual, depends_on) = match storage {
        DepthStorage::Unorm { bits } => (f64::from(bits).exp2().recip(), UnitRule::Fixed),
        // The last place of the triangle's greatest depth.
        DepthStorage::Float => ((greatest.depth.log2().floor() - f64::from(f32::MANTISSA_DIGITS - 1)).exp2(), UnitRule::Triangle),
    };
    if (greatest.unit / usual - 1.0).abs() > UNIT_TOLERANCE {
        return Some(format!(
            "a constant bias of 1 is {} at a depth of {}, not {}",
            share(greatest.unit),
            greatest.depth,
            share(usual)
        ));
    }
    let wrong = *found.bias.depends_on.as_ref().ok()? != depends_on;
    wrong.then(|| match depends_on {
        UnitRule::Fixed => "the unit of a constant bias is not the same at all depths".into(),
        UnitRule::Triangle | UnitRule::Sample => {
            "the unit of a constant bias does not go by the triangle's greatest depth".into()
        }
    })
}

fn of_comparison(name: &str, found: &ComparisonRules, warnings: &mut Vec<String>) {
    if holds(&found.filter, |filter| filter.taps() == 1) {
        warnings.push(format!("{name}: the comparison sampler tests one texel: filtering by hardware is none"));
        return;
    }
    if holds(&found.compares_first, |compares_first| !compares_first) {
        warnings.push(format!(
            "{name}: the comparison sampler averages depths before it compares them, which is no filter of shadows"
        ));
    }
    if let Ok(error) = found.worst_weight_error.as_ref()
        && *error > f64::from(tolerance::VISIBILITY)
    {
        warnings.push(format!(
            "{name}: the comparison sampler's weights are up to {error:.1e} from bilinear ones, more than the {:.1e} that `shadow compare` allows \
             visibility: filters must stay explicit taps",
            tolerance::VISIBILITY
        ));
    }
}

#[cfg(test)]
mod tests {
    use shadow_gpu::probe::{EdgeRule, SampleRange, Unmeasured};

    use super::*;

    fn raster(bits: u32) -> RasterFindings {
        RasterFindings {
            subpixel_bits: Ok(bits),
            rounding: Ok([GridRounding::Nearest(Ties::Even); 2]),
            sample: Ok(SampleRange { x: [0.5; 2], y: [0.5; 2] }),
            edges: Ok(EdgeRule {
                left: true,
                right: false,
                top: true,
                bottom: false,
                left_diagonals: [true; 2],
                right_diagonals: [false; 2],
            }),
        }
    }

    fn plane(plane: DepthPlane) -> PlaneRules {
        let unknown = || Err(Unmeasured("nothing was drawn".into()));
        PlaneRules { plane: Ok(plane), parallel: unknown(), perspective: unknown() }
    }

    fn told(bits: u32, depth_plane: DepthPlane) -> String {
        told_of_plan(bits, depth_plane, 8)
    }

    fn told_of_plan(bits: u32, depth_plane: DepthPlane, planned_bits: u32) -> String {
        let mut warnings = Vec::new();
        of_raster(&raster(bits), &mut warnings);
        of_plane(&plane(depth_plane), &raster(bits), planned_bits, &mut warnings);
        warnings.join("\n")
    }

    #[test]
    fn the_usual_rules_need_no_warning() {
        assert_eq!(told(8, DepthPlane::Unsnapped), "");
    }

    /// A coarse grid by itself moves outlines; under the depth plane the automatic bias must also know of it.
    #[test]
    fn a_coarse_grid_under_the_depth_plane_must_be_planned_for() {
        let outlines = told(4, DepthPlane::Unsnapped);
        assert!(outlines.contains("1/16 pixel") && !outlines.contains("automatic"), "{outlines}");
        let both = told(4, DepthPlane::Snapped);
        assert!(both.contains("up to 1/32 pixel") && both.contains("`--subpixel-bits 4`"), "{both}");
        assert!(!told(8, DepthPlane::Snapped).contains("automatic"), "half a step of 8 bits is what the bias leaves room for");
        assert!(!told_of_plan(4, DepthPlane::Snapped, 4).contains("automatic"), "a grid that is known is planned for");
        assert!(told(3, DepthPlane::Snapped).contains("no more than 1/32"), "Vulkan allows no such grid");
    }

    /// What was not measured is no reason to warn.
    #[test]
    fn what_is_not_known_is_not_warned_of() {
        let mut warnings = Vec::new();
        let unknown = || Unmeasured("nothing was drawn".into());
        let raster = RasterFindings {
            subpixel_bits: Err(unknown()),
            rounding: Err(unknown()),
            sample: Err(unknown()),
            edges: Err(unknown()),
        };
        of_raster(&raster, &mut warnings);
        of_plane(&plane(DepthPlane::Unsnapped), &raster, 8, &mut warnings);
        assert!(warnings.is_empty(), "{warnings:?}");
    }
}
