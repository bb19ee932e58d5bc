//! Error against cost: a dot for each technique, and the line of those that no other beats in both.

/// A technique in the plot.
pub(super) struct Dot<'a> {
    pub(super) name: &'a str,
    /// Milliseconds a frame.
    pub(super) cost: f64,
    /// The root of the mean squared error.
    pub(super) error: f64,
}

/// Width and height of the drawing, and the room for its axes, in SVG's units.
const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 64.0;
const BOTTOM: f64 = 44.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 16.0;
/// The axes end this far beyond the largest value, as a factor on it.
const HEADROOM: f64 = 1.15;

/// The techniques that no other is both cheaper and better than, from the cheapest to the dearest.
pub(super) fn pareto_front(dots: &[Dot<'_>]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..dots.len()).collect();
    order.sort_by(|&a, &b| dots[a].cost.total_cmp(&dots[b].cost).then(dots[a].error.total_cmp(&dots[b].error)));
    let mut best = f64::INFINITY;
    order.retain(|&index| {
        let is_better = dots[index].error < best;
        best = best.min(dots[index].error);
        is_better
    });
    order
}

/// The plot as SVG.
pub(super) fn svg(dots: &[Dot<'_>]) -> String {
    let largest = |value: fn(&Dot<'_>) -> f64| dots.iter().map(value).fold(0.0, f64::max);
    // A plot of nothing but zeros still has axes.
    let scale = |most: f64| if most > 0.0 { nice(most * HEADROOM) } else { 1.0 };
    let (cost_end, error_end) = (scale(largest(|dot| dot.cost)), scale(largest(|dot| dot.error)));
    let x = |cost: f64| LEFT + cost / cost_end * (WIDTH - LEFT - RIGHT);
    let y = |error: f64| HEIGHT - BOTTOM - error / error_end * (HEIGHT - BOTTOM - TOP);
    let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"error against cost\">\n");
    for tick in 0..=4 {
        let share = f64::from(tick) / 4.0;
        let (cost, error) = (share * cost_end, share * error_end);
        svg.push_str(&format!(
            "<path class=\"grid\" d=\"M{0:.1} {TOP}V{bottom}M{LEFT} {1:.1}H{right}\"/><text x=\"{0:.1}\" y=\"{2}\" text-anchor=\"middle\">{3}</text>\
             <text x=\"{4}\" y=\"{5:.1}\" text-anchor=\"end\">{6}</text>\n",
            x(cost),
            y(error),
            bottom + 16.0,
            short(cost),
            LEFT - 6.0,
            y(error) + 4.0,
            short(error),
        ));
    }
    let (middle_x, middle_y) = (0.5 * (LEFT + right), 0.5 * (TOP + bottom));
    svg.push_str(&format!(
        "<text x=\"{middle_x}\" y=\"{}\" text-anchor=\"middle\">milliseconds a frame</text>\
         <text x=\"14\" y=\"{middle_y}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {middle_y})\">RMSE of visibility</text>\n",
        HEIGHT - 8.0,
    ));
    let front = pareto_front(dots);
    let points: Vec<String> = front.iter().map(|&i| format!("{:.1},{:.1}", x(dots[i].cost), y(dots[i].error))).collect();
    svg.push_str(&format!("<polyline class=\"front\" points=\"{}\"/>\n", points.join(" ")));
    for (index, dot) in dots.iter().enumerate() {
        let class = if front.contains(&index) { "dot on-front" } else { "dot" };
        let (at_x, at_y) = (x(dot.cost), y(dot.error));
        // Names at the right end are written to the left of their dots.
        let (anchor, shift) = if at_x > 0.75 * WIDTH { ("end", -9.0) } else { ("start", 9.0) };
        svg.push_str(&format!(
            "<circle class=\"{class}\" cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"5\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>\n",
            at_x + shift,
            at_y - 7.0,
            super::page::escaped(dot.name),
        ));
    }
    svg.push_str("</svg>\n");
    svg
}

/// The next number from `x` on that is 1, 2, 4 or 8 times a power of ten: a quarter of it is short too.
fn nice(x: f64) -> f64 {
    let decade = 10_f64.powf(x.log10().floor());
    [1.0, 2.0, 4.0, 8.0, 10.0].into_iter().map(|factor| factor * decade).find(|&nice| nice >= x).unwrap_or(x)
}

/// A number on an axis.
fn short(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{}", (x * 1e6).round() / 1e6) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_no_other_beats() {
        let dots =
            [(3.0, 0.1), (1.0, 0.5), (2.0, 0.6), (2.0, 0.2), (4.0, 0.1)].map(|(cost, error)| Dot { name: "x", cost, error });
        assert_eq!(pareto_front(&dots), [1, 3, 0]);
        assert_eq!(pareto_front(&[]), [0_usize; 0]);
    }

    #[test]
    fn axes_end_at_short_numbers() {
        for (x, end) in [(0.9, 1.0), (1.1, 2.0), (37.0, 40.0), (0.05, 0.08), (81.0, 100.0)] {
            assert!((nice(x) - end).abs() < 1e-9 * end, "{x}: {}", nice(x));
        }
        assert_eq!((short(0.0), short(0.3 / 3.0), short(25.0)), ("0".into(), "0.1".into(), "25".into()));
    }
}
