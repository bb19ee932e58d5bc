//! Run-time dispatch: the same loops, compiled for the processor at hand.
//!
//! The rasteriser's loops are written in vectors of [`LANES`] numbers ([`lanes`]), the others as plain Rust over arrays, which the
//! compiler turns into vector instructions inside a function that enables AVX2. A plain release build carries both versions and chooses when it
//! runs. Neither version changes a result: the operations and their order are the same.

#[cfg(target_arch = "x86_64")]
mod avx2;
pub(crate) mod lanes;

use self::lanes::{Floats, Lanes, Portable};

/// How many samples or vertices the loops take at a time: the width of an AVX2 register in f32.
pub(crate) const LANES: usize = 8;

/// How a product and a sum are rounded: once, or one after the other.
pub(crate) trait MultiplyAdd: Copy + Send + Sync + 'static {
    /// `a * b + c`.
    fn multiply_add(a: f32, b: f32, c: f32) -> f32;

    /// `a * b + c` in each lane.
    fn multiply_add_lanes<F: Floats>(a: F, b: F, c: F) -> F;
}

/// Rounded once.
#[derive(Clone, Copy)]
pub(crate) struct Fused;

impl MultiplyAdd for Fused {
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }

    #[inline(always)]
    fn multiply_add_lanes<F: Floats>(a: F, b: F, c: F) -> F {
        a.fused(b, c)
    }
}

/// Rounded twice.
#[derive(Clone, Copy)]
pub(crate) struct Separate;

impl MultiplyAdd for Separate {
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a * b + c
    }

    #[inline(always)]
    fn multiply_add_lanes<F: Floats>(a: F, b: F, c: F) -> F {
        a * b + c
    }
}

/// Work that is compiled for each kind of processor. `run` must be `#[inline(always)]`, and so must all that it calls in
/// its inner loops, to be compiled with the instructions of the caller.
pub(crate) trait Kernel {
    type Output;
    fn run<L: Lanes, M: MultiplyAdd>(self) -> Self::Output;
}

/// Runs a kernel with the best instructions there are.
#[inline]
pub(crate) fn dispatch<K: Kernel>(fused: bool, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if has_avx2_and_fma() {
        #[allow(unsafe_code, reason = "run-time dispatch: 2.4 times as fast as the baseline on a map of 262,000 triangles")]
        // SAFETY: the processor has the features that the function enables.
        return unsafe { run_avx2(fused, kernel) };
    }
    run_portable(fused, kernel)
}

/// Runs a kernel without any instruction that some processors lack.
#[inline]
pub(crate) fn run_portable<K: Kernel>(fused: bool, kernel: K) -> K::Output {
    if fused { kernel.run::<Portable, Fused>() } else { kernel.run::<Portable, Separate>() }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<K: Kernel>(fused: bool, kernel: K) -> K::Output {
    if fused { kernel.run::<avx2::Avx2, Fused>() } else { kernel.run::<avx2::Avx2, Separate>() }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2_and_fma() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
}

/// Whether the processor has fused multiply-adds.
pub(crate) fn has_fused_multiply_add() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        std::arch::is_x86_feature_detected!("fma")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        cfg!(target_arch = "aarch64")
    }
}

/// Asks for memory that will be read soon. Only the time it takes can change.
#[inline(always)]
pub(crate) fn prefetch<T>(wanted: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        #[allow(unsafe_code, reason = "a map of a million triangles takes 26 ms instead of 30")]
        // SAFETY: the instruction reads nothing that the program could see, and is part of every x86-64 processor.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(core::ptr::from_ref(wanted).cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = wanted;
}

#[cfg(test)]
mod tests {
    use super::{
        Fused, Kernel, LANES, MultiplyAdd, Separate, dispatch,
        lanes::{Floats, Ints, Lanes},
        run_portable,
    };

    /// Every operation on every pair of numbers that differ in kind; the bits of all results.
    struct EveryOperation;

    impl Kernel for EveryOperation {
        type Output = Vec<u32>;

