//! The part of each pixel that lines enclose.

use kurbo::Point;

/// The area of each pixel to the right of all lines, as much as they go down, less that of the pixel before: the sums along a row
/// are what is covered.
#[derive(Clone, Debug)]
pub(crate) struct Area {
    width: usize,
    height: usize,
    /// Rows of `width + 2` numbers: a line on the right edge still changes the next pixel but one.
    changes: Vec<f32>,
}

impl Area {
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self { width, height, changes: vec![0.0; (width + 2) * height] }
    }

    /// Adds a line.
    pub(crate) fn add(&mut self, from: Point, to: Point) {
        let (direction, top, bottom) = if from.y < to.y { (1.0, from, to) } else { (-1.0, to, from) };
        let slope = (bottom.x - top.x) / (bottom.y - top.y);
        if !slope.is_finite() {
            return;
        }
        let end = bottom.y.min(self.height as f64);
        let mut y = top.y.max(0.0);
        while y < end {
            let row = y as usize;
            let next = (row as f64 + 1.0).min(end);
            let x = [y, next].map(|y| (top.x + (y - top.y) * slope).clamp(0.0, self.width as f64));
            self.add_in_row(row, x, direction * (next - y));
            y = next;
        }
    }

    /// Adds a line from one x to another, which rises by `height` within a row.
    fn add_in_row(&mut self, row: usize, [from, to]: [f64; 2], height: f64) {
        let (left, right) = if from < to { (from, to) } else { (to, from) };
        let first = left as usize;
        let last = (right.ceil() as usize).saturating_sub(1).max(first);
        let begin = row * (self.width + 2);
        let Some([pixels @ .., after]) = self.changes.get_mut(begin + first..begin + last + 2) else { return };
        // The height of the line before a pixel, and what of the pixel before is covered.
        let (mut passed, mut covered_before) = (0.0, 0.0);
        for (place, pixel) in (first..).zip(pixels) {
            let edge = place as f64 + 1.0;
            let reached = edge.min(right);
            let until = if right > left { height * (reached - left) / (right - left) } else { height };
            let middle = f64::midpoint(left.max(place as f64), reached);
            let covered = passed + (until - passed) * (edge - middle);
            *pixel += (covered - covered_before) as f32;
            (passed, covered_before) = (until, covered);
        }
        *after += (height - covered_before) as f32;
    }

    /// The opacity of each pixel, row by row.
    pub(crate) fn covered(&self) -> impl Iterator<Item = u8> {
        let Self { width, changes, .. } = self;
        changes.chunks_exact(width + 2).flat_map(move |row| {
            let mut sum = 0.0_f32;
            row[..*width].iter().map(move |change| {
                sum += change;
                (sum.abs().min(1.0) * 255.0 + 0.5) as u8
            })
        })
    }
}
