//! Invariants of every scenario file and of every sample of every run, for the tests and the fuzzer.

use std::sync::Arc;

use kalmanscope_core::scenario::Motion;
use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{
    Adaptation, Channel, Estimates, FilterKind, FilterSettings, Force, Hold, InputKind, Plant, PlantKind, Propagation,
    Quantity, Record, Run, Scenario, Sensor, Signal, Trouble, Values,
};

pub(crate) type Remedy = Result<(), String>;

fn require(holds: bool, what: impl FnOnce() -> String) -> Remedy {
    if holds { Ok(()) } else { Err(what()) }
}

/// Reads a scenario file: any text is a scenario or an error, and a scenario can be written and read again.
pub(crate) fn check_file(text: &str) -> Remedy {
    let scenario = match Scenario::from_toml(text) {
        Ok(scenario) => scenario,
        Err(error) => return require(!error.to_string().is_empty(), || "an error without words".to_owned()),
    };
    scenario.validate().map_err(|e| format!("read, but not valid: {e}"))?;
    let written = scenario.to_toml().map_err(|e| format!("cannot be written: {e}"))?;
    let again = Scenario::from_toml(&written).map_err(|e| format!("cannot be read again: {e}\n{written}"))?;
    require(again == scenario, || format!("reads back as another scenario:\n{written}"))
}

/// With `gap`, over its own record, in which that many of 256 measurements are missing. Returns the number of steps of all filters.
pub(crate) fn check_scenario(scenario: &Scenario, gap: u8) -> Result<usize, String> {
    let mut run = Run::new(scenario).map_err(|e| e.to_string())?;
    if gap > 0 {
        run.finish();
        if run.len() < 2 {
            return Ok(0);
        }
        let scattered =
            |sensor: usize, k: usize| ((k as u32 * 4 + sensor as u32).wrapping_mul(0x9e37_79b9) >> 24) as u8;
        let record = run.record().clone().without_truth().with_gaps(|sensor, k| scattered(sensor, k) < gap);
        run = Run::on_record(scenario, Arc::new(record)).map_err(|e| e.to_string())?;
    }
    let mut steps = 0;
    let mut stopped = vec![false; scenario.filters.len()];
    let mut wound_up = vec![Vec::new(); scenario.filters.len()];
    for k in 0.. {
        if !run.step() {
            break;
        }
        check_record(run.record(), k)?;
        for (i, (estimates, settings)) in run.estimates().iter().zip(&scenario.filters).enumerate() {
            let in_words = |what: String| format!("{} {} at {k}: {what}", settings.kind.name(), estimates.name());
            if !stopped[i] && estimates.len() == k + 1 {
                check_sample(estimates, settings, run.record(), k, &mut wound_up[i]).map_err(in_words)?;
                steps += 1;
                continue;
            }
            let stop = estimates.stop().ok_or_else(|| in_words("neither a sample nor a reason".to_owned()))?;
            let exact = stop.sample == estimates.len() && (stopped[i] || stop.sample == k);
            require(exact, || in_words(format!("{stop:?} after {} samples", estimates.len())))?;
            stopped[i] = true;
        }
    }
    let end = run.truth_stop().map_or(run.record().len(), |stop| stop.sample);
    require(run.len() == end && run.samples() == end, || format!("{} of {end} samples", run.len()))?;
    let complete = gap != 0 || run.truth_stop().is_some() || end == scenario.samples();
    require(complete, || format!("the record ends at {end} without a reason"))?;
    for (i, estimates) in run.estimates().iter().enumerate() {
        check_remarks(estimates, &wound_up[i]).map_err(|what| format!("{}: {what}", estimates.name()))?;
    }
    Ok(steps)
}

fn check_record(record: &Record, k: usize) -> Remedy {
    let truth = record.true_channels().into_iter().filter_map(|c| Some(record.truth(c)?[k]));
    require(record.force(k).is_finite() && truth.into_iter().all(f64::is_finite), || format!("the truth at {k}"))?;
    let measured = (0..record.sensors().len()).all(|s| !record.measured(s)[k].is_infinite());
    require(measured, || format!("the measurements at {k}"))
}

