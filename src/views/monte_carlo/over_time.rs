//! The charts: NEES, NIS and the error of the parameter over time, and the histogram of the last estimates.

use std::ops::RangeInclusive;

use egui::{Color32, RichText, Tooltip, Ui};
use egui_plot::{Bar, BarChart, FilledArea, HLine, Line, LineStyle, PlotUi, VLine};
use kalmanscope_core::Channel;

use super::curves::{FilterCurves, SeedCurves};
use crate::plot::plane::Plane;
use crate::session::Bound;
use crate::text::{fixed, significant};
use crate::view::ViewContext;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeChart {
    Nees,
    Nis,
    Error,
}

const FILL: f32 = 0.16;
const GREY: f32 = 0.32;
const BARS: f32 = 0.35;

/// Limits the axis of NEES and NIS.
const RATIOS: RangeInclusive<f64> = 1e-3..=1e6;

impl TimeChart {
    pub(super) const ALL: [Self; 3] = [Self::Nees, Self::Nis, Self::Error];

    pub(super) fn is_in(self, curves: &SeedCurves) -> bool {
        let has = |values: &[f64]| values.iter().any(|value| value.is_finite());
        match self {
            Self::Nees => curves.filters.iter().any(|filter| has(&filter.nees)),
            Self::Nis => curves.filters.iter().any(|filter| has(&filter.nis)),
            Self::Error => curves.parameter.is_some(),
        }
    }

