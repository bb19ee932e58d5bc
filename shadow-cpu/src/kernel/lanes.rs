//! Eight numbers at a time: the vectors that the rasteriser's inner loops are written in.
//!
//! Left to itself the compiler turned a row of eight samples into masked stores, which some processors take fifty times as long for as
//! for a blend and a whole store. Here each operation is one instruction where the processor has AVX2, and a plain loop elsewhere. Every
//! operation rounds each lane as the scalar operation does, so that both give the same bits.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

use super::LANES;

/// Eight f32.
pub(crate) trait Floats: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    type Ints: Ints<Floats = Self>;
    fn splat(x: f32) -> Self;
    fn load(from: &[f32; LANES]) -> Self;
    fn store(self, to: &mut [f32; LANES]);
    /// `self * b + c`, rounded once.
    fn fused(self, b: Self, c: Self) -> Self;
    /// The smaller of each pair; `other` where either is not a number.
    fn min(self, other: Self) -> Self;
    /// The larger of each pair; `other` where either is not a number.
    fn max(self, other: Self) -> Self;
    /// All bits set where `self < other`.
    fn less(self, other: Self) -> Self::Ints;
    /// All bits set where `self <= other`.
    fn at_most(self, other: Self) -> Self::Ints;
    /// The nearest whole numbers, of two the even one; what does not fit 32 bits, or is not a number, becomes some number.
    fn round(self) -> Self::Ints;
    /// The columns of eight rows.
    fn columns(rows: [&[f32; 4]; LANES]) -> [Self; 4];
    /// The rows of four columns.
    fn rows(columns: [Self; 4]) -> [[f32; 4]; LANES];
}

/// Eight i32. As a mask, all bits of a lane are set or none.
pub(crate) trait Ints:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + BitAnd<Output = Self> + BitOr<Output = Self>
{
    type Floats: Floats<Ints = Self>;
    fn splat(x: i32) -> Self;
    fn load(from: &[i32; LANES]) -> Self;
    fn store(self, to: &mut [i32; LANES]);
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    /// Shifted to the right, the sign kept.
    fn shift_right(self, bits: u32) -> Self;
    /// Shifted to the left; what leaves 32 bits is lost.
    fn shift_left(self, bits: u32) -> Self;
    /// All bits set where `self > other`.
    fn greater(self, other: Self) -> Self;
    /// All bits set where the lanes are equal.
    fn equal(self, other: Self) -> Self;
    /// As f32.
    fn to_floats(self) -> Self::Floats;
    /// Where a lane of `self` is negative `chosen`, else `other`: for masks, and for edge values, whose sign says that a sample is outside.
    fn select_negative(self, chosen: Self::Floats, other: Self::Floats) -> Self::Floats;
    /// As [`Ints::select_negative`], for integers.
    fn select_negative_ints(self, chosen: Self, other: Self) -> Self;
    /// A bit for each lane that is negative, the first lane's lowest.
    fn negative_bits(self) -> u32;
    /// The low and the high halves of eight pairs.
    fn columns(pairs: [i64; LANES]) -> [Self; 2];
    /// Eight pairs of these low and high halves.
    fn pairs(columns: [Self; 2]) -> [i64; LANES];
}

/// The vectors of one kind of processor.
pub(crate) trait Lanes: Copy + Send + Sync + 'static {
    type F: Floats<Ints = Self::I>;
    type I: Ints<Floats = Self::F>;
}

/// Plain loops, for every processor.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

impl Lanes for Portable {
    type F = PortableFloats;
    type I = PortableInts;
}

#[derive(Clone, Copy)]
pub(crate) struct PortableFloats([f32; LANES]);

#[derive(Clone, Copy)]
pub(crate) struct PortableInts([i32; LANES]);

/// Implements an operator lane by lane.
macro_rules! lane_by_lane {
    ($kind:ident, $operator:ident, $method:ident, |$a:ident, $b:ident| $result:expr) => {
        impl $operator for $kind {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(core::array::from_fn(|lane| {
                    let ($a, $b) = (self.0[lane], other.0[lane]);
                    $result
                }))
            }
        }
    };
}