fn check_sample(
    estimates: &Estimates,
    settings: &FilterSettings,
    record: &Record,
    k: usize,
    wound_up: &mut Vec<(Channel, usize)>,
) -> Remedy {
    let (n, m) = (estimates.channels().len(), estimates.sensors().len());
    let (mean, cov) = (estimates.mean(k), estimates.cov(k));
    require(mean.iter().all(|x| x.is_finite()), || format!("mean {mean:?}"))?;
    for i in 0..n {
        let variance = cov[i * n + i];
        require(variance.is_finite() && variance >= 0.0, || format!("variance {variance:e} of {i}"))?;
        let channel = estimates.channels()[i];
        let noise = |(sensor, std): (&Quantity, &f64)| std / sensor.aspect().info().usual_noise;
        let noisier = estimates.sensors().iter().zip(&settings.sensor_std).map(noise).fold(f64::INFINITY, f64::min);
        let noisier = if channel.is_parameter() || noisier.is_infinite() { 1.0 } else { noisier.max(1.0) };
        if variance.sqrt() > 1.001e3 * settings.initial_std[channel].max(noisier * Values::INITIAL_STD[channel]) {
            wound_up.push((channel, k));
        }
        for j in 0..i {
            let (one, other) = (cov[i * n + j], cov[j * n + i]);
            require(one.is_finite() && one.to_bits() == other.to_bits(), || format!("cov {i} {j}: {one:e} {other:e}"))?;
            let correlation = one.abs() / (variance.sqrt() * cov[j * n + j].sqrt());
            let [low, high] = [estimates.channels()[j], estimates.channels()[i]];
            let remarked = || {
                let at_k = estimates.remarks().iter().filter(|r| r.sample <= k && k <= r.last);
                at_k.into_iter().any(|r| r.what == Trouble::Indefinite(low, high))
            };
            let holds = correlation <= 1.0 + 1e-6 || one.abs() < 1e-150 || remarked();
            require(holds, || {
                let [low, high] = [variance, cov[j * n + j]];
                format!("correlation {correlation:e} of {i} and {j}: {one:e} of {low:e} and {high:e}")
            })?;
        }
    }

    let innovation = estimates.innovation(k);
    let mut told = false;
    for i in 0..m {
        let known = settings.plant.as_ref().is_none_or(|plant| plant.quantities().any(|q| q == estimates.sensors()[i]));
        let delivers = k > 0 && known && !record.measured(i)[k].is_nan();
        told |= delivers;
        require(innovation[i].is_finite() == delivers, || format!("innovation {innovation:?}"))?;
        let gain = &estimates.gain(k)[i * n..(i + 1) * n];
        let gain_is = if delivers { gain.iter().all(|x| x.is_finite()) } else { gain.iter().all(|&x| x == 0.0) };
        require(gain_is, || format!("gain {gain:?} of sensor {i}"))?;
    }
    for i in 0..m {
        for j in 0..m {
            let s = estimates.innovation_cov(k)[i * m + j];
            let both = !innovation[i].is_nan() && !innovation[j].is_nan();
            require(s.is_finite() == both, || format!("S {s} of {i} and {j}"))?;
        }
    }
    let (nis, log_likelihood) = (estimates.nis()[k], estimates.log_likelihood(k));
    require(if told { nis.is_finite() && nis >= 0.0 } else { nis.is_nan() }, || format!("NIS {nis}"))?;
    let likely = if told { log_likelihood.is_finite() } else { log_likelihood.is_nan() };
    require(likely, || format!("log likelihood {log_likelihood}"))?;
    if settings.kind == FilterKind::PF {
        let effective = estimates.effective_samples()[k];
        let range = 0.999..=1.001 * settings.ensemble_size as f64;
        require(if told { range.contains(&effective) } else { effective.is_nan() }, || format!("{effective} samples"))?;
    } else {
        require(estimates.effective_samples().is_empty(), || "it has no particles".to_owned())?;
    }

    let first = estimates.mean(0);
    for (i, &channel) in estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
        let certain = settings.initial_std[channel] == 0.0 && settings.process_std[channel] == 0.0;
        if settings.kind == FilterKind::KF || (certain && settings.eta == 0.0) {
            // Bit by bit, except for the sign of zero.
            let stays = mean[i] == first[i] && estimates.std(k, i) == 0.0;
            require(stays, || format!("{} is known, but {} ± {}", channel.key(), mean[i], estimates.std(k, i)))?;
        }
    }
    Ok(())
}

