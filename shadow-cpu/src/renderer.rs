//! The renderer: the stages of a frame, each a function of its own, and all of them in a row.

use std::{
    sync::{Mutex, PoisonError},
    time::Instant,
};

use rayon::{ThreadPool, ThreadPoolBuilder};
use shadow_math::{
    depth::{DEPTH_REVERSED, LAYER_FIRST},
    plan::{COMPOSE_FACTOR, CameraPlan, ViewPlan},
};
use shadow_scene::{
    Frame, FramePlan, Layer, LayerName, LightPasses, NO_TRIANGLE, Pass, Pixels, Request, Scene, StageTimes, Surfaces,
};

use crate::{
    buffer::{Buffer, Pool},
    raster::{
        Culling, Drawing, MAX_TARGET_SIZE, Positions, RasterRules, Run, Scratch, Target, rasterize_depth, rasterize_second,
        rasterize_stored, rasterize_visibility,
    },
    resolve::{Resolved, SceneAlphaTest, SceneView, ShadingVertices, ShadowMaps, ViewTest, resolve, resolve_color},
};

/// Why the CPU renderer cannot do what was asked for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CpuError {
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {source}")]
    Threads {
        /// How many were asked for; 0 for one a core.
        threads: usize,
        /// What the system said.
        source: rayon::ThreadPoolBuildError,
    },
    /// The picture is too large.
    #[error(
        "a picture of {width} x {height} pixels is larger than the CPU renderer's limit of {MAX_TARGET_SIZE} on a side; render it smaller"
    )]
    PictureSize {
        /// The width in pixels.
        width: u32,
        /// The height in pixels.
        height: u32,
    },
}

/// A renderer with its threads.
#[derive(Debug)]
pub struct CpuRenderer {
    threads: ThreadPool,
    rules: RasterRules,
    scratch: Mutex<Scratch>,
    floats: Pool<f32>,
    triangles: Pool<u32>,
    colors: Pool<[f32; 4]>,
}

/// A scene in the form that the CPU renderer works on.
#[derive(Debug)]
pub struct PreparedScene<'a> {
    scene: &'a Scene,
    positions: Positions,
    surfaces: Surfaces,
    vertices: ShadingVertices,
}

impl PreparedScene<'_> {
    /// The scene with its surfaces.
    #[must_use]
    pub fn view(&self) -> SceneView<'_> {
        SceneView { scene: self.scene, surfaces: &self.surfaces, vertices: &self.vertices }
    }
}

/// What the camera sees: the visibility buffer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraBuffer {
    /// The triangle of each pixel.
    pub triangles: Buffer<u32>,
    /// The reversed depth of each pixel.
    pub depth: Buffer<f32>,
}

/// A frame as the renderer has it; what was not needed is empty.
#[derive(Debug, Default)]
pub struct Drawn {
    /// What the camera sees.
    pub camera: CameraBuffer,
    /// The shadow maps.
    pub maps: ShadowMaps,
    /// The visibility of every light at every pixel, the lights of a pixel side by side.
    pub visibility: Buffer<f32>,
    /// The colour of every pixel.
    pub color: Buffer<[f32; 4]>,
    /// How long each stage took; `prepare` is 0 here and counted where the scene was prepared.
    pub times: StageTimes,
}

/// A frame and how long it took.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The layers that were asked for.
    pub frame: Frame,
    /// How long each stage took; `prepare` is 0 here and counted where the scene was prepared.
    pub times: StageTimes,
}

