//! From scores to cells, to colours, and to the bar of colours beside a panel.

use egui::{Align2, Color32, Pos2, Rect, Stroke, StrokeKind, TextStyle, Ui, pos2, vec2};
use kalmanscope_core::internals::sort_numbers;
use kalmanscope_diagnosis::CAUSES;
use kalmanscope_diagnosis::{Measure, ValueKind, VerdictKind};

use crate::laboratory::Survey;
use crate::plot::axes::ValueScale;
use crate::text::significant;
use crate::theme::{Palette, diverging, kind, sequential};

/// The limit of a consistent filter's mean NIS: its distance from 1, in standard deviations, with 99 % probability.
pub(super) const CONSISTENT: f64 = 2.575_829_303_548_901;

/// The share of the ground in the colour of a cell that lost the truth.
const PALE: f32 = 0.5;

/// The ratio of the largest to the smallest score beyond which colours are logarithmic.
const DECADES: f64 = 10.0;

/// The range of colours follows from at most this many scores, and leaves out this share of them at either end.
const MOST: usize = 4096;
const BEYOND: f64 = 0.02;

pub(super) struct Graph {
    pub(super) rect: Rect,
    pub(super) scales: [ValueScale; 2],
}

impl Graph {
    pub(super) fn at(&self, values: [f64; 2]) -> Pos2 {
        self.at_shares([0, 1].map(|at| self.scales[at].share(values[at])))
    }

    pub(super) fn at_shares(&self, [x, y]: [f64; 2]) -> Pos2 {
        let Self { rect, .. } = self;
        pos2(rect.left() + x as f32 * rect.width(), rect.bottom() - y as f32 * rect.height())
    }

    pub(super) fn in_plot(&self, shares: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|at| egui::lerp(self.scales[at].ends.0..=self.scales[at].ends.1, shares[at]))
    }

    pub(super) fn shares(&self, at: Pos2) -> [f64; 2] {
        let Self { rect, .. } = self;
        let (x, y) = ((at.x - rect.left()) / rect.width(), (rect.bottom() - at.y) / rect.height());
        [f64::from(x), f64::from(y)]
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Colors {
    Sequential(ValueScale),
    Diverging(ValueScale),
    /// The distance of a mean NIS from 1 in standard deviations, finest about zero.
    Distance(f64),
    Kinds(Vec<&'static str>),
}

impl Colors {
    pub(super) fn of(measure: Measure, cells: &[&[Cell]]) -> Self {
        let values = sorted(cells);
        match measure.info().kind {
            ValueKind::Flag => Self::Kinds(vec!["no", "yes"]),
            ValueKind::Verdict => Self::Kinds(VerdictKind::ALL.iter().map(|kind| kind.name()).collect()),
            ValueKind::Cause => Self::Kinds(CAUSES.iter().map(|cause| cause.name).collect()),
            ValueKind::Share => Self::Sequential(ValueScale::new(0.0, 1.0, false)),
            ValueKind::Ratio => Self::about_one(&values),
            ValueKind::Distance => {
                let most = quantile(&values, 0.0).abs().max(quantile(&values, 1.0).abs());
                Self::Distance(most.clamp(2.0 * CONSISTENT, 1e6))
            }
            ValueKind::LogLikelihood => {
                let (middle, best) = (quantile(&values, 0.5), quantile(&values, 1.0));
                linear(best - (best - middle).max(10.0), best)
            }
            ValueKind::Time => linear(0.0, quantile(&values, 1.0)),
            ValueKind::Signed => linear(quantile(&values, BEYOND), quantile(&values, 1.0 - BEYOND)),
            ValueKind::Words | ValueKind::Error | ValueKind::Size => sizes(&values),
        }
    }

    pub(super) fn of_comparison(measure: Measure, cells: &[Cell]) -> Self {
        let values = sorted(&[cells]);
        if measure.info().kind.is_ratio() {
            return Self::about_one(&values);
        }
        let most = quantile(&values, BEYOND).abs().max(quantile(&values, 1.0 - BEYOND).abs());
        let most = if most > 0.0 { most } else { 1.0 };
        Self::Diverging(ValueScale::new(-most, most, false))
    }

    fn about_one(values: &[f64]) -> Self {
        let ends = [quantile(values, BEYOND), quantile(values, 1.0 - BEYOND)];
        let far = ends.map(|end| if end > 0.0 { end.ln().abs() } else { 0.0 });
        let most = far[0].max(far[1]).clamp(2.0_f64.ln(), 100.0_f64.ln()).exp();
        Self::Diverging(ValueScale::new(1.0 / most, most, true))
    }

    pub(super) fn scale(&self) -> Option<ValueScale> {
        match self {
            Self::Sequential(scale) | Self::Diverging(scale) => Some(*scale),
            Self::Distance(_) | Self::Kinds(_) => None,
        }
    }

    pub(super) fn share(&self, value: f64) -> f64 {
        match self {
            Self::Sequential(scale) | Self::Diverging(scale) => scale.share(value),
            Self::Distance(most) => 0.5 + 0.5 * spread(value) / spread(*most),
            Self::Kinds(_) => 0.0,
        }
    }

    pub(super) fn at(&self, share: f64, palette: &Palette) -> Color32 {
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) as f32 };
        match self {
            Self::Sequential(..) => sequential(share),
            Self::Diverging(..) | Self::Distance(_) => diverging(share, palette),
            Self::Kinds(_) => self.kind(0),
        }
    }

    pub(super) fn kind(&self, place: usize) -> Color32 {
        match self {
            Self::Kinds(names) if names.len() == 2 => {
                if place == 0 {
                    kind(0)
                } else {
                    kind(6)
                }
            }
            _ => kind(place),
        }
    }

    pub(super) fn of_cell(&self, cell: Cell, palette: &Palette) -> Option<Color32> {
        let Cell { value, end } = cell;
        let color = match (self, end) {
            (_, CellEnd::Unknown) => None,
            (Self::Kinds(_), _) if !value.is_nan() => Some(self.kind(value as usize)),
            (_, CellEnd::Stopped) => Some(palette.grid),
            _ if value.is_nan() || value == f64::INFINITY => Some(palette.grid),
            _ => Some(self.at(self.share(value), palette)),
        };
        if end == CellEnd::Lost { color.map(|color| color.lerp_to_gamma(palette.ground, PALE)) } else { color }
    }
}

