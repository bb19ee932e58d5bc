//! By how much a disc is turned at a pixel.

use glam::Vec2;

/// The cosines and sines of sixteen angles that divide a full turn.
pub const TURNS: [[f32; 2]; 16] = [
    [1.0, 0.0],
    [0.923_879_5, 0.382_683_43],
    [core::f32::consts::FRAC_1_SQRT_2, core::f32::consts::FRAC_1_SQRT_2],
    [0.382_683_43, 0.923_879_5],
    [0.0, 1.0],
    [-0.382_683_43, 0.923_879_5],
    [-core::f32::consts::FRAC_1_SQRT_2, core::f32::consts::FRAC_1_SQRT_2],
    [-0.923_879_5, 0.382_683_43],
    [-1.0, 0.0],
    [-0.923_879_5, -0.382_683_43],
    [-core::f32::consts::FRAC_1_SQRT_2, -core::f32::consts::FRAC_1_SQRT_2],
    [-0.382_683_43, -0.923_879_5],
    [0.0, -1.0],
    [0.382_683_43, -0.923_879_5],
    [core::f32::consts::FRAC_1_SQRT_2, -core::f32::consts::FRAC_1_SQRT_2],
    [0.923_879_5, -0.382_683_43],
];

/// The order of a dispersed dither of 4 by 4 (Bayer 1973): neighbours get turns that are far from each other.
pub const DITHER: [u32; 16] = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5];

/// The cosine and sine of the angle by which a disc is turned at a pixel; the same for all pixels that lie multiples of 4 apart.
#[inline(always)]
#[must_use]
pub fn turn_of_pixel(pixel: [u32; 2]) -> Vec2 {
    let place = (pixel[1] % 4) * 4 + pixel[0] % 4;
    let [cosine, sine] = TURNS[DITHER[place as usize] as usize];
    Vec2::new(cosine, sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_angle_comes_once_in_each_square_of_four() {
        let mut seen = [false; 16];
        for y in 4..8 {
            for x in 40..44 {
                let turn = turn_of_pixel([x, y]);
                assert!((turn.length() - 1.0).abs() < 1e-6);
                let sixteenth = (turn.y.atan2(turn.x) / core::f32::consts::TAU * 16.0).round().rem_euclid(16.0);
                seen[sixteenth as usize] = true;
            }
        }
        assert_eq!(seen, [true; 16]);
    }
}
