//! Float methods that `core` lacks, from whichever of `std` and `libm` the build has.

/// Square roots and trigonometry for builds without the standard library.
///
/// With the feature `std` the inherent methods of the same names take precedence and this trait is not compiled.
#[cfg(not(feature = "std"))]
pub(crate) trait FloatFuncs: Sized {
    fn sqrt(self) -> Self;
    fn tan(self) -> Self;
    fn cos(self) -> Self;
    fn floor(self) -> Self;
    fn log2(self) -> Self;
    fn exp2(self) -> Self;
    fn powf(self, exponent: Self) -> Self;
}

#[cfg(not(feature = "std"))]
macro_rules! float_funcs {
    ($float:ty, $sqrt:ident, $tan:ident, $cos:ident, $floor:ident, $log2:ident, $exp2:ident, $pow:ident) => {
        impl FloatFuncs for $float {
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            fn tan(self) -> Self {
                libm::$tan(self)
            }
            fn cos(self) -> Self {
                libm::$cos(self)
            }
            fn floor(self) -> Self {
                libm::$floor(self)
            }
            fn log2(self) -> Self {
                libm::$log2(self)
            }
            fn exp2(self) -> Self {
                libm::$exp2(self)
            }
            fn powf(self, exponent: Self) -> Self {
                libm::$pow(self, exponent)
            }
        }
    };
}

#[cfg(not(feature = "std"))]
float_funcs!(f32, sqrtf, tanf, cosf, floorf, log2f, exp2f, powf);
#[cfg(not(feature = "std"))]
float_funcs!(f64, sqrt, tan, cos, floor, log2, exp2, pow);
