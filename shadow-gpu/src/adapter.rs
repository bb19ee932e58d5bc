//! Which adapters there are, and what is known of them.

use crate::error::GpuError;

/// What is known of a driver's choices where WebGPU leaves one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriverRules {
    /// Mesa 22.3's lavapipe: measured completely. A renderer that follows the rules agrees in every bit.
    Lavapipe22,
    /// SwiftShader with the code generator Subzero, as browsers have it: measured completely too.
    SwiftShader,
    /// Anything else: only what WebGPU promises is known.
    Unknown,
}

impl DriverRules {
    /// Whether all of its rules are known, so that a renderer that follows them agrees in every bit.
    #[must_use]
    pub fn are_complete(self) -> bool {
        matches!(self, Self::Lavapipe22 | Self::SwiftShader)
    }

    /// The bits of its sub-pixel grid, where they are known.
    #[must_use]
    pub fn subpixel_bits(self) -> Option<u32> {
        match self {
            Self::Lavapipe22 => Some(8),
            Self::SwiftShader => Some(4),
            Self::Unknown => None,
        }
    }
}

/// An adapter, for people and programs to choose by.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// The adapter's name.
    pub name: String,
    /// The graphics interface it is reached through, such as `vulkan`.
    pub backend: &'static str,
    /// What kind of device it is, such as `software` or `discrete GPU`.
    pub kind: &'static str,
    /// The driver's name.
    pub driver: String,
    /// The driver's version.
    pub driver_info: String,
    /// What is known of its rules.
    pub rules: DriverRules,
    /// The largest width and height of a texture.
    pub max_texture_size: u32,
    /// The most layers of a texture.
    pub max_texture_layers: u32,
}

impl AdapterSummary {
    /// The summary of an adapter.
    #[must_use]
    pub fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let limits = adapter.limits();
        Self {
            rules: driver_rules(&info),
            name: info.name,
            backend: info.backend.to_str(),
            kind: match info.device_type {
                wgpu::DeviceType::IntegratedGpu => "integrated GPU",
                wgpu::DeviceType::DiscreteGpu => "discrete GPU",
                wgpu::DeviceType::VirtualGpu => "virtual GPU",
                wgpu::DeviceType::Cpu => "software",
                wgpu::DeviceType::Other => "other",
            },
            driver: info.driver,
            driver_info: info.driver_info,
            max_texture_size: limits.max_texture_dimension_2d,
            max_texture_layers: limits.max_texture_array_layers,
        }
    }
}

/// Recognises the drivers whose rules were measured. Later versions of Mesa evaluate depth differently and count as unknown.
fn driver_rules(info: &wgpu::AdapterInfo) -> DriverRules {
    // The rules were measured on x86-64; its code generator makes other instructions elsewhere.
    let is_lavapipe = cfg!(target_arch = "x86_64") && info.backend == wgpu::Backend::Vulkan && info.driver == "llvmpipe";
    if is_lavapipe && info.driver_info.starts_with("Mesa 22.3.") {
        DriverRules::Lavapipe22
    } else if info.backend == wgpu::Backend::Vulkan && info.name.starts_with("SwiftShader Device (Subzero)") {
        DriverRules::SwiftShader
    } else {
        DriverRules::Unknown
    }
}

/// An instance on the backends that are compiled in, with the choices of the `WGPU_*` variables.
pub(crate) fn new_instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

/// All adapters there are.
pub async fn list_adapters() -> Vec<AdapterSummary> {
    let backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all());
    new_instance().enumerate_adapters(backends).await.iter().map(AdapterSummary::of).collect()
}

/// The adapter that [`GpuRenderer::new`](crate::GpuRenderer::new) takes for this name.
///
/// # Errors
///
/// [`GpuError::NoAdapter`].
pub async fn find_adapter(wanted: Option<&str>) -> Result<AdapterSummary, GpuError> {
    Ok(AdapterSummary::of(&choose_adapter(&new_instance(), wanted).await?))
}

/// The adapter whose name contains `wanted`, whatever the case of its letters. Without a name, the one that the variable
/// `WGPU_ADAPTER_NAME` names, else the one that wgpu prefers.
pub(crate) async fn choose_adapter(instance: &wgpu::Instance, wanted: Option<&str>) -> Result<wgpu::Adapter, GpuError> {
    let from_variable = std::env::var("WGPU_ADAPTER_NAME").ok();
    let wanted = wanted.map(String::from).or(from_variable);
    if wanted.is_none() {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::from_env().unwrap_or(wgpu::PowerPreference::HighPerformance),
            ..Default::default()
        };
        if let Ok(adapter) = instance.request_adapter(&options).await {
            return Ok(adapter);
        }
    }
    let backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all());
    let adapters = instance.enumerate_adapters(backends).await;
    let found = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    let matches = |adapter: &wgpu::Adapter| {
        let name = adapter.get_info().name.to_lowercase();
        wanted.as_ref().is_some_and(|wanted| name.contains(&wanted.to_lowercase()))
    };
    adapters.into_iter().find(matches).ok_or(GpuError::NoAdapter { wanted, found })
}
