//! Convex hulls in the plane, and the smallest rectangle around one.

use glam::DVec2;

/// By what share one rectangle must be smaller than another, or longer than wide, to count as that.
///
/// Areas of the same shape under another rotation differ by some ten roundings, 1e-15 of themselves. A picture must not turn by a right angle
/// because of those, and a share that no one can see is worth no turn.
const TIE: f64 = 1e-9;

/// A rectangle of any rotation, in the unit of the points it was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// The midpoint.
    pub center: DVec2,
    /// The direction of the longer sides, of unit length, toward +x (toward +y if it is at a right angle to x).
    pub axis: DVec2,
    /// Half the length along `axis`, and half the width at a right angle to it.
    pub half: DVec2,
}

impl Rectangle {
    /// The area in the square of the points' unit.
    #[must_use]
    pub fn area(&self) -> f64 {
        4.0 * self.half.x * self.half.y
    }

    /// The rectangle around points whose sides have the direction `axis`, of unit length, and that at a right angle to it.
    fn around(points: &[DVec2], axis: DVec2) -> Self {
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for point in points {
            let local = DVec2::new(axis.dot(*point), axis.perp_dot(*point));
            (min, max) = (min.min(local), max.max(local));
        }
        let middle = 0.5 * (min + max);
        Self { center: axis * middle.x + axis.perp() * middle.y, axis, half: 0.5 * (max - min) }.turned()
    }

    /// The same rectangle with the axis that its definition asks for.
    fn turned(self) -> Self {
        let quarter = Self { axis: toward_x(self.axis.perp()), half: DVec2::new(self.half.y, self.half.x), ..self };
        let this = Self { axis: toward_x(self.axis), ..self };
        let (length, width) = (self.half.x, self.half.y);
        let is_square = (length - width).abs() <= TIE * length.max(width);
        let is_quarter = if is_square { comes_first(quarter.axis, this.axis) } else { width > length };
        if is_quarter { quarter } else { this }
    }
}

/// The direction or its opposite, whichever points toward +x; toward +y at a right angle to x.
fn toward_x(axis: DVec2) -> DVec2 {
    if axis.x < -TIE || axis.x <= TIE && axis.y < 0.0 { -axis } else { axis }
}

/// Whether, of two axes that are equally good, the first is taken: the one at the smaller angle to +x, and of equal angles the one toward +y.
fn comes_first(a: DVec2, b: DVec2) -> bool {
    a.x > b.x + TIE || a.x >= b.x - TIE && a.y > b.y
}

/// The convex hull of points: writes its corners to the beginning of `hull`, counter-clockwise from the leftmost one, and gives their number.
///
/// Points in the middle of a side and points that come up twice are left out, so that one place gives one corner and a line two. Sorts `points`, which must
/// be finite. Nothing gives nothing. This is the monotone chain of Andrew (1979, "Another efficient algorithm for convex hulls in two dimensions").
///
/// # Panics
///
/// If `hull` has less room than there are points.
pub fn convex_hull(points: &mut [DVec2], hull: &mut [DVec2]) -> usize {
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else { return 0 };
    hull[0] = first;
    if first == last {
        return 1;
    }
    // The corners below the line between these two, from left to right, and then those above it, from right to left. Each point belongs to one half at most,
    // so that there is never more in the hull than there are points.
    let side = |point: DVec2| (last - first).perp_dot(point - first);
    let below = points.iter().copied().filter(|point| side(*point) < 0.0);
    let above = points.iter().rev().copied().filter(|point| side(*point) > 0.0);
    let (mut len, mut begin) = (1, 0);
    let mut turn_to = |point: DVec2, begin: usize, keeps: bool| {
        while len >= begin + 2 && (hull[len - 1] - hull[len - 2]).perp_dot(point - hull[len - 2]) <= 0.0 {
            len -= 1;
        }
        if keeps {
            hull[len] = point;
            len += 1;
        }
        len
    };
    for point in below {
        turn_to(point, begin, true);
    }
    begin = turn_to(last, begin, true) - 1;
    for point in above {
        turn_to(point, begin, true);
    }
    // The hull ends before it comes back to where it began.
    turn_to(first, begin, false)
}

