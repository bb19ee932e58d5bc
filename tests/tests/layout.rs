//! What WGSL repeats of Rust's data: every struct's layout, every constant, and the files themselves, read with naga.
//!
//! A struct or constant that only one side has fails a test here, so nothing has to be "kept in sync" by hand.

use std::{collections::BTreeSet, fs, mem::offset_of, path::Path};

use naga::{
    ArraySize, Expression, Handle, Literal, Module, ScalarKind, Type, TypeInner, VectorSize,
    proc::Layouter,
    valid::{Capabilities, ValidationFlags, Validator},
};
use shadow_gpu::shaders::{
    ALL, CAMERA_MODULE, COLOR_MODULE, PROBE_COMPARE_MODULE, PROBE_DRAW_MODULE, PROBE_READ_MODULE, READBACK_ID_MODULE,
    READBACK_MODULE, SHADOW_MAP_MODULE, ShaderFile, TABLE_WIDTH_BITS, VISIBILITY_MODULE, join,
};
use shadow_math::{
    bias::{GRADIENT_MARGIN, GRADIENT_ROUNDING, MAX_DEPTH_BIAS, OFFSET_SLOPE},
    caster::{CASTER_OGRE_2006, CASTER_OGRE_2006_CORRECTED, CASTER_PLAIN, CASTER_POLYGON_OFFSET, MAX_CASTER_SLOPE},
    depth::{DEPTH_LINEAR, DEPTH_REVERSED, DEPTH_Z_OVER_W, LAYER_FIRST, LAYER_MIDPOINT, LAYER_SECOND},
    filter::{
        FOOTPRINT_TESTS_PER_TEXEL, MAX_FOOTPRINT_TESTS,
        turn::{DITHER, TURNS},
    },
    material::{
        ALPHA_TABLE, DECODE_TABLE_LEN, FLAG_DOUBLE_SIDED, FLAG_MASK, MAX_TEXEL_COORDINATE, MaterialData, NO_TEXTURE, TextureData,
        WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT,
    },
    plan::{
        BIAS_AUTOMATIC, BIAS_BACK_FACES, BIAS_CONSTANT, BIAS_NONE, BIAS_NORMAL_OFFSET, BIAS_OGRE_2006, BIAS_POLYGON_OFFSET,
        BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, BIAS_SLOPE, COMPOSE_ADDITIVE, COMPOSE_FACTOR, COMPOSE_MODULATIVE,
        COMPOSE_UNSHADOWED, CameraPlan, FILTER_BILINEAR, FILTER_CROSS, FILTER_DISC, FILTER_FOOTPRINT, FILTER_HARD,
        FILTER_SEPARABLE, LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT, LightPlan, PixelRays, SELECT_BY_CONTAINMENT,
        SELECT_BY_DEPTH, SPLIT_CASCADES, SPLIT_CUBE, SPLIT_SINGLE, TERMINATOR_HARD, TERMINATOR_SOFT, ViewPlan,
    },
    shade::{INVERSE_PI, MIN_HIGHLIGHT, SPECULAR_REFLECTANCE, SPECULAR_SCALE},
    srgb::LINEAR_LIMIT,
    visibility::NO_VIEW,
};
use shadow_tests::mirror::MIRRORS;

/// Every module that the renderer makes of the files.
const MODULES: &[(&str, &[ShaderFile])] = &[
    ("shadow map", SHADOW_MAP_MODULE),
    ("camera", CAMERA_MODULE),
    ("visibility", VISIBILITY_MODULE),
    ("color", COLOR_MODULE),
    ("readback", READBACK_MODULE),
    ("readback id", READBACK_ID_MODULE),
    ("probe, drawing", PROBE_DRAW_MODULE),
    ("probe, reading", PROBE_READ_MODULE),
    ("probe, comparing", PROBE_COMPARE_MODULE),
];

/// Files that no module of the renderer needs, and why they are there.
const UNUSED_FILES: &[(&str, &str)] = &[("srgb", "for whoever shows the picture: the renderer's own colours stay linear")];

/// Structs in buffers whose Rust side is no struct, and why.
const PLAIN_STRUCTS: &[(&str, &str)] = &[("ReadbackLayer", "one word that shadow-gpu writes by itself")];

/// A struct of Rust as WGSL must have it.
#[derive(Debug)]
struct Layout {
    name: &'static str,
    size: usize,
    members: Vec<Member>,
}

#[derive(Debug, PartialEq)]
struct Member {
    name: String,
    shape: String,
    offset: usize,
    size: usize,
}

