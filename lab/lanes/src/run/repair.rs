//! Steps that are special in some lanes: the single filter takes them.

use kalmanscope_core::internals::kernel::{Correction, MAX_SENSORS};
use kalmanscope_core::internals::kernel::{Gaussian, Vector};
use kalmanscope_core::internals::{LogSum, ln_determinant};
use kalmanscope_core::{FilterError, Stop};

use super::Batch;
use crate::belief::{Belief, Noise};
use crate::lane::{LANES, Lane};
use crate::observation::Run;
use crate::plant::Plant;

impl<P: Plant<N>, T: Lane, const N: usize, const E: usize> Batch<'_, P, T, N, E> {
    /// Repeats the step to sample `k` by the single filter in the lanes for which it did not hold. Returns NIS and det
    /// S of all lanes.
    #[cold]
    #[inline(never)]
    pub(super) fn repair(
        &mut self,
        before: &Belief<T, N, E>,
        holds: T::Mask,
        told: [T; 2],
        k: usize,
        expected: u32,
    ) -> [T; 2] {
        let token = told[0].token();
        let one = told[0].of(1.0);
        let holds = T::select(holds, one, one.of(0.0)).to_array();
        let [mut nis, mut determinant] = told.map(T::to_array);
        let (starts, mut beliefs) = (before.split(), self.belief.split());
        for lane in (0..LANES).filter(|&lane| holds[lane] == 0.0) {
            (nis[lane], determinant[lane]) = (0.0, 1.0);
            if !self.stopped[lane] {
                match self.step(lane, &starts[lane], k) {
                    Ok((belief, correction)) => {
                        beliefs[lane] = belief;
                        let counted = self.take(lane, &correction, expected);
                        (nis[lane], determinant[lane]) = counted;
                        continue;
                    }
                    Err(reason) => {
                        let stop = Stop { sample: k, reason };
                        self.stopped[lane] = true;
                        self.outcomes[lane] = self.outcome(lane, k, &starts[lane], Some(stop));
                        self.park(lane);
                    }
                }
            }
            beliefs[lane] = Gaussian::independent(
                Vector::from_fn(|i, _| PARKED.get(i).copied().unwrap_or(0.0)),
                &Vector::repeat(1.0),
            );
        }
        self.belief = Belief::new(token, &beliefs);
        [nis, determinant].map(|numbers| T::from_array(token, numbers))
    }

    /// The step of the single filter in a lane.
    fn step(&self, lane: usize, start: &Gaussian<N>, k: usize) -> Result<(Gaussian<N>, Correction<N>), FilterError> {
        let Run { filter, record } = self.runs[lane];
        let mut measured = [f64::NAN; MAX_SENSORS];
        for (value, &column) in measured.iter_mut().zip(&filter.columns) {
            *value = record.measured(column)[k];
        }
        let force = &self.observations.force;
        let forces = [force.of_lane(lane, k - 1), force.of_lane(lane, k)];
        let (mut belief, mut correction) = (start.clone(), Correction::NOTHING);
        filter.step(&mut belief, forces, &measured[..filter.columns.len()], &mut correction)?;
        Ok((belief, correction))
    }

    /// NIS and det S of a lane as the sums take them. A determinant out of range is taken here, from S itself.
    fn take(&mut self, lane: usize, correction: &Correction<N>, expected: u32) -> (f64, f64) {
        let m = self.runs[lane].filter.columns.len();
        let measured = correction.innovation[..m].iter().map(|e| u32::from(!e.is_nan())).sum();
        let is_special = !correction.determinant.is_nan() && !LogSum::RANGE.contains(&correction.determinant);
        let ln = if is_special {
            let cov: Vec<f64> = correction.innovation_cov[..m].iter().flat_map(|row| row[..m].to_vec()).collect();
            ln_determinant(correction.determinant, &cov, m)
        } else {
            0.0
        };
        self.sums.correct(lane, measured, expected, ln);
        let nis = if measured > 0 { correction.nis } else { 0.0 };
        (nis, if is_special || correction.determinant.is_nan() { 1.0 } else { correction.determinant })
    }

    /// Gives a lane that has stopped noise that makes no trouble.
    fn park(&mut self, lane: usize) {
        let set = |numbers: &mut T, number: f64| {
            let mut all = numbers.to_array();
            all[lane] = number;
            *numbers = T::from_array(numbers.token(), all);
        };
        let Noise { process, fading, eta: _, decay: _ } = &mut self.noise;
        process.iter_mut().for_each(|process| set(process, 1e-6));
        set(fading, 1.0);
        self.variances.iter_mut().for_each(|variance| set(variance, 1.0));
    }
}

/// The mean of a lane that has stopped; further components are zero.
const PARKED: [f64; 4] = [0.0, 0.0, 1.0, 0.1];
