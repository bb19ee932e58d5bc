//! The triangles of probes: a sheet of cells, each with a triangle of its own.

/// Width and height of the sheet in pixels: a power of two, so that clip coordinates of points on it are exact in single precision,
/// and no larger than every adapter allows.
pub(super) const SHEET: u32 = 1024;

/// Width and height of a cell in pixels.
pub(super) const CELL: u32 = 16;

/// Cells in a row of the sheet.
const COLUMNS: u32 = SHEET / CELL;

/// Cells of the sheet.
pub(super) const CELLS: u32 = COLUMNS * COLUMNS;

/// A corner in window coordinates: pixels from the top left corner, and depth.
pub(super) type Corner = [f64; 3];

/// A triangle as the vertex stage gets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Triangle {
    /// Clip coordinates.
    pub(super) clip: [[f32; 4]; 3],
    /// The depth that its fragments write, where the pipeline lets them.
    pub(super) depth: f32,
}

impl Triangle {
    /// Across a sheet of `size` pixels, with w = 1. Clip coordinates are exact if the corners are multiples of `2^-12` and `size` is a
    /// power of two up to 1024.
    pub(super) fn in_window(size: u32, corners: [Corner; 3]) -> Self {
        let scale = 2.0 / f64::from(size);
        let clip = corners.map(|[x, y, z]| [(x * scale - 1.0) as f32, (1.0 - y * scale) as f32, z as f32, 1.0]);
        Self { clip, depth: 0.0 }
    }

    /// The same with a depth that its fragments write.
    pub(super) fn writing(self, depth: f32) -> Self {
        Self { depth, ..self }
    }

    /// The corners in window coordinates that the clip coordinates stand for, in double precision.
    pub(super) fn window(&self, size: u32) -> [Corner; 3] {
        let half = f64::from(size) / 2.0;
        self.clip.map(|clip| {
            let [x, y, z, w] = clip.map(f64::from);
            [half + half * x / w, half - half * y / w, z / w]
        })
    }
}

/// Two triangles that cover a rectangle from one corner to the other, with the depth `z` everywhere.
pub(super) fn rectangle(size: u32, [left, top]: [f64; 2], [right, bottom]: [f64; 2], z: f64) -> [Triangle; 2] {
    [
        Triangle::in_window(size, [[left, top, z], [left, bottom, z], [right, top, z]]),
        Triangle::in_window(size, [[right, top, z], [left, bottom, z], [right, bottom, z]]),
    ]
}

/// The pixel in the middle of a cell.
pub(super) fn middle_pixel(cell: u32) -> [u32; 2] {
    [cell % COLUMNS * CELL + CELL / 2, cell / COLUMNS * CELL + CELL / 2]
}

/// The centre of that pixel.
pub(super) fn middle(cell: u32) -> [f64; 2] {
    middle_pixel(cell).map(|pixel| f64::from(pixel) + 0.5)
}

/// Depths that were read back: row by row from the top.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub(super) size: u32,
    pub(super) depths: Vec<f32>,
    /// What the sheet was cleared to.
    pub(super) clear: f32,
}

impl Sheet {
    /// The depth of a pixel; NaN outside of the sheet.
    pub(super) fn at(&self, [x, y]: [u32; 2]) -> f32 {
        let index = y as usize * self.size as usize + x as usize;
        if x < self.size { self.depths.get(index).copied().unwrap_or(f32::NAN) } else { f32::NAN }
    }

    /// Whether something was drawn there. What is drawn must have another depth than the sheet was cleared to.
    pub(super) fn is_covered(&self, pixel: [u32; 2]) -> bool {
        self.at(pixel) != self.clear
    }

    /// The depth in the middle of a cell.
    pub(super) fn in_cell(&self, cell: u32) -> f32 {
        self.at(middle_pixel(cell))
    }

    /// Whether something was drawn in the middle of a cell.
    pub(super) fn covers_cell(&self, cell: u32) -> bool {
        self.is_covered(middle_pixel(cell))
    }
}

/// Numbers that look random and are the same on every run: splitmix64 (Steele, Lea and Flood 2014, figure 17).
pub(super) struct Random(pub(super) u64);

impl Random {
    /// A number from 0 to below `bound`.
    pub(super) fn below(&mut self, bound: u32) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (((bits >> 32) * u64::from(bound)) >> 32) as u32
    }

    /// A number from `low` to below `high` that is `low` and a multiple of their distance by `2^-16`.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.below(1 << 16)) / f64::from(1 << 16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners come back from their clip coordinates exactly, at the finest steps and the far end of the sheet.
    #[test]
    fn clip_coordinates_are_exact() {
        let step = 1.0 / 4096.0;
        let corners = [[1023.0 + 4095.0 * step, 512.0 + step, 0.25], [step, 1023.0 - step, 0.5], [511.5, 0.0, 1.0]];
        assert_eq!(Triangle::in_window(SHEET, corners).window(SHEET), corners);
    }

    #[test]
    fn random_numbers_spread_over_their_range() {
        let mut random = Random(1);
        let numbers: Vec<_> = (0..1000).map(|_| random.between(-1.0, 3.0)).collect();
        let mean = numbers.iter().sum::<f64>() / 1000.0;
        assert!(numbers.iter().all(|x| (-1.0..3.0).contains(x)) && (mean - 1.0).abs() < 0.15, "mean {mean}");
    }
}
