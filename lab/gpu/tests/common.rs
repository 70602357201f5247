//! The adapter of the tests, and its outcomes beside those of the core.
#![expect(clippy::panic, reason = "without an adapter there is no test, and that is a failure")]

use std::sync::LazyLock;

use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, FilterSettings, Hold, PlantKind, Quantity, Scenario, Signal};
use kalmanscope_gpu::{Gpu, Software};

static GPU: LazyLock<Gpu> = LazyLock::new(|| match pollster::block_on(Gpu::find(Software::Allowed)) {
    Ok(gpu) => gpu,
    Err(error) => panic!("these tests need a Vulkan driver, such as Mesa's lavapipe: {error}"),
});

pub(crate) fn gpu() -> &'static Gpu {
    &GPU
}

/// Limits the relative difference of scores where both filters have converged.
pub(crate) const CLOSE: f64 = 0.02;

#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) runs: usize,
    pub(crate) same: usize,
    pub(crate) kept: usize,
    pub(crate) close: usize,
    pub(crate) lost: usize,
    pub(crate) worst: (f64, String),
}

impl Tally {
    pub(crate) fn take<C: PartialEq>(
        &mut self,
        [outcome, exact]: [&Outcome; 2],
        class: impl Fn(&Outcome) -> C,
        is_kept: impl Fn(C) -> bool,
    ) {
        self.runs += 1;
        self.lost += usize::from(exact.diverged);
        if class(outcome) != class(exact) {
            return;
        }
        self.same += 1;
        if is_kept(class(exact)) {
            self.compare(outcome, exact);
        }
    }

    pub(crate) fn same_share(&self) -> f64 {
        self.same as f64 / self.runs as f64
    }

    pub(crate) fn close_share(&self) -> f64 {
        self.close as f64 / self.kept as f64
    }

    pub(crate) fn keep(&mut self, numbers: impl IntoIterator<Item = (String, f64, f64, f64)>) {
        let mut largest = 0.0_f64;
        for (name, number, exact, size) in numbers {
            let difference = if number == exact { 0.0 } else { (number - exact).abs() / size };
            largest = if difference <= largest { largest } else { difference };
            if largest > self.worst.0 {
                self.worst = (largest, format!("{name} is {number} in place of {exact}"));
            }
        }
        self.kept += 1;
        self.close += usize::from(largest <= CLOSE);
    }

    fn compare(&mut self, outcome: &Outcome, exact: &Outcome) {
        assert_eq!(outcome.samples, exact.samples);
        assert_eq!((outcome.nis.degrees, outcome.nis.samples), (exact.nis.degrees, exact.nis.samples));
        let keys = |outcome: &Outcome| outcome.channels.iter().map(|(channel, _)| *channel).collect::<Vec<_>>();
        assert_eq!(keys(outcome), keys(exact));
        let [nis, nees] = [exact.nis.per_degree(), exact.nees.per_degree()];
        let size = exact.log_likelihood.abs().max(f64::from(exact.nis.degrees));
        let mut pairs = vec![
            ("NIS".to_owned(), outcome.nis.per_degree(), nis, nis),
            ("NEES".to_owned(), outcome.nees.per_degree(), nees, nees),
            ("likelihood".to_owned(), outcome.log_likelihood, exact.log_likelihood, size),
        ];
        for i in 0..exact.mean.len() {
            pairs.push((format!("std of {i}"), outcome.std[i], exact.std[i], exact.std[i]));
            // A tenth of the standard deviation is close.
            let room = exact.std[i].max(1e-6 * exact.mean[i].abs());
            pairs.push((format!("mean of {i}"), outcome.mean[i], exact.mean[i], 0.1 / CLOSE * room));
        }
        for ((channel, score), (_, other)) in outcome.channels.iter().zip(&exact.channels) {
            // A parameter that a filter rightly knows for certain has the error of single precision alone.
            pairs.push((format!("RMSE of {}", channel.key()), score.rmse, other.rmse, other.rmse.max(1e-5)));
        }
        pairs.retain(|(_, number, exact, _)| !(number.is_nan() && exact.is_nan()));
        self.keep(pairs);
    }
}

pub(crate) fn built_in(plant: PlantKind, quantities: &[Quantity], augment: &[Channel], hold: Hold) -> Scenario {
    let filters = vec![FilterSettings::default()];
    let mut scenario = Scenario { filters, hold, duration: 10.0, ..Scenario::default() };
    scenario.filters[0].augment = augment.to_vec();
    scenario.set_plant(plant);
    scenario.set_sensors(quantities);
    // A white force is noise of the truth, and no parameter of it.
    for &channel in augment.iter().filter(|channel| **channel != Channel::WHITE_FORCE) {
        scenario.plant.set(channel, Signal::Constant(channel.usual().mean + 0.2 * channel.usual().std));
    }
    scenario
}
