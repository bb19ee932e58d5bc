//! The units of the pipeline's own depth bias, `DepthBiasState`, which WebGPU leaves to the adapter.
//!
//! Vulkan's text (section "Depth Bias and Clamp") has the most that is promised: of a format in single precision the unit is `2^(e - 23)` with the exponent `e` of
//! the triangle's greatest depth, of others it is the smallest difference that can be told; and the slope may be anything between the greater of the two derivatives and their root of
//! squares.

use super::{
    DepthFormat, DepthRules, DepthStorage, Measured, RangeOverflow,
    rig::{Drawing, Rig},
    triangles::{CELLS, SHEET, Triangle, middle, middle_pixel},
    unmeasured,
};

/// The depths at which the unit is measured: in binades of their own, and in single precision with room above them.
const DEPTHS: [f64; 5] = [0.75, 0.375, 0.1875, 0.046_875, 0.005_859_375];

/// Places between two depths of a format with whole numbers over which a unit is averaged: rounding to whole numbers then takes no part.
const PLACES: u32 = 64;

/// Pixels from a cell's middle to the corners of its triangle.
const REACH: f64 = 6.0;

/// How far a measured number may be from a rule's, as a share.
const TOLERANCE: f64 = 0.01;

/// The unit of a constant bias at a depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitAt {
    /// The depth of the triangle, the same everywhere.
    pub depth: f64,
    /// What a bias of 1 adds, as a share of the depth range.
    pub unit: f64,
}

/// What the unit of a constant bias depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitRule {
    /// Nothing: it is the same at all depths.
    Fixed,
    /// The exponent of the triangle's greatest depth.
    Triangle,
    /// The exponent of each sample's depth.
    Sample,
}

/// What a slope-scaled bias multiplies, of the depth's derivatives along x and y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlopeRule {
    /// The greater of their amounts.
    Maximum,
    /// The root of the sum of their squares.
    Hypotenuse,
    /// The sum of their amounts.
    Sum,
}

/// The units of the pipeline's bias.
#[derive(Clone, Debug, PartialEq)]
pub struct BiasRules {
    /// The unit of the constant bias at some depths, the greatest first.
    pub units: Measured<Vec<UnitAt>>,
    /// What it depends on.
    pub depends_on: Measured<UnitRule>,
    /// What the slope-scaled bias multiplies.
    pub slope: Measured<SlopeRule>,
    /// Whether the clamp bounds the bias.
    pub clamps: Measured<bool>,
    /// What becomes of depths that the bias takes beyond 1.
    pub overflow: Measured<RangeOverflow>,
}

/// A triangle around a cell's middle, with `z` as depth there and these derivatives, and its third corner to the right.
fn tilted(cell: u32, z: f64, [dx, dy]: [f64; 2]) -> Triangle {
    let [x, y] = middle(cell);
    let at = |right: f64, down: f64| [x + right, y + down, z + dx * right + dy * down];
    Triangle::in_window(SHEET, [at(-REACH, -REACH), at(-REACH, REACH), at(REACH, 0.0)])
}

/// A bias of so many units.
fn constant(units: i32) -> wgpu::DepthBiasState {
    wgpu::DepthBiasState { constant: units, ..Default::default() }
}

/// By how much a bias moves the depths in the cells' middles, or in the pixel so many to the left of it.
async fn moved(
    rig: &Rig,
    format: DepthFormat,
    bias: wgpu::DepthBiasState,
    triangles: &[Triangle],
    left: u32,
) -> Measured<Vec<f64>> {
    let without = rig.draw(&Drawing { format, ..Drawing::new(triangles) }).await?;
    let with = rig.draw(&Drawing { format, bias, ..Drawing::new(triangles) }).await?;
    let cells = (0..CELLS).zip(triangles).map(|(cell, _)| {
        let [x, y] = middle_pixel(cell);
        let pixel = [x - left, y];
        f64::from(with.at(pixel)) - f64::from(without.at(pixel))
    });
    Ok(cells.collect())
}

