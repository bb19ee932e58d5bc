//! How much memory a job takes, and the refusal of more than there should be: a failed allocation would end the program.
//!
//! The amounts are estimates from above, part by part: what is known of the renderers' buffers, not what is measured. The program itself,
//! its libraries and a graphics driver are not in them: these take about 100 MiB, whatever is drawn.

use std::fmt;

use shadow_scene::{FramePlan, LayerName, Request, Scene};

use crate::{
    args::Backend,
    console::count,
    error::CliError,
    machine,
    output::Format,
    resolve::Job,
    specs::{ByteSize, bytes_text},
};

/// The limit where the system does not say how much memory it has: 16 GiB, as much as common machines have. The largest map (1 GiB) can
/// then still be drawn for a point light (six of them), and a larger request is more likely a slip of the hand than a plan.
const FALLBACK_LIMIT: u64 = 16 << 30;

/// Bytes of a vertex in a scene: position and normal (12 each), texture coordinates (8), colour (16), and how far facets lean away from it (4).
const VERTEX: u64 = 12 + 12 + 8 + 16 + 4;
/// Bytes of a vertex in the CPU backend: its position again (12), what shading reads of it (32) and its place in the window (24).
const CPU_VERTEX: u64 = 12 + 32 + 24;
/// Bytes of a triangle in a scene: three indices and a material.
const TRIANGLE: u64 = 12 + 4 + 4;
/// Bytes of a triangle in the CPU backend, which keeps what a pass needs for the next: its edges and depth plane (44, in a list that has up to twice
/// the room it needs), and its entries in two or three bins (12 each).
const CPU_TRIANGLE: u64 = 2 * 44 + 36;
/// Bytes of a triangle in the tracer while its tree is built: corners (48), the builder's nodes and their order (two and two of 48, 36), the tree that is
/// folded from them (about 130), and indices.
const TRACE_TRIANGLE: u64 = 48 + 4 * 48 + 36 + 130 + 24;
/// Bytes of what a ray of the camera saw.
const SEEN: u64 = 32;
/// Bytes of a vertex in the GPU backend: four texels of 16 bytes, three times while they are brought there, and its position once more.
const GPU_VERTEX: u64 = 3 * 64 + 12;
/// Bytes of a triangle in the GPU backend: the same with its indices.
const GPU_TRIANGLE: u64 = 3 * 16 + 12;
/// Bytes of a texel in a scene, and again in either backend.
const TEXEL: u64 = 4;
/// Bytes of a texel of a shadow map, of a depth, of a triangle's index and of a light's visibility.
const NUMBER: u64 = 4;
/// Bytes of a colour: four numbers.
const COLOR: u64 = 16;
/// Bytes of a pixel of a frame's layer that is compared: its difference (8 for each of three channels), and the pictures of it and of the
/// two layers (3 each).
const COMPARED_PIXEL: u64 = 24 + 9;
/// Bytes of a texel of a shadow map that is compared: the same with one channel.
const COMPARED_TEXEL: u64 = 8 + 3;

/// The most memory that a job may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limit {
    pub(crate) bytes: u64,
    /// Where it comes from.
    origin: &'static str,
}

impl Limit {
    /// The limit that was typed; without one, three quarters of the machine's memory: the rest is the system's and other programs'.
    pub(crate) fn new(typed: Option<ByteSize>) -> Self {
        match (typed, machine::memory_bytes()) {
            (Some(ByteSize(bytes)), _) => Self { bytes, origin: "--memory-limit" },
            (None, Some(machine)) => Self { bytes: machine / 4 * 3, origin: "three quarters of this machine's memory" },
            (None, None) => Self { bytes: FALLBACK_LIMIT, origin: "the default on this system" },
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", bytes_text(self.bytes), self.origin)
    }
}

/// What a command has in memory at once.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Work<'a> {
    /// One backend renders a layer, which is written.
    Render(Backend, LayerName, Format),
    /// One backend renders all layers, and the colours once more without shadows, for a picture that explains them.
    Explain(Backend),
    /// One backend after the other renders all layers, and they are compared.
    Compare([Backend; 2]),
    /// One backend renders, beside the tracer; all layers are given back and judged, and the frames of so many techniques stay.
    Measure(Backend, usize),
    /// All backends stay ready, and none gives anything back.
    Bench(&'a [Backend]),
}

/// Bytes, by what they are for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Demand {
    meshes: u64,
    textures: u64,
    maps: u64,
    frame: u64,
}

