//! The range of a chart's vertical axis.

use super::columns::central_range;
use super::layers::{Layer, LayerColumns};

/// Share of the values at either end that the axis ignores, such as the first instants of a wide guess.
const OUTLIERS: f64 = 0.006;

/// Limits the pieces of a layer; the range uses the extremes of each piece.
const PIECES: usize = 250;

pub(crate) fn value_range<'a>(
    layers: impl Iterator<Item = (&'a Layer<'a>, &'a LayerColumns)>,
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
            LayerColumns::Band(columns) => add_extremes(columns, |column| (column.low, column.high), values),
            LayerColumns::Series(columns) => add_extremes(columns, |column| (column.low, column.high), values),
            LayerColumns::Level => {}
        }
    }
    let all = whole.into_iter().map(|x| (x, x)).chain(central_range(robust, OUTLIERS)).chain(least);
    let (low, high) =
        all.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))).or_else(|| central_range(dots, OUTLIERS))?;
    let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}

fn add_extremes<T>(columns: &[T], edges: impl Fn(&T) -> (f64, f64), extremes: &mut Vec<f64>) {
    for piece in columns.chunks(columns.len() / PIECES + 1) {
        let both = piece.iter().map(&edges).reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
        extremes.extend(both.into_iter().flat_map(|(low, high)| [low, high]));
    }
}
