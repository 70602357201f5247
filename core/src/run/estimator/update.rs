//! The last update of a filter, for all sensors of a scenario, and its samples in the channels' units.

use kalmanscope_filters::engine::belief::{GaussianBelief, convert};
use kalmanscope_filters::engine::columns::{factor, square};
use kalmanscope_filters::engine::number::Number;
use kalmanscope_filters::filter::robust::Robust;
use kalmanscope_filters::gaussian_likelihood::{LogSum, part_of};
use kalmanscope_filters::lists::{numbers, places};

use crate::run::sink::Sample;

/// The result of an update, for all m sensors: e, m numbers; S, m × m; K, n × m.
#[derive(Clone)]
pub(crate) struct SensorUpdate {
    pub(crate) innovation: Vec<f64>,
    pub(crate) innovation_cov: Vec<f64>,
    pub(crate) gain: Vec<f64>,
    /// The readings before those of e, S and K within the same sample, by the same sensors.
    pub(crate) earlier: u32,
    pub(crate) nis: f64,
    pub(crate) determinant: f64,
    /// ln det S of several updates, which S alone does not tell.
    pub(super) logs: Option<LogSum>,
}

impl SensorUpdate {
    pub(crate) fn nothing(n: usize, m: usize) -> Self {
        let nan = f64::NAN;
        let (innovation, innovation_cov) = (vec![nan; m], vec![nan; m * m]);
        let gain = vec![0.0; n * m];
        Self { innovation, innovation_cov, gain, earlier: 0, nis: nan, determinant: nan, logs: None }
    }

    pub(super) fn clear(&mut self) {
        self.innovation.fill(f64::NAN);
        self.innovation_cov.fill(f64::NAN);
        self.gain.fill(0.0);
        (self.earlier, self.nis, self.determinant, self.logs) = (0, f64::NAN, f64::NAN, None);
    }

    pub(super) fn take(&mut self, places: &[usize], active: &[usize], [innovation, innovation_cov, gain]: [&[f64]; 3]) {
        let (m, count) = (self.innovation.len(), active.len());
        let n = self.gain.len() / m.max(1);
        for (i, &row) in active.iter().enumerate() {
            let row = places[row];
            self.innovation[row] = innovation[i];
            self.gain[row * n..(row + 1) * n].copy_from_slice(&gain[i * n..(i + 1) * n]);
            for (j, &column) in active.iter().enumerate() {
                self.innovation_cov[places[column] * m + row] = innovation_cov[i.min(j) * count + i.max(j)];
            }
        }
    }

    /// A later update within a sample is independent of this one; e, S and K of a sensor in both are the later ones.
    pub(super) fn add(&mut self, later: &Self) {
        let m = self.innovation.len();
        let n = self.gain.len() / m.max(1);
        let is_in = |update: &Self, sensor: usize| !update.innovation[sensor].is_nan();
        for row in 0..m {
            if !is_in(later, row) {
                continue;
            }
            self.earlier += u32::from(is_in(self, row));
            self.innovation[row] = later.innovation[row];
            for other in 0..m {
                let both = match (is_in(later, other), is_in(self, other)) {
                    (true, _) => later.innovation_cov[other * m + row],
                    (false, true) => 0.0,
                    (false, false) => f64::NAN,
                };
                (self.innovation_cov[other * m + row], self.innovation_cov[row * m + other]) = (both, both);
            }
        }
        for (own, later) in self.gain.chunks_exact_mut(n.max(1)).zip(later.gain.chunks_exact(n.max(1))) {
            if later.iter().any(|gain| *gain != 0.0) {
                own.copy_from_slice(later);
            }
        }
        if self.nis.is_nan() {
            (self.nis, self.determinant) = (later.nis, later.determinant);
        } else if !later.nis.is_nan() {
            (self.nis, self.determinant) = (self.nis + later.nis, self.determinant * later.determinant);
        }
    }

    /// S with the R of the settings, which is what they claim. A reading that counts next to nothing is reported as none.
    pub(super) fn claim(&mut self, places: &[usize], active: &[usize], weights: &[f64], variances: &[f64]) {
        let m = self.innovation.len();
        for &sensor in active {
            let (own, weight, place) = (variances[sensor], weights[sensor], places[sensor]);
            if weight >= Robust::LEFT_OUT {
                self.innovation_cov[place * (m + 1)] += own - own / weight;
                continue;
            }
            self.innovation[place] = f64::NAN;
            for other in 0..m {
                self.innovation_cov[place * m + other] = f64::NAN;
                self.innovation_cov[other * m + place] = f64::NAN;
            }
        }
    }

