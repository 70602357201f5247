//! Frequency responses with their bands, over the spectrum of the force.

mod curves;

use std::sync::Arc;

use egui::{Align2, Color32, RichText, Stroke, Ui, UiBuilder, vec2};
use egui_plot::{FilledArea, Line, LineStyle, PlotPoint, PlotUi, Points, Text, VLine};
use kalmanscope_core::Estimates;
use kalmanscope_core::frequency_response::Believed;

use crate::plot::heading::{Readout, heading_ui};
use crate::plot::plane::Plane;
use crate::request::Request;
use crate::text::{in_hertz, significant};
use crate::view::{View, ViewContext};
use curves::ResponseCurves;

const HEADING: f32 = 22.0;
const SPECTRUM: f64 = 0.22;
/// Limits the visible range of the magnitudes, and of the bands above the lines \[decades\].
const MOST: (f64, f64) = (6.0, 0.3);

/// The least distance of a line from the edges of the plot \[decades\].
const HEADROOM: f64 = 0.08;
// Zero and infinity are drawn at this power of ten, which no magnitude in sight has.
const BOUNDLESS: f64 = 300.0;

pub(super) static VIEW: View = View {
    name: "Frequency response",
    help: [
        "The displacement of the first mass per force at each frequency: the truth thick, and each filter with its 95 % band. A nonlinear plant is shown for small motion.",
        "A peak in the wrong place is a wrong natural frequency, a peak too high or too low a wrong damping.",
        "At the bottom, on a scale of its own, is the spectrum of the force so far: a frequency without excitation gives a filter no information.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Request>) -> Option<f64> {
    let ViewContext { session, palette, visible, axis, .. } = *context;
    let k = axis.readout(session);
    let curves = ResponseCurves::at(ui, session, k, |id| visible.filter(id));
    let drawn = Drawn::new(&curves, context);
    let (heading, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEADING), egui::Sense::hover());
    let labels = ["angular frequency ω [rad/s]", "|H| [s²]"];
    let plane = Plane { logarithmic: [true; 2], ..Plane::linear("frequency response", labels) };
    let plot = plane.show(ui, palette, Some(drawn.range()), |plot| {
        let pointed = plot.pointer_coordinate().filter(|_| plot.response().hovered());
        let pointed = pointed.map(|point| curves.nearest(point.x));
        drawn.draw(plot, context, pointed);
        pointed
    });
    let mut heading = ui.new_child(UiBuilder::new().max_rect(heading));
    if let Some(i) = plot.inner.or_else(|| drawn.peak()) {
        heading_ui(&mut heading, "|H|", "displacement over force per mass", "s²", &readouts(&curves, i, context));
    }
    None
}

fn readouts(curves: &ResponseCurves, i: usize, context: &ViewContext<'_>) -> Vec<Readout> {
    let ViewContext { session, palette, visible, .. } = *context;
    let frequency = curves.frequencies[i];
    let hint = "The frequency under the pointer, else that of the peak".to_owned();
    let at = Readout::new(format!("at {} rad/s", significant(frequency, 3)), palette.weak, hint);
    let mut readouts = vec![Readout { aside: in_hertz(frequency, "rad/s"), ..at }];
    let truth = curves.truth.iter().filter(|_| visible.truth);
    readouts.extend(truth.map(|truth| Readout::new(significant(truth[i], 3), palette.truth, "truth".to_owned())));
    for (believed, estimates) in curves.filters.iter().zip(session.run().estimates()) {
        let Some(believed) = believed else { continue };
        let name = estimates.name();
        let hint = believed.band.as_ref().map_or_else(
            || name.to_owned(),
            |(low, high)| format!("{name}, 95 %: {} to {}", significant(low[i], 3), significant(high[i], 3)),
        );
        readouts.push(Readout::new(significant(believed.mean[i], 3), context.color(estimates), hint));
    }
    readouts
}

struct Drawn<'a> {
    curves: &'a ResponseCurves,
    frequencies: Vec<f64>,
    truth: Option<Vec<f64>>,
    filters: Vec<FilterResponse>,
}

struct FilterResponse {
    color: Color32,
    mean: Vec<f64>,
    band: Option<[Vec<f64>; 2]>,
}

impl<'a> Drawn<'a> {
    fn new(curves: &'a ResponseCurves, context: &ViewContext<'_>) -> Self {
        let visible = context.visible;
        let of_filter = |(believed, estimates): (&Option<Arc<Believed>>, &Estimates)| {
            let Believed { mean, band } = believed.as_deref()?;
            let band = band.as_ref().filter(|_| visible.bands);
            let band = band.and_then(|(low, high)| Some([logarithms(low)?, logarithms(high)?]));
            let color = context.color(estimates);
            Some(FilterResponse { color, mean: logarithms(mean)?, band })
        };
        Self {
            curves,
            frequencies: curves.frequencies.iter().map(|w| w.log10()).collect(),
            truth: curves.truth.as_ref().filter(|_| visible.truth).and_then(|truth| logarithms(truth)),
            filters: curves.filters.iter().zip(context.session.run().estimates()).filter_map(of_filter).collect(),
        }
    }

