//! The lines that go out: CSV, or one JSON object each.

use std::io::{self, Write};

use kalmanscope_cli::harmless;
use kalmanscope_core::{Channel, Document, EventFilter, Sample};

use super::watch::Watch;

/// Writes lines, each flushed. A closed pipe is the end and no error.
pub(super) struct Writer<W> {
    output: W,
    json: bool,
    names: Vec<String>,
    line: String,
}

/// The columns of a filter behind those of its channels, and the word before those in hindsight.
const LAST: [&str; 3] = ["nis", "again", "verdict"];
const HINDSIGHT: &str = "hindsight";

impl<W: Write> Writer<W> {
    pub(super) fn new(output: W, json: bool) -> Self {
        Self { output, json, names: Vec::new(), line: String::new() }
    }

    /// Writes the header of a table for these filters. Returns whether anybody reads it.
    pub(super) fn begin<'a>(&mut self, filters: impl Iterator<Item = (&'a str, &'a EventFilter)>) -> io::Result<bool> {
        self.line = "t".to_owned();
        for (name, filter) in filters {
            self.names.push(name.to_owned());
            let name = harmless(name).replace([',', '"'], "_");
            let of = |prefix: &str| {
                let each = |channel: &Channel| {
                    [channel.key(), &format!("std_{}", channel.key())].map(|key| format!("{prefix}{key}"))
                };
                filter.channels().iter().flat_map(each).collect::<Vec<_>>()
            };
            let mut columns = of("");
            columns.extend(LAST.map(str::to_owned));
            if filter.looks_back() {
                columns.push(format!("{HINDSIGHT}_t"));
                columns.extend(of(&format!("{HINDSIGHT}_")));
            }
            columns.iter().for_each(|column| self.line.push_str(&format!(",{name}.{column}")));
        }
        if self.json { Ok(true) } else { self.flush() }
    }

    /// Writes the newest estimates of all filters, and those in hindsight. A filter that has stopped has none. Returns whether anybody
    /// reads them.
    pub(super) fn write<'a>(
        &mut self,
        filters: impl Iterator<Item = (&'a mut EventFilter, &'a Watch, bool)>,
    ) -> io::Result<bool> {
        let all: Vec<FilterRow> = filters.map(FilterRow::of).collect();
        let time = all.iter().find_map(|one| one.now.as_ref()).map_or(f64::NAN, |now| now.time);
        self.line.clear();
        if self.json {
            let each = self.names.iter().zip(&all).map(|(name, one)| (name.clone(), one.in_json()));
            let entries = std::iter::once(("t".to_owned(), number(time))).chain(each);
            self.line = Document::json(&Document::of_entries(entries)).map_err(io::Error::other)?;
            return self.flush();
        }
        self.line.push_str(&cell(time));
        all.iter().for_each(|one| one.write(&mut self.line));
        self.flush()
    }

    fn flush(&mut self) -> io::Result<bool> {
        self.line.push('\n');
        let done = self.output.write_all(self.line.as_bytes()).and_then(|()| self.output.flush());
        match done {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
            done => done.map(|()| true),
        }
    }
}

/// The numbers of a filter after a line.
struct FilterRow {
    channels: Vec<Channel>,
    /// The newest estimate; `None` of a filter that has stopped.
    now: Option<Estimate>,
    /// The estimate in hindsight: `None` without a look-ahead, and inside where nothing is old enough.
    hindsight: Option<Option<Estimate>>,
    nis: f64,
    again: usize,
    verdict: &'static str,
}

/// Mean and standard deviation of each channel at a time \[s\], in canonical form: (-ωₙ, -ζ) and (ωₙ, ζ) are the same oscillator.
struct Estimate {
    time: f64,
    numbers: Vec<[f64; 2]>,
}

impl Estimate {
    fn of(time: f64, sample: &Sample<'_>, channels: &[Channel]) -> Self {
        let place = |channel| channels.iter().position(|one| *one == channel);
        let mirrored = place(Channel::NATURAL_FREQUENCY).is_some_and(|place| sample.mean[place] < 0.0);
        let n = channels.len();
        let of = |(i, channel): (usize, &Channel)| {
            let mean = if mirrored && channel.is_mirrored() { -sample.mean[i] } else { sample.mean[i] };
            [mean, sample.cov[i * n + i].sqrt()]
        };
        Self { time, numbers: channels.iter().enumerate().map(of).collect() }
    }

    fn entries<'a>(&'a self, channels: &'a [Channel]) -> impl Iterator<Item = (String, Document)> + 'a {
        channels.iter().zip(&self.numbers).map(|(channel, [mean, std])| {
            (channel.key().to_owned(), Document::of_entries([("mean", number(*mean)), ("std", number(*std))]))
        })
    }

    fn write(&self, line: &mut String) {
        self.numbers.iter().flatten().for_each(|number| line.push_str(&format!(",{}", cell(*number))));
    }
}

impl FilterRow {
    fn of((filter, watch, stopped): (&mut EventFilter, &Watch, bool)) -> Self {
        let channels = filter.channels().to_vec();
        let time = filter.time().unwrap_or(f64::NAN);
        let now = (!stopped).then(|| Estimate::of(time, &filter.sample(), &channels));
        let (looks_back, again) = (filter.looks_back(), filter.again());
        let hindsight = filter.hindsight().filter(|_| !stopped);
        let hindsight = looks_back.then(|| hindsight.map(|(time, sample)| Estimate::of(time, &sample, &channels)));
        let verdict = if stopped { "stopped" } else { watch.verdict() };
        Self { channels, now, hindsight, nis: watch.nis(), again, verdict }
    }

    fn write(&self, line: &mut String) {
        let Self { channels, now, hindsight, nis, again, verdict } = self;
        let nothing = ",".repeat(2 * channels.len());
        match now {
            Some(now) => {
                now.write(line);
                line.push_str(&format!(",{},{again},{verdict}", cell(*nis)));
            }
            None => line.push_str(&format!("{nothing},,,{verdict}")),
        }
        match hindsight {
            None => {}
            Some(None) => line.push_str(&format!(",{nothing}")),
            Some(Some(then)) => {
                line.push_str(&format!(",{}", cell(then.time)));
                then.write(line);
            }
        }
    }

    fn in_json(&self) -> Document {
        let Self { channels, now, hindsight, nis, again, verdict } = self;
        let last = ("verdict".to_owned(), Document::from(*verdict));
        let Some(now) = now else { return Document::of_entries([last]) };
        let again = Document::Integer(i64::try_from(*again).unwrap_or(i64::MAX));
        let then = hindsight.iter().flatten().map(|then| {
            let time = ("t".to_owned(), number(then.time));
            (HINDSIGHT.to_owned(), Document::of_entries(std::iter::once(time).chain(then.entries(channels))))
        });
        let all = now.entries(channels).chain([("nis".to_owned(), number(*nis)), ("again".to_owned(), again), last]);
        Document::of_entries(all.chain(then))
    }
}

/// A number in JSON, which has none that is not finite.
fn number(number: f64) -> Document {
    if number.is_finite() { Document::Number(number) } else { Document::Null }
}

/// A number in a table: ten digits, nothing for NaN.
fn cell(number: f64) -> String {
    if number.is_nan() { String::new() } else { format!("{number:.9e}") }
}
