//! Truth, measurements and estimates over time, as a picture.

mod legend;
mod panel;
mod range;
mod series;

use std::io::{self, Write as _};
use std::path::Path;

use kalmanscope_core::{Estimates, Record, Run};
use plotters::coord::Shift;
use plotters::prelude::*;
use thiserror::Error;

use crate::number::plain;
use crate::output;
use panel::Panel;

/// The reason why a picture could not be made.
#[derive(Debug, Error)]
pub enum PlotError {
    /// The picture could not be laid out.
    #[error("cannot draw: {0}")]
    Draw(String),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] io::Error),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for PlotError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Draw(error.to_string())
    }
}

/// Units of the drawing per pixel of the picture. Coordinates are whole numbers, so that larger units would give jagged
/// lines.
const SCALE: u32 = 4;
const WIDTH: u32 = 1100;
const PLOT_HEIGHT: u32 = 240;
/// Room for the time axis below the last plot.
const TIME_HEIGHT: u32 = 48;
/// Limits the plots of a page.
const PER_PAGE: usize = 3;
/// Limits the columns of a line, and the number of dots.
const COLUMNS: usize = 750;
const DOTS: usize = 1500;
/// Limits the columns of all filters together, so that the file stays small.
const ALL_COLUMNS: usize = 5000;

/// The colours of Okabe and Ito, which readers with any colour vision can distinguish; one per filter, in turn.
const PALETTE: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
];
/// The estimates of every filter with its colour.
fn colored(run: &Run) -> impl Iterator<Item = (&Estimates, RGBColor)> {
    run.estimates().iter().map(|estimates| (estimates, PALETTE[estimates.color() as usize]))
}

const TRUTH: RGBColor = RGBColor(0x3A, 0x3A, 0x3A);
const MEASURED: RGBColor = RGBColor(0x80, 0x80, 0x80);
const TEXT: RGBColor = RGBColor(0x22, 0x22, 0x22);
const GRID: RGBColor = RGBColor(0xE4, 0xE4, 0xE4);
const BAND_OPACITY: f64 = 0.2;
const DOT_OPACITY: f64 = 0.5;
const DOT_RADIUS: u32 = 3 * SCALE / 2;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws a run over one time axis and writes the picture to a file.
///
/// # Errors
/// [`PlotError`] where the file cannot be written.
pub fn plot_svg(run: &Run, path: &Path) -> Result<(), PlotError> {
    let picture = svg(run)?;
    output::write(path, |file| Ok(file.write_all(picture.as_bytes())?))
}

/// Draws the channels of a run over one time axis, as the text of an SVG file: the truth in dark grey, measurements as
/// dots, each filter's estimate as a line of its colour over its ±2σ band. Below them are the readings of sensors against
/// their predictions, within ±2√S: of those that measure no channel, and of all where no truth is known.
///
/// # Errors
/// [`PlotError::Draw`] where the picture cannot be laid out.
pub fn svg(run: &Run) -> Result<String, PlotError> {
    draw(run, &Panel::all(run))
}

/// [`svg`] in pictures of a few plots each, which fit on pages of paper.
///
/// # Errors
/// [`PlotError::Draw`] where a picture cannot be laid out.
pub fn pages(run: &Run) -> Result<Vec<String>, PlotError> {
    Panel::all(run).chunks(PER_PAGE).map(|panels| draw(run, panels)).collect()
}

fn draw(run: &Run, panels: &[Panel]) -> Result<String, PlotError> {
    let plots = panels.len() as u32;
    let legend_height = legend::height(run);
    let height = legend_height + plots * PLOT_HEIGHT + TIME_HEIGHT;
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (WIDTH * SCALE, height * SCALE)).into_drawing_area();
        root.fill(&WHITE)?;
        let (head, body) = root.split_vertically(legend_height * SCALE);
        legend::draw(run, &head)?;
        let (mut rest, mut area);
        rest = body;
        for (i, &panel) in panels.iter().enumerate() {
            let last = i + 1 == panels.len();
            (area, rest) = rest.split_vertically((PLOT_HEIGHT + if last { TIME_HEIGHT } else { 0 }) * SCALE);
            draw_panel(run, panel, &area, last)?;
        }
        root.present()?;
    }
    let drawn = format!("width=\"{}\" height=\"{}\"", WIDTH * SCALE, height * SCALE);
    Ok(text.replacen(&drawn, &format!("width=\"{WIDTH}\" height=\"{height}\""), 1))
}

