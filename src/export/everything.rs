//! Scenario, record, estimates and diagnosis as one JSON.

use kalmanscope_core::diagnosis::Evidence;
use kalmanscope_core::{Channel, Diagnosis, Document, DocumentError, Estimates, Record, Scenario, Stop, Task};

use crate::session::Session;

/// Makes the text of the file. Undefined numbers are `null`. Means are canonical, as everywhere on screen.
pub(super) struct Everything {
    scenario: Scenario,
    record: Record,
    filters: Vec<(Estimates, Option<Diagnosis>)>,
}

impl Everything {
    pub(super) fn of(session: &Session) -> Self {
        let run = session.run();
        let filters = run.estimates().iter().cloned().enumerate();
        let filters = filters.map(|(place, estimates)| (estimates, session.diagnosis(place).cloned())).collect();
        Self { scenario: session.scenario().clone(), record: run.record().clone(), filters }
    }
}

impl Task for Everything {
    type Outcome = Result<String, DocumentError>;

    fn progress(&self) -> f64 {
        0.0
    }

    fn advance(&mut self, _: &mut dyn FnMut() -> bool) -> bool {
        true
    }

    fn finish(self) -> Self::Outcome {
        let filters = self.filters.iter().map(|(estimates, diagnosis)| filter(estimates, diagnosis.as_ref()));
        let everything = Document::of_entries([
            ("kalmanscope", env!("CARGO_PKG_VERSION").into()),
            ("scenario", Document::of(&self.scenario)?),
            ("record", record(&self.record)?),
            ("filters", Document::List(filters.collect::<Result<_, _>>()?)),
        ]);
        Document::json(&everything)
    }
}

fn record(record: &Record) -> Result<Document, DocumentError> {
    let numbers = |values: &[f64]| Document::of_numbers(values.iter().copied());
    let measured = record.sensors().iter().enumerate().map(|(i, q)| (q.key(), numbers(record.measured(i))));
    let truth = Channel::all().iter().filter_map(|c| Some((c.key(), numbers(record.truth(*c)?))));
    Ok(Document::of_entries([
        ("dt", Document::Number(record.dt())),
        ("time", Document::of_numbers((0..record.len()).map(|k| record.time(k)))),
        ("input_kind", Document::of(&record.input_kind())?),
        ("hold", Document::of(&record.hold())?),
        ("input", numbers(record.input())),
        ("measured", Document::of_entries(measured)),
        ("truth", Document::of_entries(truth)),
    ]))
}

fn filter(estimates: &Estimates, found: Option<&Diagnosis>) -> Result<Document, DocumentError> {
    let of_channels = |column: &dyn Fn(usize) -> Document| {
        let channels = estimates.channels().iter().enumerate();
        Document::of_entries(channels.map(|(place, channel)| (channel.key(), column(place))))
    };
    let of_sensors = |column: &dyn Fn(usize) -> Document| {
        let sensors = estimates.sensors().iter().enumerate();
        Document::of_entries(sensors.map(|(place, sensor)| (sensor.key(), column(place))))
    };
    Ok(Document::of_entries([
        ("name", estimates.name().into()),
        ("kind", estimates.kind().name().into()),
        ("plant", Document::of(&estimates.plant())?),
        ("mean", of_channels(&|place| Document::of_numbers(estimates.canonical_means(place).iter().copied()))),
        ("std", of_channels(&|place| Document::of_numbers(estimates.stds(place)))),
        ("innovation", of_sensors(&|place| Document::of_numbers(estimates.innovations(place)))),
        ("innovation_std", of_sensors(&|place| Document::of_numbers(estimates.innovation_stds(place)))),
        ("nis", Document::of_numbers(estimates.nis().iter().copied())),
        ("log_likelihood", Document::of_numbers(estimates.log_likelihoods())),
        ("stop", estimates.stop().map(stop).into()),
        ("diagnosis", found.map(diagnosis).into()),
    ]))
}

fn stop(stop: Stop) -> Document {
    let reason = stop.reason.to_string();
    Document::of_entries([("sample", (stop.sample as u64).into()), ("reason", Document::Text(reason))])
}

fn diagnosis(diagnosis: &Diagnosis) -> Document {
    let verdict = diagnosis.verdict.as_ref();
    let part = |place: usize| Document::from(place as u64);
    let bad_parts = diagnosis.bad_parts.iter().map(|range| Document::List(vec![part(range.start), part(range.end)]));
    Document::of_entries([
        ("verdict", verdict.map(|verdict| verdict.kind.key()).into()),
        ("reason", verdict.map(|verdict| &*verdict.reason).into()),
        ("evidence", Document::List(diagnosis.evidence.iter().map(evidence).collect())),
        ("bad_parts", Document::List(bad_parts.collect())),
    ])
}

fn evidence(one: &Evidence) -> Document {
    Document::of_entries([
        ("test", one.test.name.into()),
        ("sentence", one.sentence.as_str().into()),
        ("statistic", Document::Number(one.statistic)),
        ("p_value", Document::Number(one.p_value)),
        ("effect", Document::Number(one.effect)),
        ("counts", Document::Flag(one.counts)),
    ])
}
