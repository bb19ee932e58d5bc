//! Where triangles have samples: the grid that vertices are snapped to, the place of the sample, and what edges through it do.

use super::{
    Measured,
    rig::{Drawing, Rig},
    triangles::{CELLS, Corner, SHEET, Triangle, middle},
    unmeasured,
};

/// Steps of a pixel in which vertices are moved: one for each cell of the sheet, and the finest grid that can be seen.
const STEPS: u32 = CELLS;

/// As many, of a corner that can move either way.
const STEPS_BACK: i32 = STEPS as i32;

/// Pixels from a cell's middle to the ends of the edge that is examined: far enough that its two ends can be two pixels apart across,
/// and within the cell.
const REACH: f64 = 4.0;

/// Pixels by which the two ends of that edge differ before any of them is moved: it then always slants the same way, and one rule decides about samples on it.
const SLANT: f64 = 1.0;

/// Pixels from a cell's middle to the third corner, which takes no part.
const APEX: f64 = 6.0;

/// The depth of these triangles: any but that of the background.
const DEPTH: f64 = 0.5;

/// The fewest steps between grid lines at which the rounding can be told.
const TELLING_STEPS: u32 = 4;

/// Where a coordinate half-way between two grid lines goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ties {
    /// To the line whose number, counted from a pixel's centre, is even.
    Even,
    /// To the greater coordinate: right or down.
    Up,
    /// To the smaller coordinate: left or up in the picture.
    Down,
}

/// How a vertex's coordinate gets onto the sub-pixel grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridRounding {
    /// To the nearest line.
    Nearest(Ties),
    /// To the next line at or below.
    Floor,
    /// To the next line at or above.
    Ceiling,
}

impl GridRounding {
    /// A coordinate in pixels on a grid of `2^-bits` pixel, which has a line at every pixel's centre.
    #[must_use]
    pub fn snap(self, coordinate: f64, bits: u32) -> f64 {
        let lines = f64::from(bits).exp2();
        let line = (coordinate - 0.5) * lines;
        let snapped = match self {
            Self::Nearest(Ties::Even) => line.round_ties_even(),
            Self::Nearest(Ties::Up) => (line + 0.5).floor(),
            Self::Nearest(Ties::Down) => (line - 0.5).ceil(),
            Self::Floor => line.floor(),
            Self::Ceiling => line.ceil(),
        };
        snapped / lines + 0.5
    }
}

/// Between which places of a pixel its sample lies, from 0 to 1: as close as a grid line and the next can say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleRange {
    /// The smallest and the greatest x, to the right.
    pub x: [f64; 2],
    /// The smallest and the greatest y, downwards.
    pub y: [f64; 2],
}

impl SampleRange {
    /// Whether the sample can be in the pixel's centre, where WebGPU has it.
    #[must_use]
    pub fn has_centre(&self) -> bool {
        [self.x, self.y].iter().all(|[low, high]| (*low..=*high).contains(&0.5))
    }
}

/// Whether a triangle covers a sample that lies exactly on one of its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeRule {
    /// A vertical edge with the triangle to its right.
    pub left: bool,
    /// A vertical edge with the triangle to its left.
    pub right: bool,
    /// A horizontal edge with the triangle below.
    pub top: bool,
    /// A horizontal edge with the triangle above.
    pub bottom: bool,
    /// Diagonal edges with the triangle to their right: one that rises to the right, and one that falls.
    pub left_diagonals: [bool; 2],
    /// The same with the triangle to their left.
    pub right_diagonals: [bool; 2],
}

impl EdgeRule {
    /// Whether this is WebGPU's rule: left and top edges cover, the others do not.
    #[must_use]
    pub fn is_top_left(&self) -> bool {
        self.left
            && self.top
            && !self.right
            && !self.bottom
            && self.left_diagonals == [true; 2]
            && self.right_diagonals == [false; 2]
    }

    /// Whether of two triangles with a common edge exactly one covers a sample on it.
    #[must_use]
    pub fn covers_once(&self) -> bool {
        let crossed = [0, 1].iter().all(|&slope| self.left_diagonals[slope] != self.right_diagonals[slope]);
        self.left != self.right && self.top != self.bottom && crossed
    }
}

