//! Which texels a filter weighs: for tools that explain a lookup.

use glam::{IVec2, Vec2};

use super::{bilinear_corner, disc_place, floor, footprint_counts, footprint_place, separable_corner};
use crate::{
    plan::{FILTER_BILINEAR, FILTER_CROSS, FILTER_DISC, FILTER_HARD, FILTER_SEPARABLE, LightPlan},
    visibility::Lookup,
};

/// Calls `tap` with each texel to which [`filtered_test`](super::filtered_test) gives a weight above 0; with a texel in which several tests of a disc or a footprint fall, for each of
/// them.
pub fn for_each_weighted_tap(light: &LightPlan, lookup: &Lookup, mut tap: impl FnMut(IVec2)) {
    let texel = lookup.texel;
    match light.filter {
        FILTER_HARD => tap(texel_of(texel)),
        FILTER_BILINEAR => {
            let (x, y, fraction) = bilinear_corner(texel);
            square(IVec2::new(x, y), fraction, 1, tap);
        }
        FILTER_SEPARABLE => {
            let (x, y, fraction) = separable_corner(light, texel);
            square(IVec2::new(x, y), fraction, light.filter_taps as i32, tap);
        }
        FILTER_CROSS => {
            for step in [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::NEG_X, IVec2::NEG_Y] {
                tap(texel_of(texel) + step);
            }
        }
        _ => for_each_test_place(light, lookup, |place| tap(texel_of(place))),
    }
}

/// Calls `place` with each place of which a whole test is taken: it falls into one texel or the next. Bilinear and separable filters have none, for their weights go over from texel
/// to texel.
pub fn for_each_test_place(light: &LightPlan, lookup: &Lookup, mut place: impl FnMut(Vec2)) {
    match light.filter {
        FILTER_HARD | FILTER_CROSS => place(lookup.texel),
        FILTER_BILINEAR | FILTER_SEPARABLE => {}
        FILTER_DISC => (0..light.filter_taps).for_each(|tap| place(disc_place(light, lookup, tap))),
        _ => {
            let [columns, rows] = footprint_counts(lookup);
            for row in 0..rows {
                for column in 0..columns {
                    place(footprint_place(lookup, [column, row], [columns, rows]));
                }
            }
        }
    }
}

/// The texel that a place lies in.
fn texel_of(place: Vec2) -> IVec2 {
    IVec2::new(floor(place.x) as i32, floor(place.y) as i32)
}

/// The texels from `corner` to `last` steps beyond it on each axis; the last ones only where the fraction is not 0.
fn square(corner: IVec2, fraction: Vec2, last: i32, mut tap: impl FnMut(IVec2)) {
    let columns = last + i32::from(fraction.x > 0.0);
    let rows = last + i32::from(fraction.y > 0.0);
    for y in 0..rows {
        for x in 0..columns {
            tap(corner + IVec2::new(x, y));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{filter::kernel::set_filter, settings::Filter};

    fn count(filter: Filter, x: f32, y: f32) -> usize {
        let mut light = LightPlan::default();
        set_filter(&mut light, filter, None).expect("the filter can be planned");
        let mut count = 0;
        for_each_weighted_tap(&light, &Lookup { texel: Vec2::new(x, y), ..Lookup::default() }, |_| count += 1);
        count
    }

    #[test]
    fn weighted_taps_are_those_with_a_weight() {
        assert_eq!([(3.5, 3.5), (3.6, 3.5), (3.4, 3.6)].map(|(x, y)| count(Filter::Bilinear, x, y)), [1, 2, 4]);
        assert_eq!([(3.5, 3.5), (3.6, 3.5), (3.4, 3.6)].map(|(x, y)| count(Filter::Box3, x, y)), [9, 12, 16]);
        // The middle of an even box is a corner of texels.
        assert_eq!([(3.0, 3.0), (3.5, 3.5)].map(|(x, y)| count(Filter::Box4, x, y)), [16, 25]);
        for (filter, taps) in [(Filter::Hard, 1), (Filter::Cross5, 5), (Filter::Vogel, 16), (Filter::Footprint, 1)] {
            assert_eq!(count(filter, 3.4, 3.6), taps, "{filter:?}");
        }
    }
}