/// A type that a member has on both sides.
trait Shape {
    /// WGSL's name of it.
    const NAME: &'static str;
}

macro_rules! shapes {
    ($($rust:ty = $name:literal),* $(,)?) => {
        $(impl Shape for $rust {
            const NAME: &'static str = $name;
        })*
    };
}

shapes! {
    [[f32; 4]; 2] = "array<vec4<f32>, 2>",
    [[f32; 4]; 8] = "array<vec4<f32>, 8>",
    f32 = "f32",
    u32 = "u32",
    [f32; 2] = "vec2<f32>",
    [f32; 3] = "vec3<f32>",
    [f32; 4] = "vec4<f32>",
    [u32; 4] = "vec4<u32>",
    PixelRays = "PixelRays",
    TextureData = "TextureData",
}

/// The shape and size of the member that the function reads.
fn shape_of<S, T: Shape>(_: fn(&S) -> &T) -> (&'static str, usize) {
    (T::NAME, size_of::<T>())
}

/// The layout of a Rust struct. A member that is left out or does not exist fails to compile.
macro_rules! layout {
    ($rust:ident { $($member:ident $(as $renamed:ident)?),* $(,)? }) => {{
        // Names every member, without `..`.
        let _all = |$rust { $($member: _),* }: $rust| {};
        Layout {
            name: stringify!($rust),
            size: size_of::<$rust>(),
            members: vec![$({
                let (shape, size) = shape_of(|value: &$rust| &value.$member);
                let name = [stringify!($member), $(stringify!($renamed))?].last().unwrap_or(&"").to_string();
                Member { name, shape: shape.to_string(), offset: offset_of!($rust, $member), size }
            }),*],
        }
    }};
}

/// Every struct that Rust writes and WGSL reads.
fn layouts() -> Vec<Layout> {
    vec![
        layout!(PixelRays { origin, origin_dx, origin_dy, direction, direction_dx, direction_dy }),
        layout!(CameraPlan {
            clip_x,
            clip_y,
            clip_z,
            clip_w,
            rays,
            ambient,
            exposure,
            width,
            height,
            light_count,
            first_light,
            shadow_color,
            composition
        }),
        layout!(LightPlan {
            position,
            kind,
            intensity,
            inverse_range,
            axis,
            cone_scale,
            cone_offset,
            first_view,
            view_count,
            split,
            bias,
            bias_metres,
            slope_scale,
            // `filter` is a reserved word in WGSL.
            filter as filter_kind,
            filter_taps,
            filter_reach,
            filter_total,
            normal_texels,
            plane_metres,
            gradient_fixed,
            gradient_clamp,
            gradient_scale,
            terminator,
            texel_shift,
            picture_first_word,
            picture_width,
            picture_x,
            picture_y,
            picture_w,
            picture_height,
            selection,
            guard_texels,
            shadow_far,
            view_distance,
            split_far,
            split_band,
            filter_table,
        }),
        layout!(ViewPlan {
            clip_x,
            clip_y,
            clip_z,
            clip_w,
            world_from_texel_x,
            world_from_texel_y,
            world_from_depth,
            rays,
            texel_scale,
            texel_offset,
            rounding_texels,
            rounding_depth,
            depth_factor,
            w_per_metre,
            depth_range,
            texel_metres,
            layer,
            depth_kind,
            depth_layer,
            depth_steps,
            range_over_near,
            rounding_metres,
            linear_scale,
            linear_offset,
            caster_kind,
            caster_slope,
            caster_units,
            caster_limit,
            caster_asymptote,
            caster_push,
            snap_texels,
            is_warped,
            fit_outcome,
            drawn_scale,
            drawn_z,
            drawn_offset,
            farthest_w,
            padding_0,
            padding_1,
            distance,
            half_space,
            rect,
        }),
        layout!(TextureData { first_word, width, height, wrap_u, wrap_v }),
        layout!(MaterialData { base_color, alpha_cutoff, flags, shininess, texture }),
    ]
}

/// The bits of a constant, component by component.
trait Bits {
    fn bits(&self) -> Vec<u32>;
}

impl Bits for u32 {
    fn bits(&self) -> Vec<u32> {
        vec![*self]
    }
}

impl Bits for f32 {
    fn bits(&self) -> Vec<u32> {
        vec![self.to_bits()]
    }
}

impl Bits for [f32; 3] {
    fn bits(&self) -> Vec<u32> {
        self.iter().map(|x| x.to_bits()).collect()
    }
}

