//! What numbers and causes look like in pictures.

use shadow_cpu::measure::Cause;

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
