//! Which model: the probabilities of the filters as model classes over time, and their average.

use std::cell::RefCell;
use std::ops::Range;
use std::rc::Rc;

use kalmanscope_core::{Channel, Estimates, Evidence, ModelClasses};

use crate::plot::chart::Chart;
use crate::plot::layers::Layer;
use crate::plot::series::PlotSeries;
use crate::plot::sheet::{SheetColumn, plus_minus};
use crate::session::Wanted;
use crate::text::{decimals, fixed};
use crate::view::{View, ViewContext};

/// Limits the samples at which classes are weighed for one picture; the nearest before holds between them.
const WEIGHED: usize = 2_000;

pub(super) static VIEW: View = View {
    name: "Which model",
    help: [
        "The filters that are shown as model classes: each has a share of the height, the probability that the readings so far give it. All begin alike.",
        "A class gains where it predicts the readings better, by the likelihood of each; one that can fit more predicts more widely, and pays for it.",
        "The plots below are averages over the classes, with what their disagreement adds to ±2σ. If no class is right, one of them is still the likeliest.",
    ],
    wanted: Wanted::EVIDENCE,
    charts,
    plots,
    without_charts: "Show at least two filters: each is a model class.",
    ..View::NONE
};

fn charts<'a>(context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    let classes = Rc::new(Weighed::new(context));
    if classes.all.len() < 2 {
        return Vec::new();
    }
    let averages = channels(context).into_iter().map(|channel| average(&classes, channel, context));
    std::iter::once(shares(&classes, context)).chain(averages).collect()
}

fn plots(context: &ViewContext<'_>) -> usize {
    let classes = context.filters().filter(|(place, _)| context.session.evidence().get(*place).is_some()).count();
    if classes < 2 { 0 } else { 1 + channels(context).len() }
}

struct Weighed<'a> {
    all: Vec<(&'a Estimates, &'a Evidence)>,
    len: usize,
    last: RefCell<(Range<usize>, Rc<[ModelClasses]>)>,
}

impl<'a> Weighed<'a> {
    fn new(context: &ViewContext<'a>) -> Self {
        let evidence = context.session.evidence();
        let all: Vec<_> = context.filters().filter_map(|(place, of)| Some((of, evidence.get(place)?))).collect();
        let len = if all.is_empty() { 0 } else { context.session.run().len() };
        Self { all, len, last: RefCell::new((0..0, Rc::new([]))) }
    }

    fn at(&self, k: usize) -> ModelClasses {
        ModelClasses::new(self.all.iter().map(|(_, evidence)| evidence.at(k).unwrap_or(f64::NEG_INFINITY)))
    }

    fn each(&self, samples: Range<usize>, of: impl Fn(usize, &ModelClasses) -> f64) -> Vec<f64> {
        let stride = samples.len().div_ceil(WEIGHED).max(1);
        if self.last.borrow().0 != samples {
            let weighed = samples.clone().step_by(stride).map(|k| self.at(k)).collect();
            self.last.replace((samples.clone(), weighed));
        }
        let weighed = Rc::clone(&self.last.borrow().1);
        let held = |(k, classes): (usize, &ModelClasses)| std::iter::repeat_n(of(k, classes), stride);
        samples.clone().step_by(stride).zip(weighed.iter()).flat_map(held).take(samples.len()).collect()
    }

    fn average(&self, channel: Channel, k: usize, classes: &ModelClasses) -> Option<(f64, f64)> {
        let of = |class: usize| {
            let (estimates, _) = self.all[class];
            let at = estimates.place(channel).filter(|_| k < estimates.len())?;
            let std = estimates.std(k, at);
            Some((estimates.canonical_mean(k, at), std * std))
        };
        classes.average(of).map(|(mean, variance)| (mean, variance.sqrt()))
    }
}

fn channels(context: &ViewContext<'_>) -> Vec<Channel> {
    let have = |channel: Channel| context.filters().filter(|(_, of)| of.place(channel).is_some()).count();
    let shared = |c: &Channel| c.is_parameter() && have(*c) > 1 && context.in_doubt(*c);
    context.visible.channels(context.session.run().channels().into_iter().filter(shared).collect())
}

fn shares<'a>(classes: &Rc<Weighed<'a>>, context: &ViewContext<'a>) -> Chart<'a> {
    let mut chart = Chart {
        key: "model classes".to_owned(),
        title: "probabilities of the model classes".to_owned(),
        symbol: "P".to_owned(),
        name: "of each class".to_owned(),
        least: Some((0.0, 1.0)),
        ..Chart::default()
    };
    for (class, &(estimates, _)) in classes.all.iter().enumerate() {
        let below = |count: usize| {
            let classes = Rc::clone(classes);
            move |samples| classes.each(samples, |_, all| all.probabilities[..count].iter().sum::<f64>())
        };
        let (low, high) = (below(class), below(class + 1));
        let edges = move |samples: Range<usize>| low(samples.clone()).into_iter().zip(high(samples)).collect();
        let (color, filter, len) = (context.color(estimates), Some(estimates.id()), classes.len);
        chart.bands.push(Layer::Band { series: PlotSeries::made::<(f64, f64)>(len, edges), color, filter });
        if class > 0 {
            chart.layers.push(Layer::line(PlotSeries::made(len, below(class)), context.palette.weak, 1.0));
        }
        let own = Rc::clone(classes);
        let percent = move |k: usize| ModelClasses::in_percent(own.at(k).probabilities[class]);
        chart.columns.push(SheetColumn::new(estimates.name(), color, move |k| (k < len).then(|| percent(k))));
    }
    chart
}

fn average<'a>(classes: &Rc<Weighed<'a>>, channel: Channel, context: &ViewContext<'a>) -> Chart<'a> {
    let ViewContext { session, palette, visible, .. } = *context;
    let run = session.run();
    let title = format!("average {}", channel.name());
    let mut chart = Chart {
        key: format!("average {}", channel.key()),
        name: title.clone(),
        title,
        symbol: channel.symbol().to_owned(),
        unit: context.unit(channel.unit()),
        ..Chart::default()
    };
    let of = |sigmas: f64| {
        let classes = Rc::clone(classes);
        move |samples| {
            classes.each(samples, |k, all| {
                classes.average(channel, k, all).map_or(f64::NAN, |(mean, std)| mean + sigmas * std)
            })
        }
    };
    if visible.bands {
        let (low, high) = (of(-2.0), of(2.0));
        let edges = move |samples: Range<usize>| low(samples.clone()).into_iter().zip(high(samples)).collect();
        let series = PlotSeries::made::<(f64, f64)>(classes.len, edges);
        chart.bands.push(Layer::Band { series, color: palette.weak, filter: None });
    }
    let decimals = decimals(channel);
    if let Some(truth) = run.record().truth(channel) {
        if visible.truth {
            chart.layers.push(Layer::line(PlotSeries::of(&truth[..run.len()]), palette.truth, 4.0));
        }
        chart.columns.push(SheetColumn::new("truth", palette.truth, move |k| Some(fixed(*truth.get(k)?, decimals))));
    }
    chart.layers.push(Layer::line(PlotSeries::made(classes.len, of(0.0)), palette.weak, 2.0));
    let own = Rc::clone(classes);
    chart.columns.push(SheetColumn::new("average", palette.weak, move |k| {
        let (mean, std) = (k < own.len).then(|| own.average(channel, k, &own.at(k)))??;
        Some(plus_minus(mean, std, decimals))
    }));
    chart
}
