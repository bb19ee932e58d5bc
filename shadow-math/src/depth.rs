//! What a map's texel remembers, and what depth means in metres.
//!
//! Depth is z / w of the view's own matrix, 0 at the near plane and 1 at the far plane, unless the [store](crate::settings::Store) says otherwise. Two are drawn with reversed depth, `r = 1 - z / w`, which is
//! 0 at the far plane: for a perspective view it is near / w but for a constant, so that floats, which are finest near 0, are finest where z / w is coarsest. `reversed32` keeps r, `linear` turns it
//! into the distance along the axis. `depth24` and `depth16` round z / w to so many steps, as the formats of that many bits do. `second` and `midpoint` are made of two
//! surfaces: the nearest, and the nearest of those behind it.
//!
//! [`encoded_depth`], [`comparable_depth`], [`receiver_depth`], [`linear_bias`] and [`depth_of_two`] are mirrored by `depth.wgsl`.

use crate::plan::ViewPlan;

/// [`ViewPlan::depth_kind`]: z / w of the view's own matrix: 0 at the near plane, 1 at the far plane.
pub const DEPTH_Z_OVER_W: u32 = 0;
/// [`ViewPlan::depth_kind`]: 1 - z / w: 1 at the near plane, 0 at the far plane.
pub const DEPTH_REVERSED: u32 = 1;
/// [`ViewPlan::depth_kind`]: the distance along the axis, 0 at the near plane, 1 at the far plane; drawn with reversed depth.
pub const DEPTH_LINEAR: u32 = 2;

/// [`ViewPlan::depth_layer`]: the nearest surface.
pub const LAYER_FIRST: u32 = 0;
/// [`ViewPlan::depth_layer`]: the nearest of the surfaces that lie behind the first.
pub const LAYER_SECOND: u32 = 1;
/// [`ViewPlan::depth_layer`]: half-way between the two.
pub const LAYER_MIDPOINT: u32 = 2;

/// What a map holds of a depth that was drawn, from 0 to 1.
///
/// In a [pancaked](crate::fit::ViewFit::pancaked) view what lies before the near plane is held as lying on it, and what lies behind the far plane on that. A drawn depth
/// of the far plane, where nothing is, stays one.
///
/// With reversed depth r, far plane f and near plane n, the distance w along the axis is `n f / (n + r (f - n))`, and its share of the range `(w - n) / (f - n) = (1 - r) / (1 + r (f - n) / n)`. The
/// order of depths stays, or is turned round for all: the nearest drawn is the nearest stored.
#[inline(always)]
#[must_use]
pub fn encoded_depth(view: &ViewPlan, drawn: f32) -> f32 {
    let mut depth = drawn;
    if view.drawn_scale > 0.0 {
        depth = (drawn * view.drawn_scale + view.drawn_offset).max(0.0).min(1.0);
        // Where nothing is drawn there is nothing, wherever the far plane lies.
        if view.depth_kind == DEPTH_Z_OVER_W {
            if drawn >= 1.0 {
                depth = 1.0;
            }
        } else if drawn <= 0.0 {
            depth = 0.0;
        }
    }
    if view.depth_kind == DEPTH_LINEAR {
        depth = (1.0 - depth) / (1.0 + depth * view.range_over_near);
    }
    if view.depth_steps > 0.0 {
        depth = nearest_whole(depth * view.depth_steps) / view.depth_steps;
    }
    depth
}

/// The nearest whole number, of two the even one; for numbers from 0.
#[inline(always)]
#[must_use]
pub fn nearest_whole(x: f32) -> f32 {
    /// 2^23: from here on every f32 is whole, and a sum with it has no place for fractions.
    const WHOLE: f32 = 8_388_608.0;
    if x >= WHOLE {
        return x;
    }
    (x + WHOLE) - WHOLE
}

/// A texel's depth as tests compare it: what is nearer to the light is smaller.
#[inline(always)]
#[must_use]
pub fn comparable_depth(view: &ViewPlan, stored: f32) -> f32 {
    if view.depth_kind == DEPTH_REVERSED {
        return -stored;
    }
    stored
}

/// A receiver's depth as tests compare it with [`comparable_depth`]s. `z` and `w` are its clip coordinates, z by w divided.
#[inline(always)]
#[must_use]
pub fn receiver_depth(view: &ViewPlan, z: f32, w: f32) -> f32 {
    if view.depth_kind == DEPTH_REVERSED {
        return -z;
    }
    if view.depth_kind == DEPTH_LINEAR {
        return w * view.linear_scale + view.linear_offset;
    }
    z
}

/// The comparable depths of the near and the far plane.
#[inline(always)]
#[must_use]
pub fn depth_limits(view: &ViewPlan) -> [f32; 2] {
    if view.depth_kind == DEPTH_REVERSED {
        return [-1.0, 0.0];
    }
    [0.0, 1.0]
}

/// A bias in z / w as one in the depth that the map holds.
///
/// The last H of z / w before a receiver at w end at `w - w^2 H / (factor + w H)`, by [`DepthScale`], and linear depth is the distance over the range: exact, where a derivative would be too small.
/// 1 stays 1: everything is lit.
#[inline(always)]
#[must_use]
pub fn linear_bias(view: &ViewPlan, w: f32, bias: f32) -> f32 {
    if view.depth_kind != DEPTH_LINEAR || bias >= 1.0 {
        return bias;
    }
    w * w * bias / (view.depth_factor + w * bias) * view.linear_scale
}