impl CpuRenderer {
    /// A renderer with `threads` threads, 0 for one a core, that follows these rules where WebGPU leaves a choice.
    ///
    /// # Errors
    ///
    /// [`CpuError::Threads`].
    pub fn new(threads: usize, rules: RasterRules) -> Result<Self, CpuError> {
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("shadow-cpu {index}"))
            .build()
            .map_err(|source| CpuError::Threads { threads, source })?;
        Ok(Self {
            threads: pool,
            rules,
            scratch: Mutex::default(),
            floats: Pool::default(),
            triangles: Pool::default(),
            colors: Pool::default(),
        })
    }

    /// How many threads the renderer has.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads.current_num_threads()
    }

    /// Brings a scene into the renderer's own form.
    #[must_use]
    pub fn prepare<'a>(&self, scene: &'a Scene) -> PreparedScene<'a> {
        PreparedScene {
            scene,
            positions: Positions::new(&scene.vertices().positions),
            surfaces: Surfaces::of(scene),
            vertices: ShadingVertices::new(scene.vertices()),
        }
    }

    /// Renders all shadow maps of a plan.
    #[must_use]
    pub fn shadow_maps(&self, prepared: &PreparedScene<'_>, plan: &FramePlan) -> ShadowMaps {
        let size = plan.map_size;
        let mut scratch = self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let scratch = &mut *scratch;
        let with_maps = plan.views.iter().enumerate().filter(|(_, view)| view.has_map());
        let layers = with_maps.map(|(index, view)| {
            let [_, _, width, height] = view.rect;
            let target = Target { clip_rows: view.drawn_rows(), width, height };
            let alpha_test = ViewTest { view: prepared.view(), plan: view };
            let culling = if plan.takes_back_faces(index) { Culling::Front } else { Culling::None };
            let mut runs = runs(prepared.scene, culling, Pass::casts_shadows);
            if view.has_half_space() {
                // Every caster is tested at each texel, for the side that it lies on.
                runs.iter_mut().for_each(|run| run.is_masked = true);
            }
            let texels = width as usize * height as usize;
            let mut depth = self.floats.take(texels);
            let (positions, triangles, rules) = (&prepared.positions, prepared.scene.triangles(), &self.rules);
            let drawing = Drawing { positions, triangles, runs: &runs, target: &target, rules };
            self.threads.install(|| {
                if view.holds_drawn_depth() {
                    rasterize_depth(scratch, positions, triangles, &runs, &target, rules, &alpha_test, &mut depth);
                } else if view.depth_layer == LAYER_FIRST {
                    rasterize_stored(scratch, drawing, &alpha_test, view, &mut depth);
                } else {
                    let mut first = self.floats.take(texels);
                    rasterize_depth(scratch, positions, triangles, &runs, &target, rules, &alpha_test, &mut first);
                    rasterize_second(scratch, drawing, &alpha_test, view, &first, &mut depth);
                }
            });
            if width == size { depth } else { self.within_layer(depth, view, size) }
        });
        ShadowMaps { size, layers: layers.collect() }
    }

    /// A map that is smaller than its layer, in it: the rest holds what a map does in which nothing was drawn.
    fn within_layer(&self, map: Buffer<f32>, view: &ViewPlan, size: u32) -> Buffer<f32> {
        let mut layer = self.floats.take(size as usize * size as usize);
        layer.fill(if view.depth_kind == DEPTH_REVERSED { 0.0 } else { 1.0 });
        let rows = layer.chunks_exact_mut(size as usize).zip(map.chunks_exact(view.rect[2] as usize));
        for (row, texels) in rows {
            row[..texels.len()].copy_from_slice(texels);
        }
        layer
    }

    /// Renders what the camera sees.
    ///
    /// # Errors
    ///
    /// [`CpuError::PictureSize`].
    pub fn camera(&self, prepared: &PreparedScene<'_>, plan: &FramePlan) -> Result<CameraBuffer, CpuError> {
        let camera = &plan.camera;
        if camera.width.max(camera.height) > MAX_TARGET_SIZE {
            return Err(CpuError::PictureSize { width: camera.width, height: camera.height });
        }
        let target = Target {
            clip_rows: [camera.clip_x, camera.clip_y, camera.clip_z, camera.clip_w],
            width: camera.width,
            height: camera.height,
        };
        let mut scratch = self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let scratch = &mut *scratch;
        let alpha_test = SceneAlphaTest { view: prepared.view(), rays: &camera.rays };
        let runs = runs(prepared.scene, Culling::Back, |_| true);
        let pixels = camera.width as usize * camera.height as usize;
        let mut buffer = CameraBuffer { triangles: self.triangles.take(pixels), depth: self.floats.take(pixels) };
        self.threads.install(|| {
            rasterize_visibility(
                scratch,
                &prepared.positions,
                prepared.scene.triangles(),
                &runs,
                &target,
                &self.rules,
                &alpha_test,
                &mut buffer.depth,
                &mut buffer.triangles,
            );
        });
        Ok(buffer)
    }

    /// The visibility of every light at every pixel, the lights of a pixel side by side.
    #[must_use]
    pub fn visibility(
        &self,
        prepared: &PreparedScene<'_>,
        plan: &FramePlan,
        camera: &CameraBuffer,
        maps: &ShadowMaps,
    ) -> Buffer<f32> {
        let mut visibility = self.floats.take(camera.triangles.len() * plan.lights.len());
        let out = Resolved { visibility: Some(&mut visibility), color: None };
        self.threads.install(|| resolve(prepared.view(), plan, &camera.triangles, maps, out));
        visibility
    }

    /// The colour of every pixel, from visibilities wherever they come from: the lights of a pixel side by side. In as many passes as the plan says, added up or multiplied.
    ///
    /// # Panics
    ///
    /// If `visibility` does not have a value for every light at every pixel.
    #[must_use]
    pub fn color(
        &self,
        prepared: &PreparedScene<'_>,
        plan: &FramePlan,
        camera: &CameraBuffer,
        visibility: &[f32],
    ) -> Buffer<[f32; 4]> {
        let draw = |pass: CameraPlan| {
            let mut color = self.colors.take(camera.triangles.len());
            let plan = FramePlan { camera: pass, ..plan.clone() };
            self.threads.install(|| resolve_color(prepared.view(), &plan, &camera.triangles, visibility, &mut color));
            color
        };
        let mut color = draw(plan.first_pass());
        for pass in plan.passes_of_lights() {
            let of_light = draw(pass);
            for ((color, of_light), &triangle) in color.iter_mut().zip(of_light.iter()).zip(camera.triangles.iter()) {
                if triangle == NO_TRIANGLE {
                    continue;
                }
                for (channel, of_light) in color.iter_mut().zip(of_light).take(3) {
                    *channel = if pass.composition == COMPOSE_FACTOR { *channel * of_light } else { *channel + of_light };
                }
            }
        }
        color
    }

    /// Visibility and colour in one go, where `request` has them: the surface behind each pixel is looked up once for both.
    fn shade(
        &self,
        prepared: &PreparedScene<'_>,
        plan: &FramePlan,
        camera: &CameraBuffer,
        maps: &ShadowMaps,
        request: Request,
    ) -> (Buffer<f32>, Buffer<[f32; 4]>) {
        if request.color && plan.light_passes == LightPasses::Each {
            let visibility = self.visibility(prepared, plan, camera, maps);
            let color = self.color(prepared, plan, camera, &visibility);
            return (visibility, color);
        }
        let pixels = camera.triangles.len();
        let mut visibility = if request.visibility { self.floats.take(pixels * plan.lights.len()) } else { Buffer::default() };
        let mut color = if request.color { self.colors.take(pixels) } else { Buffer::default() };
        let out =
            Resolved { visibility: request.visibility.then_some(&mut *visibility), color: request.color.then_some(&mut *color) };
        self.threads.install(|| resolve(prepared.view(), plan, &camera.triangles, maps, out));
        (visibility, color)
    }

    /// Draws all stages that the layers asked for need, in a row, into memory that the next frame uses again.
    ///
    /// # Errors
    ///
    /// [`CpuError::PictureSize`].
    pub fn draw(&self, prepared: &PreparedScene<'_>, plan: &FramePlan, request: Request) -> Result<Drawn, CpuError> {
        let start = Instant::now();
        let needs_shading = request.visibility || request.color;
        let camera = if request.camera || needs_shading { self.camera(prepared, plan)? } else { CameraBuffer::default() };
        let camera_done = Instant::now();
        let needs_maps = request.shadow_maps || needs_shading;
        let maps = if needs_maps { self.shadow_maps(prepared, plan) } else { ShadowMaps::default() };
        let maps_done = Instant::now();
        let (visibility, color) = if needs_shading {
            self.shade(prepared, plan, &camera, &maps, request)
        } else {
            (Buffer::default(), Buffer::default())
        };
        let shading_done = Instant::now();
        let milliseconds = |from: Instant, to: Instant| (to - from).as_secs_f64() * 1e3;
        let times = StageTimes {
            prepare: 0.0,
            camera: milliseconds(start, camera_done),
            shadow_maps: milliseconds(camera_done, maps_done),
            shading: milliseconds(maps_done, shading_done),
        };
        Ok(Drawn { camera, maps, visibility, color, times })
    }

    /// Renders a frame: draws it and gives its layers names.
    ///
    /// # Errors
    ///
    /// [`CpuError::PictureSize`].
    pub fn render(&self, prepared: &PreparedScene<'_>, plan: &FramePlan, request: Request) -> Result<Rendered, CpuError> {
        let drawn = self.draw(prepared, plan, request)?;
        let times = drawn.times;
        Ok(Rendered { frame: into_frame(plan, request, drawn), times })
    }
}