impl<const N: usize> Bits for [[f32; 2]; N] {
    fn bits(&self) -> Vec<u32> {
        self.as_flattened().iter().map(|x| x.to_bits()).collect()
    }
}

impl Bits for [u32; 16] {
    fn bits(&self) -> Vec<u32> {
        self.to_vec()
    }
}

macro_rules! constants {
    ($($name:ident),* $(,)?) => { vec![$((stringify!($name), $name.bits())),*] };
}

/// Every constant that WGSL repeats, and its bits in Rust.
fn constants() -> Vec<(&'static str, Vec<u32>)> {
    // What `depth_gradient` of shadow-math gives for a plane that is seen edge-on.
    const MAX_GRADIENT: f32 = f32::MAX;
    // What `support` takes for too much.
    const MAX_FLOAT: f32 = f32::MAX;
    // The sides of a footprint where there is none.
    const NO_FOOTPRINT: [[f32; 2]; 2] = [[0.0; 2]; 2];
    constants![
        LIGHT_DIRECTIONAL,
        LIGHT_SPOT,
        LIGHT_POINT,
        SPLIT_SINGLE,
        SPLIT_CUBE,
        SPLIT_CASCADES,
        SELECT_BY_DEPTH,
        SELECT_BY_CONTAINMENT,
        BIAS_NONE,
        BIAS_CONSTANT,
        BIAS_SLOPE,
        BIAS_AUTOMATIC,
        BIAS_NORMAL_OFFSET,
        BIAS_RECEIVER_PLANE,
        BIAS_RECEIVER_GRADIENT,
        BIAS_BACK_FACES,
        BIAS_POLYGON_OFFSET,
        BIAS_OGRE_2006,
        CASTER_OGRE_2006,
        COMPOSE_ADDITIVE,
        COMPOSE_FACTOR,
        COMPOSE_MODULATIVE,
        COMPOSE_UNSHADOWED,
        CASTER_OGRE_2006_CORRECTED,
        CASTER_PLAIN,
        CASTER_POLYGON_OFFSET,
        DEPTH_LINEAR,
        DEPTH_REVERSED,
        DEPTH_Z_OVER_W,
        LAYER_FIRST,
        LAYER_MIDPOINT,
        LAYER_SECOND,
        MAX_CASTER_SLOPE,
        TERMINATOR_HARD,
        TERMINATOR_SOFT,
        FILTER_HARD,
        FILTER_BILINEAR,
        FILTER_SEPARABLE,
        FILTER_CROSS,
        FILTER_DISC,
        FILTER_FOOTPRINT,
        MAX_FOOTPRINT_TESTS,
        FOOTPRINT_TESTS_PER_TEXEL,
        MAX_FLOAT,
        TURNS,
        DITHER,
        NO_FOOTPRINT,
        MAX_DEPTH_BIAS,
        MAX_GRADIENT,
        NO_VIEW,
        NO_TEXTURE,
        FLAG_MASK,
        FLAG_DOUBLE_SIDED,
        WRAP_REPEAT,
        WRAP_CLAMP,
        WRAP_MIRROR,
        DECODE_TABLE_LEN,
        ALPHA_TABLE,
        INVERSE_PI,
        SPECULAR_REFLECTANCE,
        SPECULAR_SCALE,
        MIN_HIGHLIGHT,
        GRADIENT_MARGIN,
        GRADIENT_ROUNDING,
        OFFSET_SLOPE,
        MAX_TEXEL_COORDINATE,
        LINEAR_LIMIT,
        TABLE_WIDTH_BITS,
    ]
}

fn parse(name: &str, source: &str) -> Module {
    naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("the {name} module: {}", error.emit_to_string(source)))
}

/// The modules, and one of all mirrors: some of their functions are in none of the renderer's modules.
fn modules() -> Vec<(&'static str, Module)> {
    let mut modules: Vec<_> = MODULES.iter().map(|(name, files)| (*name, parse(name, &join(files)))).collect();
    modules.push(("mirrors", parse("mirrors", &mirrors_source())));
    modules
}

