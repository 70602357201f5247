//! What the vertical axis of a chart shows.

use super::layer::DrawnLayer;
use crate::series::central_range;

/// Share of the values at either end that the axis does not bend to: the first instants of a wide guess.
const OUTLIERS: f64 = 0.006;

/// A layer's values count as the extremes of about so many pieces: enough to know where most are.
const PIECES: usize = 200;

/// All of the lines that count, and the rest but for its outermost values; dots only where there is nothing else.
pub(super) fn vertical_range(layers: &[DrawnLayer], least: Option<(f64, f64)>) -> Option<(f64, f64)> {
    let (mut whole, mut robust, mut dots) = (Vec::new(), Vec::new(), Vec::new());
    for layer in layers {
        match layer {
            DrawnLayer::Band { parts, .. } => {
                for rungs in parts {
                    add_extremes(rungs, |rung| (rung.low, rung.high), &mut robust);
                }
            }
            DrawnLayer::Line { points, bounds: true, .. } => add_extremes(points, |p| (p.y, p.y), &mut whole),
            DrawnLayer::Line { points, .. } => add_extremes(points, |p| (p.y, p.y), &mut robust),
            DrawnLayer::Dots { points, .. } => add_extremes(points, |p| (p.y, p.y), &mut dots),
            DrawnLayer::Level { .. } => {}
        }
    }
    let all = whole.into_iter().map(|x| (x, x)).chain(central_range(robust, OUTLIERS)).chain(least);
    let (low, high) =
        all.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))).or_else(|| central_range(dots, OUTLIERS))?;
    let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}

/// Adds the smallest and the largest value of each piece.
fn add_extremes<T>(values: &[T], edges: impl Fn(&T) -> (f64, f64), extremes: &mut Vec<f64>) {
    for piece in values.chunks(values.len() / PIECES + 1) {
        let both = piece.iter().map(&edges).reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
        extremes.extend(both.into_iter().flat_map(|(low, high)| [low, high]).filter(|x| x.is_finite()));
    }
}
