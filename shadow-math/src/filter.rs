//! Filters: which texels are tested, and how the tests are averaged.
//!
//! What is averaged are the results of depth tests, never depths (Reeves, Salesin and Cook 1987).
//!
//! | filter | tests | source |
//! |---|---|---|
//! | hard | the texel that the point falls into | Williams 1978 |
//! | bilinear | four, weighted by the distance to their centres | |
//! | cross 5 | the texel and its four neighbours, a fifth each | OGRE's pages, which call it bilinear |
//! | box, Gaussian, witness | a square, weighted by a kernel on each axis; between texels the kernel is interpolated with itself, a texel on | Reeves et al. 1987; the lecture on filtering |
//! | Poisson, Vogel | sixteen in a disc, turned from pixel to pixel | Cook 1986; Vogel 1979 |
//! | footprint | all over the pixel's image in the map | what Reeves et al. describe |
//!
//! A footprint's tests lie half a texel apart: for pixels of up to 14 texels they are off from the mean over the parallelogram by 0.012 on an outline, and by 0.023 where every texel is its own caster
//! (root of the mean square; at most by 0.11 and 0.15).
//!
//! Kernels are whole numbers, and so every sum of them is exact: where all tests are alike, the mean is exactly 0 or 1.
//!
//! Each has its [`support`]: with a plane's depth gradient it says how much bias the plane needs under the filter.
//!
//! Mirrored by `filter.wgsl`.

pub mod kernel;
pub mod taps;
pub mod turn;

use glam::Vec2;

use crate::{
    depth::{comparable_depth, depth_limits},
    plan::{BIAS_RECEIVER_PLANE, FILTER_BILINEAR, FILTER_CROSS, FILTER_DISC, FILTER_HARD, FILTER_SEPARABLE, LightPlan, ViewPlan},
    settings::Bias,
    visibility::{Lookup, MapAccess},
};

/// The most tests of a footprint on each axis of the pixel. A footprint that is longer than half as many texels is sampled more coarsely.
pub const MAX_FOOTPRINT_TESTS: u32 = 16;
/// Tests of a footprint lie at most half a texel apart, as long as it is not too large.
pub const FOOTPRINT_TESTS_PER_TEXEL: f32 = 2.0;
/// The texels that stay free around a map for a footprint, which has no largest size.
const FOOTPRINT_GUARD: u32 = 8;

/// By how many texels a step of one texel along the normal can move a lookup: in the map of the widest spot light.
pub(crate) const MOST_OF_A_STEP: f32 = 2.5;

/// Texels that stay free on every side of a fit: the reach of the filter from a receiver at the rim, what the bias moves a lookup by, and one for
/// rounding.
///
/// A bilinear tap is less than one texel from its lookup, a hard one half of one. The automatic bias moves a lookup along the normal by less than 2.5
/// times as much: see [`normal_offset`](crate::bias::normal_offset).
#[must_use]
pub fn guard_texels(light: &LightPlan, bias: Bias) -> u32 {
    // Rounds up: a reach is at most 17 texels.
    let up = |texels: f32| floor(texels + 0.999) as u32;
    let reach = up(farthest_tap(light));
    let moved = match bias {
        Bias::Automatic => 3 * reach,
        Bias::Parts(_) => up(MOST_OF_A_STEP * light.normal_texels),
    };
    reach + moved + 1
}

/// How far on each axis the weighted taps of a filter can lie from the lookup, in texels. Of a footprint, which has no largest size, as far as a map leaves room for.
#[must_use]
pub fn farthest_tap(light: &LightPlan) -> f32 {
    match light.filter {
        FILTER_DISC => light.filter_reach + 0.5,
        FILTER_HARD | FILTER_BILINEAR | FILTER_SEPARABLE | FILTER_CROSS => light.filter_reach,
        _ => FOOTPRINT_GUARD as f32,
    }
}

