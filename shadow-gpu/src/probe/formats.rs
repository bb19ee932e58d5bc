//! What becomes of depths: which of them a format can keep, and what happens beyond the near and far planes.

use super::{
    DepthFormat, Measured,
    rig::{Drawing, Rig},
    triangles::{CELL, CELLS, SHEET, Sheet, Triangle, middle, rectangle},
    unmeasured,
};

/// How depths are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthStorage {
    /// As a whole number from 0 to `2^bits - 1`, evenly spaced.
    Unorm {
        /// Bits of the number.
        bits: u32,
    },
    /// In single precision.
    Float,
}

/// What becomes of depths outside of 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RangeOverflow {
    /// They become 0 or 1.
    Clamped,
    /// They stay as they are.
    Kept,
}

/// What a depth format keeps.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthRules {
    /// How depths are kept.
    pub storage: Measured<DepthStorage>,
    /// What becomes of depths outside of 0 to 1 that a fragment writes.
    pub written: Measured<RangeOverflow>,
}

/// What becomes of triangles that reach beyond the near and far planes.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthLimits {
    /// Whether they are clipped at the near plane.
    pub near_clips: Measured<bool>,
    /// Whether they are clipped at the far plane.
    pub far_clips: Measured<bool>,
    /// What depth their samples beyond the planes get in pipelines with `unclippedDepth`.
    pub unclipped: Measured<RangeOverflow>,
}

/// Writes one depth in each cell, as many as there are.
async fn written(rig: &Rig, format: DepthFormat, depths: &[f32]) -> Measured<Vec<f32>> {
    let half = f64::from(CELL / 4);
    let triangles: Vec<_> = (0..CELLS)
        .zip(depths)
        .flat_map(|(cell, depth)| {
            let [x, y] = middle(cell);
            rectangle(SHEET, [x - half, y - half], [x + half, y + half], 0.5).map(|triangle| triangle.writing(*depth))
        })
        .collect();
    let sheet = rig.draw(&Drawing { format, writes_depth: true, ..Drawing::new(&triangles) }).await?;
    Ok((0..CELLS).zip(depths).map(|(cell, _)| sheet.in_cell(cell)).collect())
}

/// The bits of a format with evenly spaced depths that kept `kept`, a sequence that rises more slowly than it can follow.
fn unorm_bits(kept: &[f32]) -> Measured<u32> {
    let steps = kept.windows(2).map(|pair| f64::from(pair[1]) - f64::from(pair[0]));
    let step = steps.filter(|step| *step != 0.0).fold(f64::INFINITY, |least, step| least.min(step.abs()));
    let bits = (step.recip() + 1.0).log2().round();
    let expected = (bits.exp2() - 1.0).recip();
    /// How far a step may be from that of so many bits, as a share: its ends are rounded to single precision.
    const TOLERANCE: f64 = 1e-3;
    if step.is_infinite() || (step / expected - 1.0).abs() > TOLERANCE {
        return unmeasured(format!(
            "the smallest step between depths that were kept is {step:e}, which is that of no number of bits"
        ));
    }
    Ok(bits as u32)
}

async fn storage(rig: &Rig, format: DepthFormat) -> Measured<DepthStorage> {
    /// The smallest power of two that a depth in single precision is tried with: far below what any whole number can keep.
    const SMALLEST_EXPONENT: i32 = 100;
    let falling: Vec<f32> = (1..=SMALLEST_EXPONENT).map(|exponent| 1.5 * (-exponent as f32).exp2()).collect();
    if written(rig, format, &falling).await? == falling {
        return Ok(DepthStorage::Float);
    }
    /// The distance of depths that are written: an eighth of a step of 24 bits, so that all of them reach two steps of 16 bits.
    const STEP_EXPONENT: f32 = -27.0;
    let rising: Vec<f32> = (0..CELLS).map(|cell| cell as f32 * STEP_EXPONENT.exp2()).collect();
    let bits = unorm_bits(&written(rig, format, &rising).await?)?;
    Ok(DepthStorage::Unorm { bits })
}

/// What became of depths below and above the range.
fn overflow(wanted: [f32; 2], kept: [f32; 2]) -> Measured<RangeOverflow> {
    if kept == [0.0, 1.0] {
        Ok(RangeOverflow::Clamped)
    } else if kept == wanted {
        Ok(RangeOverflow::Kept)
    } else {
        unmeasured(format!("depths of {} and {} became {} and {}", wanted[0], wanted[1], kept[0], kept[1]))
    }
}

/// Measures what a format keeps.
pub(super) async fn measure(rig: &Rig, format: DepthFormat) -> DepthRules {
    const OUTSIDE: [f32; 2] = [-0.5, 1.5];
    let kept = written(rig, format, &OUTSIDE).await;
    let written = kept.and_then(|kept| match kept[..] {
        [below, above] => overflow(OUTSIDE, [below, above]),
        _ => unmeasured("nothing was drawn"),
    });
    DepthRules { storage: storage(rig, format).await, written }
}

/// Where the strip begins and ends, in pixels from the left.
const STRIP: [u32; 2] = [128, 896];

/// The depths at its ends.
const STRIP_DEPTHS: [f64; 2] = [-0.5, 1.5];

