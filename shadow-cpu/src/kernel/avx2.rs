//! The vectors of processors with AVX2 and FMA.
#![allow(unsafe_code, reason = "run-time dispatch: a map of a million triangles takes a third of the time that plain loops take")]

use std::{
    arch::x86_64::{
        __m256, __m256i, _CMP_LE_OQ, _CMP_LT_OQ, _mm_cvtsi32_si128, _mm_storeu_ps, _mm256_add_epi32, _mm256_add_ps,
        _mm256_and_si256, _mm256_blendv_epi8, _mm256_blendv_ps, _mm256_castps_si256, _mm256_castps256_ps128, _mm256_castsi256_ps,
        _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_cmpgt_epi32, _mm256_cvtepi32_ps, _mm256_cvtps_epi32, _mm256_div_ps,
        _mm256_extractf128_ps, _mm256_fmadd_ps, _mm256_loadu_ps, _mm256_loadu_si256, _mm256_loadu2_m128, _mm256_max_epi32,
        _mm256_max_ps, _mm256_min_epi32, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_mullo_epi32, _mm256_or_si256,
        _mm256_permute2x128_si256, _mm256_permute4x64_epi64, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi64x,
        _mm256_shuffle_ps, _mm256_sll_epi32, _mm256_sra_epi32, _mm256_srai_epi32, _mm256_storeu_ps, _mm256_storeu_si256,
        _mm256_sub_epi32, _mm256_sub_ps, _mm256_unpackhi_epi32, _mm256_unpackhi_ps, _mm256_unpacklo_epi32, _mm256_unpacklo_ps,
    },
    ops::{Add, BitAnd, BitOr, Div, Mul, Sub},
};

use super::{
    LANES,
    lanes::{Floats, Ints, Lanes},
};

/// AVX2 and FMA. Only `dispatch` names this type, where it has found that the processor has them; all code of this file runs under it.
#[derive(Clone, Copy)]
pub(crate) struct Avx2;

impl Lanes for Avx2 {
    type F = Avx2Floats;
    type I = Avx2Ints;
}

#[derive(Clone, Copy)]
pub(crate) struct Avx2Floats(__m256);

#[derive(Clone, Copy)]
pub(crate) struct Avx2Ints(__m256i);