/// How far the weighted taps of a filter reach along a plane's depth gradient, in texels: the factor of `|g1| + |g2|` in the bias it needs.
///
/// A tap at (a, b) from the lookup differs in depth by `a g1 + b g2`, and the support is the most that this can be over `|g1| + |g2|`. The hard test's texel centre lies at most
/// half a texel from the lookup on each axis. Of the bilinear taps each is less than a whole texel away on each axis, and comes as near to that as its weight comes to zero; of a square's,
/// with a kernel of n weights, less than `(n + 1) / 2`. To the half texel of a hard test the cross adds one along the steeper axis, a disc its radius
/// along the gradient, and a footprint half of each side's own step.
#[inline(always)]
#[must_use]
pub fn support(light: &LightPlan, gradient: Vec2, footprint: [Vec2; 2]) -> f32 {
    if light.filter <= FILTER_SEPARABLE {
        return light.filter_reach;
    }
    let sum = gradient.x.abs() + gradient.y.abs();
    if !(sum > 0.0 && sum <= f32::MAX) {
        // Nothing is added up, or more than there is: any number will do.
        return light.filter_reach;
    }
    let share = Vec2::new(gradient.x / sum, gradient.y / sum);
    if light.filter == FILTER_CROSS {
        return 0.5 + share.x.abs().max(share.y.abs());
    }
    if light.filter == FILTER_DISC {
        return 0.5 + light.filter_reach * square_root(share.x * share.x + share.y * share.y);
    }
    let along = |side: Vec2| (side.x * share.x + side.y * share.y).abs();
    0.5 + 0.5 * (along(footprint[0]) + along(footprint[1]))
}

/// One depth test: 1 if the receiver's `depth` is not beyond what the texel holds plus `bias`, else 0.
///
/// Equal is lit, and so is a texel outside the view's rectangle.
#[inline(always)]
#[must_use]
pub fn depth_test(maps: &impl MapAccess, view: &ViewPlan, x: i32, y: i32, depth: f32, bias: f32) -> f32 {
    let left = view.rect[0] as i32;
    let top = view.rect[1] as i32;
    if x < left || y < top || x >= left + view.rect[2] as i32 || y >= top + view.rect[3] as i32 {
        return 1.0;
    }
    let stored = comparable_depth(view, maps.fetch_texel(view.layer, x as u32, y as u32));
    if depth <= stored + bias {
        return 1.0;
    }
    0.0
}

/// The average of the depth tests of a lookup, from 0, shadowed, to 1, lit.
///
/// The lookup's texel is in texels of the layer, with texel centres at + 0.5; each coordinate must be far inside the range of i32.
#[inline(always)]
#[must_use]
pub fn filtered_test(maps: &impl MapAccess, view: &ViewPlan, light: &LightPlan, lookup: &Lookup) -> f32 {
    let texel = lookup.texel;
    if light.filter == FILTER_HARD {
        return test_at(maps, view, light, lookup, texel);
    }
    if light.filter == FILTER_BILINEAR {
        let (x0, y0, fraction) = bilinear_corner(texel);
        let t00 = tap_test(maps, view, light, lookup, x0, y0);
        let t10 = tap_test(maps, view, light, lookup, x0 + 1, y0);
        let t01 = tap_test(maps, view, light, lookup, x0, y0 + 1);
        let t11 = tap_test(maps, view, light, lookup, x0 + 1, y0 + 1);
        return bilinear_mean(t00, t10, t01, t11, fraction);
    }
    if light.filter == FILTER_SEPARABLE {
        return separable_test(maps, view, light, lookup);
    }
    if light.filter == FILTER_CROSS {
        let x = floor(texel.x) as i32;
        let y = floor(texel.y) as i32;
        let beside = tap_test(maps, view, light, lookup, x - 1, y) + tap_test(maps, view, light, lookup, x + 1, y);
        let above = tap_test(maps, view, light, lookup, x, y - 1) + tap_test(maps, view, light, lookup, x, y + 1);
        return (tap_test(maps, view, light, lookup, x, y) + beside + above) / 5.0;
    }
    if light.filter == FILTER_DISC {
        let mut lit = 0.0;
        for tap in 0..light.filter_taps {
            lit += test_at(maps, view, light, lookup, disc_place(light, lookup, tap));
        }
        return lit / light.filter_taps as f32;
    }
    let counts = footprint_counts(lookup);
    let mut lit = 0.0;
    for row in 0..counts[1] {
        for column in 0..counts[0] {
            lit += test_at(maps, view, light, lookup, footprint_place(lookup, [column, row], counts));
        }
    }
    lit / (counts[0] * counts[1]) as f32
}

