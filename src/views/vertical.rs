//! What the vertical axis of a chart shows.

use super::layer::{Columns, Layer};
use crate::series::central_range;

/// Share of the values at either end that the axis does not bend to: the first instants of a wide guess.
const OUTLIERS: f64 = 0.006;

/// A layer's values count as the extremes of no more pieces: enough to know where most are.
const PIECES: usize = 250;

/// All of the lines that count, and the rest but for its outermost values; dots only where there is nothing else.
pub(super) fn vertical_range<'a>(
    layers: impl Iterator<Item = (&'a Layer<'a>, &'a Columns)>,
    least: Option<(f64, f64)>,
) -> Option<(f64, f64)> {
    let (mut whole, mut robust, mut dots) = (Vec::new(), Vec::with_capacity(16 * PIECES), Vec::new());
    for (layer, columns) in layers {
        let values = match layer {
            Layer::Line { bounds: true, .. } => &mut whole,
            Layer::Dots { .. } => &mut dots,
            _ => &mut robust,
        };
        match columns {
            Columns::Band(columns) => add_extremes(columns, |column| (column.low, column.high), values),
            Columns::Series(columns) => add_extremes(columns, |column| (column.low, column.high), values),
            Columns::Level => {}
        }
    }
    let all = whole.into_iter().map(|x| (x, x)).chain(central_range(robust, OUTLIERS)).chain(least);
    let (low, high) =
        all.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))).or_else(|| central_range(dots, OUTLIERS))?;
    let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}

/// Adds the smallest and the largest value of each piece.
fn add_extremes<T>(columns: &[T], edges: impl Fn(&T) -> (f64, f64), extremes: &mut Vec<f64>) {
    for piece in columns.chunks(columns.len() / PIECES + 1) {
        let both = piece.iter().map(&edges).reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
        extremes.extend(both.into_iter().flat_map(|(low, high)| [low, high]));
    }
}