impl Demand {
    fn plus(self, other: Self) -> Self {
        Self {
            meshes: self.meshes.saturating_add(other.meshes),
            textures: self.textures.saturating_add(other.textures),
            maps: self.maps.saturating_add(other.maps),
            frame: self.frame.saturating_add(other.frame),
        }
    }

    fn max(self, other: Self) -> Self {
        Self {
            meshes: self.meshes.max(other.meshes),
            textures: self.textures.max(other.textures),
            maps: self.maps.max(other.maps),
            frame: self.frame.max(other.frame),
        }
    }

    fn total(self) -> u64 {
        [self.meshes, self.textures, self.maps, self.frame].into_iter().fold(0, u64::saturating_add)
    }
}

/// The amounts of a job that everything else is a multiple of.
#[derive(Clone, Copy, Debug)]
struct Amounts {
    vertices: u64,
    triangles: u64,
    /// Of textures.
    texels: u64,
    views: u64,
    /// Of one map.
    map_texels: u64,
    pixels: u64,
    lights: u64,
}

impl Amounts {
    fn of(job: &Job, plan: &FramePlan) -> Self {
        Self {
            vertices: job.scene.vertices().positions.len() as u64,
            triangles: job.scene.triangles().len() as u64,
            texels: job.scene.images().iter().map(|image| image.texels.len() as u64).sum(),
            // One more where maps hold second surfaces: the map of the first.
            views: plan.map_bytes() / (u64::from(plan.map_size).pow(2) * NUMBER),
            map_texels: u64::from(plan.map_size).pow(2),
            pixels: u64::from(plan.camera.width) * u64::from(plan.camera.height),
            lights: plan.lights.len() as u64,
        }
    }

    /// The scene itself.
    fn scene(&self) -> Demand {
        let meshes = self.vertices * VERTEX + self.triangles * TRIANGLE;
        Demand { meshes, textures: self.texels * TEXEL, ..Demand::default() }
    }

    /// All maps, once.
    fn maps(&self) -> u64 {
        self.map_texels.saturating_mul(self.views).saturating_mul(NUMBER)
    }

    fn visibility(&self) -> u64 {
        self.pixels.saturating_mul(self.lights).saturating_mul(NUMBER)
    }

    /// What measuring aliasing takes: a flag for each texel, and for each pixel and light its number three times, once where it is and twice where they are counted.
    fn aliasing(&self) -> Demand {
        const FLAGS_PER_BYTE: u64 = 8;
        let maps = self.map_texels.saturating_mul(self.views) / FLAGS_PER_BYTE;
        Demand { maps, frame: self.visibility().saturating_mul(3), ..Demand::default() }
    }

    /// The layers of a frame that are given back.
    fn layers(&self, request: Request) -> Demand {
        let if_asked = |is_asked: bool, bytes: u64| if is_asked { bytes } else { 0 };
        let frame = if_asked(request.camera, self.pixels * 2 * NUMBER)
            .saturating_add(if_asked(request.visibility, self.visibility()))
            .saturating_add(if_asked(request.color, self.pixels * COLOR));
        Demand { maps: if_asked(request.shadow_maps, self.maps()), frame, ..Demand::default() }
    }