fn draw_panel(run: &Run, panel: Panel, area: &Area<'_>, with_time: bool) -> Result<(), PlotError> {
    let record = run.record();
    let range = range::of(run, panel);
    let start = record.time(0);
    let end = record.time(record.len().saturating_sub(1)).max(start + record.dt());
    // The marks of an axis are found by sums that must stay finite.
    if !(start.abs() < range::LARGEST && end.abs() < range::LARGEST) {
        return Err(PlotError::Draw(format!("the times {start:e} s to {end:e} s are too far apart")));
    }
    let mut chart = ChartBuilder::on(area)
        .margin_top(10 * SCALE)
        .margin_right(24 * SCALE)
        .margin_left(8 * SCALE)
        .set_label_area_size(LabelAreaPosition::Left, 84 * SCALE)
        .set_label_area_size(LabelAreaPosition::Bottom, if with_time { TIME_HEIGHT * SCALE } else { 8 * SCALE })
        .build_cartesian_2d(start..end, range.0..range.1)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(SCALE))
        .axis_style(TEXT.stroke_width(SCALE))
        .label_style(font(13))
        .axis_desc_style(font(15))
        .y_desc(panel.title())
        .y_labels(5)
        .y_label_formatter(&|y| plain(rounded(*y, range)))
        .x_labels(13)
        .x_label_formatter(&|t| if with_time { plain(*t) } else { String::new() })
        .x_desc(if with_time { "time t [s]" } else { "" })
        .set_all_tick_mark_size(4 * SCALE)
        .draw()?;

    if let Some(values) = panel.measured(record) {
        let seen = |k: &usize| (range.0..=range.1).contains(&values[*k]);
        let dot = |k| Circle::new((record.time(k), values[k]), DOT_RADIUS, MEASURED.mix(DOT_OPACITY).filled());
        chart.draw_series(series::thinned(record.len(), DOTS).filter(seen).map(dot))?;
    }
    let columns = COLUMNS.min(ALL_COLUMNS / run.estimates().len().max(1));
    for (estimates, color) in colored(run) {
        let Some(curve) = panel.curve(estimates, record) else { continue };
        let edges = |k| edges(record, &curve, k);
        let outlines = series::bands(estimates.len(), columns, range, edges).into_iter();
        chart.draw_series(outlines.map(|outline| Polygon::new(outline, color.mix(BAND_OPACITY).filled())))?;
    }
    if let Some(values) = panel.truth(record) {
        let line = series::line(record.len(), COLUMNS, |k| (record.time(k), values[k]));
        chart.draw_series(paths(&line, range, TRUTH.stroke_width(5 * SCALE / 2)))?;
    }
    for (estimates, color) in colored(run) {
        let Some(curve) = panel.curve(estimates, record) else { continue };
        let line = series::line(estimates.len(), columns, |k| (record.time(k), curve(k).0));
        chart.draw_series(paths(&line, range, color.stroke_width(5 * SCALE / 4)))?;
    }
    Ok(())
}

/// Time and the edges of the ±2σ band at sample `k`.
fn edges(record: &Record, curve: &panel::Curve<'_>, k: usize) -> (f64, f64, f64) {
    let (mean, std) = curve(k);
    (record.time(k), mean - 2.0 * std, mean + 2.0 * std)
}

/// A tick's value without rounding errors, so that `-0.0000000000000001` becomes zero.
fn rounded(value: f64, (low, high): (f64, f64)) -> f64 {
    let grain = (high - low) * 1e-9;
    (value / grain).round() * grain
}

fn paths(
    line: &[series::Point],
    range: (f64, f64),
    style: ShapeStyle,
) -> impl Iterator<Item = PathElement<(f64, f64)>> {
    series::clipped(line, range).into_iter().map(move |part| PathElement::new(part, style))
}

fn font(size: u32) -> TextStyle<'static> {
    ("sans-serif", size * SCALE).into_font().color(&TEXT)
}
