//! Why the GPU renderer cannot do what was asked for.

/// Why the GPU renderer cannot do what was asked for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter, or none of that name.
    #[error("{}", no_adapter(wanted.as_deref(), found))]
    NoAdapter {
        /// The name that was asked for.
        wanted: Option<String>,
        /// The names of the adapters that there are.
        found: Vec<String>,
    },
    /// The adapter would not open.
    #[error("the adapter `{adapter}` does not open: {source}")]
    Device {
        /// The adapter's name.
        adapter: String,
        /// What it said.
        source: wgpu::RequestDeviceError,
    },
    /// Something is larger than the adapter allows.
    #[error("{what} needs {needed}, but the adapter `{adapter}` allows {allowed} ({limit}); {way_out}")]
    Limit {
        /// What is too large.
        what: String,
        /// How much it needs.
        needed: u64,
        /// How much there may be.
        allowed: u64,
        /// The name of the limit in WebGPU.
        limit: &'static str,
        /// The adapter's name.
        adapter: String,
        /// What to do instead.
        way_out: &'static str,
    },
    /// The adapter lacks something that every WebGPU adapter has.
    #[error("the adapter `{adapter}` lacks {what}; choose another adapter (`shadow devices` lists them)")]
    Unsupported {
        /// The adapter's name.
        adapter: String,
        /// What it lacks.
        what: &'static str,
    },
    /// The driver reported an error while it worked.
    #[error("the adapter `{adapter}` reported an error: {message}")]
    Driver {
        /// The adapter's name.
        adapter: String,
        /// What it said.
        message: String,
    },
}

fn no_adapter(wanted: Option<&str>, found: &[String]) -> String {
    match (wanted, found.is_empty()) {
        (_, true) => {
            "there is no graphics adapter; install a driver (on Debian and Ubuntu `apt-get install mesa-vulkan-drivers` gives a \
                      software one) or use the CPU backend"
                .into()
        }
        (Some(wanted), false) => format!("there is no adapter whose name contains `{wanted}`; there are: {}", found.join(", ")),
        (None, false) => format!("no adapter can be used; there are: {}", found.join(", ")),
    }
}
