//! The command `kalmanscope-cli stream`: readings come in, estimates go out, line by line.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::path::Path;

use kalmanscope_cli::harmless;
use kalmanscope_core::diagnostics::chi_squared;
use kalmanscope_core::document::{Document, json};
use kalmanscope_core::{Channel, EventError, EventFilter, Pass, RunError, Sample, Scenario};
use kalmanscope_sources::{Lines, StreamRow, open, read_line};

use crate::args::StreamArgs;
use crate::files::{InputError, check, is_standard_input, places, say};
use crate::prepared::read_scenario;

/// Limits the lines that are refused with a message; later ones are counted.
const MESSAGES: usize = 100;

struct Followed {
    name: String,
    filter: EventFilter,
    watch: Watch,
    has_stopped: bool,
}

/// Reads lines until there are no more, and writes the estimates at the newest time after each, flushed. What is refused is
/// said on standard error. Returns whether a filter is left that has not stopped.
pub(crate) fn stream(args: &StreamArgs) -> Result<bool, InputError> {
    let StreamArgs { scenario: file, source, late, json } = args;
    let both = [places("SCENARIO", [file]), places("SOURCE", [source])].concat();
    check(&both.into_iter().filter(|(_, file)| is_standard_input(file)).collect(), &Vec::new())?;
    let scenario = read_scenario(file, false)?;
    let mut filters = followed(file, &scenario, *late)?;
    let unread = |error: io::Error| InputError::Read { file: source.clone(), error };
    let written = |error: io::Error| InputError::unwritten(Path::new("-"), &error);
    let mut input = open(&source.to_string_lossy()).map_err(unread)?;
    let mut lines = Lines::new(&scenario);
    let mut writer = Writer::new(io::stdout().lock(), *json);
    if !writer.begin(filters.iter().map(|one| (one.name.as_str(), &one.filter))).map_err(written)? {
        return Ok(true);
    }
    let (mut bytes, mut number, mut refused) = (Vec::new(), 0_u64, 0);
    let mut taken = Vec::new();
    let mut refuse = |number: u64, reason: &dyn std::fmt::Display| {
        refused += 1;
        if refused <= MESSAGES {
            say(&format_args!("line {number}: {reason}; it is left out"));
        }
    };
    while read_line(&mut input, &mut bytes).map_err(unread)? {
        number += 1;
        let row = match lines.read(&bytes) {
            Ok(Some(row)) => row,
            Ok(None) => continue,
            Err(reason) => {
                refuse(number, &reason);
                continue;
            }
        };
        let mut reason = take(&mut filters, &row);
        if let (Some(EventError::Gap { before, .. }), [first]) = (&reason, taken.as_slice()) {
            refuse(
                *first,
                &format_args!("its time, {before} s, is far from that of the next line, as of a clock that is not set"),
            );
            filters = followed(file, &scenario, *late)?;
            reason = take(&mut filters, &row);
        }
        match reason {
            Some(reason) => refuse(number, &reason),
            None => {
                if taken.len() < 2 {
                    taken.push(number);
                }
                let all = filters.iter_mut().map(|one| (&mut one.filter, &one.watch, one.has_stopped));
                if !writer.write(all).map_err(written)? {
                    break;
                }
            }
        }
        if filters.iter().all(|one| one.has_stopped) {
            break;
        }
    }
    if refused > MESSAGES {
        say(&format_args!("{refused} of {number} lines were left out"));
    }
    Ok(filters.iter().any(|one| !one.has_stopped))
}

/// The filters of a scenario that can follow events. One that cannot is said; it is an error if there is no other.
fn followed(file: &Path, scenario: &Scenario, late: f64) -> Result<Vec<Followed>, InputError> {
    let bad = |error: RunError| InputError::Run { file: file.to_owned(), error };
    let mut filters = Vec::new();
    let mut last = None;
    for place in 0..scenario.filters.len() {
        let name = Pass::history(scenario, place).map_err(bad)?.name().to_owned();
        match EventFilter::new(scenario, place) {
            Ok(filter) => {
                let filter = filter.keeping(late);
                filters.push(Followed { name, filter, watch: Watch::default(), has_stopped: false });
            }
            Err(kalmanscope_core::EventSetupError::Run(error)) => return Err(bad(error)),
            Err(error) => {
                say(&format_args!("{name} is left out: {error}"));
                last = Some(error);
            }
        }
    }
    if filters.is_empty() {
        let reason = last.map_or_else(|| "it has no filter".to_owned(), |error| error.to_string());
        return Err(InputError::bad(file, &reason));
    }
    Ok(filters)
}