/// Where triangles have samples.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterFindings {
    /// Bits of the sub-pixel grid: its lines are `2^-bits` pixel apart, in x and y alike.
    pub subpixel_bits: Measured<u32>,
    /// How x and y get onto that grid.
    pub rounding: Measured<[GridRounding; 2]>,
    /// Where a pixel's sample is.
    pub sample: Measured<SampleRange>,
    /// What edges through a sample do.
    pub edges: Measured<EdgeRule>,
}

impl RasterFindings {
    /// The bits of the grid and how x and y get onto it.
    pub(super) fn grid(&self) -> Measured<(u32, [GridRounding; 2])> {
        match (&self.subpixel_bits, &self.rounding) {
            (Ok(bits), Ok(rounding)) => Ok((*bits, *rounding)),
            (Err(reason), _) | (_, Err(reason)) => Err(reason.clone()),
        }
    }
}

/// An axis of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    X,
    Y,
}

impl Axis {
    /// A corner `along` pixels on this axis and `across` pixels on the other one from a cell's middle.
    fn corner(self, cell: u32, along: f64, across: f64) -> Corner {
        let [x, y] = middle(cell);
        match self {
            Self::X => [x + along, y + across, DEPTH],
            Self::Y => [x + across, y + along, DEPTH],
        }
    }
}

/// Which cells' middles a triangle covers, of a sheet with one triangle in each cell.
async fn covered(rig: &Rig, corners: impl Fn(u32) -> [Corner; 3]) -> Measured<Vec<bool>> {
    let triangles: Vec<_> = (0..CELLS).map(|cell| Triangle::in_window(SHEET, corners(cell))).collect();
    let sheet = rig.draw(&Drawing::new(&triangles)).await?;
    Ok((0..CELLS).map(|cell| sheet.covers_cell(cell)).collect())
}

/// For each step of one end of an edge, how many steps the other end must go the other way until the sample between them is covered.
///
/// The sample is half-way between the two ends, so that it is covered if the two snapped coordinates add up to nothing or less. The
/// numbers rise by the steps of the grid, whatever its rounding is.
async fn counterweights(rig: &Rig, axis: Axis) -> Measured<Vec<i32>> {
    let step = 1.0 / f64::from(STEPS);
    // The first end moves by less than a pixel, and a grid takes either by at most one more.
    let (mut low, mut high) = (vec![-STEPS_BACK; CELLS as usize], vec![2 * STEPS_BACK; CELLS as usize]);
    while low.iter().zip(&high).any(|(low, high)| low + 1 < *high) {
        let tried: Vec<i32> = low.iter().zip(&high).map(|(low, high)| i32::midpoint(*low, *high)).collect();
        let corners = |cell: u32| {
            let back = f64::from(tried[cell as usize]) * step;
            [
                axis.corner(cell, SLANT + f64::from(cell) * step, -REACH),
                axis.corner(cell, -SLANT - back, REACH),
                axis.corner(cell, APEX, 0.0),
            ]
        };
        for (cell, is_covered) in covered(rig, corners).await?.into_iter().enumerate() {
            if is_covered { high[cell] = tried[cell] } else { low[cell] = tried[cell] }
        }
    }
    Ok(high)
}

/// The steps, from 1 to [`STEPS`], at which the first end gets to the next grid line.
fn grid_lines(counterweights: &[i32]) -> Vec<u32> {
    // A pixel further everything repeats.
    let closed = counterweights.iter().copied().chain(counterweights.first().map(|first| first + STEPS_BACK));
    let all: Vec<i32> = closed.collect();
    (1..).zip(all.windows(2)).filter(|(_, pair)| pair[0] != pair[1]).map(|(step, _)| step).collect()
}

/// The bits of a grid that has these lines in a pixel.
fn bits_of(lines: &[u32]) -> Measured<u32> {
    let count = lines.len() as u32;
    if count >= STEPS {
        return unmeasured(format!("every step of 1/{STEPS} pixel moves edges: a grid, if there is one, is finer than that"));
    }
    if !count.is_power_of_two() {
        return unmeasured(format!("{count} grid lines were found in a pixel, which is no power of two"));
    }
    Ok(count.ilog2())
}

