//! Checks against the adapter's limits before anything is made, so that the answer is a sentence and not a driver's error. How much memory an
//! adapter has it does not say: what is too large for that is found when it is made.

use shadow_scene::{FramePlan, Request, Scene, Surfaces};

use crate::{
    buffers::{TABLE_WIDTH, table_rows},
    error::GpuError,
};

/// Texels of a vertex in its table.
const VERTEX_TEXELS: u64 = 4;

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
        let layers = u64::from(plan.layer_count());
        let allowed = u64::from(self.limits.max_texture_array_layers);
        self.at_most(
            "the number of shadow maps",
            layers,
            allowed,
            "maxTextureArrayLayers",
            "use fewer lights or cascades (a point light takes six maps)",
        )
    }

    /// What a request reads back, in the buffers that it is read through: known before anything is drawn.
    pub(crate) fn request(&self, plan: &FramePlan, request: Request) -> Result<(), GpuError> {
        let picture = [plan.camera.width, plan.camera.height];
        if request.camera || request.visibility {
            self.numbers(picture, SMALLER_PICTURE)?;
        }
        if request.color {
            self.colors(picture)?;
        }
        if request.shadow_maps { self.numbers([plan.map_size; 2], SMALLER_MAP) } else { Ok(()) }
    }

    /// A layer of numbers that is read back.
    pub(crate) fn numbers(&self, size: [u32; 2], way_out: &'static str) -> Result<(), GpuError> {
        let what = reading_back(size);
        let bytes = u64::from(size[0]) * u64::from(size[1]) * size_of::<f32>() as u64;
        let binding = self.limits.max_storage_buffer_binding_size;
        self.at_most(what.as_str(), bytes, binding, "maxStorageBufferBindingSize", way_out)?;
        self.at_most(what, bytes, self.limits.max_buffer_size, "maxBufferSize", way_out)
    }

    /// Colours that are read back.
    pub(crate) fn colors(&self, size: [u32; 2]) -> Result<(), GpuError> {
        let bytes = u64::from(color_row_bytes(size[0])) * u64::from(size[1]);
        self.at_most(reading_back(size), bytes, self.limits.max_buffer_size, "maxBufferSize", SMALLER_PICTURE)
    }
}

/// What to do about layers that are too large to be read back.
pub(crate) const SMALLER_PICTURE: &str = "render a smaller picture, or use the CPU backend";
pub(crate) const SMALLER_MAP: &str = "choose a smaller --map-size, or use the CPU backend";

/// Bytes of a colour.
pub(crate) const COLOR_BYTES: u32 = 16;

/// Bytes of a row of colours in the buffer that they are read through: rows of a copy begin at multiples of so many.
pub(crate) fn color_row_bytes(width: u32) -> u32 {
    (width * COLOR_BYTES).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// A layer in words.
fn reading_back([width, height]: [u32; 2]) -> String {
    format!("reading a layer of {width} x {height} back, in bytes")
}

#[cfg(test)]
mod tests {
    use shadow_math::ShadowSettings;
    use shadow_scene::builtin;

    use super::*;

    /// Layers are refused by the buffers that they are read through, if they are asked for, and those are as large as is promised.
    #[test]
    fn only_what_is_read_back_must_fit_a_buffer() {
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: 4 * 64 * 64,
            max_buffer_size: 16 * 64 * 60,
            ..wgpu::Limits::default()
        };
        let check = LimitCheck { adapter: "small", limits: &limits };
        let scene = builtin::demo();
        let refusal = |(width, height), map_size, request| {
            let settings = ShadowSettings { map_size, ..ShadowSettings::default() };
            let camera = &scene.cameras()[0].camera;
            let plan = FramePlan::new(&scene, camera, &settings, width, height, None).expect("the sizes can be planned");
            check.frame(&plan).expect("textures of these sizes fit");
            check.request(&plan, request).err().map(|error| error.to_string())
        };
        let maps = Request { shadow_maps: true, ..Request::default() };
        assert_eq!(refusal((16, 16), 64, maps), None);
        let refused = refusal((16, 16), 65, maps).expect("the map is too large");
        for word in ["65 x 65", "16900", "16384", "maxStorageBufferBindingSize", "--map-size"] {
            assert!(refused.contains(word), "`{word}` is not in: {refused}");
        }
        assert_eq!(refusal((16, 16), 65, Request::COLOR), None, "no map is read back");
        assert_eq!(refusal((64, 60), 16, Request::COLOR), None);
        // 57 colours take as much as 64, since rows are padded.
        let refused = refusal((57, 61), 16, Request::COLOR).expect("the padded rows are too large");
        assert!(refused.contains("maxBufferSize") && refused.contains("smaller picture"), "{refused}");
    }
}