/// How many units a bias has to be measured with: some hundredths of the range, so that one is known to many digits and none reaches the end of the range.
const fn many_units(format: DepthFormat) -> i32 {
    match format {
        DepthFormat::Depth16Unorm => 1 << 12,
        DepthFormat::Depth24Plus | DepthFormat::Depth32Float => 1 << 16,
    }
}

/// The unit at each of [`DEPTHS`].
async fn units(rig: &Rig, format: DepthFormat, storage: DepthStorage) -> Measured<Vec<UnitAt>> {
    let places = match storage {
        DepthStorage::Unorm { bits } => f64::from(bits).exp2().recip() / f64::from(PLACES),
        DepthStorage::Float => 0.0,
    };
    let depths = DEPTHS.iter().flat_map(|depth| (0..PLACES).map(move |place| depth + f64::from(place) * places));
    let triangles: Vec<_> = (0..).zip(depths).map(|(cell, depth)| tilted(cell, depth, [0.0; 2])).collect();
    let amount = many_units(format);
    let moved = moved(rig, format, constant(amount), &triangles, 0).await?;
    let unit = |moved: &[f64]| moved.iter().sum::<f64>() / f64::from(PLACES) / f64::from(amount);
    let units: Vec<_> =
        DEPTHS.iter().zip(moved.chunks(PLACES as usize)).map(|(&depth, moved)| UnitAt { depth, unit: unit(moved) }).collect();
    match units.iter().find(|at| !(at.unit > 0.0)) {
        Some(at) => unmeasured(format!("a bias of {amount} moves a depth of {} by {:e}", at.depth, at.unit * f64::from(amount))),
        None => Ok(units),
    }
}

/// Whether two numbers are the same but for rounding.
fn is_near(measured: f64, expected: f64) -> bool {
    (measured / expected - 1.0).abs() < TOLERANCE
}

/// What the unit depends on. Where it varies, a triangle that reaches over several binades says by which of its depths.
async fn depends_on(rig: &Rig, format: DepthFormat, units: &[UnitAt]) -> Measured<UnitRule> {
    let (Some(greatest), Some(least)) = (units.first(), units.last()) else { return unmeasured("there is no unit") };
    if units.iter().all(|at| is_near(at.unit, greatest.unit)) {
        return Ok(UnitRule::Fixed);
    }
    /// Pixels to the left of the middle at which the depth is read.
    const LEFT: u32 = 5;
    /// The depth there: three binades below the triangle's greatest.
    const LOW: f64 = 0.09;
    // The greatest depth is that of the first unit, the third corner's.
    let slope = (greatest.depth - LOW) / (REACH + f64::from(LEFT));
    let triangle = tilted(0, greatest.depth - slope * REACH, [slope, 0.0]);
    let amount = many_units(format);
    let moved = moved(rig, format, constant(amount), &[triangle], LEFT).await?;
    let unit = moved.first().map_or(0.0, |moved| moved / f64::from(amount));
    // The unit halves from binade to binade.
    let of_sample = greatest.unit * (LOW.log2().floor() - greatest.depth.log2().floor()).exp2();
    if is_near(unit, greatest.unit) {
        Ok(UnitRule::Triangle)
    } else if is_near(unit, of_sample) {
        Ok(UnitRule::Sample)
    } else {
        unmeasured(format!(
            "the unit is {:e} at {} and {:e} at {}, and {unit:e} at {LOW} in a triangle that reaches to {0}",
            greatest.unit, greatest.depth, least.unit, least.depth
        ))
    }
}

