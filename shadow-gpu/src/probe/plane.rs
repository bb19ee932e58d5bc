//! Which depth a triangle's samples get: the plane that it is read from, and how far rounding takes it.

use shadow_math::rounding::map_bound;

use super::{
    Measured,
    raster::RasterFindings,
    rig::{Drawing, Rig},
    triangles::{CELL, CELLS, Corner, Random, SHEET, Sheet, Triangle, middle, middle_pixel},
    unmeasured,
};

/// The smallest area of a triangle, in square pixels: slivers have planes whose rounding says nothing about others.
const SMALLEST_AREA: f64 = 16.0;

/// Pixels from a cell's middle that corners stay within, so that triangles stay in their cells.
const REACH: f64 = 7.0;

/// The depths of corners: away from 0, near which a unit in the last place is next to nothing.
const DEPTHS: [f64; 2] = [0.125, 0.875];

/// The w of corners in perspective: a ratio of eight, as that of distances to a light may be across a triangle.
const PERSPECTIVE: [f64; 2] = [0.5, 4.0];

/// How near to the border between two grid lines a corner may not come, as a share of their distance: rounding of the projection must not decide where it is
/// snapped to.
const CLEARANCE: f64 = 0.05;

/// How many times nearer to one plane than to the other the median depth must be to say that it is this one.
const DECISIVE: f64 = 4.0;

/// Which corners a triangle's depth plane goes through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthPlane {
    /// Those that the vertex stage gave.
    Unsnapped,
    /// Those on the sub-pixel grid.
    Snapped,
}

/// How far depths are from those of exact planes through the corners that [`DepthPlane`] says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthError {
    /// How many samples were compared.
    pub samples: usize,
    /// The error that half of them do not exceed, in units in the last place of the exact depth in single precision.
    pub median_ulp: f64,
    /// The greatest error, in the same units.
    pub worst_ulp: f64,
    /// The greatest error, as a share of the depth range.
    pub worst: f64,
    /// The greatest share of what the automatic bias leaves to rounding ([`map_bound`]) that an error takes. Above 1 that bias is not enough here.
    pub worst_of_bound: f64,
}

/// How far a sample's depth is from that of an exact plane.
#[derive(Clone, Copy, Debug)]
struct SampleError {
    /// In units in the last place of the exact depth.
    ulp: f64,
    /// As a share of the depth range.
    share: f64,
    /// As a share of what the automatic bias leaves to rounding.
    of_bound: f64,
}

/// Which depth a triangle's samples get.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneRules {
    /// Which plane it is read from.
    pub plane: Measured<DepthPlane>,
    /// How exactly, for corners with w = 1, whose window coordinates are exact.
    pub parallel: Measured<DepthError>,
    /// How exactly, for corners in perspective, whose window coordinates are rounded too.
    pub perspective: Measured<DepthError>,
}

/// The unit in the last place of a number in single precision, for positive normal numbers.
fn ulp(number: f64) -> f64 {
    /// Explicit bits of a significand in single precision.
    const SIGNIFICAND_BITS: f64 = 23.0;
    (number.log2().floor() - SIGNIFICAND_BITS).exp2()
}