/// How coordinates get onto a grid that has these lines in a pixel.
fn rounding_of(lines: &[u32]) -> Measured<GridRounding> {
    let spacing = STEPS / (lines.len() as u32).max(1);
    if spacing < TELLING_STEPS {
        return unmeasured("the grid is too fine to tell how coordinates are rounded to it");
    }
    let half = spacing / 2;
    let all_at = |offset: u32| lines.iter().all(|step| step % spacing == offset);
    // Line k begins at its lower tie, or a step later if that tie goes down to line k - 1, which is even if k is odd.
    let to_even = || (1..).zip(lines).all(|(line, step)| step % spacing == half + line % 2);
    if all_at(0) {
        Ok(GridRounding::Floor)
    } else if all_at(1) {
        Ok(GridRounding::Ceiling)
    } else if all_at(half) {
        Ok(GridRounding::Nearest(Ties::Up))
    } else if all_at(half + 1) {
        Ok(GridRounding::Nearest(Ties::Down))
    } else if to_even() {
        Ok(GridRounding::Nearest(Ties::Even))
    } else {
        unmeasured("coordinates go to the grid's lines by no rule that is known here")
    }
}

/// Between which places on an axis a pixel's sample lies: an edge across the axis goes through the pixel, once with the triangle
/// beyond it and once with the triangle before it.
async fn sample_on(rig: &Rig, axis: Axis, bits: u32, rounding: GridRounding) -> Measured<[f64; 2]> {
    let place = |step: u32| f64::from(step) / f64::from(STEPS);
    let edge = |cell: u32, apex: f64| {
        // From a pixel's beginning, half a pixel before the middle.
        let along = place(cell) - 0.5;
        [axis.corner(cell, along, -APEX), axis.corner(cell, along, APEX), axis.corner(cell, along + apex, 0.0)]
    };
    let beyond = covered(rig, |cell| edge(cell, APEX)).await?;
    let before = covered(rig, |cell| edge(cell, -APEX)).await?;
    let last = beyond.iter().filter(|is_covered| **is_covered).count() as u32;
    let first = before.iter().filter(|is_covered| !**is_covered).count() as u32;
    let is_a_switch = |list: &[bool], first_part: bool, at: u32| {
        list.iter().enumerate().all(|(step, is_covered)| (*is_covered == first_part) == (step < at as usize))
    };
    if last == 0 || last == STEPS || !is_a_switch(&beyond, true, last) || !is_a_switch(&before, false, first) {
        return unmeasured("an edge that moves through a pixel covers its sample more than once, or never");
    }
    let spacing = f64::from(bits).exp2().recip();
    // The last edge that has the sample beyond it, and the first that has it before it; the sample can lie on either.
    let low = rounding.snap(place(last - 1), bits).max(rounding.snap(place(first), bits) - spacing);
    let high = (rounding.snap(place(last - 1), bits) + spacing).min(rounding.snap(place(first), bits));
    if low <= high { Ok([low, high]) } else { unmeasured("left and right edges disagree about where the sample is") }
}

/// The directions from an edge's begin to its end and to its triangle's third corner, for each kind of edge.
const EDGES: [([f64; 2], [f64; 2]); 8] = [
    ([0.0, 1.0], [1.0, 0.0]),
    ([0.0, 1.0], [-1.0, 0.0]),
    ([1.0, 0.0], [0.0, 1.0]),
    ([1.0, 0.0], [0.0, -1.0]),
    ([1.0, -1.0], [1.0, 1.0]),
    ([1.0, 1.0], [1.0, -1.0]),
    ([1.0, -1.0], [-1.0, -1.0]),
    ([1.0, 1.0], [-1.0, 1.0]),
];

