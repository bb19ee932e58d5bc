//! The pipelines of colours: one for each way in which a pass meets those before it.

use std::{
    collections::HashMap,
    sync::{Mutex, PoisonError},
};

use super::{COLOR_FORMAT, Layouts, full_screen_pipeline, module, pipeline_layout};
use crate::shaders::COLOR_MODULE;

/// What becomes of what is already there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Blend {
    Replace,
    Add,
    Multiply,
}

impl Blend {
    fn state(self) -> Option<wgpu::BlendState> {
        let component =
            |src_factor, dst_factor| wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
        // Alpha is 1 everywhere and stays so.
        let alpha = component(wgpu::BlendFactor::Zero, wgpu::BlendFactor::One);
        let color = match self {
            Self::Replace => return None,
            Self::Add => component(wgpu::BlendFactor::One, wgpu::BlendFactor::One),
            Self::Multiply => component(wgpu::BlendFactor::Zero, wgpu::BlendFactor::Src),
        };
        Some(wgpu::BlendState { color, alpha })
    }
}

/// The pipelines that were asked for.
pub(crate) struct ColorPipelines {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    /// By how a pass meets those before it, and whether any light has a soft terminator.
    made: Mutex<HashMap<(Blend, bool), wgpu::RenderPipeline>>,
}

impl ColorPipelines {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let pipelines = Self {
            module: module(device, "resolve_color", COLOR_MODULE),
            layout: pipeline_layout(device, "resolve_color", &[&layouts.geometry, &layouts.surfaces, &layouts.color]),
            made: Mutex::default(),
        };
        // What a driver has against the module is to be known from the beginning.
        pipelines.get(device, Blend::Replace, false);
        pipelines
    }

    pub(crate) fn get(&self, device: &wgpu::Device, blend: Blend, is_any_soft: bool) -> wgpu::RenderPipeline {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let make = || {
            let constants = [("ASKS_FOR_DEVIATION", f64::from(is_any_soft))];
            let target = wgpu::ColorTargetState { blend: blend.state(), ..COLOR_FORMAT.into() };
            full_screen_pipeline(device, "resolve_color", &self.module, &self.layout, &constants, target)
        };
        made.entry((blend, is_any_soft)).or_insert_with(make).clone()
    }
}
