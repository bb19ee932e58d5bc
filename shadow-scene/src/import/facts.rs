//! Facts about a file, as its JSON has them.

use super::document::Document;
use crate::source::{AnimationFacts, ImageFacts, SourceFacts};

/// What there is in a file of which `scene` is drawn; what only reading its data can tell is left at its default.
pub(super) fn of(document: &Document, scene: Option<usize>) -> SourceFacts {
    /// The most characters of a URI that serve as a name.
    const SHOWN: usize = 80;
    let root = &document.root;
    let name = |name: &Option<String>| name.clone().unwrap_or_default();
    let image_name = |image: &gltf::json::Image| match (&image.name, &image.uri) {
        (Some(name), _) => name.clone(),
        (None, Some(uri)) if !uri.starts_with("data:") => uri.chars().take(SHOWN).collect(),
        (None, _) => String::new(),
    };
    let animation = |animation: &gltf::json::Animation| AnimationFacts {
        name: name(&animation.name),
        channels: animation.channels.len(),
        ..AnimationFacts::default()
    };
    SourceFacts {
        generator: root.asset.generator.clone(),
        scenes: root.scenes.iter().map(|scene| name(&scene.name)).collect(),
        scene,
        nodes: root.nodes.len(),
        meshes: root.meshes.len(),
        primitives: root.meshes.iter().map(|mesh| mesh.primitives.len()).sum(),
        materials: root.materials.len(),
        textures: root.textures.len(),
        images: root.images.iter().map(|image| ImageFacts { name: image_name(image), size: None }).collect(),
        animations: root.animations.iter().map(animation).collect(),
        skins: root.skins.len(),
        extensions_used: root.extensions_used.clone(),
        extensions_ignored: document.ignored_extensions().map(str::to_owned).collect(),
        ..SourceFacts::default()
    }
}
