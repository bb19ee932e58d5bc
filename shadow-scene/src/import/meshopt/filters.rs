//! Filters: what decoded attributes are turned into, in place.

use serde_json::Value;

use super::Decoded;

/// What is done to the elements of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl Filter {
    pub(super) fn read(value: Option<&Value>) -> Decoded<Self> {
        let Some(value) = value else { return Ok(Self::None) };
        match value.as_str() {
            Some("NONE") => Ok(Self::None),
            Some("OCTAHEDRAL") => Ok(Self::Octahedral),
            Some("QUATERNION") => Ok(Self::Quaternion),
            Some("EXPONENTIAL") => Ok(Self::Exponential),
            Some("COLOR") => Ok(Self::Color),
            _ => Err(format!("`filter` is {value}, but must be NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL or COLOR")),
        }
    }

    /// Whether it works on elements of so many bytes.
    pub(super) fn takes(self, stride: u64) -> bool {
        match self {
            Self::None => true,
            Self::Octahedral | Self::Color => stride == 4 || stride == 8,
            Self::Quaternion => stride == 8,
            Self::Exponential => stride.is_multiple_of(4),
        }
    }

    /// Filters all elements.
    pub(super) fn apply(self, bytes: &mut [u8], stride: usize) {
        match self {
            Self::None => {}
            Self::Exponential => bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|b| *b = exponential(*b)),
            Self::Quaternion => bytes.as_chunks_mut::<8>().0.iter_mut().for_each(|b| *b = from_words(quaternion(words(*b)))),
            Self::Octahedral | Self::Color if stride == 8 => {
                for bytes in bytes.as_chunks_mut::<8>().0 {
                    let input = words(*bytes);
                    *bytes = from_words(if self == Self::Color {
                        color(input.map(i32::from), i32::from(input[3] as u16), f32::from(u16::MAX)).map(|c| c as u16 as i16)
                    } else {
                        octahedral(input.map(i32::from), f32::from(i16::MAX)).map(|c| c as i16)
                    });
                }
            }
            Self::Octahedral | Self::Color => {
                for bytes in bytes.as_chunks_mut::<4>().0 {
                    let input = bytes.map(|byte| byte as i8);
                    *bytes = if self == Self::Color {
                        color(input.map(i32::from), bytes[3].into(), f32::from(u8::MAX)).map(|c| c as u8)
                    } else {
                        octahedral(input.map(i32::from), f32::from(i8::MAX)).map(|c| c as i8 as u8)
                    };
                }
            }
        }
    }
}

fn words(bytes: [u8; 8]) -> [i16; 4] {
    core::array::from_fn(|i| i16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]))
}

fn from_words(words: [i16; 4]) -> [u8; 8] {
    core::array::from_fn(|i| words[i / 2].to_le_bytes()[i % 2])
}

/// A unit vector from a point of the octahedron; the third number stands for 1, the fourth is left as it is.
fn octahedral(input: [i32; 4], max: f32) -> [i32; 4] {
    let one = input[2] as f32;
    let (x, y) = (input[0] as f32 / one, input[1] as f32 / one);
    let z = 1.0 - x.abs() - y.abs();
    // The lower half is folded outwards.
    let t = z.min(0.0);
    let (x, y) = (x - t.copysign(x), y - t.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    // A conversion takes NaN, which a stream with 0 for 1 has, to 0.
    let round = |v: f32| (v / length * max).round() as i32;
    [round(x), round(y), round(z), input[3]]
}

/// A unit quaternion from its three smaller components; the fourth number stands for 1 and says which one is missing.
fn quaternion(input: [i16; 4]) -> [i16; 4] {
    const MAX: f32 = i16::MAX as f32;
    let one = f32::from(input[3] | 3);
    let scale = core::f32::consts::FRAC_1_SQRT_2 / one;
    let [x, y, z] = [0, 1, 2].map(|i| f32::from(input[i]) * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = (input[3] & 3) as usize;
    let mut output = [0; 4];
    for (i, value) in [w, x, y, z].into_iter().enumerate() {
        output[(largest + i) % 4] = (value * MAX).round() as i16;
    }
    output
}

/// A float from an exponent of 8 bits above a mantissa of 24, both signed.
fn exponential(input: [u8; 4]) -> [u8; 4] {
    let bits = i32::from_le_bytes(input);
    let (exponent, mantissa) = (bits >> 24, bits << 8 >> 8);
    // In double precision no power overflows or vanishes, so that only the result is rounded.
    ((f64::from(exponent).exp2() * f64::from(mantissa)) as f32).to_le_bytes()
}

/// Red, green, blue and alpha from luma, two chroma and alpha, whose highest bit says how many bits all of them have.
/// `alpha` is the fourth number without a sign.
fn color([y, co, cg, _]: [i32; 4], alpha: i32, max: f32) -> [i32; 4] {
    let bits = u32::BITS - (alpha as u32).leading_zeros();
    let scale = (1 << bits) - 1;
    // Luma is unsigned; where it fills all bits, the sign was not one.
    let y = y & scale;
    let a = alpha & (scale >> 1);
    let a = a << 1 | a & 1;
    let factor = max / scale as f32;
    [y + co - cg, y + cg, y - co - cg, a].map(|value| ((value as f32 * factor).round() as i32).clamp(0, max as i32))
}