/// One test of a lookup: of a texel, with the depth that the receiver's plane has at its centre where that is asked for.
#[inline(always)]
fn tap_test(maps: &impl MapAccess, view: &ViewPlan, light: &LightPlan, lookup: &Lookup, x: i32, y: i32) -> f32 {
    depth_test(maps, view, x, y, tap_depth(light, view, lookup, x, y), lookup.bias)
}

/// The depth that a tap is compared with: the receiver's, or that of its plane at the texel's centre, which is no farther from it than the lookup's limit. Beyond the far plane lies
/// nothing that could be compared.
#[inline(always)]
#[must_use]
pub fn tap_depth(light: &LightPlan, view: &ViewPlan, lookup: &Lookup, x: i32, y: i32) -> f32 {
    if light.bias & BIAS_RECEIVER_PLANE == 0 {
        return lookup.depth;
    }
    let along_x = lookup.slope.x * (x as f32 + 0.5 - lookup.texel.x);
    let along_y = lookup.slope.y * (y as f32 + 0.5 - lookup.texel.y);
    let correction = (along_x + along_y).max(-lookup.slope_limit).min(lookup.slope_limit);
    (lookup.depth + correction).min(depth_limits(view)[1])
}

/// The bias that OGRE 1.12's receiver reads off the map around a lookup: see [`ReceiverGradient`](crate::settings::ReceiverGradient). Texels outside the view's rectangle hold nothing: 1.
#[inline(always)]
#[must_use]
pub fn stored_gradient(maps: &impl MapAccess, view: &ViewPlan, light: &LightPlan, texel: Vec2) -> f32 {
    let x = floor(texel.x) as i32;
    let y = floor(texel.y) as i32;
    let across = (stored(maps, view, x + 1, y) - stored(maps, view, x - 1, y)).abs();
    let down = (stored(maps, view, x, y + 1) - stored(maps, view, x, y - 1)).abs();
    let difference = across.max(down).min(light.gradient_clamp);
    difference * light.gradient_scale + stored(maps, view, x, y) * light.gradient_fixed
}

/// What a texel holds; 1 outside the view's rectangle.
#[inline(always)]
fn stored(maps: &impl MapAccess, view: &ViewPlan, x: i32, y: i32) -> f32 {
    let left = view.rect[0] as i32;
    let top = view.rect[1] as i32;
    if x < left || y < top || x >= left + view.rect[2] as i32 || y >= top + view.rect[3] as i32 {
        return 1.0;
    }
    maps.fetch_texel(view.layer, x as u32, y as u32)
}

/// One test, of the texel that a place falls into.
#[inline(always)]
fn test_at(maps: &impl MapAccess, view: &ViewPlan, light: &LightPlan, lookup: &Lookup, place: Vec2) -> f32 {
    tap_test(maps, view, light, lookup, floor(place.x) as i32, floor(place.y) as i32)
}

/// A square of tests under a kernel: column by column, from the top, and then along the columns.
#[inline(always)]
fn separable_test(maps: &impl MapAccess, view: &ViewPlan, light: &LightPlan, lookup: &Lookup) -> f32 {
    let texel = lookup.texel;
    let (x0, y0, fraction) = separable_corner(light, texel);
    let taps = light.filter_taps as i32;
    let mut sum = 0.0;
    let mut column_before = 0.0;
    for x in 0..=taps {
        let mut column = 0.0;
        let mut above = tap_test(maps, view, light, lookup, x0 + x, y0);
        for y in 0..taps {
            let below = tap_test(maps, view, light, lookup, x0 + x, y0 + y + 1);
            column += kernel_weight(light, y) * (above + (below - above) * fraction.y);
            above = below;
        }
        if x > 0 {
            sum += kernel_weight(light, x - 1) * (column_before + (column - column_before) * fraction.x);
        }
        column_before = column;
    }
    sum / (light.filter_total * light.filter_total)
}

/// A weight of a separable filter's kernel.
#[inline(always)]
fn kernel_weight(light: &LightPlan, tap: i32) -> f32 {
    light.filter_table[tap as usize / 4][tap as usize % 4]
}

/// The upper left texel of a separable filter, and the weights of the kernel that begins a texel further on.
#[inline(always)]
#[must_use]
pub fn separable_corner(light: &LightPlan, texel: Vec2) -> (i32, i32, Vec2) {
    // Half of the kernel lies to the left of the point, and texel centres at + 0.5.
    let half = 0.5 * light.filter_taps as f32;
    let corner = texel - Vec2::new(half, half);
    let floor_x = floor(corner.x);
    let floor_y = floor(corner.y);
    (floor_x as i32, floor_y as i32, Vec2::new(corner.x - floor_x, corner.y - floor_y))
}