    /// What a backend has while it renders, beyond the layers that it gives back.
    fn working(&self, backend: Backend, request: Request) -> Demand {
        let all_stages = self.pixels.saturating_mul(2 * NUMBER + COLOR).saturating_add(self.visibility());
        match backend {
            // The buffers become the layers, but for visibility, whose layers are copies.
            Backend::Cpu => {
                let moved = self.layers(Request { visibility: false, ..request });
                Demand {
                    meshes: self.vertices * CPU_VERTEX + self.triangles * CPU_TRIANGLE,
                    textures: self.texels * TEXEL,
                    maps: self.maps().saturating_sub(moved.maps),
                    frame: all_stages.saturating_sub(moved.frame),
                }
            }
            // What is seen and how many samples of each light stay while colours are made, which the CPU renderer's form of the scene is for.
            Backend::Trace => Demand {
                meshes: self.vertices * CPU_VERTEX + self.triangles * TRACE_TRIANGLE,
                textures: 2 * self.texels * TEXEL,
                maps: 0,
                frame: self.pixels.saturating_mul(SEEN + NUMBER).saturating_add(self.visibility().saturating_mul(2)),
            },
            // Everything is in the adapter's memory, which may be the system's. A layer is read back through two buffers, and
            // visibility is then sorted by light. The scene is laid out and staged to be brought there.
            Backend::Gpu => {
                let read = self.layers(request);
                let map_read = if read.maps > 0 { 2 * self.map_texels * NUMBER } else { 0 };
                Demand {
                    meshes: self.vertices * GPU_VERTEX + self.triangles * GPU_TRIANGLE,
                    textures: 3 * self.texels * TEXEL,
                    maps: self.maps().saturating_add(map_read),
                    frame: all_stages.saturating_add(read.frame.saturating_mul(2)),
                }
            }
        }
    }

    /// What a command has at once.
    fn of_work(&self, work: Work<'_>) -> Demand {
        let rendering = match work {
            Work::Render(backend, layer, format) => {
                let request = crate::resolve::request_for(layer);
                // PNG has a byte a channel; of EXR the encoder takes four of them, with three or four channels.
                let written = match (format, layer) {
                    (Format::Png, _) => 3,
                    (Format::Exr, LayerName::Color) => COLOR,
                    (Format::Exr, _) => 3 * NUMBER,
                };
                let written = match layer {
                    LayerName::ShadowMap { .. } => Demand { maps: self.map_texels * written, ..Demand::default() },
                    _ => Demand { frame: self.pixels * written, ..Demand::default() },
                };
                self.working(backend, request).plus(self.layers(request)).plus(written)
            }
            // Some views draw the colours a second time.
            Work::Explain(backend) => {
                let pictures = Demand { frame: self.pixels.saturating_mul(3 + COLOR), ..Demand::default() };
                self.working(backend, Request::ALL).plus(self.layers(Request::ALL)).plus(pictures).plus(self.aliasing())
            }
            Work::Compare([first, second]) => {
                let layers = self.layers(Request::ALL);
                let working = self.working(first, Request::ALL).max(self.working(second, Request::ALL));
                let judged =
                    Demand { maps: self.map_texels * COMPARED_TEXEL, frame: self.pixels * COMPARED_PIXEL, ..Demand::default() };
                layers.plus(layers).plus(working.max(judged))
            }
            Work::Measure(backend, techniques) => {
                let rendered = self.working(backend, Request::ALL).plus(self.layers(Request::ALL));
                // The scene stays once more under lights that move, and the maps of one moment while those of another are drawn. For each light a pixel has
                // its truth (a count and a flag), and in each frame that stays a visibility, a cause, an error and a stretch.
                let of_frame = self.layers(Request { shadow_maps: false, ..Request::ALL }).frame;
                let judged = self.pixels.saturating_mul(self.lights).saturating_mul(1 + NUMBER);
                let frames = of_frame.saturating_add(judged).saturating_add(self.visibility()).saturating_mul(techniques as u64);
                let kept = Demand { maps: self.maps(), frame: frames.saturating_add(judged), ..self.scene() };
                rendered.plus(self.working(Backend::Trace, Request::ALL)).plus(kept).plus(self.aliasing())
            }
            Work::Bench(backends) => {
                let working = backends.iter().map(|&backend| self.working(backend, Request::default()));
                working.fold(Demand::default(), Demand::plus)
            }
        };
        self.scene().plus(rendering)
    }
}

