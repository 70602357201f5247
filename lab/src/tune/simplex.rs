//! The method of Nelder and Mead: a simplex of n + 1 points that walks downhill, in n dimensions.
//!
//! Source: Nelder and Mead (1965), A simplex method for function minimization.

use kalmanscope_core::sorting::sort_short_by_key;

/// A point and its cost.
type Corner = (Vec<f64>, f64);

/// A simplex, its best corner first.
pub(super) struct Simplex {
    corners: Vec<Corner>,
    /// The number of costs so far.
    pub(super) runs: u64,
}

/// `a + factor (b - a)`
fn towards(a: &[f64], b: &[f64], factor: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + factor * (b - a)).collect()
}

impl Simplex {
    /// A simplex with these corners.
    pub(super) fn new(corners: Vec<Vec<f64>>, cost: &dyn Fn(&[f64]) -> f64) -> Self {
        let corners: Vec<Corner> = corners.into_iter().map(|point| corner(point, cost)).collect();
        let mut simplex = Self { runs: corners.len() as u64, corners };
        simplex.sort();
        simplex
    }

    fn sort(&mut self) {
        sort_short_by_key(&mut self.corners, |(_, cost)| *cost);
    }

    /// The corner of least cost.
    pub(super) fn best(&self) -> Option<(&[f64], f64)> {
        self.corners.first().map(|(point, cost)| (&**point, *cost))
    }

    /// The standard deviation of the corners' costs.
    pub(super) fn spread(&self) -> f64 {
        let count = self.corners.len() as f64;
        let mean = self.corners.iter().map(|(_, cost)| cost).sum::<f64>() / count;
        let squares: f64 = self.corners.iter().map(|(_, cost)| (cost - mean) * (cost - mean)).sum();
        (1.0 / (count - 1.0) * squares).sqrt()
    }

    /// Moves the worst corner, or all but the best one. Returns false where a cost is not a number.
    pub(super) fn advance(&mut self, cost: &dyn Fn(&[f64]) -> f64) -> bool {
        let Some(((_, best), (worst_point, worst))) = self.corners.first().zip(self.corners.last()) else {
            return false;
        };
        let second_worst = self.corners.iter().rev().nth(1).map_or(*best, |(_, cost)| *cost);
        let centroid = self.centroid();
        let reflected = corner(towards(&centroid, worst_point, -1.0), cost);
        let mut runs = 1;
        let moved = if reflected.1 < *best {
            runs += 1;
            let expanded = corner(towards(&centroid, &reflected.0, 2.0), cost);
            Some(if expanded.1 < reflected.1 { expanded } else { reflected })
        } else if reflected.1 < second_worst {
            Some(reflected)
        } else if reflected.1.is_nan() {
            return false;
        } else {
            runs += 1;
            let is_outside = reflected.1 < *worst;
            let contracted = corner(towards(&centroid, if is_outside { &reflected.0 } else { worst_point }, 0.5), cost);
            let is_better = if is_outside { contracted.1 <= reflected.1 } else { contracted.1 < *worst };
            is_better.then_some(contracted)
        };
        self.runs += runs;
        match moved {
            Some(moved) => self.corners.splice(self.corners.len() - 1.., [moved]).for_each(drop),
            None => self.shrink(cost),
        }
        self.sort();
        true
    }

    /// The middle of all corners but the worst.
    fn centroid(&self) -> Vec<f64> {
        let others = &self.corners[..self.corners.len() - 1];
        let share = 1.0 / others.len() as f64;
        let dimensions = others.first().map_or(0, |(point, _)| point.len());
        (0..dimensions).map(|i| share * others.iter().map(|(point, _)| point[i]).sum::<f64>()).collect()
    }

    /// Halves the way of all corners to the best one.
    fn shrink(&mut self, cost: &dyn Fn(&[f64]) -> f64) {
        let Some(((best, _), others)) = self.corners.split_first_mut() else { return };
        for other in others {
            *other = corner(towards(best, &other.0, 0.5), cost);
            self.runs += 1;
        }
    }
}

fn corner(point: Vec<f64>, cost: &dyn Fn(&[f64]) -> f64) -> Corner {
    let cost = cost(&point);
    (point, cost)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn minimised(cost: &dyn Fn(&[f64]) -> f64, corners: Vec<Vec<f64>>, steps: usize) -> Simplex {
        let mut simplex = Simplex::new(corners, cost);
        for _ in 0..steps {
            assert!(simplex.advance(cost));
        }
        simplex
    }

    /// The valley of Rosenbrock, from where the paper begins.
    #[test]
    fn it_finds_the_end_of_a_bent_valley() {
        let valley = |x: &[f64]| 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2);
        let simplex = minimised(&valley, vec![vec![-1.2, 1.0], vec![-0.9, 1.0], vec![-1.2, 1.3]], 150);
        let (point, cost) = simplex.best().unwrap();
        assert!(cost < 1e-9 && point.iter().all(|x| (x - 1.0).abs() < 1e-4), "{point:?} {cost}");
        assert!(simplex.spread() < 1e-7 && (150..400).contains(&simplex.runs), "{} {}", simplex.spread(), simplex.runs);
    }

    /// All but the best corner move where neither reflection nor contraction is better.
    #[test]
    fn it_shrinks_towards_the_best_corner() {
        let pit = |x: &[f64]| if x == [0.0, 0.0] { 0.0 } else { 2.0 - (x[0] + x[1]).abs().min(1.0) };
        let simplex = minimised(&pit, vec![vec![0.0, 0.0], vec![1.0, 0.0], vec![0.0, 1.0]], 1);
        assert_eq!(simplex.best(), Some((&[0.0, 0.0][..], 0.0)));
        assert_eq!(simplex.runs, 3 + 2 + 2);
        assert!(simplex.corners[1..].iter().all(|(point, _)| point.iter().sum::<f64>() == 0.5));
    }

    #[test]
    fn one_dimension_is_enough() {
        let simplex = minimised(&|x| (x[0] - 0.3).powi(2), vec![vec![0.9], vec![0.8]], 60);
        assert!((simplex.best().unwrap().0[0] - 0.3).abs() < 1e-6);
    }

    #[test]
    fn it_stops_at_a_cost_that_is_no_number() {
        let cost = |x: &[f64]| if x[0] < 0.5 { f64::NAN } else { x[0] };
        let mut simplex = Simplex::new(vec![vec![0.6], vec![0.8]], &cost);
        assert!(!simplex.advance(&cost));
        assert_eq!(simplex.best(), Some((&[0.6][..], 0.6)));
    }
}
