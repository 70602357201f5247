//! Curves to lines.

use kurbo::{Affine, BezPath, PathEl, Point};

/// Limits the distance between a curve and its lines, in pixels.
const TOLERANCE: f64 = 0.25;

/// Calls `line` with the ends of each line of a path, which is closed wherever it ends.
pub(crate) fn flatten(path: &BezPath, transform: Affine, mut line: impl FnMut(Point, Point)) {
    let (mut begin, mut here) = (Point::ZERO, Point::ZERO);
    kurbo::flatten(path.iter().map(|element| transform * element), TOLERANCE, |element| {
        let to = match element {
            PathEl::LineTo(to) => to,
            _ => begin,
        };
        line(here, to);
        here = to;
        if let PathEl::MoveTo(to) = element {
            (begin, here) = (to, to);
        }
    });
    line(here, begin);
}