/// Refuses a job that would take more memory than the limit, or more than the system would give.
pub(crate) fn check(job: &Job, work: Work<'_>) -> Result<(), CliError> {
    check_plan(job, &job.plan, work)
}

/// The same for another plan of the job's scene.
pub(crate) fn check_plan(job: &Job, plan: &FramePlan, work: Work<'_>) -> Result<(), CliError> {
    let demand = Amounts::of(job, plan).of_work(work);
    // The light's view has a pixel for each texel.
    let is_of_texels = plan.camera.width != job.plan.camera.width || plan.camera.height != job.plan.camera.height;
    let needed = demand.total();
    if needed > job.limit.bytes {
        let parts = parts_text(job, plan, demand);
        let way_out = way_out(demand, is_of_texels);
        return Err(CliError::TooMuchMemory { scene: job.scene_name.clone(), needed, limit: job.limit, parts, way_out });
    }
    // Reserving asks the system without touching the memory; where it refuses, a later allocation would have ended the program.
    let reserved = usize::try_from(needed).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if reserved {
        return Ok(());
    }
    Err(CliError::OutOfMemory {
        scene: job.scene_name.clone(),
        needed,
        parts: parts_text(job, plan, demand),
        way_out: way_out(demand, is_of_texels),
    })
}

/// Whether the camera's pass before a plan fits, with the scene and the points that it gives.
pub(crate) fn check_feedback(scene_name: &str, scene: &Scene, limit: Limit, (width, height): (u32, u32)) -> Result<(), CliError> {
    /// Bytes a pixel: its triangle and depth, and the point that it shows.
    const PIXEL: u64 = 4 + 4 + 12;
    let frame = u64::from(width) * u64::from(height) * PIXEL;
    let meshes = (scene.vertices().positions.len() * 12 + scene.triangles().len() * 12) as u64;
    let needed = frame + meshes;
    if needed <= limit.bytes {
        return Ok(());
    }
    let parts = format!("the camera's pass before the plan {}, meshes {}", bytes_text(frame), bytes_text(meshes));
    let way_out = "choose a smaller --size, fit to the frustum (--fit-from) or name the plane (--plane)";
    Err(CliError::TooMuchMemory { scene: scene_name.into(), needed, limit, parts, way_out })
}

/// The parts from the largest on, with what makes them as large as they are.
fn parts_text(job: &Job, plan: &FramePlan, demand: Demand) -> String {
    let size = plan.map_size;
    let mut parts = [
        (demand.meshes, format!("meshes {} ({})", bytes_text(demand.meshes), count(job.scene.triangles().len(), "triangle"))),
        (demand.textures, format!("textures {} ({})", bytes_text(demand.textures), count(job.scene.images().len(), "image"))),
        (demand.maps, format!("shadow maps {} ({} of {size} x {size} texels)", bytes_text(demand.maps), plan.layer_count())),
        (
            demand.frame,
            format!(
                "frame {} ({} x {} pixels, {})",
                bytes_text(demand.frame),
                plan.camera.width,
                plan.camera.height,
                count(plan.lights.len(), "light")
            ),
        ),
    ];
    parts.sort_by_key(|(bytes, _)| std::cmp::Reverse(*bytes));
    parts.map(|(_, text)| text).join(", ")
}

