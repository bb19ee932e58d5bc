//! Filters: which texels are tested, and how the tests are averaged.
//!
//! What is averaged are the results of depth tests, never depths (Reeves, Salesin and Cook 1987).
//!
//! Mirrored by `filter.wgsl`.

use glam::{IVec2, Vec2};

use crate::{
    plan::{FILTER_HARD, ViewPlan},
    settings::{Bias, Filter},
    visibility::MapAccess,
};

/// Texels that stay free on every side of a fit: the reach of the widest filter from a receiver at the rim, what the bias moves a lookup by, and one for
/// rounding.
///
/// A bilinear tap is less than one texel from its lookup, a hard one half of one. The automatic bias moves a lookup along the normal by less than 2.5
/// times as much: see [`normal_offset`](crate::bias::normal_offset).
#[must_use]
pub fn guard_texels(filter: Filter, bias: Bias) -> u32 {
    let reach = match filter {
        Filter::Hard | Filter::Bilinear => 1,
    };
    let moved = match bias {
        Bias::Automatic => 3 * reach,
        Bias::None | Bias::Constant { .. } | Bias::Slope { .. } => 0,
    };
    reach + moved + 1
}

/// How far the weighted taps of a filter reach, in texels on each axis: the factor of `|g1| + |g2|` in the bias it needs.
///
/// The hard test's texel centre lies at most half a texel from the lookup. Of the four bilinear taps each is less than a whole texel
/// away on each axis, and comes as near to that as its weight comes to zero.
#[inline(always)]
#[must_use]
pub fn support(filter: u32) -> f32 {
    if filter == FILTER_HARD {
        return 0.5;
    }
    1.0
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
    let stored = maps.fetch_texel(view.layer, x as u32, y as u32);
    if depth <= stored + bias {
        return 1.0;
    }
    0.0
}

/// The average of the depth tests around `texel`, from 0, shadowed, to 1, lit.
///
/// `texel` is in texels of the layer, with texel centres at + 0.5; each coordinate must be far inside the range of i32.
#[inline(always)]
#[must_use]
pub fn filtered_test(maps: &impl MapAccess, view: &ViewPlan, filter: u32, texel: Vec2, depth: f32, bias: f32) -> f32 {
    if filter == FILTER_HARD {
        return depth_test(maps, view, floor(texel.x) as i32, floor(texel.y) as i32, depth, bias);
    }
    let (x0, y0, fraction) = bilinear_corner(texel);
    let t00 = depth_test(maps, view, x0, y0, depth, bias);
    let t10 = depth_test(maps, view, x0 + 1, y0, depth, bias);
    let t01 = depth_test(maps, view, x0, y0 + 1, depth, bias);
    let t11 = depth_test(maps, view, x0 + 1, y0 + 1, depth, bias);
    bilinear_mean(t00, t10, t01, t11, fraction)
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

/// The texels that [`filtered_test`] gives a weight above 0, and how many they are: for tools that explain a lookup.
#[must_use]
pub fn weighted_taps(filter: u32, texel: Vec2) -> ([IVec2; 4], usize) {
    if filter == FILTER_HARD {
        return ([IVec2::new(floor(texel.x) as i32, floor(texel.y) as i32); 4], 1);
    }
    let corner = texel - Vec2::new(0.5, 0.5);
    let base = IVec2::new(floor(corner.x) as i32, floor(corner.y) as i32);
    let right = i32::from(corner.x > floor(corner.x));
    let below = i32::from(corner.y > floor(corner.y));
    let mut taps = [base; 4];
    let mut count = 0;
    for dy in 0..=below {
        for dx in 0..=right {
            taps[count] = base + IVec2::new(dx, dy);
            count += 1;
        }
    }
    (taps, count)
}

/// Rounds toward minus infinity.
#[inline(always)]
fn floor(x: f32) -> f32 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    x.floor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::FILTER_BILINEAR;

    /// A map whose left half holds 0.2 and whose right half holds 0.8.
    struct Step;

    impl MapAccess for Step {
        fn fetch_texel(&self, _layer: u32, x: u32, _y: u32) -> f32 {
            if x < 8 { 0.2 } else { 0.8 }
        }
    }

    fn view() -> ViewPlan {
        ViewPlan { rect: [0, 0, 16, 16], ..ViewPlan::default() }
    }

    fn test_at(filter: u32, x: f32) -> f32 {
        filtered_test(&Step, &view(), filter, Vec2::new(x, 7.3), 0.5, 0.0)
    }

    #[test]
    fn bilinear_ramps_over_one_texel_and_hard_steps() {
        assert_eq!(test_at(FILTER_HARD, 7.999), 0.0);
        assert_eq!(test_at(FILTER_HARD, 8.0), 1.0);
        for (x, lit) in [(7.5, 0.0), (7.75, 0.25), (8.0, 0.5), (8.25, 0.75), (8.5, 1.0)] {
            assert_eq!(test_at(FILTER_BILINEAR, x), lit, "at {x}");
        }
    }

    #[test]
    fn equal_is_lit_and_so_is_the_outside() {
        assert_eq!(depth_test(&Step, &view(), 3, 3, 0.2, 0.0), 1.0);
        assert_eq!(depth_test(&Step, &view(), 3, 3, 0.200_001, 0.0), 0.0);
        for (x, y) in [(-1, 3), (3, -1), (16, 3), (3, 16)] {
            assert_eq!(depth_test(&Step, &view(), x, y, 0.9, 0.0), 1.0, "outside at ({x}, {y})");
        }
    }

    #[test]
    fn weighted_taps_are_those_with_a_weight() {
        assert_eq!(weighted_taps(FILTER_BILINEAR, Vec2::new(3.5, 3.5)).1, 1);
        assert_eq!(weighted_taps(FILTER_BILINEAR, Vec2::new(3.6, 3.5)).1, 2);
        let (taps, count) = weighted_taps(FILTER_BILINEAR, Vec2::new(3.4, 3.6));
        assert_eq!(&taps[..count], [IVec2::new(2, 3), IVec2::new(3, 3), IVec2::new(2, 4), IVec2::new(3, 4)]);
        assert_eq!(weighted_taps(FILTER_HARD, Vec2::new(3.4, 3.6)), ([IVec2::new(3, 3); 4], 1));
    }
}
