//! The picture of all trials: T² over the added mass with the line of a spring, or damping over frequency.

use egui::{Color32, Ui};
use egui_plot::{FilledArea, Line, PlotUi, Points};
use kalmanscope_lab::{Estimated, Spring, Trial};

use super::sentence::is_weighed;
use crate::plot::plane::{around, drawable, plane_ui};
use crate::theme::Palette;

/// The points of a line's band.
const STEPS: usize = 48;

/// A point with its half bands.
type Cross = [(f64, f64); 2];

pub(super) fn picture_ui(ui: &mut Ui, rows: &[Trial], palette: &Palette) {
    if is_weighed(rows) {
        line_ui(ui, rows, palette);
    } else {
        spread_ui(ui, rows, palette);
    }
}

/// T² over the added mass.
fn line_ui(ui: &mut Ui, rows: &[Trial], palette: &Palette) {
    let crosses: Vec<Cross> =
        rows.iter().map(|trial| [(1000.0 * trial.mass, 0.0), pair(trial.period_squared())]).collect();
    let heaviest = rows.iter().map(|trial| trial.mass).fold(0.0, f64::max);
    let line: Vec<[f64; 3]> = Spring::of(rows).map_or_else(Vec::new, |spring| {
        // To where T² is 0, so that the mass which was there before is seen.
        let begin = (-spring.own_mass.mean).clamp(-2.0 * heaviest, 0.0);
        let end = 1.08 * heaviest;
        let at = |step: usize| {
            let mass = begin + (end - begin) * step as f64 / STEPS as f64;
            let Estimated { mean, std } = spring.period_squared(mass);
            [1000.0 * mass, mean, 2.0 * std]
        };
        (0..=STEPS).map(at).collect()
    });
    let range = ranges(&crosses, &line);
    plane_ui(ui, "period squared over added mass", ["added mass m [g]", "T² [s²]"], palette, range, |plot| {
        // A band narrows towards the middle of the points, so it is no convex polygon.
        let edge = |sign: f64| -> (Vec<f64>, Vec<f64>) {
            line.iter().map(|[x, y, band]| drawable(plot, [*x, y + sign * band])).map(|[x, y]| (x, y)).unzip()
        };
        let ((across, low), (_, high)) = (edge(-1.0), edge(1.0));
        let fill = palette.accent.gamma_multiply(0.2);
        plot.add(FilledArea::new("band of the line", &across, &low, &high).fill_color(fill).allow_hover(false));
        let mean: Vec<[f64; 2]> = line.iter().map(|[x, y, _]| drawable(plot, [*x, *y])).collect();
        plot.line(Line::new("line of the spring", mean).color(palette.accent).width(1.8).allow_hover(false));
        draw(plot, rows, &crosses, palette);
    });
}

/// Damping over frequency.
fn spread_ui(ui: &mut Ui, rows: &[Trial], palette: &Palette) {
    let crosses: Vec<Cross> =
        rows.iter().map(|trial| [pair(trial.hertz()), pair(trial.damping.times(100.0))]).collect();
    let range = ranges(&crosses, &[]);
    plane_ui(ui, "damping over frequency", ["f [Hz]", "ζ [%]"], palette, range, |plot| {
        draw(plot, rows, &crosses, palette);
    });
}

fn pair(number: Estimated) -> (f64, f64) {
    (number.mean, number.band())
}

/// Ranges that hold all crosses, and the line.
fn ranges(crosses: &[Cross], line: &[[f64; 3]]) -> Option<[(f64, f64); 2]> {
    let seen = |axis: usize| {
        let ends = crosses.iter().map(move |cross| cross[axis]).flat_map(|(mean, band)| [mean - band, mean + band]);
        ends.chain(line.iter().map(move |point| point[axis]))
    };
    around(seen(0)).zip(around(seen(1))).map(|(x, y)| [x, y])
}

/// Draws the trials, each with its bands.
fn draw(plot: &mut PlotUi<'_>, rows: &[Trial], crosses: &[Cross], palette: &Palette) {
    for (trial, [(x, wide), (y, high)]) in rows.iter().zip(crosses) {
        let color: Color32 = if trial.is_believed { palette.text } else { palette.warning };
        for ends in [[[x - wide, *y], [x + wide, *y]], [[*x, y - high], [*x, y + high]]] {
            let ends = ends.map(|end| drawable(plot, end));
            plot.line(Line::new("band", ends.to_vec()).color(color).width(1.4).allow_hover(false));
        }
        let at = drawable(plot, [*x, *y]);
        plot.points(Points::new("trial", vec![at]).color(color).radius(3.2).allow_hover(false));
    }
}
