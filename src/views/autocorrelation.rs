//! The autocorrelation of the innovations, a test of their whiteness.

use std::ops::Range;

use egui::Ui;
use egui_plot::{Bar, BarChart, HLine, LineStyle};

use crate::plot::medium::{Medium, cells_ui};
use crate::plot::plane::Plane;
use crate::request::Request;
use crate::ruler::RulerEnd;
use crate::session::Wanted;
use crate::view::{View, ViewContext};
use kalmanscope_core::diagnostics::Whiteness;

fn span(context: &ViewContext<'_>) -> Option<Range<usize>> {
    let [a, b] = RulerEnd::BOTH.map(|end| context.ruler.time(end).map(|time| context.session.sample_at(time)));
    let (a, b) = (a?, b?);
    (a != b).then(|| a.min(b)..a.max(b) + 1)
}

pub(super) static VIEW: View = View {
    name: "Autocorrelation",
    help: [
        "The correlation of each sensor's innovations with those some samples later, from −1 to 1.",
        "Innovations of a well tuned filter are white: 19 of 20 bars are between the dashed lines.",
        "Positive bars that fall slowly: the filter follows too slowly. Negative first bars: it follows the noise.",
    ],
    wanted: Wanted::DIAGNOSTICS,
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Request>) -> Option<f64> {
    let ViewContext { session, palette, .. } = *context;
    let sensors = session.sensors();
    if sensors.is_empty() {
        ui.weak("Nothing is measured.");
    }
    let filters: Vec<_> = context.diagnostics().collect();
    let span = span(context);
    ui.small(match (&span, Medium::of(ui.ctx())) {
        (Some(_), _) => "From A to B.",
        (None, Medium::Screen) => "Of all samples; mark A and B for a part of them.",
        (None, Medium::Figure | Medium::Film) => "Of all samples.",
    });
    cells_ui(ui, sensors.len(), &mut |ui, sensor, last_row| {
        let mut band = 0.0_f64;
        let (mut lowest, mut highest) = (0.0_f64, 0.0_f64);
        let mut charts = Vec::new();
        let width = 0.8 / filters.len().max(1) as f64;
        for (i, (_, estimates, diagnostics)) in filters.iter().enumerate() {
            let of_span = span.clone().map(|samples| Whiteness::over(estimates, sensor, samples));
            let Some(whiteness) = of_span.or_else(|| diagnostics.whiteness.get(sensor).cloned()) else {
                continue;
            };
            let correlations = whiteness.autocorrelation();
            for &r in correlations.iter().filter(|r| r.is_finite()) {
                (lowest, highest) = (lowest.min(r), highest.max(r));
            }
            band = band.max(whiteness.band()).min(1.0);
            let offset = (i as f64 + 0.5) * width - 0.4;
            let bar = |(lag, r): (usize, &f64)| Bar::new((lag + 1) as f64 + offset, *r).width(width);
            let bars: Vec<Bar> = correlations.iter().enumerate().filter(|(_, r)| r.is_finite()).map(bar).collect();
            charts.push(BarChart::new("autocorrelation", bars).color(context.color(estimates)).allow_hover(false));
        }
        // The range grows in steps, so that bars can be compared while a record grows.
        let [low, high] = [-lowest, highest].map(|r| {
            let enough = |reach: &f64| *reach >= 1.1 * r.max(band);
            [0.108, 0.27, 0.54].into_iter().find(enough).unwrap_or(1.1)
        });
        let range = Some([(0.3, kalmanscope_core::diagnostics::LAGS as f64 + 0.7), (-low, high)]);
        let key = format!("autocorrelation of the {} innovations", sensors[sensor].key());
        let label = format!("r of e({})", sensors[sensor].symbol());
        let lag = if last_row { "lag [samples]" } else { "" };
        Plane::linear(&key, [lag, &label]).show(ui, palette, range, |plot| {
            for chart in charts {
                plot.bar_chart(chart);
            }
            for edge in [-band, band] {
                let style = LineStyle::dashed_dense();
                plot.hline(HLine::new("band", edge).color(palette.weak).style(style).allow_hover(false));
            }
        });
    });
    None
}
