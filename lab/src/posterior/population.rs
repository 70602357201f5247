//! Points that go from the initial belief to the posterior.

use kalmanscope_core::filter::Normal;

const LEFT: f64 = 0.5;

/// The mean number of moves of a point at each temperature, and at the last one; and the most tries of each.
const MOVES: [f64; 2] = [1.0, 6.0];
const TRIES: [u32; 2] = [8, 30];

/// The share of moves by the whole difference of two others, which lead from one mode to another.
const LEAPS: f64 = 0.3;

const NOISE: f64 = 1e-2;

/// A point, in standard deviations of the initial belief.
#[derive(Clone)]
struct Particle {
    at: Vec<f64>,
    log_likelihood: f64,
}

pub(super) struct Population {
    random: Normal,
    points: Vec<Particle>,
    /// The exponent of the likelihood, from 0 to 1, now and first.
    temperature: f64,
    first: f64,
    log_evidence: f64,
    stage: SamplerStage,
}

#[derive(Clone, Copy)]
enum SamplerStage {
    Drawn,
    /// The half of the points that tries to move, the sweeps that have ended, and the moves so far.
    Moving {
        half: usize,
        sweeps: u32,
        moves: usize,
    },
    Done,
    Failed,
}

impl Population {
    pub(super) fn new(count: usize, parameters: usize, seed: u64) -> Self {
        let mut random = Normal::from_seed(seed);
        let mut point = || (0..parameters).map(|_| random.sample()).collect();
        let points = (0..count).map(|_| Particle { at: point(), log_likelihood: f64::NAN }).collect();
        Self { random, points, temperature: 0.0, first: 1.0, log_evidence: 0.0, stage: SamplerStage::Drawn }
    }

    pub(super) fn wanted(&mut self) -> Vec<Vec<f64>> {
        match self.stage {
            SamplerStage::Drawn => self.points.iter().map(|point| point.at.clone()).collect(),
            SamplerStage::Moving { half, .. } => self.proposals(half),
            SamplerStage::Done | SamplerStage::Failed => Vec::new(),
        }
    }

    pub(super) fn take(&mut self, wanted: Vec<Vec<f64>>, log_likelihoods: &[f64]) {
        match self.stage {
            SamplerStage::Drawn => {
                for (point, &log_likelihood) in self.points.iter_mut().zip(log_likelihoods) {
                    point.log_likelihood = log_likelihood;
                }
                self.heat();
            }
            SamplerStage::Moving { half, sweeps, moves } => {
                let moves = moves + self.accept(half, wanted, log_likelihoods);
                self.stage = SamplerStage::Moving { half: 1 - half, sweeps: sweeps + half as u32, moves };
                let is_last = usize::from(self.temperature == 1.0);
                let has_moved = moves as f64 >= MOVES[is_last] * self.points.len() as f64;
                if half == 1 && (has_moved || sweeps + 1 >= TRIES[is_last]) {
                    self.heat();
                }
            }
            SamplerStage::Done | SamplerStage::Failed => {}
        }
    }

    pub(super) fn points(&self) -> impl Iterator<Item = &[f64]> {
        self.points.iter().map(|point| &*point.at)
    }

    /// ln p(z), once all is done; `None` before and where no draw has a likelihood.
    pub(super) fn log_evidence(&self) -> Option<f64> {
        matches!(self.stage, SamplerStage::Done).then_some(self.log_evidence)
    }

    pub(super) fn progress(&self, of_wanted: f64) -> f64 {
        const DRAWN: f64 = 0.1;
        const HOT: f64 = 0.8;
        match self.stage {
            SamplerStage::Drawn => DRAWN * of_wanted,
            SamplerStage::Moving { .. } if self.temperature < 1.0 => {
                DRAWN + (HOT - DRAWN) * (1.0 - libm::log(self.temperature) / libm::log(self.first))
            }
            SamplerStage::Moving { moves, .. } => {
                let share = moves as f64 / (MOVES[1] * self.points.len() as f64);
                HOT + (1.0 - HOT) * share.min(1.0)
            }
            SamplerStage::Done | SamplerStage::Failed => 1.0,
        }
    }

    fn heat(&mut self) {
        if self.temperature == 1.0 {
            self.stage = SamplerStage::Done;
            return;
        }
        let possible = self.points.iter().filter(|point| point.log_likelihood.is_finite());
        let count = possible.clone().count();
        if count == 0 {
            self.stage = SamplerStage::Failed;
            return;
        }
        let highest = possible.map(|point| point.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
        let weight = |point: &Particle, by: f64| libm::exp(by * (point.log_likelihood - highest));
        // The number of points that would do as much if they counted the same.
        let effective = |by: f64| {
            let weights = self.points.iter().map(|point| weight(point, by));
            let [sum, squares] = weights.fold([0.0, 0.0], |[sum, squares], w| [sum + w, squares + w * w]);
            sum * sum / squares
        };
        let (left, rest) = (LEFT * count as f64, 1.0 - self.temperature);
        let mut by = [0.0, rest];
        if effective(rest) < left {
            for _ in 0..60 {
                let middle = 0.5 * (by[0] + by[1]);
                by[usize::from(effective(middle) < left)] = middle;
            }
        }
        let is_last = effective(rest) >= left;
        let by = by[1];
        let weights: Vec<f64> = self.points.iter().map(|point| weight(point, by)).collect();
        self.log_evidence += by * highest + libm::log(weights.iter().sum::<f64>() / weights.len() as f64);
        self.temperature = if is_last { 1.0 } else { self.temperature + by };
        if self.first == 1.0 {
            self.first = self.temperature;
        }
        self.draw_again(&weights);
        self.stage = SamplerStage::Moving { half: 0, sweeps: 0, moves: 0 };
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

    fn proposals(&mut self, half: usize) -> Vec<Vec<f64>> {
        let Self { random, points, .. } = self;
        let others: Vec<&Particle> = points.iter().skip(1 - half).step_by(2).collect();
        let (parameters, count) = (others[0].at.len(), others.len());
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
                at + by * (others[a].at[i] - others[b].at[i]) + NOISE * stds[i] * random.sample()
            };
            point.at.iter().enumerate().map(place).collect()
        };
        points.iter().skip(half).step_by(2).map(&mut propose).collect()
    }

    fn accept(&mut self, half: usize, proposals: Vec<Vec<f64>>, log_likelihoods: &[f64]) -> usize {
        let Self { random, points, temperature, .. } = self;
        let square = |at: &[f64]| at.iter().map(|x| x * x).sum::<f64>();
        let mut moves = 0;
        let tried = points.iter_mut().skip(half).step_by(2).zip(proposals).zip(log_likelihoods);
        for ((point, at), &log_likelihood) in tried {
            let by_likelihood = *temperature * (log_likelihood - point.log_likelihood);
            let by_belief = 0.5 * (square(&point.at) - square(&at));
            if libm::log(random.uniform()) < by_likelihood + by_belief {
                *point = Particle { at, log_likelihood };
                moves += 1;
            }
        }
        moves
    }
}