/// What to do about the largest part. `is_of_texels` says that the picture is as large as a map.
fn way_out(demand: Demand, is_of_texels: bool) -> &'static str {
    let Demand { meshes, textures, maps, frame } = demand;
    let choices = [
        (meshes, "use a scene of fewer triangles"),
        (textures, "use a scene of smaller textures"),
        (maps, "choose a smaller --map-size or fewer lights"),
        (frame, if is_of_texels { "choose a smaller --map-size" } else { "choose a smaller --size or fewer lights" }),
    ];
    choices.into_iter().max_by_key(|(bytes, _)| *bytes).map_or("", |(_, choice)| choice)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIB: u64 = 1 << 30;

    /// One map of 1 GiB, a picture of 1 Mi pixels and a light; no scene.
    const AMOUNTS: Amounts =
        Amounts { vertices: 0, triangles: 0, texels: 0, views: 1, map_texels: GIB / 4, pixels: 1 << 20, lights: 1 };

    #[test]
    fn backends_hold_as_many_maps_as_they_do() {
        let maps = |work: Work<'_>| AMOUNTS.of_work(work).maps as f64 / GIB as f64;
        assert_eq!(maps(Work::Render(Backend::Cpu, LayerName::Color, Format::Png)), 1.0);
        assert_eq!(maps(Work::Render(Backend::Gpu, LayerName::Color, Format::Png)), 1.0);
        let map = LayerName::ShadowMap { light: 0, view: 0 };
        // The map and its picture of three bytes a texel, or of three numbers.
        assert_eq!(maps(Work::Render(Backend::Cpu, map, Format::Png)), 1.75);
        assert_eq!(maps(Work::Render(Backend::Cpu, map, Format::Exr)), 4.0);
        // The adapter's, two buffers to read it back, the map and its picture.
        assert_eq!(maps(Work::Render(Backend::Gpu, map, Format::Png)), 4.75);
        assert_eq!(maps(Work::Bench(&[Backend::Cpu, Backend::Gpu])), 2.0);
        // Both frames' maps, and the larger of what rendering (the adapter's map and two buffers to read it) and judging take.
        assert_eq!(maps(Work::Compare([Backend::Cpu, Backend::Gpu])), 2.0 + 3.0);
    }

    #[test]
    fn frames_count_every_buffer_once() {
        let frame = |work: Work<'_>| AMOUNTS.of_work(work).frame / AMOUNTS.pixels;
        // Triangle and depth, visibility, colour, and three bytes of the picture.
        assert_eq!(frame(Work::Render(Backend::Cpu, LayerName::Color, Format::Png)), 8 + 4 + 16 + 3);
        // On the adapter, through two buffers, and the colour itself.
        assert_eq!(frame(Work::Render(Backend::Gpu, LayerName::Color, Format::Png)), 28 + 2 * 16 + 16 + 3);
        assert_eq!(frame(Work::Bench(&[Backend::Cpu])), 28);
    }

    #[test]
    fn scenes_count_with_the_backends_copies() {
        let amounts = Amounts { vertices: 10, triangles: 100, texels: 1000, ..AMOUNTS };
        let demand = amounts.of_work(Work::Bench(&[Backend::Cpu]));
        assert_eq!((demand.meshes, demand.textures), (10 * (52 + 68) + 100 * (20 + 124), 8000));
    }

    #[test]
    fn amounts_beyond_every_machine_do_not_overflow() {
        let huge = Amounts { views: u64::MAX, lights: u64::MAX, ..AMOUNTS };
        assert_eq!(huge.of_work(Work::Compare([Backend::Gpu, Backend::Cpu])).total(), u64::MAX);
    }

    #[test]
    fn the_limit_says_where_it_comes_from() {
        assert_eq!(Limit::new(Some(ByteSize(6 * GIB))).to_string(), "6.00 GiB (--memory-limit)");
        let default = Limit::new(None);
        assert!(default.bytes > 0 && !default.to_string().contains("--memory-limit"), "{default}");
    }

    #[test]
    fn the_way_out_is_that_of_the_largest_part() {
        assert!(way_out(Demand { maps: 2, frame: 1, ..Demand::default() }, false).contains("--map-size"));
        assert!(way_out(Demand { maps: 1, frame: 2, ..Demand::default() }, false).contains("--size"));
        assert!(way_out(Demand { maps: 1, frame: 2, ..Demand::default() }, true).contains("--map-size"));
        assert!(way_out(Demand { textures: 2, frame: 1, ..Demand::default() }, false).contains("textures"));
        assert!(way_out(Demand { meshes: 2, frame: 1, ..Demand::default() }, false).contains("triangles"));
    }
}
