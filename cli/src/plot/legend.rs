//! The legend of the picture.

use kalmanscope_core::{Channel, Run};
use plotters::prelude::*;

use super::panel::Panel;
use super::{Area, BAND_OPACITY, DOT_OPACITY, DOT_RADIUS, MEASURED, PlotError, SCALE, TRUTH, WIDTH, colored, font};
use crate::number::plain;
use crate::table::heading;

const LEFT: u32 = 92;
const ROW_HEIGHT: u32 = 22;
const MARGIN: u32 = 12;
const LETTERS: usize = 36;

enum Swatch {
    Line(RGBColor),
    Dots,
    Band(RGBColor),
}

/// Height of the legend in pixels.
pub(super) fn height(run: &Run) -> u32 {
    let entries = entries(run);
    entries.len().div_ceil(columns(&entries)) as u32 * ROW_HEIGHT + MARGIN
}

fn entries(run: &Run) -> Vec<(Swatch, String)> {
    let record = run.record();
    let mut entries = Vec::new();
    if Channel::all().iter().any(|&c| record.truth(c).is_some()) {
        entries.push((Swatch::Line(TRUTH), "truth".to_owned()));
    }
    if Panel::all(run).iter().any(|panel| panel.measured(record).is_some()) {
        entries.push((Swatch::Dots, "measurement".to_owned()));
    }
    for (estimates, color) in colored(run) {
        let end = match estimates.stop() {
            Some(stop) => format!(", stopped at {} s", plain(record.time_of(stop.sample))),
            None => " ±2σ".to_owned(),
        };
        let name = shortened(&heading(estimates.name(), estimates.kind()));
        entries.push((Swatch::Band(color), name + &end));
    }
    entries
}

fn columns(entries: &[(Swatch, String)]) -> usize {
    if entries.iter().all(|(_, text)| text.chars().count() <= 24) { 4 } else { 3 }
}

fn shortened(name: &str) -> String {
    if name.chars().count() <= LETTERS {
        return name.to_owned();
    }
    name.chars().take(LETTERS - 1).chain(['…']).collect()
}

pub(super) fn draw(run: &Run, area: &Area<'_>) -> Result<(), PlotError> {
    let scaled = |x: u32, y: u32| ((x * SCALE) as i32, (y * SCALE) as i32);
    let entries = entries(run);
    let columns = columns(&entries);
    for (i, (swatch, text)) in entries.into_iter().enumerate() {
        let (row, column) = ((i / columns) as u32, (i % columns) as u32);
        let x = LEFT + column * (WIDTH - LEFT) / columns as u32;
        let y = MARGIN + row * ROW_HEIGHT + ROW_HEIGHT / 2;
        let stroke =
            |color: RGBColor| PathElement::new(vec![scaled(x, y), scaled(x + 26, y)], color.stroke_width(2 * SCALE));
        match swatch {
            Swatch::Line(color) => area.draw(&stroke(color))?,
            Swatch::Dots => {
                for (dx, up) in [(3, 0), (10, 3), (17, 1), (24, 4)] {
                    area.draw(&Circle::new(
                        scaled(x + dx, y + 2 - up),
                        DOT_RADIUS,
                        MEASURED.mix(DOT_OPACITY).filled(),
                    ))?;
                }
            }
            Swatch::Band(color) => {
                let corners = [scaled(x, y - 6), scaled(x + 26, y + 6)];
                area.draw(&Rectangle::new(corners, color.mix(BAND_OPACITY).filled()))?;
                area.draw(&stroke(color))?;
            }
        }
        area.draw_text(&text, &font(14), scaled(x + 34, y - 8))?;
    }
    Ok(())
}