/// Stretches small distances and compresses large ones; keeps the sign.
pub(super) fn spread(distance: f64) -> f64 {
    (distance / CONSISTENT).asinh()
}

fn linear(from: f64, to: f64) -> Colors {
    let to = if to > from { to } else { from + 1.0 };
    Colors::Sequential(ValueScale::new(from, to, false))
}

fn sizes(values: &[f64]) -> Colors {
    let positive: Vec<f64> = values.iter().copied().filter(|value| *value > 0.0).collect();
    let (low, high) = (quantile(&positive, BEYOND), quantile(&positive, 1.0 - BEYOND));
    let is_wide = high > DECADES * low && low > 0.0;
    if is_wide { Colors::Sequential(ValueScale::new(low, high, true)) } else { linear(0.0, high) }
}

fn sorted(cells: &[&[Cell]]) -> Vec<f64> {
    let all = cells.iter().map(|cells| cells.len()).sum::<usize>();
    let step = all.div_ceil(MOST).max(1);
    let is_used = |cell: &&Cell| cell.value.is_finite() && !matches!(cell.end, CellEnd::Unknown | CellEnd::Stopped);
    let values = cells.iter().flat_map(|cells| cells.iter()).step_by(step).filter(is_used);
    let mut values: Vec<f64> = values.map(|cell| cell.value).collect();
    sort_numbers(&mut values);
    values
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    sorted.get(place.round() as usize).copied().unwrap_or(1.0)
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub(super) value: f64,
    pub(super) end: CellEnd,
}

/// From the worst to the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum CellEnd {
    Unknown,
    Stopped,
    Lost,
    Followed,
}