/// The rectangle of the smallest area around a convex hull, as [`convex_hull`] gives it. Nothing gives a point at the origin.
///
/// One side of it lies along a side of the hull (Freeman and Shapira 1975, "Determining the minimum-area encasing rectangle for an arbitrary closed curve"),
/// and while that side goes round the hull, so do the corners that touch the other three (Toussaint 1983, "Solving geometric problems with the rotating
/// calipers"): the time is proportional to the number of corners.
///
/// Of rectangles that have the same area but for one part in 10^9 it gives the one whose axis has the smallest angle to +x, so that rounding does not
/// choose. It holds every corner, whatever rounding does to the calipers, for it is measured once more around all of them.
#[must_use]
pub fn smallest_rectangle(hull: &[DVec2]) -> Rectangle {
    let [first, second, ..] = *hull else {
        return Rectangle { center: hull.first().copied().unwrap_or_default(), axis: DVec2::X, half: DVec2::ZERO };
    };
    let mut smallest = f64::INFINITY;
    each_side(hull, |_, area| smallest = smallest.min(area));
    // A line has one side, there and back.
    let mut best = Rectangle::around(hull, (second - first).normalize_or(DVec2::X));
    let mut is_first = true;
    if hull.len() > 2 {
        each_side(hull, |axis, area| {
            if area <= smallest * (1.0 + TIE) {
                let candidate = Rectangle::around(hull, axis);
                if is_first || comes_first(candidate.axis, best.axis) {
                    (best, is_first) = (candidate, false);
                }
            }
        });
    }
    best
}

