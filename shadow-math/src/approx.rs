//! Logarithm and power from `+ - * /` alone, so that a shader that repeats the statements repeats the bits.
//!
//! Libraries and drivers differ in the last digits of `exp2`, `log2` and `pow` (72 units in the last place were seen for `pow` on a
//! software driver), and a highlight would then differ between renderers.
//!
//! Mirrored by `approx.wgsl`.

/// The base-2 logarithm of a positive normal number, to within 2e-7 absolutely for results of at most 1 and 2 units in the last
/// place beyond. Zero, negative, subnormal and non-finite numbers give the logarithm of some other number.
#[inline(always)]
#[must_use]
pub fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    // The exponent that leaves a mantissa between 1 / sqrt(2) and sqrt(2); 0x3f3504f3 is 1 / sqrt(2).
    let exponent = (bits.wrapping_sub(0x3f35_04f3) as i32) >> 23;
    let mantissa = f32::from_bits(bits.wrapping_sub((exponent as u32) << 23));
    // log2(m) = 2 / ln 2 * atanh((m - 1) / (m + 1)), and the series' next term is below 2e-9 here.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    let mut series = 0.320_598_9;
    series = series * s2 + 0.412_198_6;
    series = series * s2 + 0.577_078;
    series = series * s2 + 0.961_796_7;
    series = series * s2 + 2.885_39;
    exponent as f32 + series * s
}

/// 2 to the power of `x`, to within 3 units in the last place, for `x` up to 127. Below -126 the result would be subnormal, which
/// some hardware flushes to zero: it is 0 on all.
#[inline(always)]
#[must_use]
pub fn exp2(x: f32) -> f32 {
    if x < -126.0 {
        return 0.0;
    }
    let clamped = x.min(127.0);
    let whole = floor(clamped + 0.5);
    let f = clamped - whole;
    // The Taylor series of e^(f ln 2) for f from -1/2 to 1/2; its next term is below 6e-9.
    let mut series = 1.525_273_4e-5;
    series = series * f + 1.540_353e-4;
    series = series * f + 0.001_333_355_8;
    series = series * f + 0.009_618_129;
    series = series * f + 0.055_504_11;
    series = series * f + 0.240_226_5;
    series = series * f + core::f32::consts::LN_2;
    series = series * f + 1.0;
    series * f32::from_bits(((whole as i32 + 127) as u32) << 23)
}

/// `x` to the power of `y`; 0 for `x` that is not a positive normal number.
#[inline(always)]
#[must_use]
pub fn pow(x: f32, y: f32) -> f32 {
    if !(x >= f32::MIN_POSITIVE) {
        return 0.0;
    }
    exp2(y * log2(x))
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
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn log2_is_as_exact_as_it_says(x in 1e-30..1e30_f32) {
            let exact = f64::from(x).log2();
            let error = (f64::from(log2(x)) - exact).abs();
            prop_assert!(error <= 2e-7_f64.max(2.0 * 2.0_f64.powi(-23) * exact.abs()), "log2({x}) is off by {error}");
        }

        #[test]
        fn exp2_is_as_exact_as_it_says(x in -125.9..126.9_f32) {
            let exact = f64::from(x).exp2();
            let error = (f64::from(exp2(x)) - exact).abs() / exact;
            prop_assert!(error <= 3.0 * 2.0_f64.powi(-23), "exp2({x}) is off by {error} of itself");
        }
    }

    #[test]
    fn powers_at_the_ends() {
        assert_eq!(pow(0.0, 2.0), 0.0);
        assert_eq!(pow(-1.0, 2.0), 0.0);
        assert_eq!(pow(f32::NAN, 2.0), 0.0);
        assert_eq!(pow(1.0, 1000.0), 1.0);
        assert_eq!(pow(1e-3, 1000.0), 0.0, "no subnormal results");
        assert_eq!(exp2(0.0), 1.0);
        assert_eq!(exp2(-3.0), 0.125);
    }
}
