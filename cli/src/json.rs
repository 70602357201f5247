//! The results of a run as one document of JSON.

use kalmanscope_core::document::{self, Document, DocumentError, json};
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Estimates, Fit, Record};
use kalmanscope_diagnosis::Summary;
use kalmanscope_diagnosis::{Evidence, Final, Remedy};

use crate::free_run::FreeFit;
use crate::in_words::{are_models, sentence};
use crate::results::{FilterResults, Results};

impl Results<'_> {
    /// The results as JSON, in SI units; `null` where there is none. `docs/command-line.md` describes each key. `series` are the
    /// estimates of all filters in order, for the numbers of each sample; without them each `series` is `null`.
    ///
    /// # Errors
    /// [`DocumentError`] where a number cannot be written, which no run causes.
    pub fn json(&self, series: &[Estimates]) -> Result<String, DocumentError> {
        let record = &*self.record;
        let probabilities = self.probabilities();
        let filters = self.filters.iter().enumerate().map(|(place, one)| {
            let own = (probabilities.get(place).copied(), series.get(place).map(filter_series));
            self.filter(&one.summary, Some(one), own)
        });
        let smoothers = self.smoothers.iter().map(|summary| self.filter(summary, None, (None, None)));
        let free_runs = self.free_runs.iter().flat_map(|runs| runs.fits.iter().map(|fit| free_run(&runs.name, fit)));
        let all = json!({
            "kalmanscope": env!("CARGO_PKG_VERSION"),
            "scenario": self.scenario,
            "record": {
                "samples": record.len(),
                "start": record.time(0),
                "dt": record.dt(),
                "input_kind": record.input_kind(),
                "hold": record.hold(),
                "measured": Document::from_iter(record.sensors().iter().map(|sensor| sensor.key())),
                "series": (!series.is_empty()).then(|| record_series(record)),
            },
            "filters": Document::from_iter(filters.chain(smoothers)),
            "free_runs": Document::from_iter(free_runs),
        });
        // With series, lines for each element would give every number of every sample its own.
        if series.is_empty() { document::to_json_lines(&all) } else { document::to_json(&all) }
    }

    /// A filter, or a smoother, which has no results but its summary.
    fn filter(
        &self,
        summary: &Summary,
        own: Option<&FilterResults>,
        (probability, series): (Option<f64>, Option<Document>),
    ) -> Document {
        let verdict = summary.verdict.as_ref();
        let verdict = verdict.map(|verdict| json!({ "kind": verdict.kind.key(), "sentence": verdict.to_string() }));
        let (is_good, causes) = (are_models(summary), own.map_or(&[][..], |own| &own.causes));
        let found = causes.iter().zip(Remedy::probabilities(causes));
        let found: Vec<Document> = found.map(|(remedy, probability)| self.cause(remedy, probability)).collect();
        let (models, found) = if is_good { (found, Vec::new()) } else { (Vec::new(), found) };
        let diagnosis = own.and_then(|own| own.diagnosis.as_ref());
        let bad_parts = diagnosis.into_iter().flat_map(|one| &one.bad_parts).map(|part| json!([part.start, part.end]));
        let stopped = summary.stop.map(|stop| {
            let time = self.record.time_of(stop.sample);
            json!({ "sample": stop.sample, "time": time, "reason": stop.reason.to_string() })
        });
        json!({
            "name": summary.name,
            "kind": summary.kind.name(),
            "smoothed": own.is_none(),
            "samples": summary.samples,
            "verdict": verdict,
            "evidence": Document::from_iter(diagnosis.into_iter().flat_map(|one| &one.evidence).map(evidence)),
            "bad_parts": Document::from_iter(bad_parts),
            "causes": found,
            "models": models,
            "explained": (!causes.is_empty() && !is_good).then(|| Remedy::is_explained(causes)),
            "estimates": Document::from_iter(summary.finals.iter().map(estimate)),
            "mean_nis": summary.nis.as_ref().map(|nis| nis.mean),
            "mean_nees": summary.nees.as_ref().map(|nees| nees.mean),
            "log_likelihood": summary.nis.as_ref().map(|_| summary.log_likelihood),
            "probability": probability,
            "stopped": stopped,
            "series": series,
        })
    }

    fn cause(&self, remedy: &Remedy, probability: f64) -> Document {
        let edit =
            |edit: &Edit| json!({ "sentence": edit.in_words(&self.scenario), "key": edit.key, "value": edit.value });
        json!({
            "sentence": sentence(remedy),
            "probability": probability,
            "gain": remedy.gain,
            "then": remedy.after.as_ref().map(|verdict| verdict.kind.key()),
            "hint": remedy.first.cause.hint,
            "edits": Document::from_iter(remedy.edits.iter().map(edit)),
        })
    }
}

fn evidence(one: &Evidence) -> Document {
    json!({
        "test": one.test.name,
        "sentence": one.sentence,
        "statistic": one.statistic,
        "p_value": one.p_value,
        "effect": one.effect,
        "counts": one.counts,
    })
}

fn estimate(last: &Final) -> Document {
    let score = last.score.as_ref();
    json!({
        "channel": last.channel.key(),
        "unit": last.channel.unit(),
        "mean": last.mean,
        "std": last.std,
        "error": score.map(|score| score.error),
        "rmse": score.map(|score| score.rmse),
        "share_inside": score.map(|score| score.coverage),
        "settled": score.and_then(|score| score.settled),
    })
}

fn free_run(name: &str, fit: &FreeFit) -> Document {
    let FreeFit { filter, sensor, free, one_step } = fit;
    let of = |fit: &Option<Fit>, what: fn(Fit) -> f64| fit.map(what);
    json!({
        "record": name,
        "filter": filter,
        "sensor": sensor.key(),
        "rms": of(free, |fit| fit.rms),
        "percent": of(free, |fit| fit.percent),
        "one_step_rms": of(one_step, |fit| fit.rms),
        "one_step_percent": of(one_step, |fit| fit.percent),
    })
}

fn record_series(record: &Record) -> Document {
    let measured = record.sensors().iter().enumerate().map(|(i, quantity)| (quantity.key(), record.measured(i)));
    let truth = record.true_channels().into_iter().filter_map(|channel| Some((channel.key(), record.truth(channel)?)));
    let mut series = json!({
        "time": Document::from_iter((0..record.len()).map(|k| record.time(k))),
        "input": record.input(),
        "measured": Document::from_iter(measured),
        "truth": Document::from_iter(truth),
    });
    if !record.forced().is_empty() {
        series["forces"] = Document::from_iter(record.forces().map(|(mass, values)| (mass.key(), values)));
    }
    series
}

fn filter_series(estimates: &Estimates) -> Document {
    let of_channels = |column: &dyn Fn(usize) -> Document| {
        let channels = estimates.channels().iter().enumerate();
        Document::from_iter(channels.map(|(place, channel)| (channel.key(), column(place))))
    };
    let of_sensors = |column: &dyn Fn(usize) -> Document| {
        let sensors = estimates.sensors().iter().enumerate();
        Document::from_iter(sensors.map(|(place, sensor)| (sensor.key(), column(place))))
    };
    json!({
        "mean": of_channels(&|place| Document::from_iter(estimates.canonical_means(place).iter().copied())),
        "std": of_channels(&|place| Document::from_iter(estimates.stds(place))),
        "innovation": of_sensors(&|place| Document::from_iter(estimates.innovations(place))),
        "innovation_std": of_sensors(&|place| Document::from_iter(estimates.innovation_stds(place))),
        "nis": estimates.nis(),
        "log_likelihood": Document::from_iter(estimates.log_likelihoods()),
    })
}