/// What a texel holds of its two nearest surfaces.
#[inline(always)]
#[must_use]
pub fn depth_of_two(view: &ViewPlan, first: f32, second: f32) -> f32 {
    if view.depth_layer == LAYER_MIDPOINT {
        return (first + second) * 0.5;
    }
    second
}

/// How depth grows along the axis of a view: `depth = offset - factor / distance` for a perspective view and
/// `depth = offset + factor * distance` for an orthographic one.
///
/// `distance` is measured along the view axis in metres; for an orthographic view from the near plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthScale {
    /// The factor: 1 / m for an orthographic view, m for a perspective one.
    pub factor: f64,
    /// 1 for a perspective view, whose w is the distance; 0 for an orthographic one, whose w is 1.
    pub w_per_metre: f64,
}

impl DepthScale {
    /// The scale of an orthographic view from 0 to `range` metres.
    #[must_use]
    pub fn orthographic(range: f64) -> Self {
        Self { factor: 1.0 / range, w_per_metre: 0.0 }
    }

    /// The scale of a perspective view with these planes, in metres.
    #[must_use]
    pub fn perspective(near: f64, far: f64) -> Self {
        Self { factor: far * near / (far - near), w_per_metre: 1.0 }
    }

    /// The depth that the last `metres` before a point with clip coordinate `w` take up: exact, not a derivative.
    ///
    /// A perspective view has no depth behind its eye: lengths of the whole distance or more give infinity.
    ///
    /// ```
    /// use shadow_math::depth::DepthScale;
    ///
    /// let (near, far) = (0.5, 20.0);
    /// let depth = |distance: f64| far / (far - near) * (1.0 - near / distance);
    /// let metres = DepthScale::perspective(near, far).depth_of_metres(8.0, 0.25);
    /// assert!((metres - (depth(8.0) - depth(7.75))).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn depth_of_metres(self, w: f64, metres: f64) -> f64 {
        let w_before = w - self.w_per_metre * metres;
        if w_before <= 0.0 { f64::INFINITY } else { self.factor * metres / (w * w_before) }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn whole_numbers_are_the_nearest_and_even_ones_of_two() {
        for (x, whole) in [(0.4, 0.0), (0.5, 0.0), (1.5, 2.0), (2.5, 2.0), (65_534.6, 65_535.0), (8_388_607.5, 8_388_608.0)] {
            assert_eq!(nearest_whole(x), whole, "{x}");
        }
        assert_eq!(nearest_whole(16_777_215.0), 16_777_215.0);
    }

    /// The planes of a view, for what is computed from them alone.
    fn view(kind: u32, near: f64, far: f64) -> ViewPlan {
        ViewPlan {
            depth_kind: kind,
            depth_factor: DepthScale::perspective(near, far).factor as f32,
            w_per_metre: 1.0,
            range_over_near: ((far - near) / near) as f32,
            linear_scale: (1.0 / (far - near)) as f32,
            linear_offset: (-near / (far - near)) as f32,
            ..ViewPlan::default()
        }
    }

    proptest! {
        #[test]
        fn linear_depth_is_the_share_of_the_way_from_near_to_far(share in 0.0..1.0_f64, near in 0.01..2.0_f64) {
            let far = near + 30.0;
            let w = near + (far - near) * share;
            let reversed = near * (far - w) / (w * (far - near));
            let view = view(DEPTH_LINEAR, near, far);
            // The drawn depth is rounded once, six times while it is turned into a distance; a receiver's twice, and its w once.
            let bound = 8.0 * crate::rounding::UNIT_ROUNDOFF;
            prop_assert!((f64::from(encoded_depth(&view, reversed as f32)) - share).abs() < bound);
            prop_assert!((f64::from(receiver_depth(&view, 0.5, w as f32)) - share).abs() < bound * (1.0 + near));
        }

        #[test]
        fn a_linear_bias_reaches_as_far_as_the_bias_in_z_over_w(w in 0.6..29.0_f64, back in 0.001..0.9_f64) {
            let (near, far) = (0.5, 30.0);
            let before = near + (w - near) * back;
            let depth = |w: f64| far / (far - near) * (1.0 - near / w);
            let bias = linear_bias(&view(DEPTH_LINEAR, near, far), w as f32, (depth(w) - depth(before)) as f32);
            let expected = (w - before) / (far - near);
            // The difference of depths is rounded to f32 relative to itself, and seven operations follow.
            prop_assert!((f64::from(bias) - expected).abs() < 1e-5 * expected, "{bias} {expected}");
        }

        #[test]
        fn steps_are_as_far_off_as_the_bound_says(depth in 0.0..=1.0_f32) {
            for store in [crate::Store::Depth16, crate::Store::Depth24] {
                let view = ViewPlan { depth_steps: store.steps(), ..ViewPlan::default() };
                let off = (f64::from(encoded_depth(&view, depth)) - f64::from(depth)).abs();
                prop_assert!(off <= crate::rounding::step_rounding(store.steps()), "{store:?} {depth}: {off}");
            }
        }
    }
}