    /// All of the lines and a margin of the bands, in steps, so that the range is constant most of the time.
    fn range(&self) -> [(f64, f64); 2] {
        let lines = self.truth.iter().chain(self.filters.iter().map(|filter| &filter.mean));
        let extent = |values: &mut dyn Iterator<Item = f64>| {
            values.filter(|y| y.abs() < BOUNDLESS).map(|y| (y, y)).reduce(|(l, h), (y, _)| (l.min(y), h.max(y)))
        };
        let (low, high) = extent(&mut lines.flatten().copied()).unwrap_or((-3.0, 0.0));
        let bands = self.filters.iter().filter_map(|filter| filter.band.as_ref());
        let beyond = extent(&mut bands.flat_map(|[_, high]| high).copied()).map_or(high, |(_, most)| most);
        let high = (4.0 * (high.max(beyond.min(high + MOST.1)) + HEADROOM)).ceil() / 4.0;
        let low = (4.0 * (low - HEADROOM)).floor() / 4.0;
        let x = (self.frequencies.first().copied().unwrap_or(0.0), self.frequencies.last().copied().unwrap_or(1.0));
        [x, (low.max(high - MOST.0), high)]
    }

    fn peak(&self) -> Option<usize> {
        let line = self.truth.as_ref().or_else(|| self.filters.first().map(|filter| &filter.mean))?;
        (0..line.len()).filter(|&i| line[i].abs() < BOUNDLESS).max_by(|&i, &j| line[i].total_cmp(&line[j]))
    }

    fn draw(&self, plot: &mut PlotUi<'_>, context: &ViewContext<'_>, pointed: Option<usize>) {
        let Self { curves: _, frequencies, truth, filters } = self;
        let palette = context.palette;
        self.draw_spectrum(plot, context);
        for FilterResponse { color, mean: _, band } in filters {
            let fill = color.gamma_multiply(0.22);
            if let Some([low, high]) = band {
                let edge = Stroke::new(0.7, fill.gamma_multiply(0.8));
                let area = FilledArea::new("band", frequencies, low, high).fill_color(fill);
                plot.add(area.stroke(edge).allow_hover(false));
            }
        }
        let lines = truth.iter().map(|truth| (truth, palette.truth, 3.0));
        let lines = lines.chain(filters.iter().map(|filter| (&filter.mean, filter.color, 1.6)));
        for (line, color, width) in lines {
            let points: Vec<[f64; 2]> = frequencies.iter().zip(line).map(|(&x, &y)| [x, y]).collect();
            plot.line(Line::new("response", points).color(color).width(width).allow_hover(false));
            if let Some(i) = pointed {
                let point = Points::new("pointed", vec![[frequencies[i], line[i]]]).color(color);
                plot.points(point.radius(1.5 + width).allow_hover(false));
            }
        }
        if let Some(i) = pointed {
            let line = VLine::new("pointed", frequencies[i]).color(palette.weak).width(1.0);
            plot.vline(line.style(LineStyle::dashed_dense()).allow_hover(false));
        }
    }

    fn draw_spectrum(&self, plot: &mut PlotUi<'_>, context: &ViewContext<'_>) {
        let palette = context.palette;
        let [x, y] = if plot.auto_bounds().any() {
            self.range()
        } else {
            let bounds = plot.plot_bounds();
            [0, 1].map(|axis| (bounds.min()[axis], bounds.max()[axis]))
        };
        let height = SPECTRUM * (y.1 - y.0);
        let (label, top) = if let Some(spectrum) = &self.curves.spectrum {
            let (frequencies, top): (Vec<f64>, Vec<f64>) =
                spectrum.iter().map(|&(w, amplitude)| (w.log10(), y.0 + height * amplitude)).unzip();
            let area = FilledArea::new("spectrum", &frequencies, &vec![y.0; top.len()], &top);
            let fill = palette.force.gamma_multiply(0.22);
            let edge = Stroke::new(1.0, palette.force.gamma_multiply(0.5));
            plot.add(area.fill_color(fill).stroke(edge).allow_hover(false));
            ("spectrum of the force, own scale", SPECTRUM)
        } else {
            ("no force", 0.0)
        };
        let corner = PlotPoint::new(x.0 + 0.012 * (x.1 - x.0), y.0 + (top + 0.012) * (y.1 - y.0));
        let text = Text::new("spectrum", corner, RichText::new(label).small()).color(palette.weak);
        plot.text(text.anchor(Align2::LEFT_BOTTOM).allow_hover(false));
    }
}

/// Logarithms to the base of ten, all finite so that they can be drawn; `None` if a value overflowed on the way and is no number.
fn logarithms(values: &[f64]) -> Option<Vec<f64>> {
    let logarithm = |x: &f64| (!x.is_nan()).then(|| x.log10().clamp(-BOUNDLESS, BOUNDLESS));
    values.iter().map(logarithm).collect()
}

impl ResponseCurves {
    fn nearest(&self, logarithm: f64) -> usize {
        let after = self.frequencies.partition_point(|w| w.log10() < logarithm);
        let distance = |i: usize| (self.frequencies[i].log10() - logarithm).abs();
        let last = self.frequencies.len().saturating_sub(1);
        let (before, after) = (after.saturating_sub(1), after.min(last));
        if distance(before) < distance(after) { before } else { after }
    }
}
