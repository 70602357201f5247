//! The filter whose line, or the edge of whose band, is under the pointer.

use egui::Pos2;
use egui_plot::PlotTransform;

use super::marks::{Mark, Rung};
use super::projection::Projection;

/// A line is hit from within this distance \[points\].
const REACH: f32 = 5.0;

pub(super) fn filter_at(marks: &[Mark], transform: &PlotTransform, position: Pos2) -> Option<u32> {
    // Only points around the pointer can be near: a line goes from left to right.
    let time = |x: f32| transform.value_from_position(Pos2 { x, ..position }).x;
    let pointer = Pointer {
        position,
        times: (time(position.x - REACH), time(position.x + REACH)),
        projection: Projection::new(transform),
    };
    let (filter, _) = marks
        .iter()
        .filter_map(|mark| match mark {
            Mark::Line { points, filter, dashed: false, .. } => {
                Some((*filter, pointer.distance(points, |point| (point.x, point.y))))
            }
            Mark::Band { parts, filter, .. } => {
                let edge =
                    |part: &Vec<Rung>, of: fn(&Rung) -> f64| pointer.distance(part, |rung| (rung.time, of(rung)));
                let edges = parts.iter().map(|part| edge(part, |rung| rung.low).min(edge(part, |rung| rung.high)));
                Some((*filter, edges.fold(f32::INFINITY, f32::min)))
            }
            _ => None,
        })
        .filter(|(_, distance)| *distance <= REACH)
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    filter
}

struct Pointer {
    position: Pos2,
    times: (f64, f64),
    projection: Projection,
}

impl Pointer {
    fn distance<P>(&self, points: &[P], of: impl Fn(&P) -> (f64, f64)) -> f32 {
        let Self { position, times: (from, to), projection } = self;
        let first = points.partition_point(|point| of(point).0 < *from).saturating_sub(1);
        let last = (points.partition_point(|point| of(point).0 <= *to) + 1).min(points.len());
        let near = points.get(first..last).unwrap_or_default().iter().map(|point| {
            let (time, value) = of(point);
            projection.at(time, value)
        });
        let places: Vec<Pos2> = near.collect();
        let distances = places.windows(2).map(|ends| distance(*position, ends[0], ends[1]));
        distances.fold(f32::INFINITY, f32::min)
    }
}

fn distance(position: Pos2, from: Pos2, to: Pos2) -> f32 {
    let along = to - from;
    let share = ((position - from).dot(along) / along.length_sq().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    position.distance(from + share * along)
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::distance;

    #[test]
    fn the_distance_from_a_line_ends_at_its_ends() {
        let of = |x, y| distance(pos2(x, y), pos2(0.0, 0.0), pos2(10.0, 0.0));
        assert_eq!((of(5.0, 3.0), of(-4.0, 3.0), of(13.0, 4.0)), (3.0, 5.0, 5.0));
        assert_eq!(distance(pos2(3.0, 4.0), pos2(0.0, 0.0), pos2(0.0, 0.0)), 5.0);
    }
}
