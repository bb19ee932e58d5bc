//! A drawing of a plan's light cameras from above and from the side, as SVG.
//!
//! Grey boxes are casters, the black outline is what the camera sees, from the black dot where it stands, and each map has a colour: what it covers, the slice of the view that it is for, and lines through its
//! texels, which lie close where samples do. Lights at a place are dots, too.

use glam::{DMat4, DVec2, DVec3, DVec4};
use shadow_math::{
    Camera, Projection,
    fit::FitOutcome,
    frustum::Frustum,
    plan::{LightPlan, SPLIT_CASCADES, ViewPlan},
    rectangle::convex_hull,
};
use shadow_scene::{FramePlan, Scene};

use crate::resolve::{kind_name, view_names};

/// The side of each of the two drawings, in SVG's units.
const SIDE: f64 = 520.0;
/// The room around them and between them.
const GAP: f64 = 24.0;
/// The room around cameras and lights, in radii of the scene.
const DOT_MARGIN: f64 = 0.1;
/// A line of the legend.
const LINE: f64 = 18.0;
/// How far beyond the scene's bounds is drawn, as a share of their radius.
const MARGIN: f64 = 0.5;
/// How far from the bounds' middle cameras and lights may stand to be drawn, in radii: beyond, the scene would be a dot.
const FARTHEST_DOT: f64 = 6.0;
/// How far from there maps are drawn, in radii.
const REACH: f64 = 4.0;
/// In how many steps it is looked for which part of a line can be drawn, and how often its ends are then halved.
const STEPS: usize = 32;
/// Into how many parts of its texels a map is divided by lines.
const PARTS: usize = 16;
/// The colours of a light's maps, which stay apart for most people who do not see all colours.
const COLORS: [&str; 8] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#6b6b6b"];

/// A direction that is drawn from: which coordinates go right and down.
struct Side {
    title: &'static str,
    right: DVec3,
    down: DVec3,
}

/// What is drawn: the place of each point in the two drawings.
struct Canvas {
    sides: [Side; 2],
    center: DVec3,
    /// SVG's units a metre.
    scale: f64,
    /// What clips are named by.
    id: String,
    text: String,
}

impl Canvas {
    /// A canvas on which the scene has room, and the places of `dots` that are not too far from it.
    fn new(scene: &Scene, forward: DVec3, dots: &[DVec3], id: &str) -> Self {
        let bounds = scene.bounds();
        let radius = f64::from(bounds.radius()).max(f64::MIN_POSITIVE);
        let middle = bounds.center().as_dvec3();
        let shown = || dots.iter().copied().filter(|dot| dot.distance(middle) <= FARTHEST_DOT * radius);
        let corners = || bounds.corners().into_iter().map(|corner| corner.as_dvec3()).chain(shown());
        let low = corners().fold(middle, DVec3::min);
        let high = corners().fold(middle, DVec3::max);
        let center = 0.5 * (low + high);
        let farthest = shown().map(|dot| dot.distance(center)).fold(0.0, f64::max);
        let half = ((center.distance(middle) + radius).max(farthest) + DOT_MARGIN * radius).max(radius * (1.0 + MARGIN));
        // The side view is across the camera's own direction, so that slices of its view are seen one behind the other.
        let along = DVec3::new(forward.x, 0.0, forward.z).try_normalize().unwrap_or(DVec3::X);
        let sides = [
            Side { title: "from above", right: along.cross(DVec3::Y), down: -along },
            Side { title: "from the side", right: along, down: DVec3::NEG_Y },
        ];
        Self { sides, center, scale: SIDE / (2.0 * half), id: id.into(), text: String::new() }
    }

    fn place(&self, side: usize, point: DVec3) -> DVec2 {
        let Side { right, down, .. } = self.sides[side];
        let from_center = point - self.center;
        let middle = DVec2::new(GAP + 0.5 * SIDE + side as f64 * (SIDE + GAP), 2.0 * GAP + 0.5 * SIDE);
        middle + DVec2::new(right.dot(from_center), down.dot(from_center)) * self.scale
    }

