//! The results of a run as text.

use std::fmt::{self, Write as _};

use kalmanscope_core::{Channel, FilterKind, ModelClasses, Record, TruthStop};
use kalmanscope_diagnosis::Summary;

use crate::in_words::{evidence, likeliest, quality, remarks, unexplained};
use crate::number::{plain, short};
use crate::results::{FilterResults, Results};
use crate::rows::{COLUMNS, rows};

impl Results<'_> {
    /// The results as a table of at most ten lines a filter: the verdict in a sentence, the likeliest cause with the command that
    /// tries its remedy, and the last estimates ±2σ with units, parameters first; where the filter stopped if it did. Then the
    /// smoothed estimates of the filters that have a smoother, and free runs over records that the filters have not followed.
    ///
    /// All of it has besides: the evidence, all causes with their edits, every channel with its errors, σ over its Cramér-Rao bound,
    /// mean NIS and NEES with their 95 % intervals, the whiteness of the innovations, the likelihood, all remarks and free runs.
    pub fn table(&self, all: bool) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut text, all);
        text
    }

    fn write(&self, text: &mut String, all: bool) -> fmt::Result {
        for line in origin(&self.record, self.truth_stop) {
            writeln!(text, "{line}")?;
        }
        if self.filters.is_empty() {
            writeln!(text, "\nno filters")?;
        }
        let mut probabilities = self.probabilities().into_iter();
        let filters = self.filters.iter().map(|filter| (&filter.summary, Some(filter)));
        let sections: Vec<[Vec<String>; 2]> = filters
            .chain(self.smoothers.iter().map(|summary| (summary, None)))
            .map(|(summary, filter)| {
                let above = self.above(summary, filter, all);
                [above, self.below(summary, filter, filter.and(probabilities.next()), all)]
            })
            .collect();
        let summaries = self.filters.iter().map(|filter| &filter.summary).chain(&self.smoothers);
        let rows: Vec<Vec<[String; COLUMNS]>> = summaries
            .zip(&sections)
            .map(|(summary, [above, below])| {
                // It cannot be negative: in brief, five lines at most stand above and two below.
                self.rows(summary, if all { None } else { Some(MOST - above.len() - below.len()) })
            })
            .collect();
        let widths: [usize; COLUMNS] =
            std::array::from_fn(|i| rows.iter().flatten().map(|row| width(&row[i])).max().unwrap_or(0));
        for ([above, below], rows) in sections.iter().zip(&rows) {
            writeln!(text)?;
            above.iter().try_for_each(|line| writeln!(text, "{line}"))?;
            rows.iter().try_for_each(|row| write_row(text, row, &widths))?;
            below.iter().try_for_each(|line| writeln!(text, "{line}"))?;
        }
        for runs in self.free_runs.iter().filter(|runs| all || !runs.is_own) {
            writeln!(text, "\nfree run of the final models over {}: {} samples", runs.name, runs.samples)?;
            runs.lines(self.length()).try_for_each(|line| writeln!(text, "  {line}"))?;
        }
        if !all && !self.filters.is_empty() {
            writeln!(text, "\n--verbose prints the evidence, other causes, errors, all channels and likelihoods")?;
        }
        Ok(())
    }

    fn above(&self, summary: &Summary, filter: Option<&FilterResults>, all: bool) -> Vec<String> {
        let mut lines = vec![heading(&summary.name, summary.kind)];
        let Some(filter) = filter else { return lines };
        // Other reasons are among the evidence.
        let verdict = summary.verdict.as_ref().map_or(NO_VERDICT.to_owned(), ToString::to_string);
        lines.push(format!("  {}", verdict.split("; ").next().unwrap_or_default()));
        let evidence = filter.diagnosis.iter().filter(|_| all).flat_map(evidence);
        lines.extend(evidence.map(|line| format!("    {line}")));
        lines.extend(unexplained(&filter.causes, summary).map(|line| format!("  {line}")));
        for cause in likeliest(&filter.causes, summary, self).into_iter().take(if all { usize::MAX } else { 1 }) {
            lines.push(format!("  {}", cause.sentence));
            lines.extend(
                cause.remedy.filter(|_| all).into_iter().chain([cause.trial]).map(|line| format!("    {line}")),
            );
        }
        lines
    }

    fn below(
        &self,
        summary: &Summary,
        filter: Option<&FilterResults>,
        probability: Option<f64>,
        all: bool,
    ) -> Vec<String> {
        let mut lines = Vec::new();
        if all {
            lines.extend(filter.and_then(|filter| bounds(&filter.over_bound)));
            let quality = quality(summary, filter.is_some()).into_iter();
            lines.extend(quality.map(|(name, value)| format!("  {name:<16}{value}")));
            let probability = probability.map(ModelClasses::in_percent);
            lines.extend(probability.map(|p| format!("  probability     {p} among these models")));
        }
        let remarks = filter.into_iter().flat_map(|filter| remarks(&filter.remarks, &self.record));
        lines.extend(remarks.take(if all { usize::MAX } else { 1 }).map(|line| format!("  {line}")));
        lines.extend(stop(summary, &self.record).map(|line| format!("  {line}")));
        lines
    }

    /// The rows of all channels, or of at most this many, one each, parameters first and without errors.
    fn rows(&self, summary: &Summary, most: Option<usize>) -> Vec<[String; COLUMNS]> {
        let mapping = self.scenario.record.as_ref();
        let Some(most) = most else { return summary.finals.iter().flat_map(|last| rows(last, mapping)).collect() };
        let mut finals: Vec<_> = summary.finals.iter().collect();
        finals.sort_by_key(|last| !last.channel.is_parameter());
        finals.into_iter().take(most.min(FEW)).map(|last| brief(rows(last, mapping))).collect()
    }
}

