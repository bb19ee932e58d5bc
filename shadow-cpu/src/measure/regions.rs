//! Where a frame is wrong most.

use super::cause::Cause;

/// A square of a picture in which much is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The left edge, in pixels.
    pub x: u32,
    /// The top edge.
    pub y: u32,
    /// The width: smaller than was asked for where the picture is.
    pub width: u32,
    /// The height.
    pub height: u32,
    /// The sum of the errors of its pixels, each from 0 to 1.
    pub error: f64,
    /// The cause of most of its wrong pixels; `None` where all are right for the light's centre, and wrong for its size alone.
    pub cause: Option<Cause>,
}

/// The squares of a grid of half their side in which the errors add up to most, none overlapping a worse one.
pub(super) fn worst_regions(width: u32, height: u32, errors: &[f32], causes: &[u8], side: u32, count: usize) -> Vec<Region> {
    let side = side.max(2);
    let (region_width, region_height) = (side.min(width), side.min(height));
    // The last square of a row or column ends with the picture.
    let starts = |size: u32, extent: u32| {
        let last = size - extent;
        (0..last).step_by((side / 2) as usize).chain([last])
    };
    let mut regions = Vec::new();
    for y in starts(height, region_height) {
        for x in starts(width, region_width) {
            let rows = (y..y + region_height).map(|row| (row * width + x) as usize..(row * width + x + region_width) as usize);
            let error: f64 = rows.flat_map(|row| &errors[row]).map(|&error| f64::from(error)).sum();
            if error > 0.0 {
                regions.push(Region { x, y, width: region_width, height: region_height, error, cause: None });
            }
        }
    }
    regions.sort_by(|a, b| b.error.total_cmp(&a.error));
    let mut worst: Vec<Region> = Vec::new();
    for region in regions {
        let overlaps = |other: &Region| {
            region.x < other.x + other.width
                && other.x < region.x + region.width
                && region.y < other.y + other.height
                && other.y < region.y + region.height
        };
        if worst.len() == count {
            break;
        }
        if !worst.iter().any(overlaps) {
            worst.push(Region { cause: main_cause(&region, width, causes), ..region });
        }
    }
    worst
}

/// The cause of most of a region's wrong pixels.
fn main_cause(region: &Region, width: u32, causes: &[u8]) -> Option<Cause> {
    let mut counts = [0_u32; Cause::ALL.len()];
    for y in region.y..region.y + region.height {
        for x in region.x..region.x + region.width {
            if let Some(cause) = Cause::of_number(causes[(y * width + x) as usize]) {
                counts[cause as usize - 1] += 1;
            }
        }
    }
    let (cause, count) = Cause::ALL.into_iter().zip(counts).max_by_key(|(_, count)| *count)?;
    (count > 0).then_some(cause)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_squares_come_first_and_do_not_overlap() {
        let (width, height) = (100, 40);
        let mut errors = vec![0.0; 4000];
        let mut causes = vec![0; 4000];
        let mut wrong = |x: usize, y: usize, error: f32, cause: Cause| {
            errors[y * 100 + x] = error;
            causes[y * 100 + x] = cause as u8;
        };
        for x in 60..70 {
            wrong(x, 20, 1.0, Cause::Acne);
        }
        wrong(5, 39, 1.0, Cause::Filter);
        let worst = worst_regions(width, height, &errors, &causes, 16, 4);
        assert_eq!(worst.len(), 2, "{worst:?}");
        assert_eq!((worst[0].error, worst[0].cause), (10.0, Some(Cause::Acne)));
        assert!(worst[0].x <= 60 && worst[0].x + 16 >= 70);
        assert_eq!((worst[1].error, worst[1].cause, worst[1].y), (1.0, Some(Cause::Filter), 24));
        assert!(worst_regions(width, height, &[0.0; 4000], &causes, 16, 4).is_empty());
        assert_eq!(worst_regions(3, 2, &[0.0, 1.0, 0.0, 0.0, 0.0, 0.0], &[0; 6], 16, 4).len(), 1, "smaller than a square");
    }
}