    /// The outline of some points, in each drawing.
    fn outline(&mut self, points: &[DVec3], style: &str) {
        for side in 0..2 {
            let mut places: Vec<DVec2> = points.iter().map(|&point| self.place(side, point)).collect();
            let mut hull = vec![DVec2::ZERO; places.len()];
            let count = convex_hull(&mut places, &mut hull);
            let corners: Vec<String> = hull[..count].iter().map(|place| format!("{:.1},{:.1}", place.x, place.y)).collect();
            self.shape(side, &format!("<polygon points=\"{}\" {style}/>", corners.join(" ")));
        }
    }

    fn line(&mut self, side: usize, from: DVec3, to: DVec3, style: &str) {
        let [a, b] = [from, to].map(|point| self.place(side, point));
        self.shape(side, &format!("<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" {style}/>", a.x, a.y, b.x, b.y));
    }

    /// A dot in both drawings.
    fn dot(&mut self, point: DVec3, style: &str) {
        for side in 0..2 {
            let place = self.place(side, point);
            self.shape(side, &format!("<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"4\" {style}/>", place.x, place.y));
        }
    }

    fn shape(&mut self, side: usize, shape: &str) {
        self.text.push_str(&format!("<g clip-path=\"url(#{}{side})\">{shape}</g>\n", self.id));
    }
}

/// The drawing of a plan of a scene seen by `camera`. `id` keeps apart drawings that lie in one page.
pub(crate) fn light_drawing(scene: &Scene, camera: &Camera, plan: &FramePlan, id: &str) -> String {
    let aspect = f64::from(plan.camera.width) / f64::from(plan.camera.height.max(1));
    let places = scene.lights().iter().filter_map(|light| light.light.position());
    let places: Vec<DVec3> = places.map(|position| position.as_dvec3()).collect();
    let dots: Vec<DVec3> = places.iter().copied().chain([camera.eye]).collect();
    let mut canvas = Canvas::new(scene, camera.direction(), &dots, id);
    // The slices of several lights over each other would tell nothing.
    let sliced = plan.lights.iter().position(|light| light.split == SPLIT_CASCADES);
    for instance in scene.instances().iter().filter(|instance| instance.casts_shadows) {
        let corners = instance.bounds.corners().map(|corner| corner.as_dvec3());
        canvas.outline(&corners, "fill=\"#888\" fill-opacity=\"0.12\" stroke=\"#888\" stroke-width=\"0.5\"");
    }
    let mut legend = Vec::new();
    let mut color = 0;
    for (index, light) in plan.lights.iter().enumerate() {
        let views = plan.views_of(index);
        let names = view_names(views.len());
        let what = format!("{} {}", index, kind_name(&scene.lights()[index].light.kind));
        for (number, view) in views.iter().enumerate() {
            let paint = COLORS[color % COLORS.len()];
            color += 1;
            let is_sliced = sliced == Some(index) && view.has_map();
            let of_cascade = is_sliced.then(|| slice(scene, camera, aspect, light, number)).flatten();
            if let Some(slice) = of_cascade {
                canvas.outline(&slice.corners, &format!("fill=\"{paint}\" fill-opacity=\"0.18\" stroke=\"none\""));
            }
            if view.has_map() {
                map(&mut canvas, scene, view, paint);
            }
            legend.push((paint, format!("light {what}: map {number} {} {}", names[number], said(view))));
        }
    }
    if let Some(frustum) = whole_view(scene, camera, aspect) {
        canvas.outline(&frustum.corners, "fill=\"none\" stroke=\"black\" stroke-width=\"1.2\"");
    }
    for place in places {
        canvas.dot(place, "fill=\"#ffd400\" stroke=\"black\"");
    }
    canvas.dot(camera.eye, "fill=\"black\"");
    let tints = sliced.map_or_else(String::new, |light| format!("; tints: the slices of light {light}"));
    finish(canvas, &legend, &tints)
}

/// What a map covers, and lines through its texels.
fn map(canvas: &mut Canvas, scene: &Scene, view: &ViewPlan, paint: &str) {
    let rows = [view.clip_x, view.clip_y, view.clip_z, view.clip_w].map(|row| DVec4::from_array(row.map(f64::from)));
    let world_from_clip = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose().inverse();
    let (middle_of_scene, reach) = (scene.bounds().center().as_dvec3(), REACH * f64::from(scene.bounds().radius()));
    // Points of a warped map can lie beyond the horizon.
    let point = |x: f64, y: f64, z: f64| {
        let point = world_from_clip * DVec4::new(x, y, z, 1.0);
        let place = point.truncate() / point.w;
        (point.w > 0.0 && place.distance(middle_of_scene) < reach).then_some(place)
    };
    let steps = || (0..=PARTS).map(|step| 2.0 * step as f64 / PARTS as f64 - 1.0);
    let sides = || [-1.0, 1.0].into_iter().flat_map(|side| [0.0, 1.0].map(|z| (side, z)));
    let of_rim = sides().flat_map(|(side, z)| [visible_part(|t| point(side, t, z)), visible_part(|t| point(t, side, z))]);
    let depths = steps().flat_map(|t| [(t, -1.0), (t, 1.0), (-1.0, t), (1.0, t)]);
    let of_depth = depths.map(|(x, y)| visible_part(|t| point(x, y, 0.5 + 0.5 * t)));
    let rim: Vec<DVec3> = of_rim.chain(of_depth).flatten().flatten().collect();
    let rays: Vec<[DVec3; 2]> =
        steps().flat_map(|t| [(t, 0.0), (0.0, t)]).filter_map(|(x, y)| visible_part(|t| point(x, y, 0.5 + 0.5 * t))).collect();
    // Half-way in metres: a perspective's depths crowd near the light.
    let middle = |x: f64, y: f64| Some(0.5 * (point(x, y, 0.0)? + point(x, y, 1.0)?));
    let across: Vec<[DVec3; 2]> =
        steps().flat_map(|s| [visible_part(|t| middle(s, t)), visible_part(|t| middle(t, s))]).flatten().collect();
    let thin = format!("stroke=\"{paint}\" stroke-width=\"0.5\" stroke-opacity=\"0.5\"");
    // From above the map's own grid, half-way down; from the side the light's rays through it.
    for [from, to] in across {
        canvas.line(0, from, to, &thin);
    }
    for [from, to] in rays {
        canvas.line(1, from, to, &thin);
    }
    if !rim.is_empty() {
        canvas.outline(&rim, &format!("fill=\"none\" stroke=\"{paint}\" stroke-width=\"1.5\""));
    }
}

/// The ends of the part of a line that can be drawn; `line` has its points from -1 to 1, of which those that can be drawn follow each other. `None` if there is none.
fn visible_part(line: impl Fn(f64) -> Option<DVec3>) -> Option<[DVec3; 2]> {
    let at = |step: usize| 2.0 * step as f64 / STEPS as f64 - 1.0;
    let is_visible = |step: &usize| line(at(*step)).is_some();
    let (first, last) = ((0..=STEPS).find(is_visible)?, (0..=STEPS).rfind(is_visible)?);
    let end = |visible: usize, beyond: Option<usize>| {
        let (mut inside, mut outside) = (at(visible), beyond.map_or(at(visible), at));
        for _ in 0..STEPS {
            let middle = 0.5 * (inside + outside);
            if line(middle).is_some() { inside = middle } else { outside = middle }
        }
        line(inside)
    };
    Some([end(first, first.checked_sub(1))?, end(last, (last < STEPS).then_some(last + 1))?])
}

/// The part of the view that a cascade is for.
fn slice(scene: &Scene, camera: &Camera, aspect: f64, light: &LightPlan, cascade: usize) -> Option<Frustum> {
    let ends = light.split_far.as_flattened();
    let [nearest, farthest] = distances(scene, camera);
    let near = if cascade == 0 { nearest } else { f64::from(ends[cascade - 1]) };
    let far = f64::from(ends[cascade].min(light.shadow_far)).min(farthest);
    Frustum::slice(camera, aspect, near, far).ok()
}

/// All that the camera sees, up to the end of the scene.
fn whole_view(scene: &Scene, camera: &Camera, aspect: f64) -> Option<Frustum> {
    let [near, far] = distances(scene, camera);
    Frustum::slice(camera, aspect, near, far).ok()
}

/// The distances of the camera's near plane and of the scene's farthest corner, or the far plane if that is nearer.
fn distances(scene: &Scene, camera: &Camera) -> [f64; 2] {
    let (near, far) = match camera.projection {
        Projection::Perspective { near, far, .. } => (near, far.unwrap_or(f64::INFINITY)),
        Projection::Orthographic { near, far, .. } => (near, far),
    };
    let axis = camera.direction();
    let corners = scene.bounds().corners().map(|corner| axis.dot(corner.as_dvec3() - camera.eye));
    [near, far.min(corners.into_iter().fold(near * 2.0, f64::max))]
}

/// What is to be said of a map.
fn said(view: &ViewPlan) -> String {
    match view.outcome() {
        FitOutcome::NothingVisible => "nothing is seen".into(),
        FitOutcome::FellBackToUniform { why } => format!("uniform: {why}"),
        FitOutcome::Fitted => {
            let [width, height] = view.texel_metres.map(|metres| 1e3 * metres);
            let place = if view.is_warped != 0 {
                " in the middle"
            } else if view.w_per_metre > 0.0 {
                " at 1 m"
            } else {
                ""
            };
            format!("{} x {} texels of {width:.2} x {height:.2} mm{place}", view.rect[2], view.rect[3])
        }
    }
}

/// The whole text.
fn finish(canvas: Canvas, legend: &[(&str, String)], tints: &str) -> String {
    let width = 2.0 * SIDE + 3.0 * GAP;
    let height = 3.0 * GAP + SIDE + LINE * (legend.len() as f64 + 1.0);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\" style=\"height:auto;max-width:100%\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let id = &canvas.id;
    for (side, Side { title, .. }) in canvas.sides.iter().enumerate() {
        let x = GAP + side as f64 * (SIDE + GAP);
        let y = 2.0 * GAP;
        text.push_str(&format!(
            "<clipPath id=\"{id}{side}\"><rect x=\"{x}\" y=\"{y}\" width=\"{SIDE}\" height=\"{SIDE}\"/></clipPath>\n\
             <rect x=\"{x}\" y=\"{y}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"none\" stroke=\"#ccc\"/>\n\
             <text x=\"{x}\" y=\"{}\">{title}</text>\n",
            y - 8.0
        ));
    }
    text.push_str(&canvas.text);
    let metre = scale_bar(canvas.scale);
    let top = 3.0 * GAP + SIDE;
    text.push_str(&format!(
        "<line x1=\"{GAP}\" y1=\"{top}\" x2=\"{:.1}\" y2=\"{top}\" stroke=\"black\" stroke-width=\"2\"/><text x=\"{:.1}\" y=\"{:.1}\">{metre} m; black: the camera and what it sees; yellow: lights at a place; grey: casters; lines: every sixteenth part of a map{tints}</text>\n",
        GAP + metre * canvas.scale,
        GAP + metre * canvas.scale + 8.0,
        top + 4.0
    ));
    for (line, (paint, said)) in legend.iter().enumerate() {
        let y = top + LINE * (line as f64 + 1.0);
        text.push_str(&format!(
            "<rect x=\"{GAP}\" y=\"{:.1}\" width=\"12\" height=\"12\" fill=\"{paint}\"/><text x=\"{}\" y=\"{y:.1}\">{said}</text>\n",
            y - 10.0,
            GAP + 18.0
        ));
    }
    text.push_str("</svg>\n");
    text
}

/// A round number of metres that takes about a tenth of a drawing.
fn scale_bar(scale: f64) -> f64 {
    let wanted = 0.1 * SIDE / scale;
    let decade = 10_f64.powf(wanted.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|step| step * decade).rfind(|step| *step <= wanted * 1.01).unwrap_or(decade)
}