    pub(super) fn ui(self, ui: &mut Ui, curves: &SeedCurves, context: &ViewContext<'_>) {
        let name = self.name(curves, context);
        let plane = Plane { logarithmic: [false, self != Self::Error], ..Plane::linear(&name, ["time [s]", &name]) };
        let times = (0.0, curves.duration.max(f64::MIN_POSITIVE));
        let plot = plane.show(ui, context.palette, Some([times, self.range(curves)]), |plot| {
            match self {
                Self::Nees | Self::Nis => self.draw_ratios(plot, curves, context),
                Self::Error => draw_errors(plot, curves, context),
            }
            let time = plot.pointer_coordinate().filter(|_| plot.response().hovered())?.x;
            let distance = |at: &usize| (curves.times[*at] - time).abs();
            let at = (0..curves.times.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            plot.vline(
                VLine::new("pointed", curves.times[at]).color(context.palette.weak).width(1.0).allow_hover(false),
            );
            Some(at)
        });
        let Some(at) = plot.inner else { return };
        Tooltip::for_widget(&plot.response).at_pointer().gap(12.0).show(|ui| {
            ui.weak(format!("{} s, {} seeds", significant(curves.times[at], 4), curves.seeds));
            for filter in &curves.filters {
                ui.label(RichText::new(self.said(filter, at, curves)).color(color(context, filter.id)));
            }
        });
    }

    fn name(self, curves: &SeedCurves, context: &ViewContext<'_>) -> String {
        match (self, curves.parameter) {
            (Self::Nees, _) => "mean NEES".to_owned(),
            (Self::Nis, _) => "mean NIS".to_owned(),
            (Self::Error, None) => String::new(),
            (Self::Error, Some(channel)) => named("error of ", channel, context),
        }
    }

    fn ratios(self, filter: &FilterCurves) -> (&[f64], &[Option<RangeInclusive<f64>>]) {
        match self {
            Self::Nees => (&filter.nees, &filter.nees_band),
            Self::Nis | Self::Error => (&filter.nis, &filter.nis_band),
        }
    }

    fn range(self, curves: &SeedCurves) -> (f64, f64) {
        if self == Self::Error {
            let reach = reach(curves);
            return (-reach, reach);
        }
        let (mut low, mut high) = (0.5_f64, 2.0_f64);
        for filter in &curves.filters {
            let (values, bands) = self.ratios(filter);
            let ends = bands.iter().flatten().flat_map(|band| [*band.start(), *band.end()]);
            for value in values.iter().copied().chain(ends).filter(|value| *value > 0.0 && value.is_finite()) {
                (low, high) = (low.min(value / 1.15), high.max(value * 1.15));
            }
        }
        (low.max(*RATIOS.start()).log10(), high.min(*RATIOS.end()).log10())
    }

    fn draw_ratios(self, plot: &mut PlotUi<'_>, curves: &SeedCurves, context: &ViewContext<'_>) {
        let palette = context.palette;
        let mut drawn: Vec<&[Option<RangeInclusive<f64>>]> = Vec::new();
        for filter in &curves.filters {
            let (_, bands) = self.ratios(filter);
            // Filters with equal degrees of freedom share one band.
            if drawn.contains(&bands) {
                continue;
            }
            drawn.push(bands);
            let ends = |band: &Option<RangeInclusive<f64>>| {
                band.as_ref().map_or([f64::NAN; 2], |band| [band.start().log10(), band.end().log10()])
            };
            band(plot, &curves.times, bands.iter().map(ends), palette.grid.gamma_multiply(GREY));
        }
        plot.hline(HLine::new("one", 0.0).color(palette.truth).width(1.0).allow_hover(false));
        for (at, filter) in curves.filters.iter().enumerate() {
            let (values, _) = self.ratios(filter);
            let values = values.iter().map(|value| value.log10());
            plot.line(line(&curves.times, values, width(at), color(context, filter.id)));
        }
    }

    fn said(self, filter: &FilterCurves, at: usize, curves: &SeedCurves) -> String {
        let name = &filter.name;
        if self != Self::Error {
            let (values, bands) = self.ratios(filter);
            let value = values.get(at).copied().unwrap_or(f64::NAN);
            let band = bands.get(at).cloned().flatten();
            let band = band.map_or(String::new(), |band| format!(", 95 % in {:.3} to {:.3}", band.start(), band.end()));
            return format!("{name}: {}{band}", significant(value, 3));
        }
        let decimals = curves.parameter.map_or(3, crate::text::decimals) + 1;
        let Some([low, middle, high]) = filter.quantiles.get(at) else { return format!("{name}: –") };
        let std = filter.std.get(at).copied().unwrap_or(f64::NAN);
        let [low, middle, high, reach] = [*low, *middle, *high, 2.0 * std].map(|value| fixed(value, decimals));
        format!("{name}: {low}, median {middle}, {high}; ±2σ = {reach}")
    }
}

pub(super) fn named(what: &str, channel: Channel, context: &ViewContext<'_>) -> String {
    let unit = context.unit(channel.unit());
    let symbol = channel.symbol();
    if unit.is_empty() { format!("{what}{symbol}") } else { format!("{what}{symbol} [{unit}]") }
}

pub(super) fn color(context: &ViewContext<'_>, id: u32) -> Color32 {
    let own = context.session.scenario().filters.iter().find(|filter| filter.id == id);
    own.map_or(context.palette.text, |filter| context.palette.shade(crate::controls::filter::color_of(filter)))
}

/// The width of the line of the filter at a place. Later lines are thinner, so that they do not hide earlier ones.
fn width(at: usize) -> f32 {
    (3.4 - 1.4 * at as f32).max(1.4)
}

/// The largest error on the axis. The first tenth of the times, with their wide beliefs, may go beyond it.
fn reach(curves: &SeedCurves) -> f64 {
    let mut reach = 0.0_f64;
    for filter in &curves.filters {
        let begin = filter.quantiles.len() / 10;
        for ([low, _, high], std) in filter.quantiles.iter().zip(&filter.std).skip(begin) {
            for value in [low.abs(), high.abs(), 2.0 * std] {
                reach = if value.is_finite() { reach.max(value) } else { reach };
            }
        }
    }
    if reach > 0.0 { 1.15 * reach } else { 1.0 }
}

fn draw_errors(plot: &mut PlotUi<'_>, curves: &SeedCurves, context: &ViewContext<'_>) {
    let times = &curves.times[..];
    for filter in &curves.filters {
        let edges = filter.std.iter().map(|std| [-2.0 * std, 2.0 * std]);
        band(plot, times, edges, color(context, filter.id).gamma_multiply(FILL));
    }
    plot.hline(HLine::new("zero", 0.0).color(context.palette.truth).width(1.0).allow_hover(false));
    for (at, filter) in curves.filters.iter().enumerate() {
        for (quantile, width) in [(0, 1.0), (1, width(at)), (2, 1.0)] {
            let values = filter.quantiles.iter().map(|all| all[quantile]);
            plot.line(line(times, values, width, color(context, filter.id)));
        }
    }
    for (id, reach) in bounds(curves, context) {
        for sign in [-2.0, 2.0] {
            let bound = line(times, reach.iter().map(|std| sign * std), 1.2, color(context, id));
            plot.line(bound.style(LineStyle::dashed_loose()));
        }
    }
}

fn bounds(curves: &SeedCurves, context: &ViewContext<'_>) -> Vec<(u32, Vec<f64>)> {
    // The bound is that of one truth.
    let Some(channel) = curves.parameter.filter(|_| !curves.is_of_errors) else { return Vec::new() };
    let one = |Bound { bound, filters }: &Bound| {
        let first = curves.filters.iter().find(|filter| filters.contains(&filter.id))?;
        let at = bound.place(channel)?;
        let std = |sample: &usize| if *sample < bound.len() { bound.std(*sample, at) } else { f64::NAN };
        Some((first.id, curves.samples.iter().map(std).collect()))
    };
    context.session.bounds().iter().filter_map(one).collect()
}

fn band(plot: &mut PlotUi<'_>, times: &[f64], edges: impl Iterator<Item = [f64; 2]>, color: Color32) {
    let rungs: Vec<(f64, [f64; 2])> = times.iter().copied().zip(edges).collect();
    for part in rungs.split(|(_, edges)| !edges.iter().all(|edge| edge.is_finite())).filter(|part| part.len() > 1) {
        let times: Vec<f64> = part.iter().map(|(time, _)| *time).collect();
        let [low, high] = [0, 1].map(|edge| part.iter().map(|(_, edges)| edges[edge]).collect::<Vec<f64>>());
        plot.add(FilledArea::new("band", &times, &low, &high).fill_color(color).allow_hover(false));
    }
}

fn line<'a>(times: &[f64], values: impl Iterator<Item = f64>, width: f32, color: Color32) -> Line<'a> {
    let points: Vec<[f64; 2]> = times.iter().zip(values).map(|(time, value)| [*time, value]).collect();
    Line::new("line", points).color(color).width(width).allow_hover(false).allow_band(false)
}

pub(super) fn last_estimates_ui(ui: &mut Ui, curves: &SeedCurves, context: &ViewContext<'_>) {
    let Some(channel) = curves.parameter else { return };
    let histogram = &curves.histogram;
    let highest = histogram.counts.iter().flatten().copied().max().unwrap_or_default().max(1);
    let what = if curves.is_of_errors { "last error of " } else { "last estimate of " };
    let name = named(what, channel, context);
    let range = [(histogram.from, histogram.to), (0.0, 1.08 * highest as f64)];
    let plot = Plane::linear(&name, [&name, "seeds"]).show(ui, context.palette, Some(range), |plot| {
        for (filter, counts) in curves.filters.iter().zip(&histogram.counts) {
            let color = color(context, filter.id);
            let bar = |(bar, count): (usize, &usize)| {
                let [from, to] = histogram.ends(bar);
                Bar::new(0.5 * (from + to), *count as f64).width(to - from).fill(color.gamma_multiply(BARS))
            };
            let bars: Vec<Bar> = counts.iter().enumerate().map(bar).collect();
            plot.bar_chart(BarChart::new("seeds", bars).color(color).allow_hover(false));
        }
        if let Some(truth) = curves.truth.or(curves.is_of_errors.then_some(0.0)) {
            plot.vline(VLine::new("truth", truth).color(context.palette.truth).width(1.6).allow_hover(false));
        }
        plot.pointer_coordinate().filter(|_| plot.response().hovered() && histogram.bars() > 0).map(|at| at.x)
    });
    let Some(value) = plot.inner else { return };
    let share = (value - histogram.from) / (histogram.to - histogram.from);
    let bar = ((share * histogram.bars() as f64).max(0.0) as usize).min(histogram.bars() - 1);
    let [from, to] = histogram.ends(bar);
    Tooltip::for_widget(&plot.response).at_pointer().gap(12.0).show(|ui| {
        ui.weak(format!("{} to {} {}", significant(from, 5), significant(to, 5), context.unit(channel.unit())));
        for ((filter, counts), beyond) in curves.filters.iter().zip(&histogram.counts).zip(&histogram.beyond) {
            let aside = if *beyond > 0 { format!(", and {beyond} beyond the ends") } else { String::new() };
            let text = format!("{}: {} of {} seeds{aside}", filter.name, counts[bar], curves.seeds);
            ui.label(RichText::new(text).color(color(context, filter.id)));
        }
    });
}
