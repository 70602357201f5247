//! Truth, measurements and estimates over time, as a picture.

use kalmanscope_core::{Channel, Estimates, Quantity, Record, Run};
use kalmanscope_figures::{Anchor, Axes, Color, Style, Svg, Text};

use crate::estimates_csv::SensorEstimate;
use crate::number::plain;
use crate::series::{bands, line, padded, thinned, union, without_tails};
use crate::table::heading;

const WIDTH: f32 = 1100.0;
const PLOT_HEIGHT: f32 = 240.0;
const MARGINS: [f32; 4] = [92.0, 24.0, 10.0, 8.0];
const TIME_HEIGHT: f32 = 48.0;
const PER_PAGE: usize = 3;
/// Limits the columns of a line, and the number of dots.
const COLUMNS: usize = 750;
const DOTS: usize = 1500;
/// Limits the columns of all filters together, so that the file stays small.
const ALL_COLUMNS: usize = 5000;

/// The colours of Okabe and Ito, which readers with any colour vision can distinguish; one per filter, in turn.
const PALETTE: [[u8; 3]; 6] = [
    [0x00, 0x72, 0xB2],
    [0xD5, 0x5E, 0x00],
    [0x00, 0x9E, 0x73],
    [0xCC, 0x79, 0xA7],
    [0xE6, 0x9F, 0x00],
    [0x56, 0xB4, 0xE9],
];
const TRUTH: Color = Color([0x3A, 0x3A, 0x3A, 0xFF]);
const DOT: Color = Color([0x80, 0x80, 0x80, 0x80]);
const TEXT: Color = Color([0x22, 0x22, 0x22, 0xFF]);
const BAND_OPACITY: f32 = 0.2;
const DOT_RADIUS: f32 = 1.5;

/// The height of a line of the legend, its margin, and the letters of a name.
const LEGEND: [f32; 2] = [22.0, 12.0];
const LETTERS: usize = 36;

fn colored(run: &Run) -> impl Iterator<Item = (&Estimates, Color)> {
    run.estimates().iter().map(|estimates| {
        let [r, g, b] = PALETTE[estimates.color() as usize];
        (estimates, Color([r, g, b, 0xFF]))
    })
}

/// Draws the channels of a run over one time axis, as the text of an SVG file: the truth in dark grey, measurements as
/// dots, each filter's estimate as a line of its colour over its ±2σ band. Below them are the readings of sensors against
/// their predictions, within ±2√S: of those that measure no channel, and of all where no truth is known.
pub fn svg(run: &Run) -> String {
    draw(run, &PlotPanel::all(run))
}

/// [`svg`] in pictures of a few plots each, which fit on pages of paper.
pub fn pages(run: &Run) -> Vec<String> {
    PlotPanel::all(run).chunks(PER_PAGE).map(|panels| draw(run, panels)).collect()
}

fn draw(run: &Run, panels: &[PlotPanel]) -> String {
    let mut svg = Svg::default();
    let mut top = draw_legend(&mut svg, run);
    for (place, &panel) in panels.iter().enumerate() {
        draw_panel(&mut svg, run, panel, top, place + 1 == panels.len());
        top += PLOT_HEIGHT;
    }
    let size = [WIDTH, top + TIME_HEIGHT];
    svg.finish(size, size, "")
}

