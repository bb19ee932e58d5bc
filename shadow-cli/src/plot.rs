//! Plots as SVG: a grid with two axes, and the places of values on them.

/// Width and height of the drawing, and the room for its axes, in SVG's units.
const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 64.0;
const BOTTOM: f64 = 44.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 16.0;
/// An axis of decades has no more of them.
const MOST_DECADES: i32 = 6;
/// A linear axis ends this far beyond the largest value, as a factor on it.
const HEADROOM: f64 = 1.15;

/// An axis.
pub(crate) struct Axis {
    /// What it measures.
    title: &'static str,
    scale: Scale,
    /// The text of a value.
    text: fn(f64) -> String,
}

/// How values become places.
#[derive(Clone, Copy)]
enum Scale {
    /// From 0 to this.
    Linear(f64),
    /// Decades from one power of ten to another; one more in front of them has 0 as its beginning.
    Decades(i32, i32),
}

impl Axis {
    /// From 0 to beyond the largest of some values.
    pub(crate) fn linear(title: &'static str, values: impl Iterator<Item = f64>, text: fn(f64) -> String) -> Self {
        let most = values.fold(0.0, f64::max);
        // A plot of nothing but zeros still has axes.
        Self { title, scale: Scale::Linear(if most > 0.0 { nice(most * HEADROOM) } else { 1.0 }), text }
    }

    /// Decades from the smallest of some values above 0 to the largest, with a place for 0 itself. Of many decades the last [`MOST_DECADES`] are shown: what is smaller
    /// lies near 0.
    pub(crate) fn decades(title: &'static str, values: impl Iterator<Item = f64>, text: fn(f64) -> String) -> Self {
        let exponents = values.filter(|value| *value > 0.0).map(|value| value.log10());
        let (least, most) = exponents.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let (first, last) = if least <= most { (least.floor() as i32, most.ceil() as i32) } else { (0, 1) };
        Self { title, scale: Scale::Decades(first.max(last - MOST_DECADES), last.max(first + 1)), text }
    }

    /// Where a value lies, from 0 at the beginning of the axis to 1 at its end.
    fn share(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear(end) => value / end,
            Scale::Decades(first, last) => {
                let decades = f64::from(last - first + 1);
                if value > 0.0 { ((value.log10() - f64::from(first) + 1.0) / decades).max(0.0) } else { 0.0 }
            }
        }
    }

    /// The values that are written at the axis.
    fn ticks(&self) -> Vec<f64> {
        match self.scale {
            Scale::Linear(end) => (0..=4).map(|tick| f64::from(tick) / 4.0 * end).collect(),
            Scale::Decades(first, last) => {
                std::iter::once(0.0).chain((first..=last).map(|exponent| 10_f64.powi(exponent))).collect()
            }
        }
    }
}

/// A plot that is being drawn.
pub(crate) struct Plot {
    x: Axis,
    y: Axis,
    svg: String,
    /// The boxes of the names that were written: left, top, right and bottom.
    names: Vec<[f64; 4]>,
}

/// How high a line of text is, and about how wide a letter, in SVG's units.
const LINE: f64 = 13.0;
const LETTER: f64 = 6.0;