/// Gives a row to all filters. Returns the reason if it is refused, which all do alike.
fn take(filters: &mut [Followed], row: &StreamRow) -> Option<EventError> {
    let mut refused = None;
    for one in filters.iter_mut().filter(|one| !one.has_stopped) {
        match one.filter.take(row.time, row.input, &row.readings) {
            Ok(sample) => one.watch.watch(&sample),
            Err(EventError::Stopped { time, reason }) => {
                say(&format_args!("{} has stopped at {time} s: {reason}", one.name));
                one.has_stopped = true;
            }
            Err(reason) => refused = Some(reason),
        }
    }
    refused
}

/// The updates that are looked at, and how many there must be.
const WINDOW: usize = 200;
const LEAST: usize = 20;

#[derive(Clone, Debug, Default)]
struct Watch {
    last: VecDeque<(f64, u32)>,
    nis: f64,
}

impl Watch {
    fn watch(&mut self, sample: &Sample<'_>) {
        self.nis = sample.nis;
        let readings = sample.readings();
        if readings == 0 || !sample.nis.is_finite() {
            return;
        }
        self.last.push_back((sample.nis, readings));
        if self.last.len() > WINDOW {
            self.last.pop_front();
        }
    }

    /// NIS of the last sample; NaN if it has no readings.
    fn nis(&self) -> f64 {
        self.nis
    }

    /// The verdict on the last updates in words: their mean NIS against its 95 % interval.
    fn verdict(&self) -> &'static str {
        if self.last.len() < LEAST {
            return "too few readings";
        }
        let sum: f64 = self.last.iter().map(|(nis, _)| nis).sum();
        let degrees = self.last.iter().map(|(_, readings)| readings).sum();
        match chi_squared::interval(degrees, 1) {
            Some(usual) if sum > *usual.end() => "innovations larger than expected",
            Some(usual) if sum < *usual.start() => "innovations smaller than expected",
            Some(_) => "innovations as expected",
            None => "too few readings",
        }
    }
}

/// Writes lines, each flushed. A closed pipe is the end and no error.
struct Writer<W> {
    output: W,
    json: bool,
    names: Vec<String>,
    line: String,
}

/// The columns of a filter behind those of its channels, and the word before those in hindsight.
const LAST: [&str; 3] = ["nis", "again", "verdict"];
const HINDSIGHT: &str = "hindsight";

impl<W: Write> Writer<W> {
    fn new(output: W, json: bool) -> Self {
        Self { output, json, names: Vec::new(), line: String::new() }
    }

    /// Writes the header of a table for these filters. Returns whether anybody reads it.
    fn begin<'a>(&mut self, filters: impl Iterator<Item = (&'a str, &'a EventFilter)>) -> io::Result<bool> {
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
    fn write<'a>(&mut self, filters: impl Iterator<Item = (&'a mut EventFilter, &'a Watch, bool)>) -> io::Result<bool> {
        let all: Vec<FilterRow> = filters.map(FilterRow::of).collect();
        let time = all.iter().find_map(|one| one.now.as_ref()).map_or(f64::NAN, |now| now.time);
        self.line.clear();
        if self.json {
            let each = self.names.iter().zip(&all).map(|(name, one)| (name.clone(), one.in_json()));
            let entries = std::iter::once(("t".to_owned(), time.into())).chain(each);
            self.line = Document::from_iter(entries).to_string();
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
        let numbers = channels.iter().zip(&self.numbers);
        numbers.map(|(channel, [mean, std])| (channel.key().to_owned(), json!({ "mean": mean, "std": std })))
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
        let Some(now) = now else { return Document::from_iter([last]) };
        let then = hindsight.iter().flatten().map(|then| {
            let time = ("t".to_owned(), then.time.into());
            (HINDSIGHT.to_owned(), Document::from_iter(std::iter::once(time).chain(then.entries(channels))))
        });
        let all = now.entries(channels).chain([
            ("nis".to_owned(), (*nis).into()),
            ("again".to_owned(), (*again).into()),
            last,
        ]);
        Document::from_iter(all.chain(then))
    }
}

/// A number in a table: ten digits, nothing for NaN.
fn cell(number: f64) -> String {
    if number.is_nan() { String::new() } else { format!("{number:.9e}") }
}
