//! The layers of a chart, and the items that they are drawn as: min-max columns as lines and areas.

use std::hash::Hash;
use std::ops::Range;

use egui::epaint::Tessellator;
use egui::mutex::Mutex;
use egui::{Color32, Mesh, Rect, Shape, Stroke, Ui, Vec2};
use egui_plot::{FilledArea, HLine, Line, LineStyle, PlotItem as _, PlotPoint, PlotTransform, Points};
use kalmanscope_core::Record;

use super::medium::{Medium, Y_AXIS};
use super::series::{PlotColumn, PlotSeries, central_range};
use super::simplify::simplify;

pub(crate) enum Layer<'a> {
    Band {
        series: PlotSeries<'a>,
        color: Color32,
        filter: Option<u32>,
    },
    Dots {
        series: PlotSeries<'a>,
        color: Color32,
    },
    /// A line. `bounds` says whether the vertical axis includes all of it, also outliers.
    Line {
        series: PlotSeries<'a>,
        color: Color32,
        width: f32,
        dashed: bool,
        bounds: bool,
        filter: Option<u32>,
    },
    /// The same value at all times, with a label if it is not empty.
    Level {
        value: f64,
        color: Color32,
        label: &'static str,
    },
}

impl<'a> Layer<'a> {
    pub(crate) fn line(series: PlotSeries<'a>, color: Color32, width: f32) -> Self {
        Self::Line { series, color, width, dashed: false, bounds: false, filter: None }
    }

    pub(crate) fn dashed(series: PlotSeries<'a>, color: Color32, width: f32) -> Self {
        Self::Line { series, color, width, dashed: true, bounds: false, filter: None }
    }

    pub(crate) fn of(mut self, id: u32) -> Self {
        if let Self::Line { filter, .. } = &mut self {
            *filter = Some(id);
        }
        self
    }

    pub(crate) fn truth(series: PlotSeries<'a>, color: Color32) -> Self {
        Self::Line { series, color, width: 4.0, dashed: false, bounds: true, filter: None }
    }

    pub(crate) fn zero(color: Color32) -> Self {
        Self::Level { value: 0.0, color, label: "" }
    }

    pub(super) fn label(&self) -> Option<(f64, &'static str, Color32)> {
        match *self {
            Self::Level { value, color, label } if !label.is_empty() => Some((value, label, color)),
            _ => None,
        }
    }

    fn columns(&self, record: &Record, window: &Window) -> Vec<PlotColumn> {
        let count = |width: f32| (((window.size.x - Y_AXIS) / width) as usize).max(16);
        match self {
            Self::Band { series, .. } | Self::Dots { series, .. } => series.columns(record, window.times, count(AREA)),
            Self::Line { series, .. } => series.columns(record, window.times, count(COLUMN)),
            Self::Level { .. } => Vec::new(),
        }
    }
}

/// The width of a column of a line, and of a band or of dots \[points\].
const COLUMN: f32 = 2.0;
const AREA: f32 = 3.0;

/// Each line is a little thinner than the one below it, so that both are seen where they coincide \[points\].
pub(crate) fn line_width(place: usize, first: f32) -> f32 {
    (first - 0.8 * place as f32).max(1.2)
}

/// The part of the data that a chart shows: times \[s\], values unless the axis follows them, and the size \[points\].
#[derive(Clone, Copy)]
pub(crate) struct Window {
    pub(crate) times: (f64, f64),
    pub(crate) values: Option<(f64, f64)>,
    pub(crate) size: Vec2,
}

impl Window {
    pub(crate) fn key(&self) -> impl Hash + use<> {
        let bits = |(low, high): (f64, f64)| [low.to_bits(), high.to_bits()];
        (bits(self.times), self.values.map(bits), self.size.x.to_bits(), self.size.y.to_bits())
    }
}

pub(super) enum Mark {
    Band { times: Vec<f64>, edges: [Vec<f64>; 2], color: Color32, filter: Option<u32> },
    Dots { points: Vec<PlotPoint>, color: Color32 },
    Line { points: Vec<PlotPoint>, stroke: Stroke, dashed: bool, filter: Option<u32> },
    Level { value: f64, color: Color32 },
}

/// A curve is drawn up to this many heights of the plot beyond it: positions on screen are in single precision.
const BEYOND: f64 = 20.0;

