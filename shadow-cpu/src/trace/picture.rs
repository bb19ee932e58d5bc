//! The picture that the camera sees, with the visibility of every light at every pixel.

use rayon::prelude::*;
use shadow_scene::{Frame, Layer, LayerName, NO_TRIANGLE, Pixels, Request};

use super::{CameraView, Tracer, light::scramble};

/// How a light that has a size is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Samples a pixel and light on each side of a square, at least 1: their number is the square of this.
    pub side: u32,
}

impl Default for Sampling {
    /// 64 samples: visibilities are then known to a quarter, at 95 % confidence, at worst.
    fn default() -> Self {
        Self { side: 8 }
    }
}

impl Sampling {
    /// How many samples a pixel and light has.
    #[must_use]
    pub fn count(self) -> u32 {
        self.side * self.side
    }
}

/// A traced picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The triangle of each pixel, or [`NO_TRIANGLE`], row by row from the top.
    pub triangles: Vec<u32>,
    /// The reversed depth of each pixel; 0 where there is nothing.
    pub depth: Vec<f32>,
    /// How many samples of each light each pixel sees, the lights of a pixel side by side; all of them where there is nothing.
    pub seen: Vec<u32>,
    /// How the lights were sampled.
    pub sampling: Sampling,
}

impl Traced {
    /// The visibility of every light at every pixel, the lights of a pixel side by side: from 0, hidden, to 1.
    #[must_use]
    pub fn visibility(&self) -> Vec<f32> {
        let count = f64::from(self.sampling.count());
        self.seen.iter().map(|&seen| (f64::from(seen) / count) as f32).collect()
    }

    /// The layers that are asked for, as far as rays can make them: there are no shadow maps, and colour is made from visibility
    /// by those who know how surfaces shine.
    #[must_use]
    pub fn into_frame(self, request: Request) -> Frame {
        let (width, height) = (self.width, self.height);
        let lights = self.seen.len() / self.triangles.len().max(1);
        let mut layers = Vec::new();
        let visibility = if request.visibility { self.visibility() } else { Vec::new() };
        if request.camera {
            layers.push(Layer { name: LayerName::Triangle, width, height, pixels: Pixels::Id(self.triangles) });
            layers.push(Layer { name: LayerName::Depth, width, height, pixels: Pixels::Float(self.depth) });
        }
        if request.visibility {
            for light in 0..lights {
                let values = visibility.iter().skip(light).step_by(lights).copied().collect();
                let name = LayerName::Visibility { light: light as u32 };
                layers.push(Layer { name, width, height, pixels: Pixels::Float(values) });
            }
        }
        Frame { source: "trace".into(), layers }
    }
}

impl Tracer<'_> {
    /// Traces what a camera sees under all lights of the scene. `on_rows` is told, from any thread, how many rows more are done.
    ///
    /// The result does not depend on the number of threads.
    #[must_use]
    pub fn trace(&self, view: &CameraView, sampling: Sampling, on_rows: &(dyn Fn(u64) + Sync)) -> Traced {
        let (width, height) = (view.width() as usize, view.height() as usize);
        let lights = self.scene().lights();
        let mut traced = Traced {
            width: view.width(),
            height: view.height(),
            triangles: vec![NO_TRIANGLE; width * height],
            depth: vec![0.0; width * height],
            seen: vec![sampling.count(); width * height * lights.len()],
            sampling,
        };
        // A scene without lights has rows of no visibilities.
        let mut seen_rows: Vec<&mut [u32]> = if lights.is_empty() {
            (0..height).map(|_| Default::default()).collect()
        } else {
            traced.seen.chunks_mut(width * lights.len()).collect()
        };
        let rows = traced.triangles.par_chunks_mut(width).zip(traced.depth.par_chunks_mut(width)).zip(seen_rows.par_iter_mut());
        self.threads.install(|| {
            rows.enumerate().for_each(|(y, ((triangles, depth), seen))| {
                let mut rays = self.rays();
                for x in 0..width {
                    let ray = view.ray(x as u32, y as u32);
                    let Some(hit) = rays.closest_seen(ray) else { continue };
                    let point = self.surface_point(&hit, ray);
                    triangles[x] = hit.triangle;
                    depth[x] = view.reversed_depth(point.position) as f32;
                    for (index, light) in lights.iter().enumerate() {
                        let seed = scramble(((y * width + x) * lights.len() + index) as u64);
                        seen[x * lights.len() + index] = rays.samples_seen(&point, light, sampling.side, seed);
                    }
                }
                on_rows(1);
            });
        });
        traced
    }
}