/// A place of a disc, turned for the lookup's pixel.
#[inline(always)]
#[must_use]
pub fn disc_place(light: &LightPlan, lookup: &Lookup, tap: u32) -> Vec2 {
    let pair = light.filter_table[tap as usize / 2];
    let first = 2 * (tap as usize % 2);
    let (x, y) = (pair[first], pair[first + 1]);
    let turn = lookup.turn;
    // From left to right: shader compilers take the sum of the products apart.
    Vec2::new(lookup.texel.x + x * turn.x - y * turn.y, lookup.texel.y + x * turn.y + y * turn.x)
}

/// How many tests a footprint takes along each axis of the pixel: from 1 to [`MAX_FOOTPRINT_TESTS`].
#[inline(always)]
#[must_use]
pub fn footprint_counts(lookup: &Lookup) -> [u32; 2] {
    let count = |side: Vec2| {
        let wanted = floor(side.x.abs().max(side.y.abs()) * FOOTPRINT_TESTS_PER_TEXEL) + 1.0;
        wanted.min(MAX_FOOTPRINT_TESTS as f32) as u32
    };
    [count(lookup.footprint[0]), count(lookup.footprint[1])]
}

/// The place of one of a footprint's tests.
#[inline(always)]
#[must_use]
pub fn footprint_place(lookup: &Lookup, at: [u32; 2], counts: [u32; 2]) -> Vec2 {
    let share = |axis: usize| (at[axis] as f32 + 0.5) / counts[axis] as f32 - 0.5;
    let (a, b) = (share(0), share(1));
    let [side_x, side_y] = lookup.footprint;
    // From left to right: shader compilers take the sum of the products apart.
    Vec2::new(lookup.texel.x + side_x.x * a + side_y.x * b, lookup.texel.y + side_x.y * a + side_y.y * b)
}

/// The upper left one of the four texels around `texel`, and the weights of the right and the lower ones.
#[inline(always)]
#[must_use]
pub fn bilinear_corner(texel: Vec2) -> (i32, i32, Vec2) {
    let corner = texel - Vec2::new(0.5, 0.5);
    let floor_x = floor(corner.x);
    let floor_y = floor(corner.y);
    (floor_x as i32, floor_y as i32, Vec2::new(corner.x - floor_x, corner.y - floor_y))
}

/// The mean of four tests: upper left, upper right, lower left, lower right.
#[inline(always)]
#[must_use]
pub fn bilinear_mean(t00: f32, t10: f32, t01: f32, t11: f32, fraction: Vec2) -> f32 {
    // Equal tests give exactly 0 or 1 in this form of the interpolation.
    let top = t00 + (t10 - t00) * fraction.x;
    let bottom = t01 + (t11 - t01) * fraction.x;
    top + (bottom - top) * fraction.y
}

/// Rounds toward minus infinity.
#[inline(always)]
fn floor(x: f32) -> f32 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    x.floor()
}

