//! Lines and bands that coincide: lines take turns, so that each colour is seen, and bands are filled once.

use std::borrow::Cow;
use std::ops::Range;

use kalmanscope_core::Record;

use super::layers::{Layer, LayerColumns, Scale};
use super::series::{BandColumn, Column};

/// Lines closer than this coincide \[points\].
const CLOSE: f64 = 1.2;

/// The length of a turn \[points\].
const TURN: f64 = 9.0;

pub(super) fn drawn_runs<'c>(
    layers: &[Layer<'_>],
    columns: &'c [LayerColumns],
    record: &Record,
    scale: Scale,
) -> Vec<Vec<Range<usize>>> {
    let now: Vec<&[Column]> =
        layers.iter().zip(columns).filter_map(|(layer, columns)| of_now(layer, columns)).collect();
    let mut lines: Vec<Cow<'_, [Column]>> = Vec::new();
    let mut bands: Vec<&[BandColumn]> = Vec::new();
    let of_layer = |(layer, columns): (&Layer<'_>, &'c LayerColumns)| match (layer, columns) {
        (Layer::Line { dashed: false, bounds: false, .. }, LayerColumns::Series(columns)) => {
            let mut below = vec![0; columns.len()];
            for other in &lines {
                for (below, is_close) in below.iter_mut().zip(coinciding(columns, other, extent_of_line, scale)) {
                    *below += i64::from(is_close);
                }
            }
            let is_drawn = columns.iter().zip(below).map(|(column, below)| is_its_turn(column, below, record, scale));
            let runs = joined(runs(is_drawn));
            lines.push(Cow::Borrowed(columns));
            runs
        }
        (&Layer::Before { now: own, .. }, LayerColumns::Series(columns)) => {
            let own = now.get(own).copied().unwrap_or_default();
            let differs: Vec<bool> =
                coinciding(columns, own, extent_of_line, scale).map(|is_close| !is_close).collect();
            let different = columns.iter().zip(&differs).filter(|(_, differs)| **differs);
            lines.push(different.map(|(column, _)| *column).collect());
            joined(runs(differs))
        }
        (Layer::Band { .. }, LayerColumns::Band(columns)) => {
            let extent = |column: &BandColumn| (column.samples.0, column.low, column.high);
            let mut is_new = vec![true; columns.len()];
            for other in &bands {
                for (is_new, is_close) in is_new.iter_mut().zip(coinciding(columns, other, extent, scale)) {
                    *is_new &= !is_close;
                }
            }
            bands.push(columns);
            runs(is_new)
        }
        (_, LayerColumns::Series(columns)) => whole(columns),
        (_, LayerColumns::Band(columns)) => whole(columns),
        (_, LayerColumns::Level) => whole::<Column>(&[]),
    };
    layers.iter().zip(columns).map(of_layer).collect()
}

fn of_now<'c>(layer: &Layer<'_>, columns: &'c LayerColumns) -> Option<&'c [Column]> {
    match (layer, columns) {
        (Layer::Line { dashed: false, bounds: false, .. }, LayerColumns::Series(columns)) => Some(columns),
        _ => None,
    }
}

/// Runs that share an end with the gap before them, so that nothing is missing between two colours.
fn joined(runs: Vec<Range<usize>>) -> Vec<Range<usize>> {
    runs.into_iter().map(|run| run.start.saturating_sub(1)..run.end).collect()
}

fn extent_of_line(column: &Column) -> (usize, f64, f64) {
    (column.samples.0, column.low, column.high)
}

fn whole<C>(columns: &[C]) -> Vec<Range<usize>> {
    std::iter::once(0..columns.len()).collect()
}

fn runs(are_drawn: impl IntoIterator<Item = bool>) -> Vec<Range<usize>> {
    let drawn: Vec<bool> = are_drawn.into_iter().collect();
    let mut start = 0;
    let mut runs = Vec::new();
    for run in drawn.chunk_by(|a, b| a == b) {
        let end = start + run.len();
        if run[0] {
            runs.push(start..end);
        }
        start = end;
    }
    runs
}

/// Whether a line is drawn in a column: on top of this many earlier lines, all colours take turns.
fn is_its_turn(column: &Column, below: i64, record: &Record, scale: Scale) -> bool {
    if below == 0 {
        return true;
    }
    let turn = (record.time(column.samples.0) * scale.x / TURN).floor() as i64;
    turn.rem_euclid(below + 1) == below
}

