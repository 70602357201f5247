//! The edge of the region in which a filter is consistent.

use kalmanscope_core::Measure;

use super::scale::{CONSISTENT, spread};
use crate::laboratory::Survey;

/// A piece of the edge of a region, in cells from the middle of the first one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) ends: [[f64; 2]; 2],
    /// The direction into the region, of any length.
    pub(super) inwards: [f64; 2],
}

/// The lines on which the mean NIS leaves its 99 % interval, at either end of it.
pub(super) fn consistent(survey: &Survey, filter: usize) -> Vec<Piece> {
    let [across, up] = survey.axes().map(|axis| axis.count);
    let Some(column) = survey.column(filter, Measure::CONSISTENCY) else { return Vec::new() };
    let value = |cell: usize| survey.sheet.shown(cell).map_or(f64::NAN, |row| spread(row[column]));
    let values: Vec<f64> = (0..across * up).map(value).collect();
    [-CONSISTENT, CONSISTENT].into_iter().flat_map(|level| edge(&values, across, up, spread(level))).collect()
}

/// The lines on which numbers at the middles of cells, the second axis fastest, have a level: marching squares, after
/// Lorensen and Cline (1987). The region is on the side of zero. A square with a NaN at a corner has no line.
fn edge(values: &[f64], across: usize, up: usize, level: f64) -> Vec<Piece> {
    let at = |x: usize, y: usize| values[x * up + y] - level;
    let mut pieces = Vec::new();
    for x in 0..across.saturating_sub(1) {
        for y in 0..up.saturating_sub(1) {
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            let heights = corners.map(|(x, y)| at(x, y));
            if heights.iter().any(|height| height.is_nan()) {
                continue;
            }
            let mut crossings = Vec::with_capacity(4);
            for side in 0..4 {
                let (a, b) = (heights[side], heights[(side + 1) % 4]);
                if (a < 0.0) != (b < 0.0) {
                    let share = a / (a - b);
                    let ((x0, y0), (x1, y1)) = (corners[side], corners[(side + 1) % 4]);
                    let mix = |from: usize, to: usize| from as f64 + share * (to as f64 - from as f64);
                    crossings.push([mix(x0, x1), mix(y0, y1)]);
                }
            }
            let [a, b, c, d] = heights;
            let uphill = [b + c - a - d, c + d - a - b];
            let inwards = uphill.map(|way| -level.signum() * way);
            pieces.extend(crossings.chunks_exact(2).map(|pair| Piece { ends: [pair[0], pair[1]], inwards }));
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_around_a_hill_is_a_circle() {
        let n = 41;
        let radius = |x: f64, y: f64| (x - 20.0).hypot(y - 20.0);
        let values: Vec<f64> = (0..n * n).map(|cell| radius((cell / n) as f64, (cell % n) as f64)).collect();
        let pieces = edge(&values, n, n, 12.3);
        assert!(pieces.len() > 60, "{}", pieces.len());
        for [x, y] in pieces.iter().flat_map(|piece| piece.ends) {
            assert!((radius(x, y) - 12.3).abs() < 0.05, "{x} {y}");
        }
        let length: f64 = pieces.iter().map(|Piece { ends: [[a, b], [c, d]], .. }| (a - c).hypot(b - d)).sum();
        for Piece { ends: [[x, y], _], inwards } in &pieces {
            assert!(inwards[0] * (20.0 - x) + inwards[1] * (20.0 - y) > 0.0, "the region is inside");
        }
        assert!((length / (std::f64::consts::TAU * 12.3) - 1.0).abs() < 0.02, "{length}");
    }

    #[test]
    fn there_is_no_line_at_cells_without_a_number() {
        let values = [0.0, 1.0, f64::NAN, 1.0];
        assert!(edge(&values, 2, 2, 0.5).is_empty());
        let piece = Piece { ends: [[1.0, 0.5], [0.0, 0.5]], inwards: [0.0, -2.0] };
        assert_eq!(edge(&[0.0, 1.0, 0.0, 1.0], 2, 2, 0.5), [piece]);
    }
}