/// What a slope-scaled bias multiplies.
async fn slope(rig: &Rig, format: DepthFormat) -> Measured<SlopeRule> {
    /// The depth by which the derivatives are counted: exact in single precision, and some hundred steps of 16 bits.
    const SLOPE: f64 = 1.0 / 1024.0;
    /// The factor, which makes the bias a tenth of the range and rounding nothing.
    const SCALE: f32 = 16.0;
    /// Derivatives in units of [`SLOPE`]: of a right triangle whose sides have whole lengths, turned and mirrored.
    const SIDES: [[f64; 2]; 6] = [[3.0, 4.0], [4.0, 3.0], [-3.0, 4.0], [3.0, -4.0], [-4.0, -3.0], [-4.0, 3.0]];
    let triangles: Vec<_> = (0..).zip(SIDES).map(|(cell, sides)| tilted(cell, 0.5, sides.map(|side| side * SLOPE))).collect();
    let bias = wgpu::DepthBiasState { slope_scale: SCALE, ..Default::default() };
    let moved = moved(rig, format, bias, &triangles, 0).await?;
    let lengths: Vec<f64> = moved.iter().map(|moved| moved / f64::from(SCALE) / SLOPE).collect();
    let rules = [(4.0, SlopeRule::Maximum), (5.0, SlopeRule::Hypotenuse), (7.0, SlopeRule::Sum)];
    match rules.iter().find(|(length, _)| lengths.iter().all(|found| is_near(*found, *length))) {
        Some((_, rule)) => Ok(*rule),
        None => unmeasured(format!("derivatives of 3 and 4 make a slope of {lengths:.3?}, which is that of no known rule")),
    }
}

/// Whether the clamp bounds the bias.
async fn clamps(rig: &Rig, format: DepthFormat, units: &[UnitAt]) -> Measured<bool> {
    if !rig.downlevel.contains(wgpu::DownlevelFlags::DEPTH_BIAS_CLAMP) {
        return unmeasured("the adapter does not have the downlevel flag DEPTH_BIAS_CLAMP");
    }
    let Some(greatest) = units.first() else { return unmeasured("there is no unit") };
    /// The share of the bias that the clamp leaves.
    const SHARE: f64 = 0.25;
    let amount = many_units(format);
    let whole = greatest.unit * f64::from(amount);
    let bias = wgpu::DepthBiasState { clamp: (whole * SHARE) as f32, ..constant(amount) };
    let moved = moved(rig, format, bias, &[tilted(0, greatest.depth, [0.0; 2])], 0).await?;
    let moved = moved.first().copied().unwrap_or(0.0);
    if is_near(moved, whole * SHARE) {
        Ok(true)
    } else if is_near(moved, whole) {
        Ok(false)
    } else {
        unmeasured(format!("a bias of {whole:e} clamped to {:e} moves depths by {moved:e}", whole * SHARE))
    }
}

/// What becomes of depths that the bias takes beyond 1.
async fn overflow(rig: &Rig, format: DepthFormat, units: &[UnitAt]) -> Measured<RangeOverflow> {
    let Some(greatest) = units.first() else { return unmeasured("there is no unit") };
    /// How far the bias is meant to go.
    const BEYOND: f64 = 0.5;
    let bias = constant((BEYOND / greatest.unit).round() as i32);
    let triangles = [tilted(0, greatest.depth, [0.0; 2])];
    let sheet = rig.draw(&Drawing { format, bias, clear: 0.0, ..Drawing::new(&triangles) }).await?;
    match sheet.in_cell(0) {
        1.0 => Ok(RangeOverflow::Clamped),
        depth if is_near(f64::from(depth), greatest.depth + BEYOND) => Ok(RangeOverflow::Kept),
        depth => unmeasured(format!("a bias of {BEYOND} makes a depth of {} one of {depth}", greatest.depth)),
    }
}

/// Measures the units of the pipeline's bias.
pub(super) async fn measure(rig: &Rig, format: DepthFormat, depth: &DepthRules) -> BiasRules {
    let units = match &depth.storage {
        Ok(storage) => units(rig, format, *storage).await,
        Err(reason) => unmeasured(format!("how depths are kept is not known: {reason}")),
    };
    let slope = slope(rig, format).await;
    match units {
        Err(reason) => {
            let unknown = format!("the unit is not known: {reason}");
            let (depends_on, clamps, overflow) = (unmeasured(&*unknown), unmeasured(&*unknown), unmeasured(&*unknown));
            BiasRules { units: Err(reason), depends_on, slope, clamps, overflow }
        }
        Ok(units) => BiasRules {
            depends_on: depends_on(rig, format, &units).await,
            slope,
            clamps: clamps(rig, format, &units).await,
            overflow: overflow(rig, format, &units).await,
            units: Ok(units),
        },
    }
}