lane_by_lane!(PortableFloats, Add, add, |a, b| a + b);
lane_by_lane!(PortableFloats, Sub, sub, |a, b| a - b);
lane_by_lane!(PortableFloats, Mul, mul, |a, b| a * b);
lane_by_lane!(PortableFloats, Div, div, |a, b| a / b);
lane_by_lane!(PortableInts, Add, add, |a, b| a.wrapping_add(b));
lane_by_lane!(PortableInts, Sub, sub, |a, b| a.wrapping_sub(b));
lane_by_lane!(PortableInts, Mul, mul, |a, b| a.wrapping_mul(b));
lane_by_lane!(PortableInts, BitAnd, bitand, |a, b| a & b);
lane_by_lane!(PortableInts, BitOr, bitor, |a, b| a | b);

/// A mask of one lane.
#[inline(always)]
fn mask(yes: bool) -> i32 {
    -i32::from(yes)
}

impl Floats for PortableFloats {
    type Ints = PortableInts;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn load(from: &[f32; LANES]) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; LANES]) {
        *to = self.0;
    }

    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        Self(core::array::from_fn(|lane| self.0[lane].mul_add(b.0[lane], c.0[lane])))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| if self.0[lane] < other.0[lane] { self.0[lane] } else { other.0[lane] }))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| if self.0[lane] > other.0[lane] { self.0[lane] } else { other.0[lane] }))
    }

    #[inline(always)]
    fn less(self, other: Self) -> PortableInts {
        PortableInts(core::array::from_fn(|lane| mask(self.0[lane] < other.0[lane])))
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> PortableInts {
        PortableInts(core::array::from_fn(|lane| mask(self.0[lane] <= other.0[lane])))
    }

    #[inline(always)]
    fn round(self) -> PortableInts {
        PortableInts(self.0.map(|x| x.round_ties_even() as i32))
    }

    #[inline(always)]
    fn columns(rows: [&[f32; 4]; LANES]) -> [Self; 4] {
        core::array::from_fn(|column| Self(rows.map(|row| row[column])))
    }

    #[inline(always)]
    fn rows(columns: [Self; 4]) -> [[f32; 4]; LANES] {
        core::array::from_fn(|lane| columns.map(|column| column.0[lane]))
    }
}

impl Ints for PortableInts {
    type Floats = PortableFloats;

    #[inline(always)]
    fn splat(x: i32) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn load(from: &[i32; LANES]) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn store(self, to: &mut [i32; LANES]) {
        *to = self.0;
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| self.0[lane].min(other.0[lane])))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| self.0[lane].max(other.0[lane])))
    }

    #[inline(always)]
    fn shift_right(self, bits: u32) -> Self {
        Self(self.0.map(|x| x >> bits))
    }

    #[inline(always)]
    fn shift_left(self, bits: u32) -> Self {
        Self(self.0.map(|x| x << bits))
    }

    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| mask(self.0[lane] > other.0[lane])))
    }

    #[inline(always)]
    fn equal(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| mask(self.0[lane] == other.0[lane])))
    }

    #[inline(always)]
    fn to_floats(self) -> PortableFloats {
        PortableFloats(self.0.map(|x| x as f32))
    }

    #[inline(always)]
    fn select_negative(self, chosen: PortableFloats, other: PortableFloats) -> PortableFloats {
        let choose = |lane: usize| if self.0[lane] < 0 { chosen.0[lane] } else { other.0[lane] };
        PortableFloats(core::array::from_fn(choose))
    }

    #[inline(always)]
    fn select_negative_ints(self, chosen: Self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| if self.0[lane] < 0 { chosen.0[lane] } else { other.0[lane] }))
    }

    #[inline(always)]
    fn negative_bits(self) -> u32 {
        (0..LANES).map(|lane| u32::from(self.0[lane] < 0) << lane).sum()
    }

    #[inline(always)]
    fn columns(pairs: [i64; LANES]) -> [Self; 2] {
        [Self(pairs.map(|pair| pair as i32)), Self(pairs.map(|pair| (pair >> 32) as i32))]
    }

    #[inline(always)]
    fn pairs([low, high]: [Self; 2]) -> [i64; LANES] {
        core::array::from_fn(|lane| i64::from(high.0[lane]) << 32 | i64::from(low.0[lane] as u32))
    }
}
