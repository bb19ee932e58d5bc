//! The WGSL sources. A module is a few files joined; WGSL does not mind their order.

/// Bits of the width of the textures that hold lists. The smallest widest texture that WebGPU promises is twice as wide.
pub const TABLE_WIDTH_BITS: u32 = 12;

/// One file of shader source.
#[derive(Clone, Copy, Debug)]
pub struct ShaderFile {
    /// The file's stem: the Rust module that it mirrors has the same.
    pub stem: &'static str,
    /// The source.
    pub source: &'static str,
}

macro_rules! shader_files {
    ($($name:ident = $stem:literal),* $(,)?) => {
        $(
            #[doc = concat!("`", $stem, ".wgsl`")]
            pub const $name: ShaderFile = ShaderFile { stem: $stem, source: include_str!(concat!("shaders/", $stem, ".wgsl")) };
        )*
        /// Every file.
        pub const ALL: &[ShaderFile] = &[$($name),*];
    };
}

shader_files! {
    PLAN = "plan",
    VECTOR = "vector",
    LIGHT = "light",
    TRIANGLE = "triangle",
    DEPTH = "depth",
    GRADIENT = "gradient",
    CASTER = "caster",
    BIAS = "bias",
    FILTER = "filter",
    VISIBILITY = "visibility",
    APPROX = "approx",
    SRGB = "srgb",
    MATERIAL = "material",
    SHADE = "shade",
    GEOMETRY = "geometry",
    SURFACES = "surfaces",
    SHADOW_MAP = "shadow_map",
    CAMERA = "camera",
    FULL_SCREEN = "full_screen",
    RESOLVE_VISIBILITY = "resolve_visibility",
    RESOLVE_COLOR = "resolve_color",
    READBACK = "readback",
    READBACK_ID = "readback_id",
    PROBE_DRAW = "probe_draw",
    PROBE_READ = "probe_read",
    PROBE_COMPARE = "probe_compare",
}

/// The files of the shadow map passes.
pub const SHADOW_MAP_MODULE: &[ShaderFile] =
    &[PLAN, VECTOR, TRIANGLE, DEPTH, GRADIENT, CASTER, MATERIAL, GEOMETRY, SURFACES, SHADOW_MAP];
/// The files of the camera pass.
pub const CAMERA_MODULE: &[ShaderFile] = &[PLAN, VECTOR, TRIANGLE, MATERIAL, GEOMETRY, SURFACES, CAMERA];
/// The files of the visibility pass.
pub const VISIBILITY_MODULE: &[ShaderFile] =
    &[PLAN, VECTOR, LIGHT, TRIANGLE, DEPTH, GRADIENT, BIAS, FILTER, VISIBILITY, GEOMETRY, FULL_SCREEN, RESOLVE_VISIBILITY];
/// The files of the colour pass.
pub const COLOR_MODULE: &[ShaderFile] =
    &[PLAN, VECTOR, LIGHT, TRIANGLE, APPROX, MATERIAL, SHADE, GEOMETRY, SURFACES, FULL_SCREEN, RESOLVE_COLOR];
/// The files that read depths back.
pub const READBACK_MODULE: &[ShaderFile] = &[READBACK];
/// The files that read triangle indices back.
pub const READBACK_ID_MODULE: &[ShaderFile] = &[READBACK_ID];

/// The files that draw a probe's triangles.
pub const PROBE_DRAW_MODULE: &[ShaderFile] = &[PROBE_DRAW];
/// The files that read a probe's depths back.
pub const PROBE_READ_MODULE: &[ShaderFile] = &[PROBE_READ];
/// The files that probe the comparison sampler.
pub const PROBE_COMPARE_MODULE: &[ShaderFile] = &[PROBE_COMPARE];

/// The source of a module.
#[must_use]
pub fn join(files: &[ShaderFile]) -> String {
    files.iter().map(|file| file.source).collect::<Vec<_>>().join("\n")
}