fn draw_legend(svg: &mut Svg, run: &Run) -> f32 {
    let record = run.record();
    let mut entries = Vec::new();
    if !record.true_channels().is_empty() {
        entries.push(("truth".to_owned(), TRUTH));
    }
    if PlotPanel::all(run).iter().any(|panel| panel.measured(record).is_some()) {
        entries.push(("measurement".to_owned(), DOT));
    }
    for (estimates, color) in colored(run) {
        let end = match estimates.stop() {
            Some(stop) => format!(", stopped at {} s", plain(record.time_of(stop.sample))),
            None => " ±2σ".to_owned(),
        };
        entries.push((shortened(&heading(estimates.name(), estimates.kind)) + &end, color));
    }
    let columns = if entries.iter().all(|(text, _)| text.chars().count() <= 24) { 4 } else { 3 };
    let [row_height, margin] = LEGEND;
    for (place, (text, color)) in entries.iter().enumerate() {
        let x = MARGINS[0] + (place % columns) as f32 * (WIDTH - MARGINS[0]) / columns as f32;
        let y = margin + ((place / columns) as f32 + 0.5) * row_height;
        if *color == DOT {
            for (dx, up) in [(3.0, 0.0), (10.0, 3.0), (17.0, 1.0), (24.0, 4.0)] {
                svg.ellipse([x + dx, y + 2.0 - up], [DOT_RADIUS; 2], Style::fill(DOT));
            }
        } else {
            if *color != TRUTH {
                svg.rect([x, y - 6.0, 26.0, 12.0], 0.0, Style::fill(color.faded(BAND_OPACITY)));
            }
            svg.path([[x, y], [x + 26.0, y]], false, Style::stroke(*color, 2.0));
        }
        let anchor = Anchor::Start;
        let (origin, at, color) = ([x + 34.0, y + 5.0], [0.0; 2], TEXT);
        svg.text(&Text { text, origin, turn: 0.0, at, anchor, size: 14.0, length: None, bold: false, color });
    }
    entries.len().div_ceil(columns) as f32 * row_height + margin
}

fn shortened(name: &str) -> String {
    if name.chars().count() <= LETTERS {
        return name.to_owned();
    }
    name.chars().take(LETTERS - 1).chain(['…']).collect()
}

fn draw_panel(svg: &mut Svg, run: &Run, panel: PlotPanel, top: f32, with_time: bool) {
    let record = run.record();
    let range = range_of(run, panel);
    let start = record.time(0);
    let end = record.time(record.len().saturating_sub(1)).max(start + record.dt());
    let [left, right, above, below] = MARGINS;
    let area = [left, top + above, WIDTH - left - right, PLOT_HEIGHT - above - below];
    let axes = Axes { area, x: [start, end], y: [range.0, range.1] };
    axes.grid(svg, &panel.title(), with_time.then_some("time t [s]"), &plain);
    if let Some(values) = panel.measured(record) {
        let dots = thinned(record.len(), DOTS).map(|k| (record.time(k), values[k]));
        axes.dots(svg, dots, DOT_RADIUS, DOT);
    }
    let columns = COLUMNS.min(ALL_COLUMNS / run.estimates().len().max(1));
    for (estimates, color) in colored(run) {
        let Some(curve) = panel.curve(estimates, record) else { continue };
        let edges = |k| {
            let (mean, std) = curve(k);
            (record.time(k), mean - 2.0 * std, mean + 2.0 * std)
        };
        // All bands come before all lines: none hides the estimate of another filter.
        for outline in bands(estimates.len(), columns, range, edges) {
            axes.outline(svg, &outline, color.faded(BAND_OPACITY));
        }
    }
    if let Some(values) = panel.truth(record) {
        let line = line(record.len(), COLUMNS, |k| (record.time(k), values[k]));
        axes.line(svg, line, Style::stroke(TRUTH, 2.5));
    }
    for (estimates, color) in colored(run) {
        let Some(curve) = panel.curve(estimates, record) else { continue };
        let line = line(estimates.len(), columns, |k| (record.time(k), curve(k).0));
        axes.line(svg, line, Style::stroke(color, 1.25));
    }
}

const SAMPLES: usize = 4000;

