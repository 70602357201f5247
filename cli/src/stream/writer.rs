//! The lines that go out: CSV, or one JSON object each.

use std::io::{self, Write};

use kalmanscope_cli::harmless;
use kalmanscope_core::{Channel, Document, EventFilter};
use kalmanscope_sources::Broadcast;

use super::watch::Watch;

/// Writes lines, each flushed, and sends them as JSON to all who listen at a WebSocket. A closed pipe is the end and no error.
pub(super) struct Writer<W> {
    output: W,
    json: bool,
    broadcast: Option<Broadcast>,
    names: Vec<String>,
    line: String,
}

/// The columns of a filter behind those of its channels.
const LAST: [&str; 3] = ["nis", "again", "verdict"];

impl<W: Write> Writer<W> {
    pub(super) fn new(output: W, json: bool, broadcast: Option<Broadcast>) -> Self {
        Self { output, json, broadcast, names: Vec::new(), line: String::new() }
    }

    /// Writes the header of a table for these filters with their channels. Returns whether anybody reads it.
    pub(super) fn begin(&mut self, filters: &[(&str, &[Channel])]) -> io::Result<bool> {
        self.names = filters.iter().map(|(name, _)| (*name).to_owned()).collect();
        if self.json {
            return Ok(true);
        }
        let of = |(name, channels): &(&str, &[Channel])| {
            let name = harmless(name).replace([',', '"'], "_");
            let each = channels.iter().flat_map(|channel| [channel.key().to_owned(), format!("std_{}", channel.key())]);
            each.chain(LAST.map(str::to_owned)).map(move |column| format!(",{name}.{column}")).collect::<String>()
        };
        self.line = format!("t{}", filters.iter().map(of).collect::<String>());
        self.flush()
    }

    /// Writes the newest estimates of all filters. A filter that has stopped has none. Returns whether anybody reads them.
    pub(super) fn write<'a>(
        &mut self,
        filters: impl Iterator<Item = (&'a EventFilter, &'a Watch, bool)>,
    ) -> io::Result<bool> {
        let filters: Vec<_> = filters.collect();
        let time = filters.iter().filter(|(_, _, stopped)| !stopped).find_map(|(filter, ..)| filter.time());
        let time = time.unwrap_or(f64::NAN);
        self.line.clear();
        if self.json || self.broadcast.is_some() {
            let each = self.names.iter().zip(&filters).map(|(name, one)| (name.clone(), in_json(one)));
            let entries = std::iter::once(("t".to_owned(), number(time))).chain(each);
            let object = Document::json(&Document::of_entries(entries)).map_err(io::Error::other)?;
            if let Some(broadcast) = &mut self.broadcast {
                broadcast.send(&object);
            }
            if self.json {
                self.line = object;
                return self.flush();
            }
        }
        self.line.push_str(&cell(time));
        for (filter, watch, stopped) in &filters {
            let n = filter.channels().len();
            if *stopped {
                self.line.push_str(&",".repeat(2 * n + LAST.len() - 1));
                self.line.push_str(",stopped");
                continue;
            }
            let (mean, std) = numbers(filter);
            for (mean, std) in mean.iter().zip(&std) {
                self.line.push_str(&format!(",{},{}", cell(*mean), cell(*std)));
            }
            self.line.push_str(&format!(",{},{},{}", cell(watch.nis()), filter.again(), watch.verdict()));
        }
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

/// The newest mean and standard deviations of a filter, in canonical form: (-ωₙ, -ζ) and (ωₙ, ζ) are the same oscillator.
fn numbers(filter: &EventFilter) -> (Vec<f64>, Vec<f64>) {
    let (sample, channels) = (filter.sample(), filter.channels());
    let place = |channel| channels.iter().position(|one| *one == channel);
    let mirrored = place(Channel::NATURAL_FREQUENCY).is_some_and(|place| sample.mean[place] < 0.0);
    let turns = |channel: &Channel| [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].contains(channel);
    let mean = channels.iter().zip(sample.mean).map(|(channel, &x)| if mirrored && turns(channel) { -x } else { x });
    let n = channels.len();
    (mean.collect(), (0..n).map(|i| sample.cov[i * n + i].sqrt()).collect())
}

fn in_json((filter, watch, stopped): &(&EventFilter, &Watch, bool)) -> Document {
    if *stopped {
        return Document::of_entries([("verdict", Document::from("stopped"))]);
    }
    let (mean, std) = numbers(filter);
    let each = filter.channels().iter().zip(mean.iter().zip(&std));
    let each = each.map(|(channel, (mean, std))| {
        (channel.key().to_owned(), Document::of_entries([("mean", number(*mean)), ("std", number(*std))]))
    });
    let again = Document::Integer(i64::try_from(filter.again()).unwrap_or(i64::MAX));
    let last = [("nis", number(watch.nis())), ("again", again), ("verdict", watch.verdict().into())];
    Document::of_entries(each.chain(last.map(|(key, value)| (key.to_owned(), value))))
}

/// A number in JSON, which has none that is not finite.
fn number(number: f64) -> Document {
    if number.is_finite() { Document::Number(number) } else { Document::Null }
}

/// A number in a table: ten digits, nothing for NaN.
fn cell(number: f64) -> String {
    if number.is_nan() { String::new() } else { format!("{number:.9e}") }
}