/// Limits the length of a dashed line; a longer one, such as noise, is solid \[points\].
const LONGEST_DASHED: f64 = 30_000.0;

/// Limits the columns whose values are far enough apart for two points \[points\].
const ALIKE: f64 = 0.2;

#[derive(Default)]
pub(crate) struct Drawing {
    pub(super) marks: Vec<Mark>,
    pub(super) range: Option<(f64, f64)>,
    painted: Mutex<Option<(PaintedFrame, Vec<Shape>)>>,
}

impl Drawing {
    /// A `least` range is always shown. Whether it `settles` says that the vertical axis may cut off the beginning of a run.
    pub(super) fn new(
        layers: &[Layer<'_>],
        record: &Record,
        window: &Window,
        (least, settles): (Option<(f64, f64)>, bool),
    ) -> Self {
        let columns: Vec<Vec<PlotColumn>> = layers.iter().map(|layer| layer.columns(record, window)).collect();
        let last = columns.iter().filter_map(|columns| columns.last()).map(|column| column.samples.1).max();
        let has_begin = window.times.0 <= record.time(0);
        let begin = (BEGINNING * last.filter(|_| settles && has_begin).unwrap_or(0) as f64) as usize;
        let range = value_range(layers.iter().zip(&columns), begin, least);
        let (mut marks, mut areas) = (Vec::new(), 0);
        // Without a range there are no values to draw.
        if let Some((low, high)) = window.values.or(range) {
            let beyond = BEYOND * (high - low);
            let per = |(from, to): (f64, f64), length: f32| f64::from(length) / (to - from);
            let (across, scale) = (per(window.times, window.size.x), per((low, high), window.size.y));
            let shown = Shown { record, values: (low - beyond, high + beyond), across, scale };
            for (layer, columns) in layers.iter().zip(&columns) {
                if let Layer::Level { value, color, .. } = *layer {
                    marks.push(Mark::Level { value, color });
                }
                let is_area = shown.is_dense(layer, columns);
                for part in parts(columns) {
                    if is_area {
                        marks.extend(shown.area(layer, &columns[part], areas));
                    } else {
                        marks.push(shown.mark(layer, &columns[part]));
                    }
                }
                areas += usize::from(is_area);
            }
        }
        Self { marks, range, painted: Mutex::default() }
    }

    fn paint(&self, ui: &Ui, transform: &PlotTransform) -> Vec<Shape> {
        let is_figure = Medium::of(ui.ctx()) == Medium::Figure;
        let mut shapes = Vec::new();
        for mark in &self.marks {
            match mark {
                Mark::Band { times, edges: [low, high], color, .. } => {
                    let area = FilledArea::new("band", times, low, high).fill_color(*color);
                    area.shapes(ui, transform, &mut shapes);
                }
                Mark::Dots { points, color } => {
                    let radius = if points.len() > FEW { DOT } else { LARGE_DOT };
                    let dots = Points::new("dots", &points[..]).color(*color).radius(radius);
                    dots.shapes(ui, transform, &mut shapes);
                }
                Mark::Line { points, stroke, dashed, .. } => {
                    let style = if *dashed { LineStyle::dashed_loose() } else { LineStyle::Solid };
                    // A band has the width of the line upwards, so that a steep line would be thin.
                    let line = Line::new("line", &points[..]).stroke(*stroke).style(style).allow_band(false);
                    line.shapes(ui, transform, &mut shapes);
                }
                Mark::Level { value, color } => {
                    let line = HLine::new("level", *value).color(*color).width(1.0).style(LineStyle::dashed_loose());
                    line.shapes(ui, transform, &mut shapes);
                }
            }
        }
        if is_figure {
            return shapes;
        }
        // A circle is a picture of a letter's kind, which is quicker than its triangles.
        let is_dot = |shape: &mut Shape| matches!(shape, Shape::Circle(_));
        let dots: Vec<Shape> = shapes.extract_if(.., is_dot).collect();
        dots.into_iter().chain([Shape::mesh(mesh(ui, shapes))]).collect()
    }

    pub(super) fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let bounds = transform.bounds();
        let place = (*transform.frame(), bounds.min(), bounds.max(), ui.pixels_per_point());
        let mut painted = self.painted.lock();
        if painted.as_ref().is_none_or(|(before, _)| *before != place) {
            *painted = Some((place, self.paint(ui, transform)));
        }
        shapes.extend(painted.iter().flat_map(|(_, shapes)| shapes.iter().cloned()));
    }
}