/// Calls `visit` with the direction of each side of a hull and the area of the rectangle that has a side along it.
fn each_side(hull: &[DVec2], mut visit: impl FnMut(DVec2, f64)) {
    let count = hull.len();
    let corner = |i: usize| hull[i % count];
    // The corners farthest along the side, away from it, and against it.
    let [mut right, mut top, mut left] = [1; 3];
    for i in 0..count {
        let Some(axis) = (corner(i + 1) - corner(i)).try_normalize() else { continue };
        let advance = |from: usize, direction: DVec2| {
            let mut at = from;
            // Once round is enough, and the limit holds where rounding would go on.
            while at < i + count && (corner(at + 1) - corner(at)).dot(direction) > 0.0 {
                at += 1;
            }
            at
        };
        right = advance(right.max(i + 1), axis);
        top = advance(top.max(right), axis.perp());
        left = advance(left.max(top), -axis);
        visit(axis, (corner(right) - corner(left)).dot(axis) * (corner(top) - corner(i)).dot(axis.perp()));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn hull_of(points: &[DVec2]) -> std::vec::Vec<DVec2> {
        let mut hull = std::vec![DVec2::NAN; points.len()];
        let len = convex_hull(&mut points.to_vec(), &mut hull);
        hull.truncate(len);
        hull
    }

    fn points(pairs: &[(f64, f64)]) -> std::vec::Vec<DVec2> {
        pairs.iter().map(|(x, y)| DVec2::new(*x, *y)).collect()
    }

    /// Points of which some lie on one line, in one place or at the corners of a grid.
    fn cloud() -> impl Strategy<Value = std::vec::Vec<DVec2>> {
        let free = (-1.0..1.0_f64, -1.0..1.0_f64).prop_map(DVec2::from);
        let grid = (-2..=2_i32, -2..=2_i32).prop_map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)) / 2.0);
        let line = (0..=10_i32).prop_map(|step| DVec2::new(-1.0, -0.3).lerp(DVec2::new(0.9, 1.0), f64::from(step) / 10.0));
        let place = (0.1..3.0_f64, 0..4_u32, prop_oneof![3 => Just(0.0), 1 => Just(1e5)]);
        (prop::collection::vec(prop_oneof![free, grid, line], 1..60), place).prop_map(|(points, (stretch, power, origin))| {
            let stretch = DVec2::new(stretch, stretch * 0.01_f64.powi(power as i32));
            points.into_iter().map(|point| origin + stretch * point).collect()
        })
    }

    /// The unit in the last place of a cloud's coordinates, some ten times.
    fn rounding(points: &[DVec2]) -> f64 {
        10.0 * f64::EPSILON * points.iter().fold(0.0_f64, |largest, point| largest.max(point.abs().max_element()))
    }

    proptest! {
        #[test]
        fn the_hull_turns_left_and_holds_all_points(cloud in cloud()) {
            let hull = hull_of(&cloud);
            for (i, a) in hull.iter().enumerate() {
                let b = hull[(i + 1) % hull.len()];
                let c = hull[(i + 2) % hull.len()];
                prop_assert!(cloud.contains(a));
                let right = (b - a).perp_dot(a - c);
                prop_assert!(right <= rounding(&cloud) * (c - a).length(), "a right turn at {}", b);
                for point in &cloud {
                    let outside = -(b - a).normalize_or_zero().perp_dot(*point - a);
                    prop_assert!(outside <= rounding(&cloud), "{} lies {} outside", point, outside);
                }
            }
        }

        #[test]
        fn the_order_of_the_points_does_not_matter(cloud in cloud(), turn in 0..60_usize) {
            let mut other = cloud.clone();
            other.rotate_left(turn % cloud.len());
            other.reverse();
            prop_assert_eq!(hull_of(&cloud), hull_of(&other));
        }

        #[test]
        fn the_rectangle_holds_all_points(cloud in cloud()) {
            let rectangle = smallest_rectangle(&hull_of(&cloud));
            prop_assert!((rectangle.axis.length() - 1.0).abs() < 4.0 * f64::EPSILON, "rounding of a normalisation");
            prop_assert!(rectangle.half.x >= rectangle.half.y * (1.0 - 2.0 * TIE), "the axis is the longer one");
            for point in &cloud {
                let from = *point - rectangle.center;
                let local = DVec2::new(rectangle.axis.dot(from), rectangle.axis.perp_dot(from));
                prop_assert!((local.abs() - rectangle.half).max_element() <= rounding(&cloud), "{} in {:?}", point, rectangle);
            }
        }

        /// The smallest of those along a side, tried one by one, and of a thousand that are not.
        #[test]
        fn no_rectangle_is_smaller(cloud in cloud()) {
            let hull = hull_of(&cloud);
            let rectangle = smallest_rectangle(&hull);
            let sides = (0..hull.len()).map(|i| (hull[(i + 1) % hull.len()] - hull[i]).normalize_or(DVec2::X));
            let along = sides.map(|axis| Rectangle::around(&hull, axis).area()).fold(f64::INFINITY, f64::min);
            // Rounding moves sides by this much; and of equal areas any can be taken.
            let slack = 8.0 * rounding(&cloud) * rectangle.half.element_sum() + TIE * along;
            prop_assert!((rectangle.area() - along).abs() <= slack, "{} instead of {}", rectangle.area(), along);
            for step in 0..1000 {
                let area = Rectangle::around(&hull, DVec2::from_angle(f64::from(step) * 1e-3 * core::f64::consts::FRAC_PI_2)).area();
                prop_assert!(rectangle.area() <= area + slack, "{} at step {} is smaller than {}", area, step, rectangle.area());
            }
        }
    }

    #[test]
    fn few_points_are_their_own_hull() {
        assert_eq!(hull_of(&[]), []);
        for same in 1..4 {
            assert_eq!(hull_of(&[DVec2::ONE; 3][..same]), [DVec2::ONE]);
        }
        let line = points(&[(2.0, 2.0), (0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (0.0, 0.0)]);
        assert_eq!(hull_of(&line), points(&[(0.0, 0.0), (2.0, 2.0)]));
        let bowl = points(&[(-2.0, 4.0), (-1.0, 1.0), (0.0, 0.0), (1.0, 1.0), (2.0, 4.0)]);
        assert_eq!(hull_of(&bowl), bowl, "a hull that lies below its ends needs no more room than it has corners");
    }

    #[test]
    fn few_points_have_a_rectangle() {
        let point = Rectangle { center: DVec2::new(3.0, 4.0), axis: DVec2::X, half: DVec2::ZERO };
        assert_eq!(smallest_rectangle(&[point.center]), point);
        assert_eq!(smallest_rectangle(&[]).half, DVec2::ZERO);
        let upright = smallest_rectangle(&points(&[(1.0, 0.0), (1.0, 4.0)]));
        assert_eq!(upright, Rectangle { center: DVec2::new(1.0, 2.0), axis: DVec2::Y, half: DVec2::new(2.0, 0.0) });
    }

    /// What rounding does to the corners of shapes that several rectangles fit equally well does not choose between these.
    #[test]
    fn equal_areas_give_the_axis_nearest_to_x() {
        let quarter = core::f64::consts::FRAC_PI_2;
        for (sides, angle, expected) in
            [(4, 0.0, 0.5 * quarter), (4, 0.1, 0.1 - 0.5 * quarter), (8, 0.0, 0.25 * quarter), (3, 0.3, 0.3 - quarter / 3.0)]
        {
            for noise in 0..50_u32 {
                let corner = |i: u32| {
                    let at = DVec2::from_angle(angle + 4.0 * quarter * f64::from(i) / f64::from(sides));
                    // Some units in the last place.
                    at * (1.0 + 1e-15 * f64::from((i * 7 + noise * 13) % 11))
                };
                let hull = hull_of(&(0..sides).map(corner).collect::<std::vec::Vec<_>>());
                let axis = smallest_rectangle(&hull).axis;
                // Far below the angles between the candidates, far above the noise.
                assert!(axis.angle_to(DVec2::from_angle(expected)).abs() < 1e-6, "{sides} sides at {angle}: {}", axis.to_angle());
            }
        }
    }
}
