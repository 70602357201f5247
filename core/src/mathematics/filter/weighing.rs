//! The update of a filter that weighs its measurements by a [rule](Robust).

use super::reported::Reported;
use super::robust::Robust;
use super::{Belief, Correction, FilterError, Noise, Observation};
use crate::Model;
use crate::mathematics::engine::weights::Weights;

/// The weights of a rule, with memory to find them.
#[derive(Clone, Debug)]
pub(super) struct Weighing {
    weights: Weights<f64>,
    reported: Reported,
}

impl Weighing {
    /// The memory for a rule over some sensors; `None` for one that weighs nothing.
    pub(super) fn new(rule: Robust, sensors: usize) -> Option<Self> {
        rule.is_on().then(|| Self { weights: Weights::new(rule, sensors), reported: Reported::default() })
    }

    /// The weights of the last update.
    pub(super) fn weights(&self) -> &Weights<f64> {
        &self.weights
    }

    /// The weights, to be changed.
    pub(super) fn weights_mut(&mut self) -> &mut Weights<f64> {
        &mut self.weights
    }

    /// Conditions a belief on the measurements of an observation, weighed; those with a weight of zero leave the observation.
    /// `measured` has those of all sensors.
    ///
    /// # Errors
    /// Those of [`Belief::condition`].
    pub(super) fn condition<B: Belief + ?Sized>(
        &mut self,
        belief: &mut B,
        model: &Model,
        noise: &Noise,
        measured: &[f64],
        observation: &mut Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let can_return = belief.store();
        belief.condition(model, observation, correction)?;
        if !can_return {
            return Ok(());
        }
        let Self { weights, reported } = self;
        for pass in 0..weights.passes() {
            let Some(update) = reported.innovations(correction.reported(), observation) else { break };
            if pass == 0 {
                weights.begin(&update, &noise.sensors, measured);
            }
            if !weights.weigh(&update, &noise.sensors, false) {
                break;
            }
            belief.restore();
            correction.clear(model.size(), noise.sensors.len());
            let [measured, variances] = weights.weighed();
            observation.take(observation.force(), measured, variances)?;
            if observation.is_empty() {
                break;
            }
            belief.condition(model, observation, correction)?;
        }
        // e² / S with the R of the settings is what the settings claim. A reading that counts next to nothing is no sample of it.
        let weights = weights.each();
        if observation.sensors().iter().any(|sensor| weights[*sensor] != 1.0) {
            correction.report_with(observation.sensors(), |sensor| {
                let (own, weight) = (noise.sensors[sensor], weights[sensor]);
                (weight >= Robust::LEFT_OUT).then(|| own - own / weight)
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, FilterKind, FilterSettings, Quantity, Run, Scenario};

    /// A filter of a measured record in which every tenth reading of the first sensor is off by 10 to 30 σ: the error of ωₙ at
    /// the end, its standard deviation, and the share of the readings in the second half that the filter left out. Before, the
    /// gate may take readings for outliers because its guess is wrong.
    fn end(seed: u64, kind: FilterKind, robust: Robust, has_outliers: bool) -> [f64; 3] {
        let mut scenario =
            Scenario { duration: 25.0, seed, filters: vec![FilterSettings::default()], ..Scenario::default() };
        let sensor_std = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
        let std = scenario.sensors[0].noise_std;
        scenario.filters[0] = FilterSettings { kind, robust, sensor_std, ..scenario.filters[0].clone() };
        let mut run = Run::new(&scenario).unwrap();
        run.finish();
        let far = |sensor: usize, k: usize| {
            let number = libm::sin((k * k) as f64 + seed as f64);
            let is_off = has_outliers && sensor == 0 && k % 10 == 7;
            if is_off { std * (20.0 * number + libm::copysign(10.0, number)) } else { 0.0 }
        };
        let record = run.record().clone().with_measured(|sensor, k, z| z + far(sensor, k));
        let mut run = Run::on_record(&scenario, record.into()).unwrap();
        run.finish();
        let estimates = &run.estimates()[0];
        assert_eq!(estimates.stop(), None);
        let last = estimates.len() - 1;
        let late = last / 2..=last;
        let count = late.clone().count() as f64;
        let left_out = late.filter(|&k| estimates.innovation(k)[0].is_nan()).count() as f64 / count;
        let truth = scenario.plant.parameter(Channel::NATURAL_FREQUENCY).unwrap().at(0.0);
        [estimates.mean(last)[2] - truth, estimates.std(last, 2), left_out]
    }

    #[test]
    fn a_tenth_of_outliers_misleads_the_plain_filter_and_no_robust_one() {
        for kind in [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF] {
            let rms = Robust::ALL.map(|robust| {
                let mut sum = 0.0;
                for seed in 1..=8 {
                    let [error, std, left_out] = end(seed, kind, robust, true);
                    let what = format!("{kind:?} {robust:?}, seed {seed}: {error} ± {std}, {left_out} left out");
                    assert!(!robust.is_on() || error.abs() < 4.0 * std, "{what}");
                    let expected = if robust.is_on() { 0.08..0.11 } else { 0.0..1e-9 };
                    assert!(expected.contains(&left_out), "{what}");
                    sum += error * error / 8.0;
                }
                sum.sqrt()
            });
            assert!(rms[1..].iter().all(|rms_of_robust| *rms_of_robust < 0.5 * rms[0]), "{kind:?}: {rms:?}");
        }
    }

    #[test]
    fn a_gate_leaves_clean_readings_in() {
        for seed in 1..=4 {
            let [error, std, left_out] = end(seed, FilterKind::EKF, Robust::GATE, false);
            assert!(error.abs() < 4.0 * std && left_out < 0.002, "{error} ± {std}, {left_out}");
        }
    }

    #[test]
    fn a_reading_that_counts_for_nothing_is_no_reason_to_stop() {
        for robust in Robust::ALL {
            for kind in [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF, FilterKind::IEKF] {
                let mut scenario =
                    Scenario { duration: 20.0, filters: vec![FilterSettings::default()], ..Scenario::default() };
                scenario.set_sensors(&[Quantity::DISPLACEMENT]);
                (scenario.filters[0].kind, scenario.filters[0].robust) = (kind, robust);
                let std = scenario.sensors[0].noise_std;
                let mut run = Run::new(&scenario).unwrap();
                run.finish();
                let record = run.record().clone();
                let far = |k: usize| if k > 1000 && k.is_multiple_of(50) { 30.0 * std } else { 0.0 };
                let record = record.with_measured(|_, k, z| z + far(k));
                let mut run = Run::on_record(&scenario, record.into()).unwrap();
                run.finish();
                let estimates = &run.estimates()[0];
                assert_eq!(estimates.stop(), None, "{kind:?} {robust:?}");
                let left_out = (1001..estimates.len()).filter(|&k| estimates.innovation(k)[0].is_nan()).count();
                let expected = if robust.is_on() { 18..24 } else { 0..1 };
                assert!(expected.contains(&left_out), "{kind:?} {robust:?}: {left_out}");
            }
        }
    }

    #[test]
    fn noise_that_is_learnt_from_readings_is_not_learnt_from_those_that_count_for_nothing() {
        for robust in Robust::ALL {
            let mut scenario =
                Scenario { duration: 20.0, filters: vec![FilterSettings::default()], ..Scenario::default() };
            scenario.filters[0].sensor_std = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
            (scenario.filters[0].adaptation.process_noise, scenario.filters[0].robust) = (true, robust);
            let std = scenario.sensors[0].noise_std;
            let mut run = Run::new(&scenario).unwrap();
            run.finish();
            let far = |k: usize| if k.is_multiple_of(50) { 12.0 * std } else { 0.0 };
            let record = run.record().clone().with_measured(|sensor, k, z| if sensor == 0 { z + far(k) } else { z });
            let mut run = Run::on_record(&scenario, record.into()).unwrap();
            run.finish();
            assert_eq!(run.estimates()[0].stop(), None, "{robust:?}");
        }
    }
}