fn check_remarks(estimates: &Estimates, wound_up: &[(Channel, usize)]) -> Remedy {
    for remark in estimates.remarks() {
        let range = remark.sample <= remark.last && remark.last < estimates.len();
        require(range && !remark.what.to_string().is_empty(), || format!("{remark:?}"))?;
    }
    for &(channel, k) in wound_up {
        let covers = |r: &&kalmanscope_core::Remark| r.what == Trouble::WindUp(channel) && r.sample <= k && k <= r.last;
        require(estimates.remarks().iter().any(|r| covers(&r)), || format!("{} winds up at {k}", channel.key()))?;
    }
    Ok(())
}

/// A valid scenario from any bytes, and how many measurements in 256 it lacks. Zeros and the end choose plain settings.
pub(crate) fn scenario_of(bytes: &[u8]) -> (Scenario, u8) {
    let mut dice = Dice(bytes.iter());
    let steps = 1 + usize::from(dice.byte()) * 2;
    let dt = dice.pick(&[0.01, 0.01, 0.02, 1e-3, 1e-4, 0.1, 0.3, 1.0]);
    let gap = if dice.one_in(4) { dice.byte() } else { 0 };
    let kind = dice.pick(&PlantKind::ALL[..6]);
    let mut scenario = Scenario {
        seed: u64::from(dice.byte()),
        dt,
        duration: steps as f64 * dt,
        plant: dice.plant(&kind),
        force: dice.force(),
        sensors: dice.sensors(&kind),
        filters: Vec::new(),
        ..Scenario::default()
    };
    let filters = 1 + dice.byte() % 6;
    scenario.filters = (0..filters).map(|_| dice.filter(&scenario)).collect();
    if dice.one_in(6) {
        scenario.hold = Hold::First;
    }
    if dice.one_in(6) {
        scenario.input = InputKind::GroundAcceleration;
    }
    (scenario, gap)
}

struct Dice<'a>(std::slice::Iter<'a, u8>);