/// Edges exactly through samples, in many places of the sheet.
async fn edges(rig: &Rig) -> Measured<EdgeRule> {
    let kind_of = |cell: u32| cell as usize % EDGES.len();
    let corners = |cell: u32| {
        let [x, y] = middle(cell);
        let (along, apex) = EDGES[kind_of(cell)];
        let at = |[dx, dy]: [f64; 2], reach: f64| [x + dx * reach, y + dy * reach, DEPTH];
        [at(along, -REACH), at(along, REACH), at(apex, REACH)]
    };
    let is_covered = covered(rig, corners).await?;
    let mut found = [None; EDGES.len()];
    for (cell, is_covered) in (0..).zip(is_covered) {
        let before = found[kind_of(cell)].replace(is_covered);
        if before.is_some_and(|before| before != is_covered) {
            return unmeasured("whether an edge covers a sample on it varies from place to place");
        }
    }
    let [left, right, top, bottom, rising_left, falling_left, rising_right, falling_right] =
        found.map(|is_covered| is_covered == Some(true));
    Ok(EdgeRule {
        left,
        right,
        top,
        bottom,
        left_diagonals: [rising_left, falling_left],
        right_diagonals: [rising_right, falling_right],
    })
}

/// The same on both axes, or why it is not.
fn both<T: PartialEq + Copy + std::fmt::Debug>(x: Measured<T>, y: Measured<T>) -> Measured<T> {
    match (x?, y?) {
        (x, y) if x == y => Ok(x),
        (x, y) => unmeasured(format!("it is {x:?} in x and {y:?} in y")),
    }
}

/// Measures where triangles have samples.
pub(super) async fn measure(rig: &Rig) -> RasterFindings {
    let x = counterweights(rig, Axis::X).await.map(|numbers| grid_lines(&numbers));
    let y = counterweights(rig, Axis::Y).await.map(|numbers| grid_lines(&numbers));
    let lines = |lines: &Measured<Vec<u32>>, axis: fn(&[u32]) -> Measured<u32>| lines.clone().and_then(|lines| axis(&lines));
    let subpixel_bits = both(lines(&x, bits_of), lines(&y, bits_of));
    let rounding = match (&subpixel_bits, &x, &y) {
        (Ok(_), Ok(x), Ok(y)) => rounding_of(x).and_then(|x| Ok([x, rounding_of(y)?])),
        (Err(reason), ..) | (_, Err(reason), _) | (.., Err(reason)) => Err(reason.clone()),
    };
    let mut findings = RasterFindings {
        subpixel_bits,
        rounding,
        sample: unmeasured("the sub-pixel grid is not known"),
        edges: edges(rig).await,
    };
    if let Ok((bits, [x, y])) = findings.grid() {
        findings.sample = match (sample_on(rig, Axis::X, bits, x).await, sample_on(rig, Axis::Y, bits, y).await) {
            (Ok(x), Ok(y)) => Ok(SampleRange { x, y }),
            (Err(reason), _) | (_, Err(reason)) => Err(reason),
        };
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a rasteriser with this grid would answer: the counterweight of each step.
    fn counterweights(bits: u32, rounding: GridRounding) -> Vec<i32> {
        let snap = |step: i32| rounding.snap(0.5 + f64::from(step) / f64::from(STEPS), bits) - 0.5;
        let answer = |step: i32| (-STEPS_BACK..=2 * STEPS_BACK).find(|back| snap(step) + snap(-back) <= 0.0);
        (0..STEPS_BACK).map(|step| answer(step).expect("two pixels are enough")).collect()
    }

    #[test]
    fn grids_and_their_rounding_are_told_apart() {
        for bits in [4, 8] {
            let all = [
                GridRounding::Nearest(Ties::Even),
                GridRounding::Nearest(Ties::Up),
                GridRounding::Nearest(Ties::Down),
                GridRounding::Floor,
                GridRounding::Ceiling,
            ];
            for rounding in all {
                let lines = grid_lines(&counterweights(bits, rounding));
                assert_eq!((bits_of(&lines), rounding_of(&lines)), (Ok(bits), Ok(rounding)), "{bits} {rounding:?}");
            }
        }
    }

    /// What is no grid is not given a number of bits.
    #[test]
    fn what_is_no_grid_is_not_measured() {
        let finest: Vec<i32> = (0..STEPS_BACK).collect();
        assert!(bits_of(&grid_lines(&finest)).is_err_and(|reason| reason.0.contains("finer")));
        let thirds: Vec<i32> = (0..STEPS_BACK).map(|step| step * 3 / STEPS_BACK * STEPS_BACK / 3).collect();
        let reason = bits_of(&grid_lines(&thirds)).expect_err("three lines are no grid of bits");
        assert!(reason.0.starts_with("3 grid lines"), "{reason}");
    }
}