        #[inline(always)]
        fn run<L: Lanes, M: MultiplyAdd>(self) -> Vec<u32> {
            let numbers = [
                0.0,
                -0.0,
                1.0,
                -1.5,
                1e-40,
                -1e-40,
                3.4e38,
                -3.4e38,
                f32::INFINITY,
                f32::NEG_INFINITY,
                f32::NAN,
                0.5,
                16_777_217.0,
                -0.333_333_34,
                254.5,
                1e-6,
            ];
            let integers = [0, 1, -1, 2, 63, -64, 1 << 30, -(1 << 30), i32::MAX, i32::MIN, 12_345, -12_345, 7, 255, 256, -257];
            let mut bits = Vec::new();
            for shift in 0..numbers.len() {
                for half in [0, LANES] {
                    let pick = |offset: usize| core::array::from_fn::<_, LANES, _>(|lane| numbers[(half + lane + offset) % 16]);
                    let (a, b, c) = (L::F::load(&pick(0)), L::F::load(&pick(shift)), L::F::load(&pick(3 * shift + 1)));
                    let pick = |offset: usize| core::array::from_fn::<_, LANES, _>(|lane| integers[(half + lane + offset) % 16]);
                    let (i, j) = (L::I::load(&pick(0)), L::I::load(&pick(shift)));
                    let steps = shift as u32 % 8;
                    let floats = [
                        a + b,
                        a - b,
                        a * b,
                        a / b,
                        a.min(b),
                        a.max(b),
                        M::multiply_add_lanes(a, b, c),
                        i.to_floats(),
                        i.select_negative(a, b),
                    ];
                    let ints = [
                        i + j,
                        i - j,
                        i * j,
                        i & j,
                        i | j,
                        i.min(j),
                        i.max(j),
                        i.shift_right(steps),
                        i.shift_left(steps),
                        i.greater(j),
                        i.equal(j),
                        a.less(b),
                        a.at_most(b),
                        // What does not fit 32 bits is each processor's choice.
                        a.min(L::F::splat(1e9)).max(L::F::splat(-1e9)).round(),
                        i.select_negative_ints(j, i),
                    ];
                    for lanes in floats {
                        let mut values = [0.0; LANES];
                        lanes.store(&mut values);
                        // What a result that is no number looks like is each processor's choice.
                        bits.extend(values.map(|value| if value.is_nan() { f32::NAN.to_bits() } else { value.to_bits() }));
                    }
                    for lanes in ints {
                        let mut values = [0; LANES];
                        lanes.store(&mut values);
                        bits.extend(values.map(|value| value as u32));
                    }
                    bits.push(i.negative_bits());
                    let rows: [[f32; 4]; LANES] =
                        core::array::from_fn(|row| core::array::from_fn(|i| (4 * row + i + shift) as f32));
                    let columns = L::F::columns(rows.each_ref());
                    assert_eq!(L::F::rows(columns), rows);
                    for column in columns {
                        let mut values = [0.0; LANES];
                        column.store(&mut values);
                        bits.extend(values.map(f32::to_bits));
                    }
                    let pairs = core::array::from_fn(|row| (row as i64 + 100) << 32 | i64::from(integers[row] as u32));
                    let columns = L::I::columns(pairs);
                    assert_eq!(L::I::pairs(columns), pairs);
                    for column in columns {
                        let mut values = [0; LANES];
                        column.store(&mut values);
                        bits.extend(values.map(|value| value as u32));
                    }
                }
            }
            bits
        }
    }

    #[test]
    fn both_kinds_of_vectors_give_the_same_bits() {
        for fused in [false, true] {
            let portable = run_portable(fused, EveryOperation);
            let best = dispatch(fused, EveryOperation);
            assert!(portable.len() > 7_000);
            for (i, (portable, best)) in portable.iter().zip(&best).enumerate() {
                assert_eq!(portable, best, "number {i}, fused: {fused}");
            }
        }
    }

    #[test]
    fn a_fused_product_is_rounded_once() {
        let (a, c) = (1.0 + f32::EPSILON, -(1.0 + 2.0 * f32::EPSILON));
        assert_ne!(Fused::multiply_add(a, a, c).to_bits(), Separate::multiply_add(a, a, c).to_bits());
    }
}
