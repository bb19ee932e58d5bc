//! Whether two frames of the same plan agree.
//!
//! A frame is compared layer by layer under a [`Contract`]: [`Contract::Exact`] between renderers whose rules are known to be the same,
//! where any differing bit is a failure, or [`Contract::Tolerance`] where WebGPU leaves a driver choices. The tolerances are the
//! constants of [`tolerance`], each with its reason.
//!
//! Frames that cannot be compared (a layer missing, another size, another kind of value, nothing at all) are an error and never agreement.

mod layers;
pub mod tolerance;

pub use layers::compare;

use crate::frame::LayerName;

/// What two frames are held to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contract {
    /// Every layer is identical to the bit.
    Exact,
    /// Layers agree within [`tolerance`] at the pixels where agreement is promised, and those where it is not are few.
    Tolerance,
}

impl Contract {
    /// The name that programs read: `exact` or `tolerance`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Tolerance => "tolerance",
        }
    }
}

/// Pixels where the tolerance contract promises nothing, by the reason. A pixel counts once, for the first reason that applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// The camera passes show different triangles there.
    pub camera_coverage: usize,
    /// A weighted tap falls on a texel whose map coverage or depth differs.
    pub map_coverage: usize,
    /// A weighted tap's comparison is a tie within the depth tolerance, or the lookup lies on a texel's border.
    pub tie: usize,
}

impl LeftOut {
    /// All of them.
    #[must_use]
    pub fn total(&self) -> usize {
        self.camera_coverage + self.map_coverage + self.tie
    }
}

/// How one layer compares.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerComparison {
    /// The layer.
    pub name: LayerName,
    /// How many pixels it has.
    pub pixels: usize,
    /// How many pixels differ in any bit.
    pub differing: usize,
    /// How many pixels are left out, by reason; none under the exact contract.
    pub left_out: LeftOut,
    /// The largest difference of any channel among the pixels that are not left out; 1 for different triangles, infinite where one of the
    /// values is NaN and the other is not.
    pub max_difference: f64,
    /// How many pixels break the contract.
    pub violations: usize,
    /// Whether the layer keeps the contract.
    pub within_contract: bool,
}

/// How two frames compare.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The contract that was applied.
    pub contract: Contract,
    /// One entry a layer.
    pub layers: Vec<LayerComparison>,
}

impl Comparison {
    /// Whether there are layers and every one keeps the contract.
    #[must_use]
    pub fn agree(&self) -> bool {
        !self.layers.is_empty() && self.layers.iter().all(|layer| layer.within_contract)
    }
}

/// Why two frames cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// Both frames come from the same source, whose agreement with itself proves nothing.
    #[error("both frames come from `{0}`, and that it agrees with itself proves nothing")]
    SameSource(String),
    /// There are no layers to compare.
    #[error("the frames have no layers, so there is nothing that could agree")]
    Empty,
    /// A layer is missing from one of the frames.
    #[error("the layer {name} is only in the {which} frame")]
    Missing {
        /// The layer.
        name: LayerName,
        /// "first" or "second".
        which: &'static str,
    },
    /// A layer has another size.
    #[error("the layer {name} is {} x {} in the first frame and {} x {} in the second", first.0, first.1, second.0, second.1)]
    Size {
        /// The layer.
        name: LayerName,
        /// Width and height in the first frame.
        first: (u32, u32),
        /// Width and height in the second frame.
        second: (u32, u32),
    },
    /// A layer does not have as many values as its size says, or another kind of values.
    #[error("the layer {name} does not hold one value of the right kind for each pixel in both frames")]
    Values {
        /// The layer.
        name: LayerName,
    },
    /// The tolerance contract needs a layer that was not asked for.
    #[error("judging {name} within tolerances needs the layer {needed} of both frames")]
    Needs {
        /// The layer that is judged.
        name: LayerName,
        /// The layer that is needed.
        needed: LayerName,
    },
}