/// It leaves out values that would flatten the rest, such as a wide initial band or a diverged filter.
fn range_of(run: &Run, panel: PlotPanel) -> (f64, f64) {
    let record = run.record();
    let out = |tail: f64| (record.len().min(SAMPLES) as f64 * tail) as usize;
    let truth = panel.truth(record).and_then(|values| without_tails(values.iter().copied(), 0));
    let seen = |values: &[f64]| {
        let thinned = thinned(record.len(), SAMPLES).map(|k| values[k]);
        without_tails(thinned, out(0.002))
    };
    let measured = panel.measured(record).and_then(seen);
    let mut estimated = None;
    let mut banded = None;
    for estimates in run.estimates() {
        let Some(curve) = panel.curve(estimates, record) else { continue };
        let mean = |k: usize| curve(k).0;
        let spread = |k: usize| 2.0 * curve(k).1;
        // Shares are those of the whole record, so that a filter that stopped early counts little.
        let samples = || thinned(record.len(), SAMPLES).filter(|&k| k < estimates.len());
        estimated = union(estimated, without_tails(samples().map(mean), out(0.005)));
        banded = union(banded, without_tails(samples().map(|k| mean(k) - spread(k)), out(0.1)));
        banded = union(banded, without_tails(samples().map(|k| mean(k) + spread(k)), out(0.1)));
    }
    let known = union(truth, measured);
    let range = match known {
        Some((low, high)) => {
            // A constant truth has no span: half its size stands in for it.
            let room = 6.0 * (high - low).max(0.5 * low.abs().max(high.abs()));
            let near = |(a, b): (f64, f64)| (a.max(low - room), b.min(high + room));
            let wanted = union(estimated, banded);
            union(known, if room > 0.0 { wanted.map(near) } else { wanted })
        }
        None => union(estimated, banded),
    };
    padded(range.unwrap_or((0.0, 0.0)))
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum PlotPanel {
    Channel(Channel),
    Sensor(Quantity),
}

/// Mean and standard deviation at a sample; NaN where there is none.
type Curve<'a> = Box<dyn Fn(usize) -> (f64, f64) + 'a>;

impl PlotPanel {
    /// A sensor has its own plot if no channel equals its reading, or if its prediction is the only comparison.
    fn all(run: &Run) -> Vec<Self> {
        let (channels, record) = (run.channels(), run.record());
        let knows_truth = !record.true_channels().is_empty();
        let is_shown = |sensor: &Quantity| sensor.channel().is_some_and(|channel| channels.contains(&channel));
        let sensors = record.sensors().iter().copied().filter(|sensor| !(knows_truth && is_shown(sensor)));
        let used = |sensor: &Quantity| run.estimates().iter().any(|estimates| estimates.sensors().contains(sensor));
        let sensors: Vec<Self> = sensors.filter(used).map(Self::Sensor).collect();
        channels.iter().copied().map(Self::Channel).chain(sensors).collect()
    }

    fn title(self) -> String {
        let (name, symbol, unit) = match self {
            Self::Channel(channel) => (channel.name().to_owned(), channel.symbol(), channel.unit()),
            Self::Sensor(sensor) => (format!("predicted {}", sensor.name()), sensor.symbol(), sensor.unit()),
        };
        format!("{name} {symbol} [{}]", if unit.is_empty() { "-" } else { unit })
    }

    fn measured(self, record: &Record) -> Option<&[f64]> {
        let sensor = match self {
            Self::Channel(channel) => *Quantity::all().iter().find(|q| q.channel() == Some(channel))?,
            Self::Sensor(sensor) => sensor,
        };
        record.measured_quantity(sensor)
    }

    fn truth(self, record: &Record) -> Option<&[f64]> {
        match self {
            Self::Channel(channel) => record.truth(channel),
            Self::Sensor(_) => None,
        }
    }

    /// A filter's estimate, or its prediction from all earlier samples. `None` if it has neither.
    fn curve<'a>(self, estimates: &'a Estimates, record: &'a Record) -> Option<Curve<'a>> {
        Some(match self {
            Self::Channel(channel) => {
                let place = estimates.place(channel)?;
                Box::new(move |k| (estimates.canonical_mean(k, place), estimates.std(k, place)))
            }
            Self::Sensor(sensor) => {
                estimates.sensors().contains(&sensor).then_some(())?;
                Box::new(move |k| {
                    let SensorEstimate { std, predicted, .. } = SensorEstimate::of(estimates, record, sensor, k);
                    (predicted, std)
                })
            }
        })
    }
}
