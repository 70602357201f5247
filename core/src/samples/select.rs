//! The choice between a tuned kernel, the engine and the book. Smoothers have no kernel: one pass over a record is enough.

use crate::FilterSettings;
use crate::samples::estimator::bounded::{Bounded, Truncation};
use crate::samples::estimator::{Estimator, Failed, FilterContext, book, kernel, walk};
#[cfg(not(target_arch = "wasm32"))]
use crate::samples::estimator::{engine, setup::Setup};
use crate::samples::guesses::{Guesses, members};
use crate::samples::scales::Scales;
use crate::samples::smoother::Smoother;
use crate::samples::smoother::forward::Forward;
use crate::samples::smoother::interval::FixedInterval;
use crate::samples::smoother::lag::FixedLag;
use crate::scenario::Bounds;

/// Builds the filter of some settings, or those of its guesses side by side.
pub(crate) fn estimator(settings: &FilterSettings, context: FilterContext<'_>) -> Box<dyn Estimator> {
    if !settings.bounds.is_empty() {
        let truncation = Truncation::of(settings, context.model(settings).channels());
        let free = FilterSettings { bounds: Bounds::default(), ..settings.clone() };
        return Box::new(Bounded::new(estimator(&free, context), truncation));
    }
    if settings.process_scales > 1 {
        let bank = Scales::new(settings, &context, |member| single(member, context));
        return bank.map_or_else(|error| Box::new(Failed(error)) as Box<dyn Estimator>, |bank| Box::new(bank));
    }
    if settings.guesses > 1 {
        return Box::new(Guesses::new(members(settings).iter().map(|member| single(member, context))));
    }
    single(settings, context)
}

/// Builds the filter of one guess: a bank where its parameters may walk; else a tuned kernel if there is one, else the engine's,
/// else the reference filter.
fn single(settings: &FilterSettings, context: FilterContext<'_>) -> Box<dyn Estimator> {
    if context.is_timed {
        // The weights of the readings of one sensor within a step are the book's, and so are plucks.
        let engine =
            if settings.robust.is_on() || !settings.plucks.is_empty() { None } else { of_engine(settings, &context) };
        return engine.unwrap_or_else(|| book::estimator(settings, &context));
    }
    if settings.walk > 0.0 {
        return walk::estimator(settings, &context);
    }
    if !settings.plucks.is_empty() {
        return book::estimator(settings, &context);
    }
    kernel::estimator(settings, context)
        .or_else(|| of_engine(settings, &context))
        .unwrap_or_else(|| book::estimator(settings, &context))
}

/// A page has the book's way to the engine only, to be smaller: the bits are the same.
#[cfg(target_arch = "wasm32")]
fn of_engine(_: &FilterSettings, _: &FilterContext<'_>) -> Option<Box<dyn Estimator>> {
    None
}

/// The engine's filter, if it has all that the settings ask for.
#[cfg(not(target_arch = "wasm32"))]
fn of_engine(settings: &FilterSettings, context: &FilterContext<'_>) -> Option<Box<dyn Estimator>> {
    let sensors = context.sensors.len();
    let setup = Setup::of(settings, context, (0..sensors).collect())?;
    Some(engine::estimator(&setup, sensors))
}

