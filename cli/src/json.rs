//! The results of a run as one document of JSON.

use kalmanscope_core::diagnosis::Final;
use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::{Document, DocumentError, Fit, Summary};

use crate::free_run::FreeFit;
use crate::in_words::{evidence, likeliest};
use crate::results::Results;

impl Results<'_> {
    /// The numbers of the table and of the free runs as JSON, in SI units; `null` where there is none:
    ///
    /// ```text
    /// samples, start [s], dt [s], measured: [quantity]
    /// filters: [{ name, kind, smoothed, samples, verdict: { kind, sentence }, evidence: [sentence], causes: [{ sentence, probability, remedies }],
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
        Document::json_lines(&Document::of_entries([
            ("samples", count(record.len())),
            ("start", Document::Number(record.time(0))),
            ("dt", Document::Number(record.dt())),
            ("measured", Document::List(record.sensors().iter().map(|sensor| sensor.key().into()).collect())),
            ("filters", Document::List(filters.chain(smoothers).collect())),
            ("free_runs", Document::List(free_runs.collect())),
        ]))
    }
}

/// One filter, or one smoother, which has no evidence.
fn filter(
    summary: &Summary,
    probability: Option<f64>,
    evidence: Option<Vec<String>>,
    causes: &[Remedy],
    results: &Results<'_>,
) -> Document {
    let Results { scenario, record, .. } = results;
    let verdict = summary.verdict.as_ref().map(|verdict| {
        Document::of_entries([("kind", text(verdict.kind.key())), ("sentence", Document::Text(verdict.to_string()))])
    });
    let explained = if causes.is_empty() { Document::Null } else { Document::Flag(Remedy::is_explained(causes)) };
    let causes =
        likeliest(causes, scenario).into_iter().zip(Remedy::probabilities(causes)).map(|(cause, probability)| {
            Document::of_entries([
                ("sentence", Document::Text(cause.sentence)),
                ("probability", Document::Number(probability)),
                ("remedies", texts(cause.remedies)),
            ])
        });
    let stopped = summary.stop.map(|stop| {
        Document::of_entries([
            ("sample", count(stop.sample)),
            ("time", Document::Number(record.time_of(stop.sample))),
            ("reason", Document::Text(stop.reason.to_string())),
        ])
    });
    Document::of_entries([
        ("name", text(&summary.name)),
        ("kind", text(summary.kind.name())),
        ("smoothed", Document::Flag(evidence.is_none())),
        ("samples", count(summary.samples)),
        ("verdict", verdict.unwrap_or(Document::Null)),
        ("evidence", texts(evidence.unwrap_or_default())),
        ("causes", Document::List(causes.collect())),
        ("explained", explained),
        ("estimates", Document::List(summary.finals.iter().map(estimate).collect())),
        ("mean_nis", number(summary.nis.as_ref().map(|nis| nis.mean))),
        ("mean_nees", number(summary.nees.as_ref().map(|nees| nees.mean))),
        ("log_likelihood", number(summary.nis.as_ref().map(|_| summary.log_likelihood))),
        ("probability", number(probability)),
        ("stopped", stopped.unwrap_or(Document::Null)),
    ])
}

fn estimate(last: &Final) -> Document {
    let score = last.score.as_ref();
    Document::of_entries([
        ("channel", text(last.channel.key())),
        ("unit", text(last.channel.unit())),
        ("mean", Document::Number(last.mean)),
        ("std", Document::Number(last.std)),
        ("error", number(score.map(|score| score.error))),
        ("rmse", number(score.map(|score| score.rmse))),
        ("share_inside", number(score.map(|score| score.coverage))),
        ("settled", number(score.and_then(|score| score.settled))),
    ])
}

fn free_run(name: &str, fit: &FreeFit) -> Document {
    let FreeFit { filter, sensor, free, one_step } = fit;
    let of = |fit: &Option<Fit>, what: fn(Fit) -> f64| number(fit.map(what));
    Document::of_entries([
        ("record", text(name)),
        ("filter", text(filter)),
        ("sensor", text(sensor.key())),
        ("rms", of(free, |fit| fit.rms)),
        ("percent", of(free, |fit| fit.percent)),
        ("one_step_rms", of(one_step, |fit| fit.rms)),
        ("one_step_percent", of(one_step, |fit| fit.percent)),
    ])
}

fn text(text: &str) -> Document {
    text.into()
}

fn texts(texts: Vec<String>) -> Document {
    Document::List(texts.into_iter().map(Document::Text).collect())
}

fn number(number: Option<f64>) -> Document {
    number.map_or(Document::Null, Document::Number)
}

fn count(count: usize) -> Document {
    i64::try_from(count).map_or(Document::Null, Document::Integer)
}
