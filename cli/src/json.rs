//! The results of a run as one document of JSON.

use kalmanscope_core::diagnosis::Final;
use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::document::{self, Document, DocumentError, json};
use kalmanscope_core::{Fit, Summary};

use crate::free_run::FreeFit;
use crate::in_words::{are_models, evidence, likeliest};
use crate::results::Results;

impl Results<'_> {
    /// The numbers of the table and of the free runs as JSON, in SI units; `null` where there is none:
    ///
    /// ```text
    /// samples, start [s], dt [s], measured: [quantity]
    /// filters: [{ name, kind, smoothed, samples, verdict: { kind, sentence }, evidence: [sentence], causes: [{ sentence, probability, remedies }],
    ///             models: of a filter to be believed those that are likelier, as causes,
    ///             explained: whether the first cause leaves a good verdict,
    ///             estimates: [{ channel, unit, mean, std, error, rmse, share_inside, settled }],
    ///             mean_nis, mean_nees, log_likelihood,
    ///             probability: of the filter as a model class, stopped: { sample, time, reason } }]
    /// free_runs: [{ record, filter, sensor, rms, percent, one_step_rms, one_step_percent }]
    /// ```
    ///
    /// # Errors
    /// [`DocumentError`] where a number cannot be written, which no run causes.
    pub fn json(&self) -> Result<String, DocumentError> {
        let record = self.record;
        let probabilities = self.probabilities();
        let filters = self.filters.iter().enumerate().map(|(place, one)| {
            let evidence = one.diagnosis.as_ref().map_or_else(Vec::new, evidence);
            filter(&one.summary, probabilities.get(place).copied(), Some(evidence), &one.causes, self)
        });
        let smoothers = self.smoothers.iter().map(|summary| filter(summary, None, None, &[], self));
        let free_runs = self.free_runs.iter().flat_map(|runs| runs.fits.iter().map(|fit| free_run(&runs.name, fit)));
        document::to_json_lines(&json!({
            "samples": record.len(),
            "start": record.time(0),
            "dt": record.dt(),
            "measured": Document::from_iter(record.sensors().iter().map(|sensor| sensor.key())),
            "filters": Document::from_iter(filters.chain(smoothers)),
            "free_runs": Document::from_iter(free_runs),
        }))
    }
}

fn filter(
    summary: &Summary,
    probability: Option<f64>,
    evidence: Option<Vec<String>>,
    causes: &[Remedy],
    results: &Results<'_>,
) -> Document {
    let Results { scenario, record, .. } = results;
    let verdict = summary.verdict.as_ref();
    let verdict = verdict.map(|verdict| json!({ "kind": verdict.kind.key(), "sentence": verdict.to_string() }));
    let is_good = are_models(summary);
    let explained = (!causes.is_empty() && !is_good).then(|| Remedy::is_explained(causes));
    let causes = likeliest(causes, summary, scenario).into_iter().zip(Remedy::probabilities(causes)).map(
        |(cause, probability)| json!({ "sentence": cause.sentence, "probability": probability, "remedies": cause.remedies }),
    );
    let (models, causes): (Vec<Document>, Vec<Document>) = causes.partition(|_| is_good);
    let stopped = summary.stop.map(
        |stop| json!({ "sample": stop.sample, "time": record.time_of(stop.sample), "reason": stop.reason.to_string() }),
    );
    json!({
        "name": summary.name,
        "kind": summary.kind.name(),
        "smoothed": evidence.is_none(),
        "samples": summary.samples,
        "verdict": verdict,
        "evidence": evidence.unwrap_or_default(),
        "causes": causes,
        "models": models,
        "explained": explained,
        "estimates": Document::from_iter(summary.finals.iter().map(estimate)),
        "mean_nis": summary.nis.as_ref().map(|nis| nis.mean),
        "mean_nees": summary.nees.as_ref().map(|nees| nees.mean),
        "log_likelihood": summary.nis.as_ref().map(|_| summary.log_likelihood),
        "probability": probability,
        "stopped": stopped,
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
