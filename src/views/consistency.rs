//! NIS and NEES over time: the consistency of a filter's covariances with its errors.

use egui::Ui;
use kalmanscope_core::diagnostics::{Depth, Diagnostics, Total, chi_squared};

use crate::plot::chart::Chart;
use crate::plot::charts::charts_ui;
use crate::plot::heading::Readout;
use crate::plot::layers::{Layer, line_width};
use crate::plot::series::Series;
use crate::request::Request;
use crate::session::Wanted;
use crate::text::significant;
use crate::view::{View, ViewContext};

/// Duration of the moving mean \[s\].
const WINDOW: f64 = 2.0;

/// Normalised squares of innovations and errors.
pub(super) struct Consistency;

impl View for Consistency {
    fn name(&self) -> &'static str {
        "NIS and NEES"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "Squares of innovations (NIS) and errors (NEES) over their expectation, as a moving mean, on a logarithmic axis.",
            "At 1 the filter is consistent. Above: overconfident. Below: underconfident. Between the dashed lines chance explains the difference.",
            "NIS needs only measurements; NEES needs the truth. Errors change slowly, so NEES strays further than NIS by chance.",
        ]
    }

    fn wanted(&self) -> Wanted {
        Wanted::diagnostics(Depth::Consistency)
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
        charts_ui(ui, 2, &context.plot_input(), requests, |i, last_row| {
            if i == 0 {
                chart("NIS", "normalised innovation squared", context, last_row, Diagnostics::nis_within)
            } else {
                chart("NEES", "normalised estimation error squared", context, last_row, Diagnostics::nees_within)
            }
        })
    }
}

fn chart<'a>(
    symbol: &str,
    name: &str,
    context: &ViewContext<'a>,
    last_row: bool,
    within: fn(&Diagnostics, std::ops::Range<usize>) -> Total,
) -> Chart<'a> {
    let ViewContext { session, palette, axis, .. } = *context;
    let window = (WINDOW / session.run().record().dt()).ceil().max(1.0) as usize;
    let ratio = move |diagnostics: &Diagnostics, k: usize| {
        within(diagnostics, (k + 1).saturating_sub(window)..k + 1).per_degree()
    };
    let k = axis.readout(session);
    let mut layers: Vec<Layer<'a>> = vec![Layer::Level { value: 0.0, color: palette.truth }];
    let mut readouts = Vec::new();
    // The samples of one window are independent for NIS; for NEES they count as one.
    let last = context
        .diagnostics()
        .map(|(_, _, d)| within(d, d.len().saturating_sub(window)..d.len()))
        .find(|t| t.degrees > 0);
    if let Some(total) = last {
        let degrees = if symbol == "NIS" { total.degrees } else { total.degrees / total.samples.max(1) };
        if let Some(interval) = chi_squared::quick_interval(degrees, degrees) {
            for edge in [interval.start(), interval.end()] {
                layers.push(Layer::Level { value: edge.log10(), color: palette.weak });
            }
        }
    }
    for (place, estimates, diagnostics) in context.diagnostics() {
        layers.push(Layer::Line {
            series: Series::new(diagnostics.len(), move |samples| samples.map(move |k| ratio(diagnostics, k)))
                .through(f64::log10),
            color: palette.shade(estimates.color()),
            width: line_width(place, 2.0),
            dashed: false,
            bounds: false,
        });
        if k < diagnostics.len() {
            readouts.push(Readout {
                text: significant(ratio(diagnostics, k), 3),
                color: palette.shade(estimates.color()),
                hint: estimates.name().to_owned(),
            });
        }
    }
    Chart {
        key: symbol.to_owned(),
        title: name.to_owned(),
        symbol: symbol.to_owned(),
        name: format!("over expectation, mean of {WINDOW} s"),
        unit: "",
        readouts,
        layers,
        handles: Vec::new(),
        last_row,
        least: Some((-0.5, 0.5)),
        logarithmic: true,
    }
}
