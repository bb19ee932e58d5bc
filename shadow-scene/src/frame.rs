//! Frames: what a renderer gives back, as named and typed layers.

use core::fmt;

use shadow_math::visibility::MapAccess;

use crate::FramePlan;

/// [`Pixels::Id`] of a pixel that shows no triangle.
pub const NO_TRIANGLE: u32 = u32::MAX;

/// What a layer is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LayerName {
    /// The index of the triangle that each pixel shows, or [`NO_TRIANGLE`].
    Triangle,
    /// The camera's reversed depth: 1 at the near plane, 0 where there is nothing.
    Depth,
    /// The depths of a shadow map: 0 at the near plane, 1 where there is nothing.
    ShadowMap {
        /// The light's index.
        light: u32,
        /// The view's index among those of the light.
        view: u32,
    },
    /// How much of a light reaches each pixel: 0 shadowed to 1 lit.
    Visibility {
        /// The light's index.
        light: u32,
    },
    /// Linear colour after exposure; alpha is 1.
    Color,
}

impl fmt::Display for LayerName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Triangle => f.write_str("triangle"),
            Self::Depth => f.write_str("depth"),
            Self::ShadowMap { light, view } => write!(f, "shadow-map:{light}:{view}"),
            Self::Visibility { light } => write!(f, "visibility:{light}"),
            Self::Color => f.write_str("color"),
        }
    }
}

/// The values of a layer, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// One number a pixel.
    Float(Vec<f32>),
    /// Four numbers a pixel.
    Rgba(Vec<[f32; 4]>),
    /// One index a pixel.
    Id(Vec<u32>),
}

impl Pixels {
    /// How many pixels there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Float(values) => values.len(),
            Self::Rgba(values) => values.len(),
            Self::Id(values) => values.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values as bytes, in the machine's byte order.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        match self {
            Self::Float(values) => bytemuck::cast_slice(values),
            Self::Rgba(values) => bytemuck::cast_slice(values),
            Self::Id(values) => bytemuck::cast_slice(values),
        }
    }
}

/// One layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// What it is of.
    pub name: LayerName,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height` values.
    pub pixels: Pixels,
}

/// A set of layers. Which are present is up to what was [asked for](Request).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// What rendered it, such as `cpu` or the name of an adapter: a comparison refuses two frames from the same source.
    pub source: String,
    /// The layers, each name at most once, in the order in which the stages make them.
    pub layers: Vec<Layer>,
}

impl Frame {
    /// The layer of that name, if it is present.
    #[must_use]
    pub fn layer(&self, name: LayerName) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// The triangle layer's indices, if present.
    #[must_use]
    pub fn triangles(&self) -> Option<&[u32]> {
        match &self.layer(LayerName::Triangle)?.pixels {
            Pixels::Id(values) => Some(values),
            _ => None,
        }
    }

    /// The values of a layer of single numbers, if present.
    #[must_use]
    pub fn floats(&self, name: LayerName) -> Option<&[f32]> {
        match &self.layer(name)?.pixels {
            Pixels::Float(values) => Some(values),
            _ => None,
        }
    }

    /// The colour layer's pixels, if present.
    #[must_use]
    pub fn color(&self) -> Option<&[[f32; 4]]> {
        match &self.layer(LayerName::Color)?.pixels {
            Pixels::Rgba(values) => Some(values),
            _ => None,
        }
    }
}

/// The shadow maps of a frame, as lookups ask for them.
#[derive(Clone, Debug)]
pub struct FrameMaps<'a> {
    /// The maps, in the order of their layers.
    layers: Vec<&'a [f32]>,
    /// Width and height of each.
    size: usize,
}

impl<'a> FrameMaps<'a> {
    /// The maps of a frame that was rendered by `plan`; `None` if one of them is not there, or is of another size.
    #[must_use]
    pub fn of(frame: &'a Frame, plan: &FramePlan) -> Option<Self> {
        let size = plan.map_size as usize;
        let layers = plan.maps().map(|(layer, _)| frame.floats(layer).filter(|texels| texels.len() == size * size));
        Some(Self { layers: layers.collect::<Option<_>>()?, size })
    }
}

impl MapAccess for FrameMaps<'_> {
    fn fetch_texel(&self, layer: u32, x: u32, y: u32) -> f32 {
        // A view's layer is its place among those that have maps.
        self.layers[layer as usize][y as usize * self.size + x as usize]
    }
}

/// Which layers are to be given back. What is not asked for is not copied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Request {
    /// The camera's triangle and depth layers.
    pub camera: bool,
    /// All shadow maps.
    pub shadow_maps: bool,
    /// The visibility of every light.
    pub visibility: bool,
    /// The colour.
    pub color: bool,
}

impl Request {
    /// Every layer there is.
    pub const ALL: Self = Self { camera: true, shadow_maps: true, visibility: true, color: true };
    /// The picture alone.
    pub const COLOR: Self = Self { camera: false, shadow_maps: false, visibility: false, color: true };
}

/// How long each stage of a frame took, in milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageTimes {
    /// Bringing the scene into the renderer's own form, once per scene.
    pub prepare: f64,
    /// Rendering all shadow maps.
    pub shadow_maps: f64,
    /// The camera pass.
    pub camera: f64,
    /// Visibility and shading.
    pub shading: f64,
}

impl StageTimes {
    /// The frame: all stages but `prepare`, which is done once for many frames.
    #[must_use]
    pub fn frame(&self) -> f64 {
        self.shadow_maps + self.camera + self.shading
    }
}
