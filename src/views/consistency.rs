//! NIS and NEES over time: the consistency of a filter's covariances with its errors.

use std::ops::Range;

use kalmanscope_core::diagnostics::{Diagnostics, Total, chi_squared};

use crate::plot::chart::{Chart, Curve};
use crate::plot::layers::{Layer, line_width};
use crate::plot::series::PlotSeries;
use crate::session::Wanted;
use crate::text::significant;
use crate::view::{View, ViewContext};

const WINDOW: f64 = 2.0;

pub(super) static VIEW: View = View {
    name: "NIS and NEES",
    help: [
        "Squares of innovations (NIS) and errors (NEES) over their expectation, as a moving mean, on a logarithmic axis.",
        "At 1 the filter is consistent. Above: overconfident. Below: underconfident. Between the dashed lines lie 95 % of the means of a consistent filter, by the χ² distribution.",
        "NIS needs only measurements; NEES needs the truth. Errors change slowly, so NEES strays further than NIS by chance.",
    ],
    wanted: Wanted::DIAGNOSTICS,
    charts,
    plots: |_| 2,
    ..View::NONE
};

fn charts<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    [NIS, NEES].iter().map(|square| chart(square, context)).collect()
}

struct Square {
    symbol: &'static str,
    name: &'static str,
    within: fn(&Diagnostics, Range<usize>) -> Total,
    moving: fn(&Diagnostics, usize, Range<usize>) -> Vec<f64>,
}

const NIS: Square = Square {
    symbol: "NIS",
    name: "normalised innovation squared",
    within: Diagnostics::nis_within,
    moving: Diagnostics::moving_nis,
};
const NEES: Square = Square {
    symbol: "NEES",
    name: "normalised estimation error squared",
    within: Diagnostics::nees_within,
    moving: Diagnostics::moving_nees,
};

fn chart<'a>(square: &Square, context: &ViewContext<'a>) -> Chart<'a> {
    let palette = context.palette;
    let Square { symbol, name, within, moving } = *square;
    let window = (WINDOW / context.session.run().record().dt()).ceil().max(1.0) as usize;
    let remark = format!("over expectation, mean of {WINDOW} s");
    let mut chart = Chart {
        key: symbol.to_owned(),
        title: format!("{symbol}, {name}, {remark}"),
        symbol: symbol.to_owned(),
        name: remark,
        layers: vec![Layer::zero(palette.truth)],
        least: Some((-0.5, 0.5)),
        logarithmic: true,
        ..Chart::default()
    };
    // The samples of one window are independent for NIS; for NEES they count as one.
    let last = context
        .diagnostics()
        .map(|(_, _, d)| within(d, d.len().saturating_sub(window)..d.len()))
        .find(|t| t.degrees > 0);
    if let Some(total) = last {
        let degrees = if symbol == "NIS" { total.degrees } else { total.degrees / total.samples.max(1) };
        if let Some(interval) = chi_squared::quick_interval(degrees, degrees) {
            for (edge, label) in [(interval.start(), "χ² 2.5 %"), (interval.end(), "χ² 97.5 %")] {
                chart.layers.push(Layer::Level { value: edge.log10(), color: palette.weak, label });
            }
        }
    }
    for (place, of, diagnostics) in context.diagnostics() {
        let line = PlotSeries::made(diagnostics.len(), move |samples| moving(diagnostics, window, samples));
        let curve = Curve { line: line.through(f64::log10), band: None, width: line_width(place, 2.0) };
        let ratio = move |k: usize| within(diagnostics, (k + 1).saturating_sub(window)..k + 1).per_degree();
        context.add(&mut chart, of, curve, move |k| (k < diagnostics.len()).then(|| significant(ratio(k), 3)));
    }
    chart
}
