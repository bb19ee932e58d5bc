//! Materials: what of glTF's metallic-roughness model matters for shadows and for a plain picture.

use std::collections::HashMap;

use glam::{Affine2, Mat2, Vec2, Vec4};
use gltf::json::{
    material::AlphaMode,
    texture::{Info, WrappingMode},
    validation::Checked,
};

use super::{buffers::Buffers, document::Document, error::Result, images, notes::Notes, uri::Folder};
use crate::{
    builder::SceneBuilder,
    scene::{Alpha, Material, Texture, Wrap},
    source::SourceFacts,
};

/// Where the texture coordinates of a material's base colour come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UvSource {
    /// The number of the attribute TEXCOORD.
    pub(super) set: u32,
    /// From the attribute's coordinates to the texture's, both with v down (KHR_texture_transform).
    pub(super) transform: Affine2,
}

impl UvSource {
    /// The source of a material; `None` if it has no base colour texture.
    pub(super) fn of(document: &Document, material: usize) -> Result<Option<Self>> {
        Ok(BaseColor::of(document, material)?.texture.as_ref().map(Self::of_texture))
    }

    fn of_texture(info: &Info) -> Self {
        let Some(transform) = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref()) else {
            return Self { set: info.tex_coord, transform: Affine2::IDENTITY };
        };
        // Counter-clockwise for the viewer is clockwise in coordinates whose v points down, hence the sign.
        let turn = Mat2::from_angle(-transform.rotation.0);
        Self {
            set: transform.tex_coord.unwrap_or(info.tex_coord),
            transform: Affine2::from_mat2_translation(
                turn * Mat2::from_diagonal(Vec2::from_array(transform.scale.0)),
                Vec2::from_array(transform.offset.0),
            ),
        }
    }
}

/// What colours a surface.
#[derive(Clone, Debug)]
struct BaseColor {
    factor: [f32; 4],
    texture: Option<Info>,
    roughness: f32,
}

/// What KHR_materials_pbrSpecularGlossiness has in place of metal and roughness; its specular colour is left out.
#[derive(serde::Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct SpecularGlossiness {
    diffuse_factor: [f32; 4],
    diffuse_texture: Option<Info>,
    glossiness_factor: f32,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self { diffuse_factor: [1.0; 4], diffuse_texture: None, glossiness_factor: 1.0 }
    }
}

impl BaseColor {
    /// That of a material: its diffuse colour, if it has the extension for that.
    fn of(document: &Document, material: usize) -> Result<Self> {
        const EXTENSION: &str = "KHR_materials_pbrSpecularGlossiness";
        // `Document` guarantees the index.
        let root = &document.root;
        let Some(extension) = document.material_extension(material, EXTENSION) else {
            let pbr = &root.materials[material].pbr_metallic_roughness;
            return Ok(Self {
                factor: pbr.base_color_factor.0,
                texture: pbr.base_color_texture.clone(),
                roughness: pbr.roughness_factor.0,
            });
        };
        let place = format!("materials[{material}].extensions.{EXTENSION}");
        let read: SpecularGlossiness = serde::Deserialize::deserialize(extension)
            .map_err(|error| document.invalid(&place, format_args!("{error}; export the file again")))?;
        if read.diffuse_texture.as_ref().is_some_and(|info| info.index.value() >= root.textures.len()) {
            let problem =
                format!("names a texture that does not exist, there are {}; export the file again", root.textures.len());
            return Err(document.invalid(format_args!("{place}.diffuseTexture"), problem));
        }
        Ok(Self { factor: read.diffuse_factor, texture: read.diffuse_texture, roughness: 1.0 - read.glossiness_factor })
    }
}

/// The materials and images that the scene has so far.
#[derive(Debug)]
pub(super) struct Materials<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    folder: Folder<'a>,
    /// The scene's material for each of the file's; `None` is glTF's default one.
    materials: HashMap<Option<usize>, u32>,
    /// The scene's image for each of the file's.
    images: HashMap<usize, u32>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(document: &'a Document, buffers: &'a Buffers<'a>, folder: Folder<'a>) -> Self {
        Self { document, buffers, folder, materials: HashMap::new(), images: HashMap::new() }
    }

    /// The scene's material for one of the file's, which is added when it is asked for first.
    pub(super) fn scene_material(&mut self, index: Option<usize>, builder: &mut SceneBuilder, notes: &mut Notes) -> Result<u32> {
        if let Some(&known) = self.materials.get(&index) {
            return Ok(known);
        }
        let material = match index {
            None => Material::white(),
            Some(index) => self.read(index, builder, notes)?,
        };
        let added = builder.add_material(material);
        self.materials.insert(index, added);
        Ok(added)
    }

    /// Adds the sizes of the images that were read to the facts about the file.
    pub(super) fn describe_images(&self, builder: &SceneBuilder, facts: &mut SourceFacts) {
        for (&source, &image) in &self.images {
            let image = &builder.images()[image as usize];
            facts.images[source].size = Some([image.width, image.height]);
        }
    }

    fn read(&mut self, index: usize, builder: &mut SceneBuilder, notes: &mut Notes) -> Result<Material> {
        // `Document` guarantees the indices and that enumerations are valid.
        let json = &self.document.root.materials[index];
        let base = BaseColor::of(self.document, index)?;
        let texture = match &base.texture {
            None => None,
            Some(info) => self.texture(info.index.value(), builder, notes)?,
        };
        let alpha = match json.alpha_mode {
            Checked::Valid(AlphaMode::Mask) => {
                Alpha::Mask { cutoff: json.alpha_cutoff.map_or(DEFAULT_CUTOFF, |cutoff| cutoff.0).clamp(0.0, f32::MAX) }
            }
            Checked::Valid(AlphaMode::Blend) => {
                notes.blended += 1;
                Alpha::Opaque
            }
            Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => Alpha::Opaque,
        };
        Ok(Material {
            name: json.name.clone().unwrap_or_default(),
            // Exporters round 1 upwards now and then; a surface reflects no more than all light.
            base_color: Vec4::from_array(base.factor).clamp(Vec4::ZERO, Vec4::ONE),
            texture,
            alpha,
            double_sided: json.double_sided,
            roughness: base.roughness.clamp(0.0, 1.0),
        })
    }

    /// A texture of the scene; `None` if it has no image that can be read.
    fn texture(&mut self, index: usize, builder: &mut SceneBuilder, notes: &mut Notes) -> Result<Option<Texture>> {
        let root = &self.document.root;
        let json = &root.textures[index];
        let source = json.source.value();
        if source >= root.images.len() {
            notes.without_image += 1;
            return Ok(None);
        }
        let image = match self.images.get(&source) {
            Some(&known) => known,
            None => {
                let image = images::read(self.document, self.buffers, self.folder, source)?;
                let added = builder.add_image(image);
                self.images.insert(source, added);
                added
            }
        };
        let sampler = json.sampler.map(|sampler| &root.samplers[sampler.value()]);
        let (wrap_u, wrap_v) = sampler.map_or((Wrap::Repeat, Wrap::Repeat), |s| (wrap(s.wrap_s), wrap(s.wrap_t)));
        Ok(Some(Texture { image, wrap_u, wrap_v }))
    }
}

/// `alphaCutoff` where the file gives none.
const DEFAULT_CUTOFF: f32 = 0.5;

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}
