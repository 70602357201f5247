//! Axes of numbers, and curves over them.

use crate::svg::{Anchor, Color, Point, Style, Svg, Text};

const TEXT: Color = Color([0x22, 0x22, 0x22, 0xff]);
const GRID: Color = Color([0xe4, 0xe4, 0xe4, 0xff]);

/// The size of the type of numbers, and of that of names.
const TYPE: [f32; 2] = [13.0, 15.0];
const NAME: [f32; 2] = [66.0, 40.0];
/// Limits the distance of a point from the corner of the area. Readers of SVG round larger ones.
const FARTHEST: f64 = 20_000.0;
const MARKS: [f32; 2] = [76.0, 28.0];

/// An area with a horizontal and a vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Left, top, width and height of the area of the curves.
    pub area: [f32; 4],
    /// The first and the last number of the horizontal axis.
    pub x: [f64; 2],
    /// The lowest and the highest number of the vertical axis.
    pub y: [f64; 2],
}

impl Axes {
    fn at(&self, (x, y): (f64, f64)) -> Point {
        let [left, top, width, height] = self.area;
        let place = |value: f64, [from, to]: [f64; 2], length: f32| {
            let place = (value - from) / (to - from) * f64::from(length);
            if place.is_nan() { 0.0 } else { place.clamp(-FARTHEST, FARTHEST) as f32 }
        };
        [left + place(x, self.x, width), top + height - place(y, self.y, height)]
    }

    /// Grid, numbers and names of the axes. Without a name of the horizontal axis it has no numbers either.
    pub fn grid(&self, svg: &mut Svg, y_name: &str, x_name: Option<&str>, number: &dyn Fn(f64) -> String) {
        let [left, top, width, height] = self.area;
        let bottom = top + height;
        for mark in marks(self.x, (width / MARKS[0]) as usize) {
            let [x, _] = self.at((mark, self.y[0]));
            svg.path([[x, top], [x, bottom]], false, Style::stroke(GRID, 1.0));
            if x_name.is_some() {
                svg.text(&label(&number(mark), [x, bottom + 18.0], Anchor::Middle, TYPE[0]));
            }
        }
        for mark in marks(self.y, (height / MARKS[1]) as usize) {
            let [_, y] = self.at((self.x[0], mark));
            svg.path([[left, y], [left + width, y]], false, Style::stroke(GRID, 1.0));
            svg.text(&label(&number(mark), [left - 8.0, y + 0.35 * TYPE[0]], Anchor::End, TYPE[0]));
        }
        svg.path([[left, top], [left, bottom], [left + width, bottom]], false, Style::stroke(TEXT, 1.0));
        let name = label(y_name, [left - NAME[0], top + 0.5 * height], Anchor::Middle, TYPE[1]);
        svg.text(&Text { turn: -90.0, ..name });
        if let Some(name) = x_name {
            svg.text(&label(name, [left + 0.5 * width, bottom + NAME[1]], Anchor::Middle, TYPE[1]));
        }
    }

    /// A line through points, with a gap where a number is NaN.
    pub fn line(&self, svg: &mut Svg, points: impl IntoIterator<Item = (f64, f64)>, style: Style) {
        let mut parts = vec![Vec::new()];
        for point in points {
            match parts.last_mut() {
                Some(part) if !point.1.is_nan() => part.push(self.at(point)),
                Some(part) if part.is_empty() => {}
                _ => parts.push(Vec::new()),
            }
        }
        svg.clipped(self.area, |svg| svg.paths(parts.into_iter().filter(|part| part.len() > 1), false, style));
    }

    /// An area inside an outline.
    pub fn outline(&self, svg: &mut Svg, points: &[(f64, f64)], color: Color) {
        let points = points.iter().map(|point| self.at(*point));
        svg.clipped(self.area, |svg| svg.path(points, true, Style::fill(color)));
    }

    /// Dots, those inside the area.
    pub fn dots(&self, svg: &mut Svg, points: impl IntoIterator<Item = (f64, f64)>, radius: f32, color: Color) {
        for point in points.into_iter().filter(|point| (self.y[0]..=self.y[1]).contains(&point.1)) {
            svg.ellipse(self.at(point), [radius; 2], Style::fill(color));
        }
    }
}

fn label(text: &str, origin: Point, anchor: Anchor, size: f32) -> Text<'_> {
    Text { text, origin, turn: 0.0, at: [0.0; 2], anchor, size, length: None, bold: false, color: TEXT }
}

/// Round numbers between two others, at most this many: multiples of 1, 2 or 5 times a power of ten.
pub fn marks([low, high]: [f64; 2], most: usize) -> Vec<f64> {
    let least = (high - low) / most.max(1) as f64;
    let power = 10_f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= least);
    let Some(step) = step.filter(|step| step.is_finite() && *step > 0.0) else { return Vec::new() };
    let first = (low / step).ceil();
    // Multiples, no sums: tenths that add up leave the round numbers.
    (0..=most).map(|place| (first + place as f64) * step).filter(|mark| (low..=high).contains(mark)).collect()
}