/// Twice the signed area.
fn doubled_area([a, b, c]: [Corner; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The derivatives along x and y of the plane through three corners.
fn gradient([a, b, c]: [Corner; 3]) -> [f64; 2] {
    let area = doubled_area([a, b, c]);
    let [to_b, to_c] = [b[2] - a[2], c[2] - a[2]];
    [(to_b * (c[1] - a[1]) - to_c * (b[1] - a[1])) / area, (to_c * (b[0] - a[0]) - to_b * (c[0] - a[0])) / area]
}

/// The depth at a point of that plane.
fn depth_at(corners: [Corner; 3], [x, y]: [f64; 2]) -> f64 {
    let [dx, dy] = gradient(corners);
    let [a, ..] = corners;
    a[2] + dx * (x - a[0]) + dy * (y - a[1])
}

/// Random triangles, one in each cell; in perspective or not. None if the grid leaves no room for such corners.
fn triangles(seed: u64, is_perspective: bool, is_clear: impl Fn(&Corner) -> bool) -> Option<Vec<Triangle>> {
    /// How often a cell is tried: one triangle in eight will do on a usual grid.
    const TRIES: u32 = 512;
    /// Steps of a pixel that corners lie on, so that those with w = 1 are exact in clip coordinates.
    const STEPS: f64 = 4096.0;
    let mut random = Random(seed);
    let mut corner = |cell: u32| {
        let [x, y] = middle(cell);
        let mut place = |middle: f64| ((middle + random.between(-REACH, REACH)) * STEPS).round() / STEPS;
        [place(x), place(y), random.between(DEPTHS[0], DEPTHS[1])]
    };
    let mut weights = Random(!seed);
    let mut candidate = |cell: u32| {
        let mut triangle = Triangle::in_window(SHEET, [corner(cell), corner(cell), corner(cell)]);
        if is_perspective {
            for clip in &mut triangle.clip {
                let w = weights.between(PERSPECTIVE[0], PERSPECTIVE[1]) as f32;
                *clip = [clip[0] * w, clip[1] * w, clip[2] * w, w];
            }
        }
        let window = triangle.window(SHEET);
        let will_do = doubled_area(window).abs() >= 2.0 * SMALLEST_AREA && window.iter().all(&is_clear);
        will_do.then_some(triangle)
    };
    (0..CELLS).map(|cell| (0..TRIES).find_map(|_| candidate(cell))).collect()
}

/// The errors of all covered samples against exact planes.
fn errors(sheet: &Sheet, triangles: &[Triangle], snap: impl Fn(Corner) -> Corner) -> Vec<SampleError> {
    let mut errors = Vec::new();
    let [texels, depth] = map_bound(f64::from(SHEET));
    for (cell, triangle) in (0..).zip(triangles) {
        let corners = triangle.window(SHEET).map(&snap);
        let [dx, dy] = gradient(corners);
        let bound = texels * (dx.abs() + dy.abs()) + depth;
        let [left, top] = middle_pixel(cell).map(|pixel| pixel - CELL / 2);
        for pixel in (0..CELL * CELL).map(|index| [left + index % CELL, top + index / CELL]) {
            if sheet.is_covered(pixel) {
                let exact = depth_at(corners, pixel.map(|place| f64::from(place) + 0.5));
                let share = (f64::from(sheet.at(pixel)) - exact).abs();
                errors.push(SampleError { ulp: share / ulp(exact), share, of_bound: share / bound });
            }
        }
    }
    errors
}

/// The median and the greatest of errors.
fn summary(mut errors: Vec<SampleError>) -> Measured<DepthError> {
    if errors.is_empty() || errors.iter().any(|error| error.ulp.is_nan()) {
        return unmeasured("the triangles covered nothing, or with depths that are no numbers");
    }
    let worst = |part: fn(&SampleError) -> f64| errors.iter().map(part).fold(0.0, f64::max);
    let [worst_ulp, worst, worst_of_bound] =
        [worst(|error| error.ulp), worst(|error| error.share), worst(|error| error.of_bound)];
    errors.sort_by(|a, b| a.ulp.total_cmp(&b.ulp));
    Ok(DepthError { samples: errors.len(), median_ulp: errors[errors.len() / 2].ulp, worst_ulp, worst, worst_of_bound })
}

/// Measures which depth a triangle's samples get.
pub(super) async fn measure(rig: &Rig, raster: &RasterFindings) -> PlaneRules {
    let (bits, rounding) = match raster.grid() {
        Ok(grid) => grid,
        Err(reason) => {
            let unknown = format!("the sub-pixel grid is not known: {reason}");
            return PlaneRules {
                plane: unmeasured(&*unknown),
                parallel: unmeasured(&*unknown),
                perspective: unmeasured(unknown),
            };
        }
    };
    let snap = |[x, y, z]: Corner| [rounding[0].snap(x, bits), rounding[1].snap(y, bits), z];
    let lines = f64::from(bits).exp2();
    let is_clear = |corner: &Corner| {
        let [x, y, _] = snap(*corner);
        // Nearest lines are at most half their distance away, those at or below at most all of it.
        let moved = [x - corner[0], y - corner[1]].map(|distance| (distance * lines).abs());
        moved.iter().all(|share| (share - 0.5).abs() > CLEARANCE && (CLEARANCE..1.0 - CLEARANCE).contains(share))
    };
    let mut summaries = Vec::new();
    for is_perspective in [false, true] {
        let Some(drawn) = triangles(u64::from(is_perspective) + 1, is_perspective, is_clear) else {
            let reason =
                || unmeasured(format!("corners cannot be kept clear of the borders between the lines of a grid of {bits} bits"));
            summaries.push([reason(), reason()]);
            continue;
        };
        summaries.push(match rig.draw(&Drawing::new(&drawn)).await {
            Ok(sheet) => [summary(errors(&sheet, &drawn, |corner| corner)), summary(errors(&sheet, &drawn, snap))],
            Err(reason) => [Err(reason.clone()), Err(reason)],
        });
    }
    let plane = match summaries.first() {
        Some([Ok(unsnapped), Ok(snapped)]) if unsnapped.median_ulp * DECISIVE < snapped.median_ulp => Ok(DepthPlane::Unsnapped),
        Some([Ok(unsnapped), Ok(snapped)]) if snapped.median_ulp * DECISIVE < unsnapped.median_ulp => Ok(DepthPlane::Snapped),
        Some([Ok(unsnapped), Ok(snapped)]) => unmeasured(format!(
            "depths are {:.1} ulp from planes through unsnapped corners and {:.1} from those through snapped ones, in the median: neither is near",
            unsnapped.median_ulp, snapped.median_ulp
        )),
        Some([Err(reason), _] | [_, Err(reason)]) => Err(reason.clone()),
        None => unmeasured("nothing was drawn"),
    };
    let mut of_plane = summaries.into_iter().map(|[unsnapped, snapped]| match &plane {
        Ok(DepthPlane::Unsnapped) => unsnapped,
        Ok(DepthPlane::Snapped) => snapped,
        Err(reason) => unmeasured(format!("the depth plane is not known: {reason}")),
    });
    let mut next = || of_plane.next().unwrap_or_else(|| unmeasured("nothing was drawn"));
    let (parallel, perspective) = (next(), next());
    PlaneRules { plane, parallel, perspective }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_go_through_their_corners() {
        let corners = [[1.0, 2.0, 0.25], [9.0, 3.0, 0.5], [2.0, 8.0, 0.75]];
        for [x, y, z] in corners {
            assert!((depth_at(corners, [x, y]) - z).abs() < 1e-15);
        }
        let centre = [4.0, 13.0 / 3.0];
        assert!((depth_at(corners, centre) - 0.5).abs() < 1e-15, "the centroid has the mean depth");
    }

    #[test]
    fn units_in_the_last_place_are_those_of_single_precision() {
        for number in [0.125_f32, 0.3, 0.5, 0.875] {
            assert_eq!(ulp(f64::from(number)), f64::from(number.next_up()) - f64::from(number));
        }
    }

    /// A grid that leaves no room ends the search.
    #[test]
    fn corners_that_are_never_clear_are_given_up() {
        assert_eq!(triangles(1, false, |_| false), None);
    }

    /// A rounding error that a sheet has is found in the units that it was made in.
    #[test]
    fn errors_are_counted_in_units_in_the_last_place() {
        let drawn = triangles(1, false, |_| true).expect("there is room");
        let depths = (0..SHEET * SHEET).map(|pixel| {
            let [x, y] = [pixel % SHEET, pixel / SHEET];
            let cell = y / CELL * (SHEET / CELL) + x / CELL;
            let exact = depth_at(drawn[cell as usize].window(SHEET), [f64::from(x) + 0.5, f64::from(y) + 0.5]);
            // Depths within the range of the corners stand for covered samples.
            if (DEPTHS[0]..DEPTHS[1]).contains(&exact) { (exact + 3.0 * ulp(exact)) as f32 } else { 1.0 }
        });
        let sheet = Sheet { size: SHEET, depths: depths.collect(), clear: 1.0 };
        let found = summary(errors(&sheet, &drawn, |corner| corner)).expect("there are errors");
        assert!((2.5..=3.5).contains(&found.median_ulp) && found.worst_ulp <= 3.5 + 1e-6, "{found:?}");
    }
}