impl Plot {
    /// The grid and its axes; `label` says what the plot shows.
    pub(crate) fn new(label: &str, x: Axis, y: Axis) -> Self {
        let svg = format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">\n", super::page::escaped(label));
        let mut plot = Self { x, y, svg, names: Vec::new() };
        let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        for value in plot.x.ticks() {
            let (x, _) = plot.place(value, 0.0);
            let (text, y) = ((plot.x.text)(value), bottom + 16.0);
            plot.svg.push_str(&format!(
                "<path class=\"grid\" d=\"M{x:.1} {TOP}V{bottom}\"/><text x=\"{x:.1}\" y=\"{y}\" text-anchor=\"middle\">{text}</text>\n"
            ));
        }
        for value in plot.y.ticks() {
            let (_, y) = plot.place(0.0, value);
            let (text, x) = ((plot.y.text)(value), LEFT - 6.0);
            plot.svg.push_str(&format!(
                "<path class=\"grid\" d=\"M{LEFT} {y:.1}H{right}\"/><text x=\"{x}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>\n",
                y + 4.0
            ));
        }
        let (middle_x, middle_y) = (0.5 * (LEFT + right), 0.5 * (TOP + bottom));
        let titles = format!(
            "<text x=\"{middle_x}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
             <text x=\"14\" y=\"{middle_y}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {middle_y})\">{}</text>\n",
            HEIGHT - 8.0,
            plot.x.title,
            plot.y.title
        );
        plot.svg.push_str(&titles);
        plot
    }

    /// Where two values lie.
    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        (LEFT + self.x.share(x) * (right - LEFT), bottom - self.y.share(y) * (bottom - TOP))
    }

    /// A line through points, of a class of the page's style.
    pub(crate) fn line(&mut self, class: &str, points: impl Iterator<Item = (f64, f64)>) {
        let places: Vec<String> = points
            .map(|(x, y)| {
                let (x, y) = self.place(x, y);
                format!("{x:.1},{y:.1}")
            })
            .collect();
        self.svg.push_str(&format!("<polyline class=\"{class}\" points=\"{}\"/>\n", places.join(" ")));
    }

    /// A dot, of a class of the page's style, with a title that is shown while the pointer is on it.
    pub(crate) fn dot(&mut self, class: &str, radius: f64, (x, y): (f64, f64), title: &str) {
        let (x, y) = self.place(x, y);
        let title = super::page::escaped(title);
        self.svg.push_str(&format!(
            "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"><title>{title}</title></circle>\n"
        ));
    }

    /// A name beside a dot, clear of the names before: right or left of it and, where both are taken, as much higher as it takes, with a line to the dot.
    pub(crate) fn name(&mut self, (x, y): (f64, f64), name: &str) {
        let (dot_x, dot_y) = self.place(x, y);
        let width = LETTER * name.chars().count() as f64;
        let rows = (0..).map(|row| dot_y - 7.0 - LINE * f64::from(row)).take_while(|y| *y > TOP);
        let places = rows.flat_map(|y| [(dot_x + 9.0, y), (dot_x - 9.0 - width, y)]);
        let is_free = |(left, y): &(f64, f64)| {
            let (right, top) = (left + width, y - LINE);
            let is_inside = *left > LEFT && right < WIDTH;
            is_inside && !self.names.iter().any(|[l, t, r, b]| left < r && right > *l && top < *b && y > t)
        };
        // Where nothing is free, names lie on each other: the table has them too.
        let (left, y) = places.into_iter().find(is_free).unwrap_or((dot_x + 9.0, dot_y - 7.0));
        self.names.push([left, y - LINE, left + width, y]);
        if y < dot_y - 7.0 {
            let end = if left > dot_x { left } else { left + width };
            self.svg.push_str(&format!("<path class=\"leader\" d=\"M{dot_x:.1} {dot_y:.1}L{end:.1} {:.1}\"/>\n", y - 3.0));
        }
        let name = super::page::escaped(name);
        self.svg.push_str(&format!("<text x=\"{left:.1}\" y=\"{y:.1}\">{name}</text>\n"));
    }

    /// The drawing.
    pub(crate) fn finish(mut self) -> String {
        self.svg.push_str("</svg>\n");
        self.svg
    }
}

/// The next number from `x` on that is 1, 2, 4 or 8 times a power of ten: a quarter of it is short too.
fn nice(x: f64) -> f64 {
    let decade = 10_f64.powf(x.log10().floor());
    [1.0, 2.0, 4.0, 8.0, 10.0].into_iter().map(|factor| factor * decade).find(|&nice| nice >= x).unwrap_or(x)
}

/// A number on an axis.
pub(crate) fn short(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{}", (x * 1e6).round() / 1e6) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_short_numbers() {
        for (x, end) in [(0.9, 1.0), (1.1, 2.0), (37.0, 40.0), (0.05, 0.08), (81.0, 100.0)] {
            assert!((nice(x) - end).abs() < 1e-9 * end, "{x}: {}", nice(x));
        }
        assert_eq!((short(0.0), short(0.3 / 3.0), short(25.0)), ("0".into(), "0.1".into(), "25".into()));
    }

    #[test]
    fn decades_have_a_place_for_zero() {
        let axis = Axis::decades("", [0.0, 0.02, 3.0].into_iter(), short);
        assert_eq!(axis.ticks(), [0.0, 0.01, 0.1, 1.0, 10.0]);
        let shares = axis.ticks().into_iter().map(|tick| axis.share(tick));
        for (share, expected) in shares.zip([0.0, 0.25, 0.5, 0.75, 1.0]) {
            assert!((share - expected).abs() < 1e-12, "{share} {expected}");
        }
        assert_eq!(Axis::decades("", [0.0].into_iter(), short).ticks(), [0.0, 1.0, 10.0]);
        let wide = Axis::decades("", [1e-9, 1.0].into_iter(), short);
        assert_eq!((wide.ticks().len(), wide.share(1e-9)), (8, 0.0));
    }

    #[test]
    fn names_do_not_lie_on_each_other() {
        let axis = || Axis::linear("", [1.0].into_iter(), short);
        let mut plot = Plot::new("", axis(), axis());
        for name in ["one", "another", "third"] {
            plot.name((0.5, 0.2), name);
        }
        let [a, b, c] = [plot.names[0], plot.names[1], plot.names[2]];
        assert!(b[2] <= a[0] && c[3] <= a[1], "{a:?} {b:?} {c:?}");
    }
}
