//! The options of `shadow plan`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use super::{BiasArgs, PictureArgs};

/// `shadow plan`.
#[derive(Debug, ClapArgs)]
pub(crate) struct PlanArgs {
    /// What picture of which scene.
    #[command(flatten)]
    pub(crate) picture: PictureArgs,

    /// Its bias.
    #[command(flatten)]
    pub(crate) bias: BiasArgs,

    /// A file for a drawing of the camera's view, the casters and all maps from above and from the side, whose name ends in .svg
    ///
    /// Each map has a colour: what it covers, the slice of the view that a cascade is for, and a line for every sixteenth part of its texels, which lie close where samples do. A file that is already there is replaced once the new
    /// one is complete.
    #[arg(long, value_name = "FILE")]
    pub(crate) draw: Option<PathBuf>,

    /// Report as JSON on standard output
    ///
    /// An object with `scene`, `notes`, `origin`, `exposure`, `map_size`, `camera` (whose `spec` is what
    /// --camera takes, null where there is no such description) and `lights`. Each light has its `fit`, `split`,
    /// `store`, `bias` and `filter`, `cameras` (fit, split and what else is said of them, as a settings file has it), `plane` (of plane-optimal fits, given or found: the numbers of `nx x + ny y + nz z + d = 0` in the coordinates of the file; null for others), `cascade_ends` (metres from the camera along its axis, of cascades), and `views` with `outcome` (`fitted`, `nothing-visible`, or why it is `uniform`), `is_warped`,
    /// `size` in texels, `clip_from_world` (a list of rows), `depth_range` (in metres, from the light, or of parallel light from the near plane; `is_pancaked` tells whether casters beyond are drawn onto these planes), `texel_metres` (in metres, at 1 m from the light for a perspective view, and in the middle of what is seen for a warped one), and the bounds on `rounding` in texels and in depth.
    #[arg(long)]
    pub(crate) json: bool,
}