/// The mirrors with what they expect around them.
fn mirrors_source() -> String {
    format!(
        "{}
        @group(0) @binding(0) var<storage, read> lights: array<LightPlan>;
        @group(0) @binding(1) var<storage, read> views: array<ViewPlan>;
        @group(0) @binding(2) var<storage, read> materials: array<MaterialData>;
        @group(0) @binding(3) var<storage, read> words: array<u32>;
        fn fetch_word(index: u32) -> u32 {{ return words[index]; }}
        fn decoded(byte: u32) -> f32 {{ return bitcast<f32>(words[byte]); }}
        fn decoded_alpha(byte: u32) -> f32 {{ return bitcast<f32>(words[ALPHA_TABLE + byte]); }}
        fn fetch_material(material: u32) -> MaterialData {{ return materials[material]; }}
        fn filter_kind(light: u32) -> u32 {{ return lights[light].filter_kind; }}
        fn bias_kind(light: u32) -> u32 {{ return lights[light].bias; }}
        fn depth_kind(view: u32) -> u32 {{ return views[view].depth_kind; }}
        fn is_warped(view: u32) -> u32 {{ return views[view].is_warped; }}
        fn blends_views(light: u32) -> bool {{ return true; }}
        fn fetch_texel(layer: u32, x: u32, y: u32) -> f32 {{ return 1.0; }}",
        join(MIRRORS)
    )
}

/// WGSL's name of a type.
fn shape_name(module: &Module, handle: Handle<Type>) -> String {
    let ty = &module.types[handle];
    let kind = |kind| match kind {
        ScalarKind::Float => "f32",
        ScalarKind::Uint => "u32",
        ScalarKind::Sint => "i32",
        _ => "other",
    };
    match (&ty.name, &ty.inner) {
        (_, TypeInner::Scalar(scalar)) => kind(scalar.kind).to_string(),
        (_, TypeInner::Vector { size, scalar }) => {
            let size = match size {
                VectorSize::Bi => 2,
                VectorSize::Tri => 3,
                VectorSize::Quad => 4,
            };
            format!("vec{size}<{}>", kind(scalar.kind))
        }
        (None, TypeInner::Array { base, size: ArraySize::Constant(count), .. }) => {
            format!("array<{}, {count}>", shape_name(module, *base))
        }
        (Some(name), _) => name.clone(),
        (None, inner) => format!("{inner:?}"),
    }
}

/// The size and members of a WGSL struct; `None` where the module has no such struct.
fn wgsl_struct(module: &Module, name: &str) -> Option<(usize, Vec<Member>)> {
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).expect("every type has a layout");
    module.types.iter().find_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } if ty.name.as_deref() == Some(name) => {
            let members = members.iter().map(|member| Member {
                name: member.name.clone().unwrap_or_default(),
                shape: shape_name(module, member.ty),
                offset: member.offset as usize,
                size: layouter[member.ty].size as usize,
            });
            Some((*span as usize, members.collect()))
        }
        _ => None,
    })
}

/// What is different between a struct of Rust and one of WGSL.
fn compare_layout(rust: &Layout, size: usize, members: &[Member]) -> Vec<String> {
    let mut problems = Vec::new();
    if rust.size != size {
        problems.push(format!("{} has {} bytes in Rust and {size} in WGSL", rust.name, rust.size));
    }
    if rust.members.len() != members.len() {
        problems.push(format!("{} has {} members in Rust and {} in WGSL", rust.name, rust.members.len(), members.len()));
    }
    for (expected, actual) in rust.members.iter().zip(members) {
        if expected != actual {
            problems.push(format!("{} has {expected:?} in Rust and {actual:?} in WGSL", rust.name));
        }
    }
    problems
}

/// The value of a constant expression, component by component.
fn bits_of(module: &Module, handle: Handle<Expression>) -> Option<Vec<u32>> {
    match &module.global_expressions[handle] {
        Expression::Literal(Literal::F32(x)) => Some(vec![x.to_bits()]),
        Expression::Literal(Literal::U32(x)) => Some(vec![*x]),
        Expression::Constant(constant) => bits_of(module, module.constants[*constant].init),
        Expression::Compose { components, .. } => {
            let components: Option<Vec<_>> = components.iter().map(|component| bits_of(module, *component)).collect();
            Some(components?.concat())
        }
        Expression::Splat { size, value } => Some(bits_of(module, *value)?.repeat(*size as usize)),
        _ => None,
    }
}

#[test]
fn every_module_is_valid() {
    for (name, module) in modules() {
        // No capability beyond what WebGPU has everywhere.
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        if let Err(error) = validator.validate(&module) {
            panic!("the {name} module: {error:?}");
        }
        assert!(module.entry_points.is_empty() == (name == "mirrors"), "the {name} module's entry points");
    }
}

