//! Scenario, record, estimates and diagnosis as one JSON.

use kalmanscope_core::{Channel, Diagnosis, Document, DocumentError, Estimates, Record, Scenario};
use serde_json::{Map, Value, json};

use crate::session::Session;

/// The text of the file. Undefined numbers are `null`. Means are canonical, as everywhere on screen.
pub(super) fn json(session: &Session) -> Result<String, DocumentError> {
    let run = session.run();
    let scenario: &Scenario = session.scenario();
    let filters = run.estimates().iter().enumerate().map(|(place, estimates)| {
        let mut filter = filter(estimates);
        filter.insert("diagnosis".to_owned(), session.diagnosis(place).map_or(Value::Null, diagnosis));
        Value::Object(filter)
    });
    let filters: Vec<Value> = filters.collect();
    let everything = json!({
        "kalmanscope": env!("CARGO_PKG_VERSION"),
        "scenario": Document::of(scenario)?,
        "record": record(run.record()),
        "filters": filters,
    });
    serde_json::to_string(&everything).map_err(serde::ser::Error::custom)
}

fn record(record: &Record) -> Value {
    let times: Vec<f64> = (0..record.len()).map(|k| record.time(k)).collect();
    let measured =
        (0..record.sensors().len()).map(|i| (record.sensors()[i].key().to_owned(), json!(record.measured(i))));
    let truth = Channel::all().iter().filter_map(|c| Some((c.key().to_owned(), json!(record.truth(*c)?))));
    json!({
        "dt": record.dt(),
        "time": times,
        "input_kind": record.input_kind(),
        "hold": record.hold(),
        "input": record.input(),
        "measured": Value::Object(measured.collect()),
        "truth": Value::Object(truth.collect()),
    })
}

fn filter(estimates: &Estimates) -> Map<String, Value> {
    let samples = 0..estimates.len();
    let of_channels = |value: &dyn Fn(usize, usize) -> f64| -> Value {
        let column = |(place, channel): (usize, &Channel)| {
            let values: Vec<f64> = samples.clone().map(|k| value(k, place)).collect();
            (channel.key().to_owned(), json!(values))
        };
        Value::Object(estimates.channels().iter().enumerate().map(column).collect())
    };
    let of_sensors = |value: &dyn Fn(usize, usize) -> f64| -> Value {
        let column = |place: usize| {
            let values: Vec<f64> = samples.clone().map(|k| value(k, place)).collect();
            (estimates.sensors()[place].key().to_owned(), json!(values))
        };
        Value::Object((0..estimates.sensors().len()).map(column).collect())
    };
    let sensors = estimates.sensors().len();
    let log_likelihood: Vec<f64> = samples.clone().map(|k| estimates.log_likelihood(k)).collect();
    let stop = estimates.stop().map(|stop| json!({ "sample": stop.sample, "reason": stop.reason.to_string() }));
    let parts = [
        ("name", json!(estimates.name())),
        ("kind", json!(estimates.kind().name())),
        ("plant", json!(estimates.plant())),
        ("mean", of_channels(&|k, place| estimates.canonical_mean(k, place))),
        ("std", of_channels(&|k, place| estimates.std(k, place))),
        ("innovation", of_sensors(&|k, place| estimates.innovation(k)[place])),
        ("innovation_std", of_sensors(&|k, place| estimates.innovation_cov(k)[place * (sensors + 1)].sqrt())),
        ("nis", json!(estimates.nis())),
        ("log_likelihood", json!(log_likelihood)),
        ("stop", json!(stop)),
    ];
    parts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

fn diagnosis(diagnosis: &Diagnosis) -> Value {
    let evidence = diagnosis.evidence.iter().map(|one| {
        json!({
            "test": one.test.name,
            "sentence": one.sentence,
            "statistic": one.statistic,
            "p_value": one.p_value,
            "effect": one.effect,
            "counts": one.counts,
        })
    });
    let verdict = diagnosis.verdict.as_ref();
    json!({
        "verdict": verdict.map(|verdict| verdict.kind.key()),
        "reason": verdict.map(|verdict| &verdict.reason),
        "evidence": evidence.collect::<Vec<Value>>(),
        "bad_parts": diagnosis.bad_parts.iter().map(|part| [part.start, part.end]).collect::<Vec<_>>(),
    })
}