/// A row of pixels that it covers.
const STRIP_ROW: u32 = SHEET / 2;

/// What the sheet is cleared to: no pixel of the strip has its centre at this depth.
const STRIP_BACKGROUND: f32 = 0.25;

/// The exact depth of the strip in a column of pixels.
fn strip_depth(column: u32) -> f64 {
    let share = (f64::from(column) + 0.5 - f64::from(STRIP[0])) / f64::from(STRIP[1] - STRIP[0]);
    STRIP_DEPTHS[0] + share * (STRIP_DEPTHS[1] - STRIP_DEPTHS[0])
}

/// Draws a strip whose depth rises from before the near plane to beyond the far one.
async fn strip(rig: &Rig, unclipped: bool) -> Measured<Sheet> {
    let [left, right] = STRIP.map(f64::from);
    let [top, bottom] = [f64::from(STRIP_ROW - CELL), f64::from(STRIP_ROW + CELL)];
    let [near, far] = STRIP_DEPTHS;
    let triangles = [
        Triangle::in_window(SHEET, [[left, top, near], [left, bottom, near], [right, top, far]]),
        Triangle::in_window(SHEET, [[right, top, far], [left, bottom, near], [right, bottom, far]]),
    ];
    rig.draw(&Drawing { unclipped, clear: STRIP_BACKGROUND, ..Drawing::new(&triangles) }).await
}

/// Whether the pixels of the strip are covered whose depth is in a part of it: all of them or none.
fn is_covered(sheet: &Sheet, part: impl Fn(f64) -> bool) -> Measured<bool> {
    /// Depths so near to a plane are left to rounding: half a pixel of the strip.
    const BORDER: f64 = 0.5 * 2.0 / 768.0;
    let is_clear = |depth: f64| depth.abs() > BORDER && (depth - 1.0).abs() > BORDER;
    let columns = (STRIP[0]..STRIP[1]).filter(|column| part(strip_depth(*column)) && is_clear(strip_depth(*column)));
    let found: Vec<_> = columns.map(|column| sheet.is_covered([column, STRIP_ROW])).collect();
    match (found.contains(&true), found.contains(&false)) {
        (is_covered, false) => Ok(is_covered),
        (false, true) => Ok(false),
        (true, true) => unmeasured("only some of the samples beyond the plane are drawn"),
    }
}

/// Measures what becomes of triangles that reach beyond the near and far planes.
pub(super) async fn measure_limits(rig: &Rig) -> DepthLimits {
    let clipped = strip(rig, false).await.and_then(|sheet| match is_covered(&sheet, |depth| (0.0..1.0).contains(&depth))? {
        true => Ok(sheet),
        false => unmeasured("a triangle that reaches beyond both planes is not drawn between them"),
    });
    let clips = |part: fn(f64) -> bool| clipped.clone().and_then(|sheet| Ok(!is_covered(&sheet, part)?));
    DepthLimits { near_clips: clips(|depth| depth < 0.0), far_clips: clips(|depth| depth > 1.0), unclipped: unclipped(rig).await }
}

async fn unclipped(rig: &Rig) -> Measured<RangeOverflow> {
    if !rig.can_unclip() {
        return unmeasured("the adapter does not have the feature depth-clip-control");
    }
    let sheet = strip(rig, true).await?;
    if !is_covered(&sheet, |depth| depth < 0.0)? || !is_covered(&sheet, |depth| depth > 1.0)? {
        return unmeasured("samples beyond the planes are not drawn even with unclippedDepth");
    }
    /// How far a depth that is kept may be from the exact one.
    const TOLERANCE: f64 = 1e-5;
    let ends = [STRIP[0] + 1, STRIP[1] - 2];
    let wanted = ends.map(strip_depth);
    let kept = ends.map(|column| sheet.at([column, STRIP_ROW]));
    let is_kept = wanted.iter().zip(kept).all(|(wanted, kept)| (wanted - f64::from(kept)).abs() < TOLERANCE);
    let wanted = if is_kept { kept } else { wanted.map(|depth| depth as f32) };
    overflow(wanted, kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_told_from_the_smallest_step() {
        for bits in [16, 24] {
            let greatest = f64::from(bits).exp2() - 1.0;
            let kept: Vec<f32> =
                (0..CELLS).map(|cell| ((f64::from(cell) * (-27.0_f64).exp2() * greatest).round() / greatest) as f32).collect();
            assert_eq!(unorm_bits(&kept), Ok(bits));
        }
        assert!(unorm_bits(&[0.0; 8]).is_err(), "a format that keeps nothing has no bits");
        assert!(unorm_bits(&[0.0, 0.3]).is_err(), "a third is no step of bits");
    }

    #[test]
    fn depths_outside_of_the_range_are_clamped_or_kept() {
        assert_eq!(overflow([-0.5, 1.5], [0.0, 1.0]), Ok(RangeOverflow::Clamped));
        assert_eq!(overflow([-0.5, 1.5], [-0.5, 1.5]), Ok(RangeOverflow::Kept));
        assert!(overflow([-0.5, 1.5], [0.0, 1.5]).is_err());
    }
}
