//! The options of `shadow probe`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

/// Examples for `shadow probe`.
pub(super) const PROBE_EXAMPLES: &str = "\
Examples:
  shadow probe
  shadow probe --adapter llvmpipe --output llvmpipe.json
  shadow probe --json | jq .raster.subpixel_bits
  shadow probe --json | jq '.formats[].bias_units'";

/// `shadow probe`.
#[derive(Debug, ClapArgs)]
pub(crate) struct ProbeArgs {
    /// Take the graphics adapter whose name contains NAME (`shadow devices` lists them)
    #[arg(long, value_name = "NAME", help_heading = "Backend")]
    pub(crate) adapter: Option<String>,

    /// A file for the report of --json too, whose name ends in .json
    ///
    /// A file that is already there is replaced once the new one is complete.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Report as JSON on standard output
    ///
    /// An object with `adapter` (`name`, `backend`, `kind`, `driver`, `driver_info`), `raster` (`subpixel_bits`, `rounding`, `sample`, `edges`, `top_left_rule`,
    /// `covers_shared_edges_once`), `depth_plane` (`goes_through`, `parallel`, `perspective`), `limits` (`near_clips`, `far_clips`, `unclipped_depth`), `formats`
    /// (by name, each with `storage`, `written_beyond_0_to_1`, `bias_units`, `bias_unit_depends_on`, `bias_slope`, `bias_clamp`, `bias_beyond_1`, `comparison_taps`,
    /// `compares_first`, `weight_steps` and `worst_weight_error`), `reasons`, `warnings` and `output` (null without one). What could not be
    /// measured is null, and `reasons` has the reason under the path of its names joined by dots.
    #[arg(long)]
    pub(crate) json: bool,
}