/// The smoother that the settings of a filter ask for, if its kind has one.
pub(crate) fn smoother(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Box<dyn Smoother>> {
    let Some(lag) = settings.lag(context.dt) else { return whole_smoother(settings, context) };
    Some(Box::new(FixedLag::new(forward(settings, context)?, lag)))
}

/// The smoother of a filter over the whole record, if its kind has one.
pub(crate) fn whole_smoother(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Box<dyn Smoother>> {
    Some(Box::new(FixedInterval::new(forward(settings, context)?)))
}

fn forward(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Forward> {
    (!settings.kind.is_sampled()).then(|| Forward::new(settings, &context)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::sink::{Sample, Sink};
    use crate::{Channel, FilterKind, Hold, PlantKind, Propagation, Quantity, Robust, Run, Scenario, Stop};

    /// All numbers of all samples.
    #[derive(Default)]
    struct Bits(Vec<u64>);

    impl Sink for Bits {
        fn push(&mut self, sample: &Sample<'_>) {
            let Sample { mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, nis, determinant, .. } =
                *sample;
            let numbers = [nis, determinant, f64::from(u8::from(sample.has_widened))];
            let [q, r, of_r] =
                sample.noise.map(|noise| [noise.process, noise.sensors, noise.uncertainty]).unwrap_or_default();
            let learnt = [q, r, of_r, sample.weights].concat();
            let parts = [mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, &numbers, &learnt];
            self.0.extend(parts.concat().iter().map(|x| if x.is_nan() { u64::MAX } else { (x + 0.0).to_bits() }));
        }

        fn stop_at(&mut self, _: Stop) {}

        fn wants_prior(&self) -> bool {
            true
        }
    }

    fn bits(estimator: &mut dyn Estimator, run: &Run, sensors: &[Quantity]) -> Result<Bits, crate::FilterError> {
        let (mut bits, record) = (Bits::default(), run.record());
        // A measured input often has the same number twice.
        let force = |k: usize| record.force(k - k % 3);
        estimator.begin(&mut bits)?;
        for k in 1..record.len() {
            let mut measured = record.sample(k, sensors, &crate::record::Delays::default());
            if k % 7 == 0 {
                measured[k % 2] = f64::NAN;
            }
            if k % 11 == 5 {
                measured[k % 2] += 0.5;
            }
            estimator.step(force(k - 1), force(k), &measured, &mut bits)?;
        }
        Ok(bits)
    }

    /// The engine's estimator and the reference filter with the engine's beliefs give the same bits. A web page has
    /// only the reference filter.
    #[test]
    fn both_ways_to_the_engine_give_the_same_bits() -> Result<(), Box<dyn std::error::Error>> {
        let augmentations: [&[Channel]; 4] =
            [&[], &[Channel::INPUT_GAIN, Channel::INPUT_OFFSET], &[Channel::WHITE_FORCE], &[Channel::UNKNOWN_FORCE]];
        let mut compared = 0;
        for plant in [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::BOUC_WEN, PlantKind::SHEAR_2] {
            for (nth, augment) in augmentations.into_iter().enumerate() {
                for kind in [FilterKind::KF, FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF] {
                    let mut scenario = Scenario { duration: 1.0, hold: Hold::First, ..Scenario::default() };
                    scenario.plant.kind = plant;
                    scenario.sensors.truncate(1);
                    scenario.sensors.push(crate::Sensor::new(Quantity::ACCELERATION, 0.1));
                    let filter = &mut scenario.filters[0];
                    (filter.kind, filter.augment, filter.fading) = (kind, augment.to_vec(), 1.002);
                    (filter.substeps, filter.eta) = ([1, 1, 2, 3][nth], [0.0, 0.02, 0.0, 0.0][nth]);
                    filter.log_parameters = nth % 2 == 1;
                    filter.propagation = Some(Propagation::ALL[nth % 3]);
                    let learns = kind != FilterKind::SR_UKF;
                    filter.robust = if learns { Robust::ALL[(nth + compared) % 5] } else { Robust::NONE };
                    filter.adaptation.process_noise = learns && compared % 3 == 1;
                    filter.adaptation.sensor_noise = learns && compared % 2 == 1 && !filter.robust.is_on();
                    filter.adaptation.training = [0.0, 0.4][compared / 2 % 2];
                    filter.jump = learns && compared % 4 == 2 && kind != FilterKind::KF;
                    let sensors = [Quantity::DISPLACEMENT, Quantity::ACCELERATION];
                    let mut run = Run::new(&Scenario { filters: vec![], ..scenario.clone() })?;
                    run.finish();
                    let settings = &scenario.filters[0];
                    let context = FilterContext::new(&scenario, &sensors, run.record().dt(), settings);
                    let Some(mut engine) = of_engine(settings, &context) else { continue };
                    let mut book = book::estimator(settings, &context);
                    let [engine, book] = [&mut engine, &mut book].map(|one| bits(&mut **one, &run, &sensors));
                    match (engine, book) {
                        (Ok(engine), Ok(book)) => assert_eq!(engine.0, book.0, "{plant:?} {kind:?} {augment:?}"),
                        (engine, book) => assert_eq!(engine.err(), book.err(), "{plant:?} {kind:?} {augment:?}"),
                    }
                    compared += 1;
                }
            }
        }
        assert!(compared > 65, "{compared}");
        Ok(())
    }
}
