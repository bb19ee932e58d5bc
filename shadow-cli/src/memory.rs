//! How much memory a picture takes, and the refusal of more than there should be: a failed allocation would end the program.

use shadow_scene::FramePlan;

use crate::error::CliError;

/// One GiB in bytes.
const GIB: u64 = 1 << 30;
/// One MiB in bytes.
const MIB: u64 = 1 << 20;

/// The most memory that pictures and shadow maps may take: 16 GiB. The largest map (1 GiB) can then still be drawn for a point light
/// (six), and a larger request is more likely a slip of the hand than a plan.
const LIMIT: u64 = 16 * GIB;

/// Bytes of a pixel in every frame: triangle and depth (4 each), colour (16), and the written picture (4).
const BYTES_PER_PIXEL: u64 = 4 + 4 + 16 + 4;
/// Bytes of a pixel for each light: its visibility, as it is computed and as a layer.
const BYTES_PER_PIXEL_AND_LIGHT: u64 = 4 + 4;
/// Bytes of a texel of a shadow map.
const BYTES_PER_TEXEL: u64 = 4;

/// About how many bytes one frame of a plan takes; saturating.
pub(crate) fn frame_bytes(plan: &FramePlan) -> u64 {
    let pixels = u64::from(plan.camera.width).saturating_mul(u64::from(plan.camera.height));
    let lights = (plan.lights.len() as u64).saturating_mul(BYTES_PER_PIXEL_AND_LIGHT);
    let texels = u64::from(plan.map_size).pow(2).saturating_mul(plan.views.len() as u64);
    pixels.saturating_mul(lights.saturating_add(BYTES_PER_PIXEL)).saturating_add(texels.saturating_mul(BYTES_PER_TEXEL))
}

/// Refuses to hold `copies` frames of a plan where they take more than the limit, or more than the system would give.
pub(crate) fn check(plan: &FramePlan, copies: u64) -> Result<(), CliError> {
    check_bytes(&describe(plan, copies), frame_bytes(plan).saturating_mul(copies))
}

fn describe(plan: &FramePlan, copies: u64) -> String {
    let times = if copies > 1 { format!(", {copies} times over,") } else { String::new() };
    let maps = if plan.views.len() == 1 { "shadow map" } else { "shadow maps" };
    format!(
        "a picture of {} x {} pixels with {} {maps} of {size} x {size} texels{times}",
        plan.camera.width,
        plan.camera.height,
        plan.views.len(),
        size = plan.map_size
    )
}

fn check_bytes(what: &str, bytes: u64) -> Result<(), CliError> {
    if bytes > LIMIT {
        return Err(CliError::TooMuchMemory { what: what.into(), needed: bytes.div_ceil(GIB), limit: LIMIT / GIB });
    }
    // Reserving asks the system without touching the memory; where it refuses, a later allocation would have ended the program.
    let reserved = usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if reserved { Ok(()) } else { Err(CliError::OutOfMemory { what: what.into(), megabytes: bytes.div_ceil(MIB) }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_is_a_sentence() {
        check_bytes("a small picture", 1 << 20).unwrap();
        let error = check_bytes("a picture", LIMIT + 1).unwrap_err().to_string();
        assert!(error.contains("17 GiB") && error.contains("16 GiB") && error.contains("--map-size"), "{error}");
        assert!(check_bytes("a picture", u64::MAX).is_err());
    }
}
