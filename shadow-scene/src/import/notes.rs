//! What the person who loads a file should know: what was left out, and what was taken for something else.

/// Counts of what could not be imported as it is; each becomes one sentence.
#[derive(Debug, Default)]
pub(super) struct Notes {
    /// Drawn primitives made of points or lines.
    pub(super) points_or_lines: usize,
    /// Drawn primitives without positions.
    pub(super) without_positions: usize,
    /// Drawn primitives whose last triangle is incomplete.
    pub(super) incomplete_triangles: usize,
    /// Drawn primitives without the texture coordinates that their material's texture needs.
    pub(super) without_uvs: usize,
    /// Normals, texture coordinates and colours that are not finite.
    pub(super) not_finite: usize,
    /// That the pose is not the one that was asked for, as a sentence.
    pub(super) pose: Option<String>,
    /// Used materials that are blended.
    pub(super) blended: usize,
    /// Used textures without an image that can be read.
    pub(super) without_image: usize,
    /// Extensions that the file uses and that are left out.
    pub(super) extensions: Vec<String>,
}

impl Notes {
    /// The notes as sentences without a full stop, most important first.
    pub(super) fn sentences(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        let mut say = |count: usize, one: &str, many: &str| {
            if count > 0 {
                sentences.push(if count == 1 { format!("1 {one}") } else { format!("{count} {many}") });
            }
        };
        say(
            self.blended,
            "material is blended (alphaMode BLEND); it is drawn, and casts shadows, as if it were opaque",
            "materials are blended (alphaMode BLEND); they are drawn, and cast shadows, as if they were opaque",
        );
        say(
            self.points_or_lines,
            "primitive is made of points or lines and is left out: only triangles cast shadows",
            "primitives are made of points or lines and are left out: only triangles cast shadows",
        );
        say(
            self.without_positions,
            "primitive has no positions and is left out",
            "primitives have no positions and are left out",
        );
        say(
            self.incomplete_triangles,
            "primitive ends with an incomplete triangle, which is left out",
            "primitives end with an incomplete triangle, which is left out",
        );
        say(
            self.without_image,
            "texture has no PNG or JPEG image; its material is drawn without it",
            "textures have no PNG or JPEG image; their materials are drawn without them",
        );
        say(
            self.without_uvs,
            "primitive lacks the texture coordinates that its texture needs; the texture's first texel colours it",
            "primitives lack the texture coordinates that their textures need; the texture's first texel colours them",
        );
        say(
            self.not_finite,
            "normal, texture coordinate or colour is not a finite number and is taken for 0",
            "normals, texture coordinates or colours are not finite numbers and are taken for 0",
        );
        sentences.extend(self.pose.clone());
        if !self.extensions.is_empty() {
            sentences.push(format!("extensions that are not supported are left out: {}", self.extensions.join(", ")));
        }
        sentences
    }
}