/// The triangles of shapes: they are kept while nothing moves, and a frame then takes 6 ms in place of 37 (six views, four filters).
fn mesh(ui: &Ui, shapes: Vec<Shape>) -> Mesh {
    let options = ui.ctx().tessellation_options(|options| *options);
    let mut tessellator = Tessellator::new(ui.pixels_per_point(), options, [1, 1], Vec::new());
    tessellator.set_clip_rect(ui.clip_rect());
    let mut mesh = Mesh::default();
    shapes.into_iter().for_each(|shape| tessellator.tessellate_shape(shape, &mut mesh));
    mesh
}

type PaintedFrame = (Rect, [f64; 2], [f64; 2], f32);

/// Radius of a dot, of a dot among few, and the number of few dots \[points\].
const DOT: f32 = 1.3;
const LARGE_DOT: f32 = 2.2;
const FEW: usize = 300;

struct Shown<'a> {
    record: &'a Record,
    values: (f64, f64),
    /// Points of the screen for a second, and for a unit of the value.
    across: f64,
    scale: f64,
}

/// A filter's line is drawn as the area that it fills where it goes up and down by more than this in a column \[points\], over a range of
/// which this share is that of the next column too: noise, but no swing that the columns show.
const DENSE: f64 = 8.0;
const ALIKE_RANGES: f64 = 0.65;

const OF_BAND: f32 = 0.24;
const OF_AREA: f32 = 0.38;

impl Shown<'_> {
    fn edges(&self, columns: &[PlotColumn]) -> (Vec<f64>, [Vec<f64>; 2]) {
        let Self { record, values: (least, most), .. } = *self;
        let times = columns.iter().map(|column| record.time(column.samples.0)).collect();
        let edges = [|column: &PlotColumn| column.low, |column: &PlotColumn| column.high]
            .map(|edge| columns.iter().map(|column| edge(column).clamp(least, most)).collect());
        (times, edges)
    }

    fn is_dense(&self, layer: &Layer<'_>, columns: &[PlotColumn]) -> bool {
        let is_line = matches!(layer, Layer::Line { filter: Some(_), dashed: false, .. });
        let climb: f64 = columns.iter().map(|column| column.high - column.low).sum();
        let both = |two: &[PlotColumn]| (two[0].high.min(two[1].high) - two[0].low.max(two[1].low)).max(0.0);
        let overlap: f64 = columns.windows(2).map(both).sum();
        is_line && self.scale * climb > DENSE * columns.len() as f64 && overlap > ALIKE_RANGES * climb
    }

    /// A dense line: filled if it is the first, and as an outline if there are `before` it, so that all are seen.
    fn area(&self, layer: &Layer<'_>, columns: &[PlotColumn], before: usize) -> Vec<Mark> {
        let Layer::Line { color, filter, .. } = *layer else { return Vec::new() };
        let (times, edges) = self.edges(columns);
        if before == 0 {
            return vec![Mark::Band { times, edges, color: color.gamma_multiply(OF_AREA), filter }];
        }
        let outline = |edge: Vec<f64>| Mark::Line {
            points: times.iter().zip(edge).map(|(time, value)| PlotPoint::new(*time, value)).collect(),
            stroke: Stroke::new(1.0, color),
            dashed: false,
            filter,
        };
        edges.map(outline).into()
    }

    fn mark(&self, layer: &Layer<'_>, columns: &[PlotColumn]) -> Mark {
        let Self { record, values: (least, most), scale, .. } = *self;
        let point = |sample: usize, value: f64| PlotPoint::new(record.time(sample), value.clamp(least, most));
        match *layer {
            Layer::Level { value, color, .. } => Mark::Level { value, color },
            Layer::Band { color, filter, .. } => {
                let (times, edges) = self.edges(columns);
                Mark::Band { times, edges, color: color.gamma_multiply(OF_BAND), filter }
            }
            Layer::Dots { color, .. } => {
                let both = |c: &PlotColumn| [c.low, c.high].map(|value| point(c.samples.0, value));
                Mark::Dots { points: columns.iter().flat_map(both).collect(), color }
            }
            Layer::Line { color, width, dashed, filter, .. } => {
                let mut points = Vec::with_capacity(2 * columns.len());
                for &PlotColumn { samples: (first, last), low, high, rising } in columns {
                    let (begin, end) = if rising { (low, high) } else { (high, low) };
                    points.push(point(first, begin));
                    if scale * (high - low) > ALIKE {
                        points.push(point(last, end));
                    }
                }
                let scaled = points.iter().map(|point| (self.across * point.x, scale * point.y));
                let points: Vec<PlotPoint> = simplify(scaled).into_iter().map(|at| points[at]).collect();
                let climb: f64 = points.windows(2).map(|two| (two[1].y - two[0].y).abs()).sum();
                let dashed = dashed && scale * climb < LONGEST_DASHED;
                Mark::Line { points, stroke: Stroke::new(width, color), dashed, filter }
            }
        }
    }
}