/// The runs of triangles that a pass over the scene draws.
fn runs(scene: &Scene, of_single_sided: Culling, is_drawn: impl Fn(Pass) -> bool) -> Vec<Run> {
    Pass::ALL
        .into_iter()
        .filter(|&pass| is_drawn(pass) && !scene.pass_triangles(pass).is_empty())
        .map(|pass| Run {
            triangles: scene.pass_triangles(pass),
            culling: if pass.culls_back_faces() { of_single_sided } else { Culling::None },
            is_masked: pass.is_masked(),
        })
        .collect()
}

/// Names the layers that were asked for.
fn into_frame(plan: &FramePlan, request: Request, drawn: Drawn) -> Frame {
    let Drawn { camera, maps, visibility, color, .. } = drawn;
    let (width, height) = (plan.camera.width, plan.camera.height);
    let mut layers = Vec::new();
    if request.camera {
        layers.push(Layer { name: LayerName::Triangle, width, height, pixels: Pixels::Id(camera.triangles.into_vec()) });
        layers.push(Layer { name: LayerName::Depth, width, height, pixels: Pixels::Float(camera.depth.into_vec()) });
    }
    if request.shadow_maps {
        for ((name, _), depth) in plan.maps().zip(maps.layers) {
            layers.push(Layer { name, width: maps.size, height: maps.size, pixels: Pixels::Float(depth.into_vec()) });
        }
    }
    if request.visibility {
        for light in 0..plan.lights.len() {
            let values = visibility.iter().skip(light).step_by(plan.lights.len()).copied().collect();
            let name = LayerName::Visibility { light: light as u32 };
            layers.push(Layer { name, width, height, pixels: Pixels::Float(values) });
        }
    }
    if request.color {
        layers.push(Layer { name: LayerName::Color, width, height, pixels: Pixels::Rgba(color.into_vec()) });
    }
    Frame { source: "cpu".into(), layers }
}