/// Implements an operator by an instruction.
macro_rules! instruction {
    ($kind:ident, $operator:ident, $method:ident, $instruction:ident) => {
        impl $operator for $kind {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the processor has AVX2, as `Avx2` says.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

instruction!(Avx2Floats, Add, add, _mm256_add_ps);
instruction!(Avx2Floats, Sub, sub, _mm256_sub_ps);
instruction!(Avx2Floats, Mul, mul, _mm256_mul_ps);
instruction!(Avx2Floats, Div, div, _mm256_div_ps);
instruction!(Avx2Ints, Add, add, _mm256_add_epi32);
instruction!(Avx2Ints, Sub, sub, _mm256_sub_epi32);
instruction!(Avx2Ints, Mul, mul, _mm256_mullo_epi32);
instruction!(Avx2Ints, BitAnd, bitand, _mm256_and_si256);
instruction!(Avx2Ints, BitOr, bitor, _mm256_or_si256);

impl Floats for Avx2Floats {
    type Ints = Avx2Ints;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn load(from: &[f32; LANES]) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says; the reference holds eight numbers, of any alignment.
        Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; LANES]) {
        // SAFETY: the processor has AVX2, as `Avx2` says; the reference holds eight numbers, of any alignment.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        // SAFETY: the processor has FMA, as `Avx2` says.
        Self(unsafe { _mm256_fmadd_ps(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn less(self, other: Self) -> Avx2Ints {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Avx2Ints(unsafe { _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) })
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> Avx2Ints {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Avx2Ints(unsafe { _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) })
    }

    #[inline(always)]
    fn round(self) -> Avx2Ints {
        // SAFETY: the processor has AVX2, as `Avx2` says. Rust programs run with the default rounding mode, to the nearest and even.
        Avx2Ints(unsafe { _mm256_cvtps_epi32(self.0) })
    }

    #[inline(always)]
    fn columns(rows: [&[f32; 4]; LANES]) -> [Self; 4] {
        // SAFETY: the processor has AVX2, as `Avx2` says; each reference holds four numbers, of any alignment.
        unsafe {
            // Rows i and i + 4 side by side; the usual transposition of 4 x 4 then goes on in both halves.
            let r0 = _mm256_loadu2_m128(rows[4].as_ptr(), rows[0].as_ptr());
            let r1 = _mm256_loadu2_m128(rows[5].as_ptr(), rows[1].as_ptr());
            let r2 = _mm256_loadu2_m128(rows[6].as_ptr(), rows[2].as_ptr());
            let r3 = _mm256_loadu2_m128(rows[7].as_ptr(), rows[3].as_ptr());
            let (low01, low23) = (_mm256_unpacklo_ps(r0, r1), _mm256_unpacklo_ps(r2, r3));
            let (high01, high23) = (_mm256_unpackhi_ps(r0, r1), _mm256_unpackhi_ps(r2, r3));
            [
                Self(_mm256_shuffle_ps::<0b01_00_01_00>(low01, low23)),
                Self(_mm256_shuffle_ps::<0b11_10_11_10>(low01, low23)),
                Self(_mm256_shuffle_ps::<0b01_00_01_00>(high01, high23)),
                Self(_mm256_shuffle_ps::<0b11_10_11_10>(high01, high23)),
            ]
        }
    }

    #[inline(always)]
    fn rows([c0, c1, c2, c3]: [Self; 4]) -> [[f32; 4]; LANES] {
        let mut rows = [[0.0; 4]; LANES];
        // SAFETY: the processor has AVX2, as `Avx2` says; each reference holds four numbers, of any alignment.
        unsafe {
            let (low01, low23) = (_mm256_unpacklo_ps(c0.0, c1.0), _mm256_unpacklo_ps(c2.0, c3.0));
            let (high01, high23) = (_mm256_unpackhi_ps(c0.0, c1.0), _mm256_unpackhi_ps(c2.0, c3.0));
            // Rows i and i + 4 side by side.
            let pairs = [
                _mm256_shuffle_ps::<0b01_00_01_00>(low01, low23),
                _mm256_shuffle_ps::<0b11_10_11_10>(low01, low23),
                _mm256_shuffle_ps::<0b01_00_01_00>(high01, high23),
                _mm256_shuffle_ps::<0b11_10_11_10>(high01, high23),
            ];
            for (row, pair) in pairs.into_iter().enumerate() {
                _mm_storeu_ps(rows[row].as_mut_ptr(), _mm256_castps256_ps128(pair));
                _mm_storeu_ps(rows[row + 4].as_mut_ptr(), _mm256_extractf128_ps::<1>(pair));
            }
        }
        rows
    }
}

impl Ints for Avx2Ints {
    type Floats = Avx2Floats;

    #[inline(always)]
    fn splat(x: i32) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_set1_epi32(x) })
    }

    #[inline(always)]
    fn load(from: &[i32; LANES]) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says; the reference holds eight numbers, of any alignment.
        Self(unsafe { _mm256_loadu_si256(from.as_ptr().cast()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [i32; LANES]) {
        // SAFETY: the processor has AVX2, as `Avx2` says; the reference holds eight numbers, of any alignment.
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), self.0) }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_min_epi32(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_max_epi32(self.0, other.0) })
    }

    #[inline(always)]
    fn shift_right(self, bits: u32) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_sra_epi32(self.0, _mm_cvtsi32_si128(bits as i32)) })
    }

    #[inline(always)]
    fn shift_left(self, bits: u32) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_sll_epi32(self.0, _mm_cvtsi32_si128(bits as i32)) })
    }

    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_cmpgt_epi32(self.0, other.0) })
    }

    #[inline(always)]
    fn equal(self, other: Self) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Self(unsafe { _mm256_cmpeq_epi32(self.0, other.0) })
    }

    #[inline(always)]
    fn to_floats(self) -> Avx2Floats {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Avx2Floats(unsafe { _mm256_cvtepi32_ps(self.0) })
    }

    #[inline(always)]
    fn select_negative(self, chosen: Avx2Floats, other: Avx2Floats) -> Avx2Floats {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        Avx2Floats(unsafe { _mm256_blendv_ps(other.0, chosen.0, _mm256_castsi256_ps(self.0)) })
    }

    #[inline(always)]
    fn select_negative_ints(self, chosen: Self, other: Self) -> Self {
        // SAFETY: the processor has AVX2, as `Avx2` says. The blend looks at the sign of each byte, which the shift copies from the lane's.
        Self(unsafe { _mm256_blendv_epi8(other.0, chosen.0, _mm256_srai_epi32::<31>(self.0)) })
    }

    #[inline(always)]
    fn negative_bits(self) -> u32 {
        // SAFETY: the processor has AVX2, as `Avx2` says.
        unsafe { _mm256_movemask_ps(_mm256_castsi256_ps(self.0)) as u32 }
    }

    #[inline(always)]
    fn columns(pairs: [i64; LANES]) -> [Self; 2] {
        let [p0, p1, p2, p3, p4, p5, p6, p7] = pairs;
        // SAFETY: the processor has AVX2, as `Avx2` says.
        unsafe {
            let low = _mm256_castsi256_ps(_mm256_setr_epi64x(p0, p1, p2, p3));
            let high = _mm256_castsi256_ps(_mm256_setr_epi64x(p4, p5, p6, p7));
            // The shuffle works within halves: rows 0 1 4 5 2 3 6 7, which the permutation of pairs sets right.
            let first = _mm256_castps_si256(_mm256_shuffle_ps::<0b10_00_10_00>(low, high));
            let second = _mm256_castps_si256(_mm256_shuffle_ps::<0b11_01_11_01>(low, high));
            [Self(_mm256_permute4x64_epi64::<0b11_01_10_00>(first)), Self(_mm256_permute4x64_epi64::<0b11_01_10_00>(second))]
        }
    }

    #[inline(always)]
    fn pairs([low, high]: [Self; 2]) -> [i64; LANES] {
        let mut pairs = [0; LANES];
        // SAFETY: the processor has AVX2, as `Avx2` says; both halves of the array hold four numbers of 64 bits, of any alignment.
        unsafe {
            // Pairs 0 1 4 5 and 2 3 6 7.
            let first = _mm256_unpacklo_epi32(low.0, high.0);
            let second = _mm256_unpackhi_epi32(low.0, high.0);
            let (front, back) = pairs.split_at_mut(4);
            _mm256_storeu_si256(front.as_mut_ptr().cast(), _mm256_permute2x128_si256::<0x20>(first, second));
            _mm256_storeu_si256(back.as_mut_ptr().cast(), _mm256_permute2x128_si256::<0x31>(first, second));
        }
        pairs
    }
}
