//! Points that go from the initial belief to the posterior.

use kalmanscope_core::filter::Normal;

// At each degree half the points still count: of fewer, most would be copies of each other.
const LEFT: f64 = 0.5;

/// The mean number of moves of a point at each temperature, and at the last one; and the most tries of each.
const MOVES: [f64; 2] = [1.0, 6.0];
const TRIES: [u32; 2] = [8, 30];

/// The share of moves by the whole difference of two others, which lead from one mode to another.
const LEAPS: f64 = 0.3;

const NOISE: f64 = 1e-2;

/// A point, in standard deviations of the initial belief.
#[derive(Clone)]
pub(super) struct Particle {
    pub(super) at: Vec<f64>,
    log_likelihood: f64,
}

pub(super) struct Population<L> {
    random: Normal,
    pub(super) points: Vec<Particle>,
    log_likelihoods: L,
    pub(super) runs: u64,
}

impl<L: Fn(&[Vec<f64>]) -> Vec<f64>> Population<L> {
    pub(super) fn new(count: usize, parameters: usize, seed: u64, log_likelihoods: L) -> Self {
        let mut random = Normal::from_seed(seed);
        let draws: Vec<Vec<f64>> = (0..count).map(|_| (0..parameters).map(|_| random.sample()).collect()).collect();
        let points = log_likelihoods(&draws).into_iter().zip(draws);
        let points = points.map(|(log_likelihood, at)| Particle { at, log_likelihood }).collect();
        Self { random, points, log_likelihoods, runs: count as u64 }
    }

    /// Turns the likelihood on by degrees. Returns ln p(z), or `None` where no draw has a likelihood.
    pub(super) fn heat(&mut self) -> Option<f64> {
        let (mut temperature, mut log_evidence) = (0.0, 0.0);
        while temperature < 1.0 {
            let possible = self.points.iter().filter(|point| point.log_likelihood.is_finite());
            let count = possible.clone().count();
            if count == 0 {
                return None;
            }
            let highest = possible.map(|point| point.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
            // Relative to the highest one: the likelihood itself of a long record is no number.
            let weight = |point: &Particle, by: f64| libm::exp(by * (point.log_likelihood - highest));
            // The number of points that would do as much if they counted the same.
            let effective = |by: f64| {
                let weights = self.points.iter().map(|point| weight(point, by));
                let [sum, squares] = weights.fold([0.0, 0.0], |[sum, squares], w| [sum + w, squares + w * w]);
                sum * sum / squares
            };
            let (left, rest) = (LEFT * count as f64, 1.0 - temperature);
            let is_last = effective(rest) >= left;
            let mut by = [0.0, rest];
            if effective(rest) < left {
                for _ in 0..60 {
                    let middle = 0.5 * (by[0] + by[1]);
                    by[usize::from(effective(middle) < left)] = middle;
                }
            }
            let by = by[1];
            let weights: Vec<f64> = self.points.iter().map(|point| weight(point, by)).collect();
            log_evidence += by * highest + libm::log(weights.iter().sum::<f64>() / weights.len() as f64);
            temperature = if is_last { 1.0 } else { temperature + by };
            self.draw_again(&weights);
            self.spread(temperature);
        }
        Some(log_evidence)
    }

    /// Source: Kitagawa (1996), Monte Carlo filter and smoother for non-Gaussian nonlinear state space models.
    fn draw_again(&mut self, weights: &[f64]) {
        let step = weights.iter().sum::<f64>() / weights.len() as f64;
        let (mut goal, mut sum, mut place) = (step * self.random.uniform(), weights[0], 0);
        let draw = |_| {
            while sum < goal && place + 1 < weights.len() {
                place += 1;
                sum += weights[place];
            }
            goal += step;
            self.points[place].clone()
        };
        let points = (0..weights.len()).map(draw).collect();
        self.points = points;
    }

    fn spread(&mut self, temperature: f64) {
        let is_last = usize::from(temperature == 1.0);
        let mut moves = 0;
        for _ in 0..TRIES[is_last] {
            for half in 0..2 {
                let proposals = self.proposals(half);
                let log_likelihoods = (self.log_likelihoods)(&proposals);
                self.runs += proposals.len() as u64;
                moves += self.accept(half, temperature, proposals, &log_likelihoods);
            }
            if moves as f64 >= MOVES[is_last] * self.points.len() as f64 {
                break;
            }
        }
    }

    fn proposals(&mut self, half: usize) -> Vec<Vec<f64>> {
        let Self { random, points, .. } = self;
        // The points of the other half rest meanwhile: moves are then reversible, and run side by side.
        let others: Vec<&Particle> = points.iter().skip(1 - half).step_by(2).collect();
        let (parameters, count) = (others[0].at.len(), others.len());
        // The best size for a normal distribution, by ter Braak (2006).
        let usual = 2.38 / libm::sqrt(2.0 * parameters as f64);
        let std = |i: usize| {
            let mean = others.iter().map(|point| point.at[i]).sum::<f64>() / count as f64;
            let squares = others.iter().map(|point| (point.at[i] - mean) * (point.at[i] - mean));
            libm::sqrt(squares.sum::<f64>() / count as f64)
        };
        let stds: Vec<f64> = (0..parameters).map(std).collect();
        let pick = |random: &mut Normal, below: usize| ((random.uniform() * below as f64) as usize).min(below - 1);
        let mut propose = |point: &Particle| {
            let a = pick(random, count);
            let b = (a + 1 + pick(random, count - 1)) % count;
            let by = if random.uniform() < LEAPS { 1.0 } else { usual };
            let place = |(i, &at): (usize, &f64)| {
                // Without the noise, points would reach sums of the first differences only.
                at + by * (others[a].at[i] - others[b].at[i]) + NOISE * stds[i] * random.sample()
            };
            point.at.iter().enumerate().map(place).collect()
        };
        points.iter().skip(half).step_by(2).map(&mut propose).collect()
    }

    fn accept(&mut self, half: usize, temperature: f64, proposals: Vec<Vec<f64>>, log_likelihoods: &[f64]) -> usize {
        let Self { random, points, .. } = self;
        let square = |at: &[f64]| at.iter().map(|x| x * x).sum::<f64>();
        let mut moves = 0;
        let tried = points.iter_mut().skip(half).step_by(2).zip(proposals).zip(log_likelihoods);
        for ((point, at), &log_likelihood) in tried {
            let by_likelihood = temperature * (log_likelihood - point.log_likelihood);
            let by_belief = 0.5 * (square(&point.at) - square(&at));
            if libm::log(random.uniform()) < by_likelihood + by_belief {
                *point = Particle { at, log_likelihood };
                moves += 1;
            }
        }
        moves
    }
}