/// Offsets, sizes, shapes, names and order of every member.
#[test]
fn structs_have_the_same_layout() {
    let modules = modules();
    for rust in layouts() {
        let mut seen = false;
        for (name, module) in &modules {
            if let Some((size, members)) = wgsl_struct(module, rust.name) {
                seen = true;
                let problems = compare_layout(&rust, size, &members);
                assert!(problems.is_empty(), "the {name} module: {}", problems.join("\n"));
            }
        }
        assert!(seen, "no module has the struct {}", rust.name);
    }
}

/// Every struct in a buffer is one of those that are compared.
#[test]
fn no_struct_in_a_buffer_is_left_out() {
    let layouts = layouts();
    let mut plain_seen = BTreeSet::new();
    for (name, module) in modules() {
        let mut waiting: Vec<_> = module.global_variables.iter().map(|(_, variable)| variable.ty).collect();
        while let Some(ty) = waiting.pop() {
            match &module.types[ty].inner {
                TypeInner::Array { base, .. } => waiting.push(*base),
                TypeInner::Struct { members, .. } => {
                    waiting.extend(members.iter().map(|member| member.ty));
                    let struct_name = module.types[ty].name.clone().unwrap_or_default();
                    let plain = PLAIN_STRUCTS.iter().any(|(plain, _)| *plain == struct_name);
                    let compared = layouts.iter().any(|layout| layout.name == struct_name);
                    assert!(plain || compared, "the {name} module: nothing compares the struct {struct_name} with Rust");
                    if plain {
                        plain_seen.insert(struct_name);
                    }
                }
                _ => {}
            }
        }
    }
    for (plain, reason) in PLAIN_STRUCTS {
        assert!(plain_seen.contains(*plain) && !reason.is_empty(), "{plain} is excepted but is in no buffer");
    }
}

/// Bit for bit, and none left out: a constant that is new in WGSL needs a twin here.
#[test]
fn constants_have_the_same_bits() {
    let constants = constants();
    let mut seen = BTreeSet::new();
    for (name, module) in modules() {
        for (_, constant) in module.constants.iter() {
            let Some(constant_name) = &constant.name else { continue };
            let bits = bits_of(&module, constant.init)
                .unwrap_or_else(|| panic!("the {name} module: {constant_name} is no number that this test can read"));
            let Some((_, expected)) = constants.iter().find(|(known, _)| known == constant_name) else {
                panic!("the {name} module: nothing compares the constant {constant_name} with Rust");
            };
            assert_eq!(&bits, expected, "the {name} module: the bits of {constant_name}, WGSL's first");
            seen.insert(constant_name.clone());
        }
    }
    for (name, _) in constants {
        assert!(seen.contains(name), "no module has the constant {name}");
    }
}

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The folder, the list and the modules hold the same files.
#[test]
fn every_file_is_listed_and_used() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shadow-gpu/src/shaders");
    let mut stems = BTreeSet::new();
    for entry in fs::read_dir(&folder).expect("the shaders are there") {
        let path = entry.expect("the folder can be read").path();
        assert_eq!(path.extension().and_then(|e| e.to_str()), Some("wgsl"), "{} is no shader", path.display());
        stems.insert(path.file_stem().unwrap_or_default().to_string_lossy().into_owned());
    }
    let listed: BTreeSet<_> = ALL.iter().map(|file| file.stem.to_string()).collect();
    assert_eq!(stems, listed, "the files in {}, and those that `shaders::ALL` lists", folder.display());
    assert_eq!(listed.len(), ALL.len(), "`shaders::ALL` lists a file twice");
    let used = |stem: &str| MODULES.iter().any(|(_, files)| files.iter().any(|file| file.stem == stem));
    for stem in &listed {
        let excepted = UNUSED_FILES.iter().any(|(file, reason)| file == stem && !reason.is_empty());
        assert_eq!(used(stem), !excepted, "{stem}.wgsl is in no module, or is excepted although it is in one");
    }
    assert!(UNUSED_FILES.iter().all(|(file, _)| listed.contains(*file)), "an excepted file does not exist");
}

/// The Rust files that a shader's comments name, each with the item in it that is mirrored, if one is named.
fn named_twins(source: &str) -> Vec<(String, Option<String>)> {
    let mut twins = Vec::new();
    for comment in source.lines().filter_map(|line| line.strip_prefix("//")) {
        let words: Vec<_> = comment.split_whitespace().map(|word| word.trim_end_matches(['.', ',', ';', ':'])).collect();
        for (index, word) in words.iter().enumerate() {
            if word.ends_with(".rs") {
                let item = (index >= 2 && words[index - 1] == "of").then(|| words[index - 2]);
                twins.push((word.to_string(), item.map(|item| item.rsplit("::").next().unwrap_or(item).to_string())));
            }
        }
    }
    twins
}

