//! What the depth of a map means in metres.

/// The kind of depth that a view stores; the value of [`ViewPlan::depth_kind`](crate::plan::ViewPlan).
///
/// z / w of the view's own matrix: 0 at the near plane, 1 at the far plane.
pub const DEPTH_Z_OVER_W: u32 = 0;

/// How depth grows along the axis of a view: `depth = offset - factor / distance` for a perspective view and
/// `depth = offset + factor * distance` for an orthographic one.
///
/// `distance` is measured along the view axis in metres; for an orthographic view from the near plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthScale {
    /// The factor: 1 / m for an orthographic view, m for a perspective one.
    pub factor: f64,
    /// 1 for a perspective view, whose w is the distance; 0 for an orthographic one, whose w is 1.
    pub w_per_metre: f64,
}

impl DepthScale {
    /// The scale of an orthographic view from 0 to `range` metres.
    #[must_use]
    pub fn orthographic(range: f64) -> Self {
        Self { factor: 1.0 / range, w_per_metre: 0.0 }
    }

    /// The scale of a perspective view with these planes, in metres.
    #[must_use]
    pub fn perspective(near: f64, far: f64) -> Self {
        Self { factor: far * near / (far - near), w_per_metre: 1.0 }
    }

    /// The depth that the last `metres` before a point with clip coordinate `w` take up: exact, not a derivative.
    ///
    /// A perspective view has no depth behind its eye: lengths of the whole distance or more give infinity.
    ///
    /// ```
    /// use shadow_math::depth::DepthScale;
    ///
    /// let (near, far) = (0.5, 20.0);
    /// let depth = |distance: f64| far / (far - near) * (1.0 - near / distance);
    /// let metres = DepthScale::perspective(near, far).depth_of_metres(8.0, 0.25);
    /// assert!((metres - (depth(8.0) - depth(7.75))).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn depth_of_metres(self, w: f64, metres: f64) -> f64 {
        let w_before = w - self.w_per_metre * metres;
        if w_before <= 0.0 { f64::INFINITY } else { self.factor * metres / (w * w_before) }
    }
}
