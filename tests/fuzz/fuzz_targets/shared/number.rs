//! Numbers for inputs: some as any bits are, more of the size that scenes have.

use arbitrary::{Arbitrary, Result, Unstructured};
use glam::Vec3;

/// A number with any bits, or a special one, or one from a thousandth to thousands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Number(pub(crate) f64);

/// Where rounding, overflow and comparison change.
const SPECIAL: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MIN_POSITIVE,
    1e-45,
    1e-38,
    1e-12,
    1e12,
    16_777_216.0,
    3.402_823_466e38,
    -3.402_823_466e38,
];

impl<'a> Arbitrary<'a> for Number {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let kind = u8::arbitrary(u)?;
        Ok(Self(match kind {
            0..16 => SPECIAL[usize::from(kind)],
            16..32 => f64::from_bits(u64::arbitrary(u)?),
            32..64 => f64::from(f32::from_bits(u32::arbitrary(u)?)),
            // Whole numbers and quarters, in which coincidences are likely.
            64..128 => f64::from(i8::arbitrary(u)?) / 4.0,
            _ => f64::from(i32::arbitrary(u)?) / f64::from(1 << 20),
        }))
    }
}

impl Number {
    pub(crate) fn f32(self) -> f32 {
        self.0 as f32
    }
}

/// A vector of such numbers.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub(crate) struct Vector(pub(crate) [Number; 3]);

impl Vector {
    pub(crate) fn vec3(self) -> Vec3 {
        Vec3::from_array(self.0.map(Number::f32))
    }
}
