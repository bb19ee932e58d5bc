//! What an adapter really does where WebGPU leaves it a choice, measured by drawing and reading back.
//!
//! Nothing here is looked up: each [`Measured`] value comes from pictures that the adapter drew, and where the pictures do not
//! decide, it says why instead of guessing. What is drawn, and why that decides, is described where each value is measured.

mod rig;
mod triangles;
mod raster;
mod plane;
mod bias;
mod compare;
mod formats;

pub use self::{
    bias::{BiasRules, SlopeRule, UnitAt, UnitRule},
    compare::{ComparisonFilter, ComparisonRules, WeightSteps},
    formats::{DepthLimits, DepthRules, DepthStorage, RangeOverflow},
    plane::{DepthError, DepthPlane, PlaneRules},
    raster::{EdgeRule, GridRounding, RasterFindings, SampleRange, Ties},
};

use self::rig::Rig;
use crate::{
    adapter::{AdapterSummary, choose_adapter, new_instance},
    error::GpuError,
};

/// Why something could not be measured, as a sentence without its full stop.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unmeasured(pub String);

impl From<GpuError> for Unmeasured {
    fn from(error: GpuError) -> Self {
        Self(error.to_string())
    }
}

/// A measured value, or why there is none.
pub type Measured<T> = Result<T, Unmeasured>;

/// The refusal to guess.
fn unmeasured<T>(reason: impl Into<String>) -> Measured<T> {
    Err(Unmeasured(reason.into()))
}

/// The depth formats that are probed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthFormat {
    /// `depth16unorm`: 16 bits, as WebGPU promises.
    Depth16Unorm,
    /// `depth24plus`: at least 24 bits, of which kind is the adapter's choice.
    Depth24Plus,
    /// `depth32float`: single precision, as WebGPU promises.
    Depth32Float,
}

impl DepthFormat {
    /// All of them, the coarsest first.
    pub const ALL: [Self; 3] = [Self::Depth16Unorm, Self::Depth24Plus, Self::Depth32Float];

    /// WebGPU's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth16Unorm => "depth16unorm",
            Self::Depth24Plus => "depth24plus",
            Self::Depth32Float => "depth32float",
        }
    }

    const fn of_wgpu(self) -> wgpu::TextureFormat {
        match self {
            Self::Depth16Unorm => wgpu::TextureFormat::Depth16Unorm,
            Self::Depth24Plus => wgpu::TextureFormat::Depth24Plus,
            Self::Depth32Float => wgpu::TextureFormat::Depth32Float,
        }
    }
}

/// What an adapter does with one depth format.
#[derive(Clone, Debug, PartialEq)]
pub struct FormatRules {
    /// Which format.
    pub format: DepthFormat,
    /// What it keeps, and what becomes of depths that it cannot keep.
    pub depth: DepthRules,
    /// The units of the pipeline's bias.
    pub bias: BiasRules,
    /// The weights of its comparison sampler.
    pub comparison: ComparisonRules,
}

/// What an adapter does where WebGPU leaves it a choice.
#[derive(Clone, Debug, PartialEq)]
pub struct AdapterRules {
    /// Which adapter.
    pub adapter: AdapterSummary,
    /// Where triangles have samples.
    pub raster: RasterFindings,
    /// Which depth those samples get, and how exactly.
    pub plane: PlaneRules,
    /// What becomes of depths beyond the near and far planes.
    pub limits: DepthLimits,
    /// What depends on the format of depths, in the order of [`DepthFormat::ALL`].
    pub formats: Vec<FormatRules>,
}

/// Measures what decides which samples of a map are covered and which depth they get, of the adapter that [`probe`] would take: a part of what that measures, in a fraction of its time.
///
/// # Errors
///
/// As [`probe`].
pub async fn probe_raster(adapter: Option<&str>) -> Result<(RasterFindings, PlaneRules), GpuError> {
    let adapter = choose_adapter(&new_instance(), adapter).await?;
    let rig = Rig::open(&adapter).await?;
    let raster = raster::measure(&rig).await;
    let plane = plane::measure(&rig, &raster).await;
    Ok((raster, plane))
}

/// Measures the adapter whose name contains `adapter`; without a name the one that `WGPU_ADAPTER_NAME` names, else the one that wgpu
/// prefers.
///
/// # Errors
///
/// [`GpuError::NoAdapter`], [`GpuError::Device`] and [`GpuError::Unsupported`]: the adapter cannot be opened, or cannot run the shader that everything
/// is read back with. What fails later is told in the [`Measured`] values.
pub async fn probe(adapter: Option<&str>) -> Result<AdapterRules, GpuError> {
    let adapter = choose_adapter(&new_instance(), adapter).await?;
    let rig = Rig::open(&adapter).await?;
    let raster = raster::measure(&rig).await;
    let plane = plane::measure(&rig, &raster).await;
    let limits = formats::measure_limits(&rig).await;
    let mut formats = Vec::new();
    for format in DepthFormat::ALL {
        let depth = formats::measure(&rig, format).await;
        let bias = bias::measure(&rig, format, &depth).await;
        let comparison = compare::measure(&rig, format).await;
        formats.push(FormatRules { format, depth, bias, comparison });
    }
    Ok(AdapterRules { adapter: AdapterSummary::of(&adapter), raster, plane, limits, formats })
}