    /// NIS and det S of e and S, where a sensor has an innovation and S is positive definite; else NaN.
    pub(crate) fn take_squares(&mut self) {
        let m = self.innovation.len();
        let kept = places(m, &|sensor| !self.innovation[sensor].is_nan());
        let mut lower = part_of(&self.innovation_cov, m, &kept);
        let mut white = numbers(kept.len(), &|i| self.innovation[kept[i]]);
        let (determinant, is_positive) = factor(&mut lower, kept.len());
        (self.nis, self.determinant) = if is_positive && !kept.is_empty() {
            (square(&lower, kept.len(), &mut white), determinant)
        } else {
            (f64::NAN, f64::NAN)
        };
    }

    pub(crate) fn sample<'a>(&'a self, mean: &'a [f64], cov: &'a [f64]) -> Sample<'a> {
        let Self { innovation, innovation_cov, gain, .. } = self;
        let (earlier, nis, determinant) = (self.earlier, self.nis, self.determinant);
        let logs = self.logs.filter(|_| !determinant.is_normal());
        let ln_determinant = logs.map_or(f64::NAN, LogSum::value);
        let unmeasured = Sample { ln_determinant, ..Sample::unmeasured(mean, cov) };
        Sample { innovation, innovation_cov, gain, earlier, nis, determinant, ..unmeasured }
    }
}

/// Beliefs of a filter of logarithms in the channels' units, of one run or of several in lanes.
#[derive(Clone, Debug)]
pub(crate) struct InUnits<T> {
    logarithms: Vec<usize>,
    /// The size of each component's unit in its channel's unit.
    unit: Vec<T>,
    pub(crate) belief: GaussianBelief<T>,
    prior: GaussianBelief<T>,
    /// K, n × m.
    gain: Vec<T>,
}

impl<T: Number> InUnits<T> {
    pub(crate) fn new(logarithms: &[usize], n: usize, sensors: usize) -> Option<Box<Self>> {
        let zeros = |count| vec![T::of(0.0); count];
        let belief = GaussianBelief { mean: zeros(n), cov: zeros(n * n) };
        let (unit, gain, prior) = (vec![T::of(1.0); n], zeros(n * sensors), belief.clone());
        (!logarithms.is_empty()).then(|| Box::new(Self { logarithms: logarithms.to_vec(), unit, belief, prior, gain }))
    }

    pub(crate) fn convert(&mut self, belief: &GaussianBelief<T>) {
        convert(&self.logarithms, &mut self.unit, [&belief.mean, &belief.cov], &mut self.belief);
    }
}

impl InUnits<f64> {
    pub(super) fn back(&mut self, mean: &[f64], cov: &[f64]) -> &GaussianBelief<f64> {
        let Self { logarithms, unit, belief, .. } = self;
        belief.mean.copy_from_slice(mean);
        belief.cov.copy_from_slice(cov);
        for &place in &*logarithms {
            unit[place] = mean[place];
            belief.mean[place] = libm::log(mean[place]);
        }
        for (column, by) in belief.cov.chunks_exact_mut(unit.len()).zip(&*unit) {
            column.iter_mut().zip(&*unit).for_each(|(entry, unit)| *entry /= unit * by);
        }
        belief
    }

    /// Converts to the channels' units. Returns whether the numbers are finite in them.
    pub(crate) fn take<'a>(&'a mut self, sample: Sample<'a>) -> (Sample<'a>, bool) {
        let Self { logarithms, unit, belief, prior, gain } = self;
        if !sample.prior_mean.is_empty() {
            convert(logarithms, unit, [sample.prior_mean, sample.prior_cov], prior);
        }
        convert(logarithms, unit, [sample.mean, sample.cov], belief);
        let gain = &mut gain[..sample.gain.len()];
        gain.copy_from_slice(sample.gain);
        for column in gain.chunks_exact_mut(unit.len()) {
            column.iter_mut().zip(&*unit).for_each(|(entry, unit)| *entry *= unit);
        }
        let is_finite = belief.mean.iter().chain(&belief.cov).chain(&*gain).all(|number| number.is_finite());
        let sample = Sample { mean: &belief.mean, cov: &belief.cov, gain, ..sample };
        let has_prior = !sample.prior_mean.is_empty();
        (if has_prior { sample.with_prior(prior) } else { sample }, is_finite)
    }
}
