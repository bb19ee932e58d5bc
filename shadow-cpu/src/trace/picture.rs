//! The picture that the camera sees, and the visibility of every light at every pixel of it.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use shadow_scene::{Frame, Layer, LayerName, NO_TRIANGLE, Pixels, Request};

use super::{CameraView, Hit, Tracer, light::scramble};

/// How a light that has a size is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Samples a pixel and light on each side of a square, at least 1: their number is the square of this.
    pub side: u32,
}

impl Default for Sampling {
    /// 64 samples: at 95 % confidence a visibility is then known to 0.13 either way at worst.
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

/// What a camera sees: where the ray through each pixel ends, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Whose rays they are.
    pub view: CameraView,
    /// Where they end; the triangle is [`NO_TRIANGLE`] where there is nothing.
    pub hits: Vec<Hit>,
}

/// How much of each light is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenLights {
    /// How many samples of each light each pixel sees, the lights of a pixel side by side; all of them where there is nothing.
    pub samples_seen: Vec<u32>,
    /// How the lights were sampled.
    pub sampling: Sampling,
    /// How many rays were sent: a surface that does not face a light needs none, and a light without a size one.
    pub rays: u64,
}

impl SeenLights {
    /// The visibility of every light at every pixel, the lights of a pixel side by side: from 0, hidden, to 1.
    #[must_use]
    pub fn visibility(&self) -> Vec<f32> {
        let count = f64::from(self.sampling.count());
        self.samples_seen.iter().map(|&seen| (f64::from(seen) / count) as f32).collect()
    }
}

impl Seen {
    /// The triangle of each pixel.
    #[must_use]
    pub fn triangles(&self) -> Vec<u32> {
        self.hits.iter().map(|hit| hit.triangle).collect()
    }
}

/// A ray's end where there is nothing.
const NOTHING: Hit = Hit { triangle: NO_TRIANGLE, distance: f64::INFINITY, u: 0.0, v: 0.0, is_back: false };

impl Tracer<'_> {
    /// What a camera sees. `on_row` is called, from any thread, as each row is done.
    ///
    /// The result does not depend on the number of threads.
    #[must_use]
    pub fn camera(&self, view: CameraView, on_row: &(dyn Fn() + Sync)) -> Seen {
        let (width, height) = (view.width() as usize, view.height() as usize);
        let mut hits = vec![NOTHING; width * height];
        self.threads.install(|| {
            hits.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
                let mut rays = self.rays();
                for (x, hit) in row.iter_mut().enumerate() {
                    *hit = rays.closest_seen(view.ray(x as u32, y as u32)).unwrap_or(NOTHING);
                }
                on_row();
            });
        });
        Seen { view, hits }
    }

    /// How much of each of the scene's lights is seen from what a camera sees. `on_row` is called, from any thread, as each row is done.
    ///
    /// The result does not depend on the number of threads.
    ///
    /// # Panics
    ///
    /// If what is seen is not of this scene.
    #[must_use]
    pub fn lights(&self, seen: &Seen, sampling: Sampling, on_row: &(dyn Fn() + Sync)) -> SeenLights {
        let width = seen.view.width() as usize;
        let lights = self.scene().lights();
        let mut samples_seen = vec![sampling.count(); seen.hits.len() * lights.len()];
        let sent = AtomicU64::new(0);
        // A scene without lights has no rows of visibilities.
        let rows = samples_seen.par_chunks_mut((width * lights.len()).max(1)).zip(seen.hits.par_chunks(width));
        self.threads.install(|| {
            rows.enumerate().for_each(|(y, (samples_seen, hits))| {
                let mut rays = self.rays();
                for (x, hit) in hits.iter().enumerate().filter(|(_, hit)| hit.triangle != NO_TRIANGLE) {
                    let point = self.surface_point(hit, seen.view.ray(x as u32, y as u32));
                    for (index, light) in lights.iter().enumerate() {
                        let place = x * lights.len() + index;
                        let seed = scramble((y * width * lights.len() + place) as u64);
                        samples_seen[place] = rays.samples_seen(&point, light, sampling, seed);
                    }
                }
                sent.fetch_add(rays.sent(), Ordering::Relaxed);
                on_row();
            });
        });
        SeenLights { samples_seen, sampling, rays: sent.into_inner() }
    }

    /// The layers that are asked for of what a camera sees, as far as rays can make them: there are no shadow maps. `lights` and `color` are those that
    /// belong to it, where they are asked for.
    #[must_use]
    pub fn frame(&self, seen: &Seen, lights: Option<&SeenLights>, color: Option<Vec<[f32; 4]>>, request: Request) -> Frame {
        let (width, height) = (seen.view.width(), seen.view.height());
        let mut layers = Vec::new();
        if request.camera {
            let depth = seen.hits.iter().enumerate().map(|(pixel, hit)| {
                let (x, y) = (pixel as u32 % width, pixel as u32 / width);
                if hit.triangle == NO_TRIANGLE {
                    0.0
                } else {
                    seen.view.reversed_depth(seen.view.ray(x, y).at(hit.distance)) as f32
                }
            });
            let depth = Pixels::Float(depth.collect());
            layers.push(Layer { name: LayerName::Triangle, width, height, pixels: Pixels::Id(seen.triangles()) });
            layers.push(Layer { name: LayerName::Depth, width, height, pixels: depth });
        }
        if let (true, Some(lights)) = (request.visibility, lights) {
            let (visibility, count) = (lights.visibility(), self.scene().lights().len());
            for light in 0..count {
                let values = visibility.iter().skip(light).step_by(count).copied().collect();
                let name = LayerName::Visibility { light: light as u32 };
                layers.push(Layer { name, width, height, pixels: Pixels::Float(values) });
            }
        }
        if let (true, Some(color)) = (request.color, color) {
            layers.push(Layer { name: LayerName::Color, width, height, pixels: Pixels::Rgba(color) });
        }
        Frame { source: "trace".into(), layers }
    }
}
