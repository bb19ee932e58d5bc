//! What numbers and causes look like in pictures.

use shadow_cpu::measure::{Cause, NO_STRETCH};

/// The colour of a cause, for pictures and for the table's heading.
pub(crate) fn color_of(cause: Cause) -> [u8; 3] {
    match cause {
        Cause::Coverage => [150, 150, 150],
        Cause::Terminator => [170, 110, 40],
        Cause::Seam => [0, 190, 190],
        Cause::Filter => [90, 130, 255],
        Cause::Aliasing => [60, 180, 75],
        Cause::Acne => [230, 25, 75],
        Cause::PeterPanning => [245, 130, 48],
        Cause::Leak => [240, 50, 230],
    }
}

/// An error from 0 to 1 as a colour: black, red, yellow, white.
pub(crate) fn heat(error: f32) -> [u8; 3] {
    if error == 0.0 {
        return [0; 3];
    }
    // A floor of a fifth keeps small errors visible beside none.
    let heat = 0.2 + 0.8 * error.clamp(0.0, 1.0);
    let channel = |from: f32| ((heat - from) * 3.0 * 255.0).clamp(0.0, 255.0) as u8;
    [channel(0.0), channel(1.0 / 3.0), channel(2.0 / 3.0)]
}

/// The colour of a pixel without a stretch.
const WITHOUT_STRETCH: [u8; 3] = [24; 3];
/// The m at which the colours of stretches end, either way: this, and 1 over it.
const WIDEST_STRETCH: f32 = 8.0;
/// The colours of stretches, at equal steps of the logarithm of m: from 1 / [`WIDEST_STRETCH`] over 1, which is white, to that.
const STRETCHES: [[f32; 3]; 5] =
    [[25.0, 50.0, 190.0], [110.0, 170.0, 230.0], [245.0, 245.0, 245.0], [250.0, 205.0, 40.0], [205.0, 20.0, 30.0]];

/// How many pixels a texel smears over, m, as a colour: blue where a pixel has many texels, white where it has one, yellow and red where a texel has many pixels.
pub(crate) fn stretch_color(stretch: f32) -> [u8; 3] {
    if stretch == NO_STRETCH {
        return WITHOUT_STRETCH;
    }
    let last = (STRETCHES.len() - 1) as f32;
    // From 0 to 1; infinite ones are the last, and none is negative.
    let share = (0.5 + 0.5 * stretch.max(f32::MIN_POSITIVE).ln() / WIDEST_STRETCH.ln()).clamp(0.0, 1.0);
    let first = (share * last).floor().min(last - 1.0);
    let (a, b) = (STRETCHES[first as usize], STRETCHES[first as usize + 1]);
    let fraction = share * last - first;
    [0, 1, 2].map(|channel| (a[channel] + (b[channel] - a[channel]) * fraction).round() as u8)
}

/// What the colours of stretches mean.
pub(crate) const STRETCH_LEGEND: &str = "blue is 8 texels and more to a pixel, white one to one, yellow 3 pixels to a texel, red 8 and more; dark where a surface faces away from the light";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_run_from_blue_over_white_to_red() {
        assert_eq!(stretch_color(NO_STRETCH), WITHOUT_STRETCH);
        assert_eq!(stretch_color(1.0), [245; 3]);
        for (beyond, end) in [(0.0, 0.125), (0.01, 0.125), (8.1, 8.0), (f32::INFINITY, 8.0)] {
            assert_eq!(stretch_color(beyond), stretch_color(end), "{beyond}");
        }
        let [[r0, _, b0], [r1, _, b1]] = [0.125, 8.0].map(stretch_color);
        assert!(b0 > 2 * r0 && r1 > 2 * b1);
        let yellow = stretch_color(WIDEST_STRETCH.sqrt());
        assert!(yellow[0] > 200 && yellow[1] > 200 && yellow[2] < 100, "{yellow:?}");
    }
}