/// Each mirror has a Rust module of its stem, or its first line names the file that it mirrors; what comments name exists.
#[test]
fn every_mirror_has_its_twin() {
    for file in MIRRORS {
        let first = file.source.lines().next().unwrap_or_default();
        let twins = named_twins(first);
        let named = twins.iter().any(|(path, _)| path.starts_with("shadow-math/src/"));
        assert!(named && first.contains("mirrors "), "{}.wgsl: the first line does not say what it mirrors", file.stem);
        let of_its_stem = twins.iter().any(|(path, _)| path.ends_with(&format!("/{}.rs", file.stem)));
        // The plan's data and the way to a light are in a submodule.
        let of_a_submodule =
            twins.iter().any(|(path, _)| path.starts_with("shadow-math/src/plan/") || path.starts_with("shadow-math/src/fit/"));
        assert!(of_its_stem || of_a_submodule, "{}.wgsl mirrors no Rust file of its stem", file.stem);
    }
    for file in ALL {
        for (path, item) in named_twins(file.source) {
            let rust = read(&path);
            if let Some(item) = item {
                let declared = ["fn", "struct"].iter().any(|keyword| {
                    let declaration = format!("{keyword} {item}");
                    rust.match_indices(&declaration)
                        .any(|(at, _)| !rust[at + declaration.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_'))
                });
                assert!(declared, "{}.wgsl mirrors {item} of {path}, which is not there", file.stem);
            }
        }
    }
}

/// The Rust modules that say which shader mirrors them are right.
#[test]
fn every_shader_that_rust_names_exists() {
    let mut count = 0;
    for (path, source) in rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../shadow-math/src")) {
        for rest in source.split("irrored by `").skip(1) {
            let name = rest.split('`').next().unwrap_or_default();
            assert!(ALL.iter().any(|file| format!("{}.wgsl", file.stem) == name), "{path}: there is no shader {name}");
            count += 1;
        }
    }
    assert!(count >= 8, "only {count} modules say that they are mirrored");
}

fn rust_files(folder: &Path) -> Vec<(String, String)> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("the sources are there") {
        let path = entry.expect("the folder can be read").path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push((path.display().to_string(), fs::read_to_string(&path).expect("the file can be read")));
        }
    }
    files
}

/// The comparison of layouts sees what can be wrong with one.
#[test]
fn a_different_layout_is_seen() {
    let layouts = layouts();
    let rust = layouts.iter().find(|layout| layout.name == "TextureData").expect("it is in the list");
    let compare = |source: &str| {
        let (size, members) = wgsl_struct(&parse("test", source), "TextureData").expect("the struct is there");
        compare_layout(rust, size, &members)
    };
    let same = "struct TextureData { first_word: u32, width: u32, height: u32, wrap_u: u32, wrap_v: u32 }";
    assert!(compare(same).is_empty(), "the same layout is seen as different");
    let different = [
        ("another order", same.replace("wrap_u", "wrap").replace("wrap_v", "wrap_u").replace("wrap:", "wrap_v:")),
        ("a member more", same.replace(" }", ", depth: u32 }")),
        ("a member fewer", same.replace(", wrap_v: u32", "")),
        ("another type of the same size", same.replace("height: u32", "height: f32")),
        ("another name", same.replace("height", "rows")),
        ("another offset", same.replace("height: u32", "@align(16) height: u32")),
    ];
    for (what, source) in different {
        assert!(!compare(&source).is_empty(), "{what} is not seen");
    }
}

/// Constant expressions are evaluated, in f32 where they are f32.
#[test]
fn constants_are_read_as_numbers() {
    let module =
        parse("test", "const A: f32 = 0.1; const B: f32 = A * A * 3.0; const C = vec3f(B, 1.0, A); const D: u32 = 1u << 4u;");
    let read = |name: &str| {
        let (_, constant) =
            module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some(name)).expect("it is there");
        bits_of(&module, constant.init)
    };
    assert_eq!(read("B"), Some((0.1_f32 * 0.1 * 3.0).bits()));
    assert_eq!(read("C"), Some([0.1_f32 * 0.1 * 3.0, 1.0, 0.1].bits()));
    assert_eq!(read("D"), Some(16_u32.bits()));
}