/// A curve breaks at a gap of `SAMPLES` samples and `DISTANCES` times the mean distance: that of a slow clock does not.
const SAMPLES: usize = 10;
const DISTANCES: usize = 8;

fn parts(columns: &[PlotColumn]) -> Vec<Range<usize>> {
    let (Some(first), Some(last)) = (columns.first(), columns.last()) else { return Vec::new() };
    let (distances, whole) = (columns.len() - 1, last.samples.0 - first.samples.0);
    let (mut parts, mut begin) = (Vec::new(), 0);
    for place in 1..columns.len() {
        let gap = columns[place].samples.0 - columns[place - 1].samples.1;
        if gap >= SAMPLES && gap * distances > DISTANCES * whole {
            parts.push(begin..place);
            begin = place;
        }
    }
    parts.push(begin..columns.len());
    parts
}

/// Share of the values at either end that the axis ignores, such as the first instants of a wide guess.
const OUTLIERS: f64 = 0.006;

/// Limits the pieces of a layer; the range uses the extremes of each piece.
const PIECES: usize = 250;

const BEGINNING: f64 = 0.2;

fn value_range<'a>(
    layers: impl Iterator<Item = (&'a Layer<'a>, &'a Vec<PlotColumn>)>,
    begin: usize,
    least: Option<(f64, f64)>,
) -> Option<(f64, f64)> {
    let (mut whole, mut robust, mut dots) = (Vec::new(), Vec::with_capacity(16 * PIECES), Vec::new());
    for (layer, columns) in layers {
        let (values, columns) = match layer {
            Layer::Line { bounds: true, .. } => (&mut whole, &columns[..]),
            Layer::Dots { .. } => (&mut dots, &columns[..]),
            _ => (&mut robust, &columns[columns.partition_point(|column| column.samples.1 < begin)..]),
        };
        for piece in columns.chunks(columns.len() / PIECES + 1) {
            let both = piece.iter().map(|column| (column.low, column.high));
            let both = both.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
            values.extend(both.into_iter().flat_map(|(low, high)| [low, high]));
        }
    }
    let all = whole.into_iter().map(|x| (x, x)).chain(central_range(robust, OUTLIERS)).chain(least);
    let (low, high) =
        all.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))).or_else(|| central_range(dots, OUTLIERS))?;
    let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_gap_breaks_a_curve_and_a_slow_clock_does_not() {
        let column = |k: &usize| PlotColumn { samples: (*k, *k), low: 0.0, high: 0.0, rising: true };
        let of = |samples: &[usize]| parts(&samples.iter().map(column).collect::<Vec<_>>());
        let slow: Vec<usize> = (0..50).map(|k| 14 * k).collect();
        assert_eq!(of(&slow).len(), 1);
        let fast: Vec<usize> = (0..200).filter(|k| !(90..120).contains(k)).collect();
        assert_eq!(of(&fast), [0..90, 90..170]);
        let uneven: Vec<usize> = (0..200).filter(|k| k % 3 != 1 && !(50..58).contains(k)).collect();
        assert_eq!(of(&uneven).len(), 1);
        assert_eq!([&[3][..], &[3, 90]].map(|samples| of(samples).len()), [1; 2]);
    }
}
