//! Draws the pictures of the README: `cargo run --release -p shadow-tests --example pictures`.

use std::{error::Error, path::Path};

use shadow_cpu::{CpuRenderer, RasterRules};
use shadow_gpu::GpuRenderer;
use shadow_math::{ShadowSettings, srgb::encode_pixel};
use shadow_scene::{Frame, FramePlan, LayerName, Request, builtin};

/// Differences are multiplied by this to be seen.
const AMPLIFICATION: f32 = 8.0;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/images");
    let scene = builtin::demo();
    let (width, height) = (960, 540);
    let plan = FramePlan::new(&scene, &scene.cameras()[0].camera, &ShadowSettings::default(), width, height, None)?;
    let on_cpu = |rules: RasterRules| -> Result<Frame, Box<dyn Error>> {
        let renderer = CpuRenderer::new(0, rules)?;
        Ok(renderer.render(&renderer.prepare(&scene), &plan, Request::ALL)?.frame)
    };
    let cpu = on_cpu(RasterRules::default())?;
    let coarse = on_cpu(RasterRules { subpixel_bits: 4, ..RasterRules::default() })?;
    let gpu = pollster::block_on(async {
        let renderer = GpuRenderer::new(None).await?;
        let uploaded = renderer.upload(&scene).await?;
        Ok::<_, shadow_gpu::GpuError>(renderer.render(&uploaded, &plan, Request::ALL).await?.frame)
    })?;

    let save = |name: &str, pixel: &dyn Fn(usize) -> [u8; 3]| {
        let picture = image::RgbImage::from_fn(width, height, |x, y| image::Rgb(pixel((y * width + x) as usize)));
        picture.save(folder.join(name))
    };
    let color = |frame: &Frame, i: usize| frame.color().map_or([0.0; 4], |pixels| pixels[i]);
    let difference = |a: &Frame, b: &Frame, i: usize| {
        let channel = |c: usize| {
            let light = LayerName::Visibility { light: 0 };
            let visibility = a.floats(light).zip(b.floats(light)).map_or(0.0, |(a, b)| (a[i] - b[i]).abs());
            let other_triangle = f32::from(u8::from(a.triangles().map(|ids| ids[i]) != b.triangles().map(|ids| ids[i])));
            let color = (color(a, i)[c] - color(b, i)[c]).abs();
            ((color + visibility + other_triangle) * AMPLIFICATION).min(1.0)
        };
        [channel(0), channel(1), channel(2)].map(|value| (value * 255.0) as u8)
    };
    save("demo.png", &|i| {
        let [r, g, b, _] = encode_pixel(color(&cpu, i).into());
        [r, g, b]
    })?;
    save("demo-difference.png", &|i| difference(&cpu, &gpu, i))?;
    save("one-rule-difference.png", &|i| difference(&cpu, &coarse, i))?;
    Ok(())
}
