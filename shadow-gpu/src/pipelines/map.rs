//! The pipelines that draw shadow maps: one for each way in which casters are drawn.

use std::{
    collections::HashMap,
    sync::{Mutex, PoisonError},
};

use shadow_math::{
    depth::{DEPTH_REVERSED, LAYER_FIRST},
    plan::ViewPlan,
};

use super::{Layouts, RenderStyle, module, pipeline_layout, render_pipeline};
use crate::shaders::SHADOW_MAP_MODULE;

/// What becomes of the depths that are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Drawn {
    /// They are the map.
    Depth,
    /// The fragment shader turns them into what the map holds.
    Stored,
    /// The fragment shader leaves those that are the first surface's out, and combines the others with it.
    Second,
}

/// How a run of triangles is drawn into a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MapStyle {
    pub(crate) drawn: Drawn,
    /// Whether the largest depth wins.
    pub(crate) is_reversed: bool,
    pub(crate) is_masked: bool,
    pub(crate) takes_back_faces_alone: bool,
}

impl MapStyle {
    /// How opaque casters of both sides are drawn into a view's map; the first surface of those that hold a second one.
    pub(crate) fn of(view: &ViewPlan) -> Self {
        // First surfaces are drawn as second ones are, so that a driver gives both the same depth.
        let is_plain = view.has_plain_casters() && view.depth_layer == LAYER_FIRST;
        Self {
            drawn: if is_plain { Drawn::Depth } else { Drawn::Stored },
            // Linear depth is drawn with reversed depth and turned round: the smallest wins.
            is_reversed: view.depth_kind == DEPTH_REVERSED,
            is_masked: false,
            takes_back_faces_alone: false,
        }
    }

    /// The depth of a map in which nothing was drawn.
    pub(crate) fn far(self) -> f32 {
        if self.is_reversed { 0.0 } else { 1.0 }
    }

    /// Whether positions come as a vertex attribute, by indices, and not from the scene's tables.
    pub(crate) fn is_indexed(self) -> bool {
        self.drawn == Drawn::Depth && !self.is_masked
    }
}

/// The pipelines that were asked for.
pub(crate) struct MapPipelines {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    layout_of_second: wgpu::PipelineLayout,
    made: Mutex<HashMap<MapStyle, wgpu::RenderPipeline>>,
}

impl MapPipelines {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let Layouts { geometry, surfaces, views, first_surface, .. } = layouts;
        let pipelines = Self {
            module: module(device, "shadow map", SHADOW_MAP_MODULE),
            layout: pipeline_layout(device, "shadow map", &[geometry, surfaces, views]),
            layout_of_second: pipeline_layout(device, "second surfaces", &[geometry, surfaces, views, first_surface]),
            made: Mutex::default(),
        };
        // What most scenes need is made at once, and what a driver has against the module is known from the beginning.
        for is_masked in [false, true] {
            pipelines.get(device, MapStyle { is_masked, ..MapStyle::of(&ViewPlan::default()) });
        }
        pipelines
    }

    pub(crate) fn get(&self, device: &wgpu::Device, style: MapStyle) -> wgpu::RenderPipeline {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        made.entry(style).or_insert_with(|| self.make(device, style)).clone()
    }

    fn make(&self, device: &wgpu::Device, style: MapStyle) -> wgpu::RenderPipeline {
        let MapStyle { drawn, is_reversed, is_masked, takes_back_faces_alone } = style;
        let constants = [("IS_MASKED", f64::from(is_masked)), ("TAKES_BACK_FACES", f64::from(takes_back_faces_alone))];
        let (vertex, fragment) = match (drawn, is_masked, takes_back_faces_alone) {
            (Drawn::Depth, false, false) => ("opaque_vertex", None),
            (Drawn::Depth, false, true) => ("opaque_vertex", Some("opaque_back_fragment")),
            (Drawn::Depth, true, false) => ("masked_vertex", Some("masked_fragment")),
            (Drawn::Depth, true, true) => ("masked_vertex", Some("masked_back_fragment")),
            (Drawn::Stored, ..) => ("stored_vertex", Some("stored_fragment")),
            (Drawn::Second, ..) => ("stored_vertex", Some("second_fragment")),
        };
        render_pipeline(
            device,
            &RenderStyle {
                label: "shadow map",
                layout: if drawn == Drawn::Second { &self.layout_of_second } else { &self.layout },
                module: &self.module,
                vertex,
                fragment,
                constants: if drawn == Drawn::Depth { &[] } else { &constants },
                positions_as_attribute: style.is_indexed(),
                target: None,
                depth_compare: if is_reversed { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less },
            },
        )
    }
}