#[inline(always)]
fn square_root(x: f32) -> f32 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    x.sqrt()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{kernel::set_filter, *};
    use crate::settings::Filter;

    /// A map whose left half holds 0.2 and whose right half holds 0.8.
    struct Step;

    impl MapAccess for Step {
        fn fetch_texel(&self, _layer: u32, x: u32, _y: u32) -> f32 {
            if x < 8 { 0.2 } else { 0.8 }
        }
    }

    fn view() -> ViewPlan {
        ViewPlan { rect: [0, 0, 64, 64], ..ViewPlan::default() }
    }

    fn light(filter: Filter) -> LightPlan {
        let mut light = LightPlan::default();
        set_filter(&mut light, filter, None).expect("the filter can be planned");
        light
    }

    fn test_at(filter: Filter, x: f32) -> f32 {
        let lookup = Lookup { texel: Vec2::new(x, 7.3), depth: 0.5, turn: Vec2::X, ..Lookup::default() };
        filtered_test(&Step, &view(), &light(filter), &lookup)
    }

    #[test]
    fn bilinear_ramps_over_one_texel_and_hard_steps() {
        assert_eq!(test_at(Filter::Hard, 7.999), 0.0);
        assert_eq!(test_at(Filter::Hard, 8.0), 1.0);
        for (x, lit) in [(7.5, 0.0), (7.75, 0.25), (8.0, 0.5), (8.25, 0.75), (8.5, 1.0)] {
            assert_eq!(test_at(Filter::Bilinear, x), lit, "at {x}");
        }
    }

    /// The kernel over a step is its running sum, interpolated.
    #[test]
    fn a_kernel_over_a_step_is_its_running_sum() {
        for (x, lit) in [(6.5, 0.0), (7.0, 0.5 / 4.0), (7.5, 1.0 / 4.0), (8.0, 2.0 / 4.0), (8.5, 3.0 / 4.0), (9.5, 1.0)] {
            assert_eq!(test_at(Filter::Witness3, x), lit, "witness 3 at {x}");
        }
        for (x, lit) in [(6.0, 0.0), (7.0, 0.25), (7.5, 0.375), (8.0, 0.5), (9.0, 0.75), (10.0, 1.0)] {
            assert_eq!(test_at(Filter::Box4, x), lit, "box 4 at {x}");
        }
        assert_eq!([6.9, 7.1, 8.0, 8.9, 9.0].map(|x| test_at(Filter::Cross5, x)), [0.0, 0.2, 0.8, 0.8, 1.0]);
    }

    /// A plane that falls along x by 0.01 a texel, as a map has it.
    struct Ramp;

    impl MapAccess for Ramp {
        fn fetch_texel(&self, _layer: u32, x: u32, _y: u32) -> f32 {
            0.1 + 0.01 * (x as f32 + 0.5)
        }
    }

    /// Compared with the receiver's own plane no tap of it is shadowed, however wide the filter; corrected by less it is.
    #[test]
    fn taps_of_the_receivers_plane_are_lit() {
        for filter in Filter::ALL {
            let light = LightPlan { bias: BIAS_RECEIVER_PLANE, ..light(filter) };
            let lookup = Lookup {
                texel: Vec2::new(20.8, 30.8),
                depth: 0.1 + 0.01 * 20.8,
                // What f32 makes of the plane's own depths.
                bias: 1e-6,
                turn: Vec2::X,
                footprint: [Vec2::new(3.0, 1.0), Vec2::new(-1.0, 2.0)],
                slope: Vec2::new(0.01, 0.0),
                slope_limit: 0.2,
                ..Lookup::default()
            };
            assert_eq!(filtered_test(&Ramp, &view(), &light, &lookup), 1.0, "{filter:?}");
            let limited = Lookup { slope_limit: 0.001, ..lookup };
            assert!(filtered_test(&Ramp, &view(), &light, &limited) < 1.0, "{filter:?}");
            let without = LightPlan { bias: 0, ..light };
            assert!(filtered_test(&Ramp, &view(), &without, &lookup) < 1.0, "{filter:?}");
        }
        // Nothing is compared beyond the far plane.
        let light = LightPlan { bias: BIAS_RECEIVER_PLANE, ..light(Filter::Hard) };
        let far = Lookup {
            texel: Vec2::new(4.0, 4.0),
            depth: 0.995,
            slope: Vec2::new(0.1, 0.0),
            slope_limit: 1.0,
            ..Lookup::default()
        };
        assert_eq!(tap_depth(&light, &ViewPlan::default(), &far, 4, 4), 1.0);
    }

    /// OGRE 1.12's receiver, by its own formula on a ramp: neighbours differ by two texels' slope, the clamp cuts that, and the fixed part is a share of the depth.
    #[test]
    fn the_stored_gradient_is_that_of_the_ramp() {
        let texel = Vec2::new(20.3, 30.8);
        let stored = 0.1 + 0.01 * 20.5;
        for (clamp, difference) in [(1.0, 0.02), (0.005, 0.005)] {
            let light = LightPlan { gradient_fixed: 0.5, gradient_clamp: clamp, gradient_scale: 3.0, ..LightPlan::default() };
            let found = stored_gradient(&Ramp, &view(), &light, texel);
            let expected = 3.0 * difference + 0.5 * stored;
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn equal_is_lit_and_so_is_the_outside() {
        assert_eq!(depth_test(&Step, &view(), 3, 3, 0.2, 0.0), 1.0);
        assert_eq!(depth_test(&Step, &view(), 3, 3, 0.200_001, 0.0), 0.0);
        for (x, y) in [(-1, 3), (3, -1), (64, 3), (3, 64)] {
            assert_eq!(depth_test(&Step, &view(), x, y, 0.9, 0.0), 1.0, "outside at ({x}, {y})");
        }
    }

    /// A map of random depths, moved by whole texels.
    struct Noise {
        x: u32,
        y: u32,
    }

    impl MapAccess for Noise {
        fn fetch_texel(&self, _layer: u32, x: u32, y: u32) -> f32 {
            let mut bits = (x + self.x).wrapping_mul(0x9e37_79b9) ^ (y + self.y).wrapping_mul(0x85eb_ca6b);
            bits = (bits ^ (bits >> 15)).wrapping_mul(0x2c1b_3c6d);
            (bits >> 8) as f32 / 16_777_216.0
        }
    }

    fn any_filter() -> impl Strategy<Value = Filter> {
        prop::sample::select(Filter::ALL.to_vec())
    }

    proptest! {
        /// Weights are at least 0 and add up to 1: what is averaged stays between 0 and 1, and is constant where the tests are. A texel further on the map, everything
        /// is a texel further on.
        #[test]
        fn filters_average(
            filter in any_filter(),
            (x, y) in (20.0..40.0_f32, 20.0..40.0_f32),
            depth in 0.0..1.0_f32,
            sides in prop::array::uniform4(-6.0..6.0_f32),
            pixel in prop::array::uniform2(0..8_u32),
        ) {
            // Steps of 1/256 of a texel survive a shift by whole texels exactly.
            let steps = |x: f32| (x * 256.0).round() / 256.0;
            let footprint = [Vec2::new(sides[0], sides[1]), Vec2::new(sides[2], sides[3])].map(|side| side.map(steps));
            let lookup = Lookup {
                texel: Vec2::new(steps(x), steps(y)),
                depth,
                turn: turn::turn_of_pixel(pixel),
                footprint,
                ..Lookup::default()
            };
            let light = light(filter);
            let test = |maps: Noise, lookup: &Lookup| filtered_test(&maps, &view(), &light, lookup);
            let mean = test(Noise { x: 0, y: 0 }, &lookup);
            prop_assert!((0.0..=1.0).contains(&mean), "{mean}");
            prop_assert_eq!(test(Noise { x: 0, y: 0 }, &Lookup { bias: 1.0, ..lookup }), 1.0);
            prop_assert_eq!(test(Noise { x: 0, y: 0 }, &Lookup { depth: 2.0, ..lookup }), 0.0);
            let further_on = Lookup { texel: lookup.texel - Vec2::new(3.0, 5.0), ..lookup };
            // A disc's places are not whole steps: one in a million falls on the other side of a texel's edge.
            let moved = test(Noise { x: 3, y: 5 }, &further_on);
            let places = if light.filter == FILTER_DISC { 1.0 / 16.0 } else { 0.0 };
            prop_assert!((moved - mean).abs() <= places, "{moved} {mean}");
        }

        /// The support is enough for every weighted tap, and some lookup comes near to needing it.
        #[test]
        fn no_tap_lies_beyond_the_support(
            filter in any_filter(),
            (x, y) in (20.0..40.0_f32, 20.0..40.0_f32),
            angle in 0.0..core::f32::consts::TAU,
            sides in prop::array::uniform4(-6.0..6.0_f32),
            pixel in prop::array::uniform2(0..8_u32),
        ) {
            let gradient = Vec2::from_angle(angle) * 0.01;
            let footprint = [Vec2::new(sides[0], sides[1]), Vec2::new(sides[2], sides[3])];
            let lookup = Lookup { texel: Vec2::new(x, y), turn: turn::turn_of_pixel(pixel), footprint, ..Lookup::default() };
            let light = light(filter);
            let need = support(&light, gradient, footprint) * (gradient.x.abs() + gradient.y.abs());
            let mut most = 0.0_f32;
            taps::for_each_weighted_tap(&light, &lookup, |tap| {
                most = most.max((tap.as_vec2() + 0.5 - lookup.texel).dot(gradient));
            });
            // Texels of 40 in f32, times the gradient.
            prop_assert!(most <= need + 1e-6, "{most} {need}");
        }
    }

    /// A footprint against 64 by 64 tests in the same parallelogram: how far it is off on noise, where every texel is its own, and on an outline. Its tests lie half a texel apart.
    #[test]
    fn a_footprint_is_the_mean_over_its_parallelogram() {
        /// Half of the map is in shadow, along a line that leans.
        struct Outline;
        impl MapAccess for Outline {
            fn fetch_texel(&self, _layer: u32, x: u32, y: u32) -> f32 {
                if 2 * x + y < 90 { 0.2 } else { 0.8 }
            }
        }
        let light = light(Filter::Footprint);
        let (mut noise, mut outline) = ([0.0_f32; 2], [0.0_f32; 2]);
        let count = 2000_u32;
        for step in 0..count {
            let at = |prime: u32| (step.wrapping_mul(prime) % 65_521) as f32 / 65_521.0;
            let side = |a: u32, b: u32| Vec2::new(at(a) * 14.0 - 7.0, at(b) * 14.0 - 7.0);
            let lookup = Lookup {
                texel: Vec2::new(26.0 + 8.0 * at(104_729), 26.0 + 8.0 * at(1_299_709)),
                depth: 0.5,
                footprint: [side(7919, 15_485_863), side(611_953, 32_452_843)],
                ..Lookup::default()
            };
            let fine = |maps: &dyn Fn(i32, i32) -> f32| {
                let places = (0..64).flat_map(|row| (0..64).map(move |column| [column, row]));
                let lit: f32 = places
                    .map(|at| {
                        let place = footprint_place(&lookup, at, [64, 64]).floor();
                        maps(place.x as i32, place.y as i32)
                    })
                    .sum();
                lit / 4096.0
            };
            let errors = [
                filtered_test(&Noise { x: 0, y: 0 }, &view(), &light, &lookup)
                    - fine(&|x, y| depth_test(&Noise { x: 0, y: 0 }, &view(), x, y, 0.5, 0.0)),
                filtered_test(&Outline, &view(), &light, &lookup) - fine(&|x, y| depth_test(&Outline, &view(), x, y, 0.5, 0.0)),
            ];
            for (error, sums) in errors.into_iter().zip([&mut noise, &mut outline]) {
                sums[0] = sums[0].max(error.abs());
                sums[1] += error * error / count as f32;
            }
        }
        // Stated in the module: measured here, with a tenth more.
        let [noise_rms, outline_rms] = [noise[1].sqrt(), outline[1].sqrt()];
        assert!(noise_rms < 0.026 && noise[0] < 0.165, "on noise: rms {noise_rms}, at most {}", noise[0]);
        assert!(outline_rms < 0.0135 && outline[0] < 0.12, "on an outline: rms {outline_rms}, at most {}", outline[0]);
    }

    /// The support is no more than is needed: over many lookups some tap comes within a few per cent of it.
    #[test]
    fn some_tap_comes_near_the_support() {
        for filter in Filter::ALL {
            let light = light(filter);
            let mut nearest = 0.0_f32;
            for step in 0..40_000_u32 {
                let at = |prime: u32| (step.wrapping_mul(prime) % 65_521) as f32 / 65_521.0;
                let gradient = Vec2::from_angle(at(7919) * core::f32::consts::TAU);
                let side = |a: u32, b: u32| Vec2::new(at(a) * 4.0 - 2.0, at(b) * 4.0 - 2.0);
                let lookup = Lookup {
                    texel: Vec2::new(20.0 + at(104_729), 30.0 + at(1_299_709)),
                    turn: turn::turn_of_pixel([step % 4, step / 4 % 4]),
                    footprint: [side(3, 5), side(11, 13)],
                    ..Lookup::default()
                };
                let need = support(&light, gradient, lookup.footprint) * (gradient.x.abs() + gradient.y.abs());
                taps::for_each_weighted_tap(&light, &lookup, |tap| {
                    nearest = nearest.max((tap.as_vec2() + 0.5 - lookup.texel).dot(gradient) / need);
                });
            }
            // A disc has no place on its very rim, and a footprint none in its corners.
            let expected = if light.filter > FILTER_CROSS { 0.8 } else { 0.95 };
            assert!(nearest > expected, "{filter:?}: {nearest}");
        }
    }
}