/// Limits the lines of a filter, and the rows of estimates among them.
const MOST: usize = 10;
const FEW: usize = 4;

pub(crate) const NO_VERDICT: &str = "no verdict: fewer than 20 measurements";

/// The samples of a record, its sensors, and where it ends if that is early.
pub(crate) fn origin(record: &Record, truth_stop: Option<TruthStop>) -> Vec<String> {
    let (start, end) = (record.time(0), record.time(record.len().saturating_sub(1)));
    let [start, end, dt] = [start, end, record.dt()].map(plain);
    let sensors: Vec<String> = record.sensors().iter().map(|sensor| sensor.name()).collect();
    let sensors = if sensors.is_empty() { "nothing".to_owned() } else { sensors.join(", ") };
    let mut lines = vec![
        format!("{} samples from {start} s to {end} s, {dt} s apart", record.len()),
        format!("measured: {sensors}"),
    ];
    let stop = truth_stop.map(|stop| format!("the record ends before sample {}: {}", stop.sample, stop.reason));
    lines.extend(stop);
    lines
}

/// The sample at which a filter stopped, and why.
pub(crate) fn stop(summary: &Summary, record: &Record) -> Option<String> {
    let stop = summary.stop?;
    Some(format!("stopped at sample {} ({} s): {}", stop.sample, plain(record.time_of(stop.sample)), stop.reason))
}

/// The rows of a channel as one, with the number in another unit behind its own and without errors.
fn brief(rows: Vec<[String; COLUMNS]>) -> [String; COLUMNS] {
    let mut rows = rows.into_iter();
    let mut row = rows.next().unwrap_or_default();
    row[5..].iter_mut().for_each(String::clear);
    if let Some([symbol, name, value, spread, unit, ..]) = rows.next() {
        let name = if symbol.is_empty() { name } else { symbol };
        row[4].push_str(format!(" ({name} {value} ± {spread} {unit}").trim_end());
        row[4].push(')');
    }
    row
}

fn bounds(over_bound: &[(Channel, f64)]) -> Option<String> {
    let ratios = over_bound.iter().map(|(channel, ratio)| format!("{} {}", channel.symbol(), short(*ratio)));
    let ratios: Vec<String> = ratios.collect();
    (!ratios.is_empty()).then(|| format!("  σ over bound    {}", ratios.join(", ")))
}

pub(crate) fn heading(name: &str, kind: FilterKind) -> String {
    // A line break in a name would break the table.
    let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    match name.trim() {
        "" => kind.name().to_owned(),
        name if name.split(|c: char| !(c.is_alphanumeric() || c == '-')).any(|word| word == kind.name()) => {
            name.to_owned()
        }
        name => format!("{name} ({})", kind.name()),
    }
}

const LABELS: [&str; COLUMNS] = ["", "", "", "±", "", "error", "", "RMSE", "last third", "inside", "settled"];

/// Aligns numbers to the right of their column and words to the left; leaves out columns that are empty in every row.
fn write_row(text: &mut String, row: &[String; COLUMNS], widths: &[usize; COLUMNS]) -> fmt::Result {
    let mut line = " ".to_owned();
    for (i, ((cell, &width), label)) in row.iter().zip(widths).zip(LABELS).enumerate() {
        let label = if cell.is_empty() { " ".repeat(label.len()) } else { label.to_owned() };
        match i {
            _ if width == 0 => {}
            0 | 1 | 4 | 6 => write!(line, " {cell:width$}")?,
            3 => write!(line, " {label} {cell:width$}")?,
            5 | 7.. => write!(line, "  {label} {cell:>width$}")?,
            _ => write!(line, "  {cell:>width$}")?,
        }
    }
    writeln!(text, "{}", line.trim_end())
}

fn width(text: &str) -> usize {
    // `format!` pads by characters, and ωₙ has more bytes than characters.
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_stay_on_one_line() {
        assert_eq!(heading("EKF", FilterKind::EKF), "EKF");
        assert_eq!(heading("EKF, no 2", FilterKind::EKF), "EKF, no 2");
        assert_eq!(heading("robust", FilterKind::UKF), "robust (UKF)");
        assert_eq!(heading("two\nlines", FilterKind::KF), "two lines (KF)");
        assert_eq!(heading(" \t ", FilterKind::KF), "KF");
    }
}