/// For each column, whether it looks like that of another series at the same samples. `extent` gives a column's first sample,
/// by which they are in order, and its lowest and highest value.
fn coinciding<'c, C>(
    columns: &'c [C],
    others: &'c [C],
    extent: impl Fn(&C) -> (usize, f64, f64) + 'c,
    scale: Scale,
) -> impl Iterator<Item = bool> + 'c {
    let close = CLOSE / scale.y;
    let mut rest = others;
    columns.iter().map(move |column| {
        let (first, low, high) = extent(column);
        while let [next, later @ ..] = rest
            && extent(next).0 < first
        {
            rest = later;
        }
        rest.first().is_some_and(|other| {
            let (at, other_low, other_high) = extent(other);
            at == first && (other_low - low).abs() < close && (other_high - high).abs() < close
        })
    })
}

#[cfg(test)]
mod tests {
    use egui::{Color32, Vec2};
    use kalmanscope_core::record::Input;
    use kalmanscope_core::{Hold, InputKind};

    use super::super::series::{Band, Series};
    use super::*;
    use crate::plot::layers::Window;

    const N: usize = 400;

    fn line(values: &[f64]) -> Layer<'_> {
        Layer::line(Series::of(values), Color32::RED, 2.0)
    }

    fn runs_of(layers: &[Layer<'_>]) -> Vec<Vec<Range<usize>>> {
        let input = Input { kind: InputKind::Force, hold: Hold::Zero, values: vec![0.0; N] };
        let record = Record::new(0.01, input, vec![]).unwrap();
        let window = Window { times: (0.0, 4.0), values: Some((-1.0, 1.0)), size: Vec2::new(400.0, 200.0) };
        let columns: Vec<LayerColumns> =
            layers.iter().map(|layer| LayerColumns::new(layer, &record, &window)).collect();
        drawn_runs(layers, &columns, &record, window.scale(None).unwrap())
    }

    fn covered(runs: &[Range<usize>], of: usize) -> f64 {
        runs.iter().map(Range::len).sum::<usize>() as f64 / of as f64
    }

    #[test]
    fn coinciding_lines_take_turns_and_others_are_whole() {
        let (same, apart) = (vec![0.0; N], vec![0.5; N]);
        let runs = runs_of(&[line(&same), line(&same), line(&same), line(&apart)]);
        let of = runs[0][0].len();
        assert_eq!((runs[0].len(), runs[3].len(), covered(&runs[3], of)), (1, 1, 1.0));
        assert!(runs[1].len() > 10 && (0.3..0.7).contains(&covered(&runs[1], of)), "{:?}", runs[1]);
        assert!(runs[2].len() > 10 && (0.2..0.5).contains(&covered(&runs[2], of)), "{:?}", runs[2]);
    }

    #[test]
    fn a_line_from_before_is_drawn_where_it_differs_from_that_of_now() {
        let (low, high) = (vec![0.0; N], vec![0.5; N]);
        let half: Vec<f64> = (0..N).map(|k| if k < N / 2 { 0.0 } else { 0.5 }).collect();
        let before = |values, now| Layer::Before { series: Series::of(values), color: Color32::GRAY, now };
        let runs = runs_of(&[before(&low, 0), before(&half, 0), line(&low), line(&high)]);
        let of = runs_of(&[line(&low)])[0][0].len();
        assert!(runs[0].is_empty(), "{:?}", runs[0]);
        assert!((covered(&runs[1], of) - 0.5).abs() < 0.02, "{:?}", runs[1]);
        assert_eq!((runs[2].len(), covered(&runs[2], of)), (1, 1.0), "its own line of now is whole");
        let other = covered(&runs[3], of);
        assert!((0.65..0.85).contains(&other), "the other filter's takes turns with it in one half: {other}");
    }

    #[test]
    fn bands_that_agree_are_filled_once() {
        let (means, variances) = (vec![0.0; N], vec![0.01; N]);
        let half: Vec<f64> = (0..N).map(|k| if k < N / 2 { 0.01 } else { 0.04 }).collect();
        let band = |variances| Layer::Band {
            band: Band::around(&means, variances),
            color: Color32::RED,
            under: 0.0,
            filter: None,
        };
        let runs = runs_of(&[band(&variances), band(&variances), band(&half)]);
        assert!(runs[1].is_empty());
        let of = runs[0][0].len();
        assert_eq!(runs[2].len(), 1);
        assert!((covered(&runs[2], of) - 0.5).abs() < 0.02);
    }
}