impl Dice<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    fn one_in(&mut self, n: u8) -> bool {
        self.byte() % n == n - 1
    }

    fn pick<T: Clone>(&mut self, of: &[T]) -> T {
        of[usize::from(self.byte()) % of.len()].clone()
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(u16::from_be_bytes([self.byte(), self.byte()])) / f64::from(u16::MAX)
    }

    /// A number that is not negative: of the usual size, powers of ten off it, zero, or of any size.
    fn size(&mut self, usual: f64) -> f64 {
        match self.byte() % 16 {
            0..=7 => usual * self.between(1.0, 3.0),
            8..=10 => usual * 10_f64.powf(self.between(-4.0, 4.0)),
            11..=13 => 0.0,
            14 => 10_f64.powf(self.between(-20.0, 20.0)),
            _ => 10_f64.powf(self.between(-300.0, 300.0)),
        }
    }

    fn value(&mut self, usual: f64) -> f64 {
        let size = self.size(usual);
        if self.one_in(4) { -size } else { size }
    }

    fn signal(&mut self, usual: f64) -> Signal {
        let positive = |x: f64| if x > 0.0 { x } else { usual };
        let (from, to) = (positive(self.size(usual)), positive(self.size(usual)));
        let at = self.between(0.0, 5.0);
        match self.byte() % 8 {
            0..=4 => Signal::Constant(from),
            5 => Signal::Step(Step { from, to, at }),
            6 => Signal::Ramp(Ramp { from, to, start: at, end: at + self.between(0.0, 5.0) }),
            _ => Signal::Sine(Sine { mean: from, amplitude: self.between(0.0, 0.9) * from, period: 0.1 + at }),
        }
    }

    fn plant(&mut self, kind: &PlantKind) -> Plant {
        let mut plant = Plant::default().with(Channel::NATURAL_FREQUENCY, 6.0);
        plant.kind = kind.clone();
        for channel in kind.parameters() {
            let usual = plant.parameter(channel).map_or(1.0, |signal| signal.at(0.0));
            let mut signal = self.signal(usual);
            if !channel.is_positive() && self.one_in(3) {
                signal = Signal::Constant(-signal.at(0.0));
            }
            if let Some(parameter) = plant.parameter_mut(channel) {
                *parameter = signal;
            }
        }
        plant.initial = Motion { displacement: self.value(0.1), velocity: self.value(0.5) };
        plant.disturbance_std = if self.one_in(2) { self.size(1.0) } else { 0.0 };
        plant
    }

    fn force(&mut self) -> Force {
        let amplitude = self.value(10.0);
        match self.byte() % 8 {
            0..=2 => Force::WhiteNoise { std: amplitude.abs() },
            3 => Force::None,
            4 => Force::Sine { amplitude, frequency: self.value(6.0) },
            5 => Force::Chirp { amplitude, from: self.value(1.0), to: self.value(20.0), sweep: self.between(0.1, 9.0) },
            6 => Force::ImpulseTrain { impulse: amplitude, period: self.between(0.1, 3.0) },
            _ => Force::Step { amplitude, at: self.between(0.0, 3.0) },
        }
    }

    fn sensors(&mut self, kind: &PlantKind) -> Vec<Sensor> {
        let quantities: Vec<Quantity> = kind.quantities().collect();
        let mut sensors: Vec<Sensor> = Vec::new();
        for _ in 0..self.pick(&[2, 1, 3, 4, 0]) {
            let measures = self.pick(&quantities);
            let noise_std = self.size(0.01);
            if sensors.iter().all(|s| s.measures != measures) {
                sensors.push(Sensor::new(measures, noise_std));
            }
        }
        sensors
    }

    fn filter(&mut self, scenario: &Scenario) -> FilterSettings {
        use Propagation::{Euler, LocalLinearisation, RungeKutta};
        let usual = FilterSettings::default();
        let kind = self.pick(&FilterKind::ALL);
        let plant = self.one_in(6).then(|| self.pick(&PlantKind::ALL[..6]));
        let mut filter = FilterSettings {
            name: kind.name().to_owned(),
            kind,
            plant,
            log_parameters: self.one_in(4),
            propagation: self.pick(&[None, Some(LocalLinearisation), Some(RungeKutta), Some(Euler)]),
            iterations: 1 + usize::from(self.byte() % 6),
            ensemble_size: 2 + usize::from(self.byte() % 20),
            adaptation: Adaptation {
                sensor_noise: self.one_in(4),
                process_noise: self.one_in(4),
                forgetting: self.pick(&[0.995, 0.9, 0.5, 1e-9, 1.0 - 1e-9]),
                training: self.pick(&[0.0, 0.0, 0.1, 1e-9, 1e300]),
            },
            fading: self.pick(&[1.0, 1.0, 1.0, 1.005, 1.02, 1.1, 3.0]),
            eta: if self.one_in(4) { self.size(0.1) } else { 0.0 },
            sensor_std: scenario.sensors.iter().map(|s| s.noise_std.max(1e-9)).collect(),
            ..usual.clone()
        };
        for std in &mut filter.sensor_std {
            if self.one_in(3) {
                *std = Some(self.size(0.01)).filter(|&s| s > 0.0).unwrap_or(1e-200);
            }
        }
        for &channel in filter.plant.clone().unwrap_or(scenario.plant.kind.clone()).channels() {
            let mean = usual.initial_mean[channel];
            filter.initial_mean[channel] = if self.one_in(2) { self.value(mean.max(0.01)) } else { mean };
            if filter.log_parameters && channel.is_positive() {
                filter.initial_mean[channel] = Some(filter.initial_mean[channel]).filter(|&x| x > 0.0).unwrap_or(mean);
            }
            filter.initial_std[channel] = self.size(usual.initial_std[channel]);
            filter.process_std[channel] = self.size(usual.process_std[channel]);
        }
        filter
    }
}
