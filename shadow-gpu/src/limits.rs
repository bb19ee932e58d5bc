//! Checks against the adapter's limits before anything is made, so that the answer is a sentence and not a driver's error.

use shadow_scene::{FramePlan, Request, Scene, Surfaces};

use crate::{
    buffers::{TABLE_WIDTH, table_rows},
    error::GpuError,
};

/// Texels of a vertex in its table.
const VERTEX_TEXELS: u64 = 3;

pub(crate) struct LimitCheck<'a> {
    pub(crate) adapter: &'a str,
    pub(crate) limits: &'a wgpu::Limits,
}

impl LimitCheck<'_> {
    fn at_most(
        &self,
        what: impl Into<String>,
        needed: u64,
        allowed: u64,
        limit: &'static str,
        way_out: &'static str,
    ) -> Result<(), GpuError> {
        if needed <= allowed {
            return Ok(());
        }
        Err(GpuError::Limit { what: what.into(), needed, allowed, limit, adapter: self.adapter.into(), way_out })
    }

    fn table(&self, what: &str, texels: u64, way_out: &'static str) -> Result<(), GpuError> {
        let rows = u64::from(self.limits.max_texture_dimension_2d);
        let what = format!("{what} in rows of {TABLE_WIDTH} texels");
        self.at_most(what, table_rows(texels), rows, "maxTextureDimension2D", way_out)
    }

    /// A scene's tables and buffers.
    pub(crate) fn scene(&self, scene: &Scene, surfaces: &Surfaces) -> Result<(), GpuError> {
        const WAY_OUT: &str = "use the CPU backend or a simpler scene";
        self.table("the scene's vertices", scene.vertices().positions.len() as u64 * VERTEX_TEXELS, WAY_OUT)?;
        self.table("the scene's triangles", scene.triangles().len() as u64, WAY_OUT)?;
        self.table("the scene's textures", surfaces.words.len() as u64, WAY_OUT)
    }

    /// A frame's textures.
    pub(crate) fn frame(&self, plan: &FramePlan) -> Result<(), GpuError> {
        let size = u64::from(self.limits.max_texture_dimension_2d);
        let camera = &plan.camera;
        for (what, pixels) in [("the picture's width in pixels", camera.width), ("the picture's height in pixels", camera.height)]
        {
            self.at_most(what, u64::from(pixels), size, "maxTextureDimension2D", "render a smaller picture")?;
        }
        let map = u64::from(plan.map_size);
        self.at_most("the width of a shadow map in texels", map, size, "maxTextureDimension2D", "choose a smaller --map-size")?;
        let layers = plan.views.len() as u64;
        let allowed = u64::from(self.limits.max_texture_array_layers);
        self.at_most(
            "the number of shadow maps",
            layers,
            allowed,
            "maxTextureArrayLayers",
            "use fewer lights (a point light takes six maps)",
        )
    }

    /// What a request reads back, in the buffers that it is read through: known before anything is drawn.
    pub(crate) fn request(&self, plan: &FramePlan, request: Request) -> Result<(), GpuError> {
        let (picture, map) = ([plan.camera.width, plan.camera.height], [plan.map_size; 2]);
        if request.camera || request.visibility {
            self.numbers(picture)?;
        }
        if request.color {
            self.colors(picture)?;
        }
        if request.shadow_maps { self.numbers(map) } else { Ok(()) }
    }

    /// A layer of numbers that is read back.
    pub(crate) fn numbers(&self, size: [u32; 2]) -> Result<(), GpuError> {
        let (what, bytes) = layer_bytes(size, size_of::<f32>());
        self.at_most(what.as_str(), bytes, self.limits.max_storage_buffer_binding_size, "maxStorageBufferBindingSize", SMALLER)?;
        self.at_most(what, bytes, self.limits.max_buffer_size, "maxBufferSize", SMALLER)
    }

    /// Colours that are read back.
    pub(crate) fn colors(&self, size: [u32; 2]) -> Result<(), GpuError> {
        let (what, bytes) = layer_bytes(size, size_of::<[f32; 4]>());
        self.at_most(what, bytes, self.limits.max_buffer_size, "maxBufferSize", SMALLER)
    }
}

/// What to do about a layer that is too large to be read back.
const SMALLER: &str = "render a smaller picture or map, or use the CPU backend";

/// A layer in words, and its bytes.
fn layer_bytes([width, height]: [u32; 2], pixel: usize) -> (String, u64) {
    (format!("reading a layer of {width} x {height} back, in bytes"), u64::from(width) * u64::from(height) * pixel as u64)
}