pub(super) fn of_filter(survey: &Survey, filter: usize, measure: Measure) -> Vec<Cell> {
    let columns = [measure, Measure::STOPPED, Measure::DIVERGED].map(|measure| survey.column(filter, measure));
    let cell = |cell: usize| {
        let Some(row) = survey.sheet.shown(cell) else { return Cell { value: f64::NAN, end: CellEnd::Unknown } };
        let [value, stopped, diverged] = columns.map(|column| column.map_or(f64::NAN, |at| row[at]));
        let value = if measure.info().kind == ValueKind::Error { value.abs() } else { value };
        let end = match (stopped == 0.0, diverged == 1.0) {
            (false, _) => CellEnd::Stopped,
            (true, true) => CellEnd::Lost,
            (true, false) => CellEnd::Followed,
        };
        Cell { value, end }
    };
    (0..survey.ensemble.cells()).map(cell).collect()
}

pub(super) fn compared(a: &[Cell], b: &[Cell], measure: Measure) -> Vec<Cell> {
    let is_ratio = measure.info().kind.is_ratio();
    let cell = |(a, b): (&Cell, &Cell)| Cell {
        value: if is_ratio { a.value / b.value } else { a.value - b.value },
        end: a.end.min(b.end),
    };
    a.iter().zip(b).map(cell).collect()
}

/// Room for a bar with its numbers, and for one with the names of kinds \[points\].
const NUMBERS: f32 = 46.0;
const NAMES: f32 = 104.0;

/// The width of the bar, and its distance from the panel \[points\].
const WIDTH: f32 = 11.0;
const APART: f32 = 6.0;

const STEPS: usize = 64;

pub(super) fn bar_room(colors: &Colors) -> f32 {
    if matches!(colors, Colors::Kinds(names) if names.len() > 2) { NAMES } else { NUMBERS }
}

pub(super) fn bar_ui(ui: &Ui, frame: Rect, colors: &Colors, palette: &Palette) {
    if let Colors::Kinds(names) = colors {
        return kinds_ui(ui, frame, colors, names, palette);
    }
    let painter = ui.painter();
    let left = frame.right() + APART;
    let rect = Rect::from_min_max(pos2(left, frame.top()), pos2(left + WIDTH, frame.bottom()));
    let y = |share: f64| rect.bottom() - share as f32 * rect.height();
    for step in 0..STEPS {
        let [low, high] = [step, step + 1].map(|step| step as f64 / STEPS as f64);
        let part =
            Rect::from_min_max(pos2(rect.left(), y(high)), pos2(rect.right(), (y(low) + 0.5).min(rect.bottom())));
        painter.rect_filled(part, 0.0, colors.at(0.5 * (low + high), palette));
    }
    painter.rect_stroke(rect, 0.0, Stroke::new(0.7, palette.grid), StrokeKind::Middle);
    let font = TextStyle::Small.resolve(ui.style());
    for (share, text) in colors.ticks(rect.height()) {
        let at = pos2(rect.right(), y(share));
        painter.line_segment([at, at + vec2(3.0, 0.0)], Stroke::new(1.0, palette.grid));
        painter.text(at + vec2(5.0, 0.0), Align2::LEFT_CENTER, text, font.clone(), palette.weak);
    }
}

fn kinds_ui(ui: &Ui, frame: Rect, colors: &Colors, names: &[&str], palette: &Palette) {
    let painter = ui.painter();
    let font = TextStyle::Small.resolve(ui.style());
    let line = (frame.height() / names.len().max(1) as f32).min(font.size + 6.0);
    for (place, name) in names.iter().enumerate() {
        let at = pos2(frame.right() + APART, frame.top() + line * place as f32);
        let rect = Rect::from_min_size(at + vec2(0.0, 1.0), vec2(WIDTH, line - 2.0));
        painter.rect_filled(rect, 0.0, colors.kind(place));
        let at = rect.right_center() + vec2(4.0, 0.0);
        painter.text(at, Align2::LEFT_CENTER, *name, font.clone(), palette.weak);
    }
}

impl Colors {
    pub(super) fn ticks(&self, length: f32) -> Vec<(f64, String)> {
        match self {
            Self::Distance(most) => {
                let steps = [0.0, 2.6, 10.0, 100.0, 1e3, 1e4, 1e5].into_iter().filter(|step| *step <= *most);
                let both = steps.flat_map(|step| if step == 0.0 { vec![0.0] } else { vec![-step, step] });
                both.map(|value| (self.share(value), significant(value, 2))).collect()
            }
            other => other.scale().map_or(Vec::new(), |scale| scale.ticks(length, 30.0)),
        }
    }
}
