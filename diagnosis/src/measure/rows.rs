//! The table of measures: a row each, with its formulas.

use kalmanscope_core::diagnostics::{ErrorSums, Total};
use kalmanscope_core::free_run::one_step;
use kalmanscope_core::internals::mapped;
use kalmanscope_core::score::LOST;
use kalmanscope_core::{Evidence, FilterSettings, Identified, InputKind, ModelClasses, PlantKind, Task};

use serde::{Deserialize, Serialize};

use super::info::MeasureSubject::{Channel, Filter, Gain, Sensor};
use super::info::ValueKind::{
    Cause, Distance, Error, Flag, LogLikelihood, Ratio, Share, Signed, Size, Time, Verdict, Words,
};
use super::info::{Best, MeasureInfo, row};
use super::observed::{Observed, Part};
use super::{FirstCause, Value, observed};
use crate::Diagnosis;

const PURE: Option<&str> = Some("");

const EXPECTED_INSIDE: f64 = 0.954;

/// The functions from all estimates stand apart, so that a program that has sums alone does not contain them.
macro_rules! measures {
    ($($name:ident = $row:expr => $within:expr;)*) => {
        /// A measure without the channel or the sensor that it is of. In text it is a word.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(try_from = "String", into = "String")]
        pub enum MeasureKind { $(#[doc(hidden)] $name),* }
        pub(super) static ROWS: [MeasureKind; [$(stringify!($name)),*].len()] = [$(MeasureKind::$name),*];
        static INFOS: [MeasureInfo; ROWS.len()] = [$($row),*];
        static WITHIN: [fn(&Part<'_>) -> Value; ROWS.len()] = [$($within),*];
    };
}

impl MeasureKind {
    /// Its description.
    pub fn info(self) -> &'static MeasureInfo {
        &INFOS[self as usize]
    }

    pub(super) fn within(self, part: &Part<'_>) -> Value {
        WITHIN[self as usize](part)
    }
}

measures! {
    Nis = row("nis", "mean NIS, 1 expected", Ratio, Filter)
        .best(Best::One)
        .with_sums(|sums| sums.whole.outcome.nis.per_degree())
        => |part| number(nis(part).per_degree());

    Nees = row("nees", "mean NEES, 1 expected", Ratio, Filter)
        .best(Best::One)
        .with_truth()
        .with_sums(|sums| sums.whole.outcome.nees.per_degree())
        => |part| number(part.run.diagnostics().nees_within(part.range()).per_degree());

    Consistency = row("consistency", "mean NIS, distance in σ", Distance, Filter)
        .best(Best::Zero)
        .with_sums(|sums| distance(sums.whole.outcome.nis))
        => |part| number(distance(nis(part)));

    LogLikelihood = row("log_likelihood", "log likelihood", LogLikelihood, Filter)
        .best(Best::Largest)
        .with_sums(|sums| sums.whole.outcome.log_likelihood)
        => |part| number(log_likelihood(part).0);

    LogLikelihoodPerSample =
        row("log_likelihood_per_sample", "log likelihood per measured sample", LogLikelihood, Filter)
        .best(Best::Largest)
        .special()
        => |part| {
            let (sum, samples) = log_likelihood(part);
            number(sum / f64::from(samples))
        };

    Diverged = row("diverged", "lost the truth", Flag, Filter)
        .with_sums(|sums| Value::Flag(sums.whole.outcome.diverged).number())
        => |part| {
            let diagnostics = part.run.diagnostics();
            Value::Flag(diagnostics.stop.is_some() || !diagnostics.lost(part.run.estimates, LOST).is_empty())
        };

    Stopped = row("stopped", "stopped", Flag, Filter)
        .with_sums(|sums| Value::Flag(sums.whole.outcome.stop.is_some()).number())
        => |part| Value::Flag(part.run.estimates.stop().is_some());

    Verdict = row("verdict", "verdict", Verdict, Filter)
        => |part| {
            let diagnosis = Diagnosis::new(part.run.diagnostics(), part.run.estimates, part.run.record);
            Value::Verdict(diagnosis.and_then(|diagnosis| diagnosis.verdict).map(|verdict| verdict.kind))
        };

    Cause = row("cause", "first cause of a bad verdict", Cause, Filter).special()
        => |part| {
            let Observed { scenario, place, record, estimates, .. } = *part.run;
            Value::Cause(FirstCause::new(scenario, place, estimates, record).run())
        };

    Remark = row("remark", "remarks", Words, Filter).special()
        => |part| {
            let mut keys: Vec<_> = mapped(part.run.estimates.remarks(), &|remark| remark.what.key());
            keys.dedup();
            Value::Words(keys)
        };

    Autocorrelation = row("autocorrelation", "largest autocorrelation of innovations", Signed, Filter).best(Best::Zero)
        => |part| {
            let first = part.run.diagnostics().whiteness.iter().map(|whiteness| whiteness.autocorrelation()[0]);
            number(first.max_by(f64::total_cmp))
        };

    Probability = MeasureInfo {
            needs_others: true,
            ..row("probability", "probability among the filters", Share, Filter).best(Best::Largest).special()
        }
        => |part| number(probability(part));

    Evaluations = row("evaluations", "evaluations of the rate per step", Size, Filter).special()
        => |part| number(evaluations(part.run.settings(), &part.run.scenario.plant.kind));

    Error = row("error", "last error of @", Error, Channel(None))
        .best(Best::Zero)
        .with_truth()
        .with_sums(|sums| sums.score(|score| score.error))
        => |part| {
            let errors = part.sample().and_then(|k| part.errors(k..k + 1));
            number(errors.map(|errors| errors[0][0]))
        };

    Rmse = row("rmse", "RMS error of @", Size, Channel(None))
        .best(Best::Smallest)
        .with_truth()
        .with_sums(|sums| sums.score(|score| score.rmse))
        => |part| number(part.tally().map(ErrorSums::rmse));

    MeanError = row("mean_error", "size of the mean error of @", Size, Channel(None))
        .best(Best::Smallest)
        .with_truth()
        .special()
        => |part| number(part.errors(part.range()).map(|errors| mean(errors.iter().map(|[error, _]| *error)).abs()));

    ErrorInStd = row("error_in_std", "RMS error of @ in σ", Ratio, Channel(PURE)).best(Best::One).with_truth()
        => |part| {
            let range = if part.times.at.is_some() { part.sample().map(|k| k..k + 1) } else { Some(part.range()) };
            let square = |[error, std]: &[f64; 2]| error * error / (std * std);
            number(range.and_then(|range| part.errors(range)).map(|errors| mean(errors.iter().map(square)).sqrt()))
        };

    RmseOverSensor = row("rmse_over_sensor", "RMS error of @ over its sensor's noise", Size, Channel(PURE))
        .best(Best::Smallest)
        .with_truth()
        .special()
        => |part| number(part.tally().zip(part.sensor_noise_of_channel()).map(|(tally, noise)| tally.rmse() / noise));

    Estimate = row("estimate", "last estimate of @", Signed, Channel(None)).with_sums(observed::estimate)
        => |part| number(part.sample().zip(part.place()).map(|(k, place)| part.run.estimates.canonical_mean(k, place)));

    RawEstimate = row("raw_estimate", "last estimate of @, mirrored or not", Signed, Channel(None)).special()
        => |part| number(part.sample().zip(part.place()).map(|(k, place)| part.run.estimates.mean(k)[place]));

    Std = row("std", "last σ of @", Size, Channel(None)).with_sums(observed::std)
        => |part| number(part.sample().zip(part.place()).map(|(k, place)| part.run.estimates.std(k, place)));

    StdOverBound = row("std_over_bound", "last σ of @ over its bound", Ratio, Channel(PURE)).with_truth()
        => |part| {
            let of = |(k, place)| Some(part.run.estimates.std(k, place) / part.bound(k)?);
            number(part.sample().zip(part.place()).and_then(of))
        };

    Settled = row("settled", "settling time of @", Time, Channel(Some("s")))
        .best(Best::Smallest)
        .with_truth()
        .with_sums(|sums| {
                let whole = sums.whole;
                let time = |settled: Option<usize>| settled.filter(|_| whole.outcome.stop.is_none());
                sums.score(|score| time(score.settled).map_or(f64::INFINITY, |k| whole.record.time_of(k)))
            })
        => |part| {
            let settled = part.settled().map_or(f64::INFINITY, |k| part.run.record.time_of(k));
            number((settled - part.times.from.unwrap_or(0.0)).max(0.0))
        };

    Coverage = row("coverage", "share of @ inside ±2σ", Share, Channel(PURE))
        .best(Best::At(EXPECTED_INSIDE))
        .with_truth()
        .with_sums(|sums| sums.score(|score| score.coverage))
        => |part| number(part.tally().map(ErrorSums::coverage));

    Gain = row("gain", "mean size of the gain of @", Size, Gain).special()
        => |part| number(gain(part));

    FreeRun = row("free_run", "free-run error of @", Size, Sensor(None)).best(Best::Smallest)
        => |part| {
            let run = part.run;
            let model = part.sample().map(|k| Identified::at(run.scenario, run.settings(), run.estimates, k));
            let fit = model.zip(part.sensor).and_then(|(model, sensor)| {
                model.run(run.record, part.range_of_record()).fit(run.record, sensor)
            });
            number(fit.map(|fit| fit.rms))
        };

    OneStep = row("one_step", "one-step error of @", Size, Sensor(None)).best(Best::Smallest)
        => |part| {
            let record = part.run.record;
            let sensor = part.sensor.and_then(|sensor| sensor.place_in(record.sensors()));
            let fit = sensor.and_then(|sensor| one_step(part.run.estimates, record, sensor, part.range_of_record()));
            number(fit.map(|fit| fit.rms))
        };

    LearntNoise = row("learnt_noise", "learnt σ of @ over the true one", Ratio, Sensor(PURE))
        .best(Best::One)
        .with_truth()
        .special()
        => |part| {
            let learnt = part.sample().and_then(|k| part.learnt_noise(k));
            number(learnt.zip(part.true_noise()).map(|([std, _], truth)| std / truth))
        };

    LearntNoiseStd = row("learnt_noise_std", "uncertainty of the learnt σ of @, as a share of it", Size, Sensor(PURE))
        .special()
        => |part| number(part.sample().and_then(|k| part.learnt_noise(k)).map(|[std, spread]| spread / std));

    LearntNoiseCoverage =
        row("learnt_noise_coverage", "share of the true σ of @ inside ±2σ of the learnt one", Share, Sensor(PURE))
        .best(Best::At(EXPECTED_INSIDE))
        .with_truth()
        .special()
        => |part| number(part.true_noise().and_then(|truth| {
            coverage_of(part, |k| part.learnt_noise(k).map(|[std, spread]| (std - truth).abs() <= 2.0 * spread))
        }));

    ProcessScale = row("process_scale", "learnt √Q over the true one", Ratio, Filter)
        .best(Best::One)
        .with_truth()
        .special()
        => |part| number(part.sample().and_then(|k| part.process_scale(k)).map(|[mean, _]| libm::exp(mean)));

    ProcessScaleStd = row("process_scale_std", "uncertainty of the learnt √Q, as a share of it", Size, Filter).special()
        => |part| number(part.sample().and_then(|k| part.run.estimates.process_scale(k)).map(|[_, std]| std));

    ProcessScaleCoverage =
        row("process_scale_coverage", "share of the true √Q inside ±2σ of the learnt one", Share, Filter)
        .best(Best::At(EXPECTED_INSIDE))
        .with_truth()
        .special()
        => |part| number(coverage_of(part, |k| part.process_scale(k).map(|[mean, std]| mean.abs() <= 2.0 * std)));
}

fn number(number: impl Into<Option<f64>>) -> Value {
    Value::Number(number.into().unwrap_or(f64::NAN))
}

fn mean(numbers: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = numbers.len() as f64;
    numbers.sum::<f64>() / count
}

fn nis(part: &Part<'_>) -> Total {
    part.run.diagnostics().nis_within(part.range())
}

/// d squares have the mean d and the variance 2 d. Source: Bar-Shalom, Li and Kirubarajan (2001), section 5.4.
fn distance(nis: Total) -> f64 {
    let degrees = f64::from(nis.degrees);
    (nis.sum - degrees) / libm::sqrt(2.0 * degrees)
}

fn log_likelihood(part: &Part<'_>) -> (f64, u32) {
    let values = part.range().map(|k| part.run.estimates.log_likelihood(k)).filter(|value| !value.is_nan());
    values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1))
}

fn probability(part: &Part<'_>) -> Option<f64> {
    let k = part.sample()?;
    let evidence = part.run.all.iter().map(|of| Evidence::new(of).at(k).unwrap_or(f64::NEG_INFINITY));
    ModelClasses::new(evidence).probabilities.get(part.run.place).copied()
}

fn evaluations(settings: &FilterSettings, truth: &PlantKind) -> f64 {
    (settings.kind.info().evaluations)(&settings.method(truth), settings.model(truth, InputKind::Force).size()) as f64
}

fn gain(part: &Part<'_>) -> Option<f64> {
    let estimates = part.run.estimates;
    let entry = part.place_of_sensor()? * estimates.channels().len() + part.place()?;
    Some(mean(part.range().map(|k| estimates.gain(k)[entry].abs())))
}

fn coverage_of(part: &Part<'_>, is_inside: impl Fn(usize) -> Option<bool>) -> Option<f64> {
    let all: Vec<bool> = part.range().map(is_inside).collect::<Option<_>>()?;
    Some(mean(all.iter().map(|inside| f64::from(u8::from(*inside)))))
}
