//! The results of a population, for people and for programs.

use std::fmt::{self, Write as _};

use kalmanscope_cli::significant;
use kalmanscope_core::{Channel, Document, DocumentError, Scenario, VerdictKind};
use kalmanscope_lab::{LastError, share_interval};

use super::Population;

/// The share of the truth within which a parameter counts as identified.
const NEAR: f64 = 0.01;

/// A part of the members.
#[derive(Clone, Copy)]
struct Share {
    count: usize,
    of: usize,
}

impl Population {
    fn scenario(&self) -> &Scenario {
        self.runner.ensemble().scenario()
    }

    /// The channels of the `nth` filter that do not move by themselves, with their last errors.
    fn parameters(&self, nth: usize) -> impl Iterator<Item = (Channel, &[LastError])> {
        let channels = self.statistics.channels(nth).iter().enumerate();
        channels.filter(|(_, channel)| channel.is_parameter() || channel.is_augmentation()).filter_map(
            move |(place, &channel)| {
                let errors = self.statistics.last_errors(nth, place);
                (!errors.is_empty()).then_some((channel, errors))
            },
        )
    }

    /// Lost and stopped runs of the `nth` filter.
    fn lost(&self, nth: usize) -> [Share; 2] {
        let of = self.statistics.runs();
        self.statistics.diverged(nth).map(|share| Share { count: (share * of as f64).round() as usize, of })
    }

    /// The runs of the `nth` filter with each verdict that occurs.
    fn verdicts(&self, nth: usize) -> impl Iterator<Item = (VerdictKind, Share)> {
        let of = self.statistics.verdicts(nth).iter().sum();
        let counts = VerdictKind::ALL.into_iter().zip(self.statistics.verdicts(nth));
        counts.filter(|(_, count)| **count > 0).map(move |(kind, &count)| (kind, Share { count, of }))
    }

    /// The shares with their 95 % intervals, as text.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, text: &mut String) -> fmt::Result {
        let scenario = self.scenario();
        let (done, impossible) = (self.statistics.done(), self.statistics.impossible());
        write!(text, "{done} members")?;
        match impossible {
            0 => writeln!(text)?,
            some => writeln!(text, ", {some} of which are impossible scenarios and left out")?,
        }
        if scenario.draw.is_empty() {
            writeln!(text, "nothing is drawn but the noise: the scenario has no [draw]")?;
        }
        for (key, law) in &scenario.draw {
            let [a, b] = law.numbers().map(|number| significant(number, 6, 9));
            let [what, other] = law.info().numbers;
            writeln!(text, "drawn: {}, {}: {what} {a}, {other} {b}", scenario.address_by_name(key), law.info().name)?;
        }
        for (nth, filter) in scenario.filters.iter().enumerate() {
            writeln!(text, "\n{}", filter.name)?;
            let [lost, stopped] = self.lost(nth);
            line(text, "lost the truth, or stopped", lost)?;
            if stopped.count > 0 {
                line(text, "of these stopped", stopped)?;
            }
            for (channel, errors) in self.parameters(nth) {
                if channel.is_parameter() {
                    line(text, &format!("{} within 1 % at the end", channel.symbol()), near(errors))?;
                }
                line(text, &format!("{} inside ±2σ at the end", channel.symbol()), covered(errors))?;
            }
            for (kind, share) in self.verdicts(nth) {
                line(text, &format!("verdict: {}", kind.name()), share)?;
            }
            if let Some(causes) = self.causes.as_ref().and_then(|causes| causes.get(nth)).filter(|one| one.bad > 0) {
                writeln!(text, "  causes of the {} bad verdicts: as the first, and among the first two", causes.bad)?;
                for (name, [first, among]) in &causes.named {
                    let [first, among] = [*first, *among].map(|count| 100.0 * count as f64 / causes.bad as f64);
                    writeln!(text, "  {name:<42}{first:>6.1} % {among:>6.1} %")?;
                }
                let said = 100.0 * causes.said / causes.bad as f64;
                writeln!(text, "  {:<42}{said:>6.1} %", "mean probability of the first cause")?;
                line(text, "no cause", Share { count: causes.none, of: causes.bad })?;
                line(text, "not explained by the first cause", Share { count: causes.unexplained, of: causes.bad })?;
            }
        }
        Ok(())
    }

    /// The same numbers as JSON:
    ///
    /// ```text
    /// members, impossible, drawn: [{ key, law, numbers }]
    /// filters: [{ name, lost, stopped, parameters: [{ channel, within_1_percent, inside_2_sigma, rmse }],
    ///             verdicts: [{ kind, members }], causes: [{ name, first, among_first_two }], mean_probability,
    ///             unexplained }]
    /// ```
    pub(super) fn json(&self) -> Result<String, DocumentError> {
        let scenario = self.scenario();
        let drawn = scenario.draw.iter().map(|(key, law)| {
            Document::of_entries([
                ("key", scenario.address_by_name(key).as_str().into()),
                ("law", law.info().key.into()),
                ("numbers", Document::List(law.numbers().map(Document::Number).to_vec())),
            ])
        });
        let filters = scenario.filters.iter().enumerate().map(|(nth, filter)| {
            let [lost, stopped] = self.lost(nth);
            let parameters = self.parameters(nth).map(|(channel, errors)| {
                let squares = errors.iter().map(|last| last.error * last.error).sum::<f64>();
                Document::of_entries([
                    ("channel", channel.key().into()),
                    ("within_1_percent", near(errors).number()),
                    ("inside_2_sigma", covered(errors).number()),
                    ("rmse", Document::Number((squares / errors.len() as f64).sqrt())),
                ])
            });
            let verdicts = self.verdicts(nth).map(|(kind, share)| {
                Document::of_entries([("kind", kind.name().into()), ("members", number(share.count))])
            });
            let causes = self.causes.as_ref().and_then(|causes| causes.get(nth));
            let named = causes.into_iter().flat_map(|causes| &causes.named).map(|(name, [first, among])| {
                Document::of_entries([
                    ("name", (*name).into()),
                    ("first", number(*first)),
                    ("among_first_two", number(*among)),
                ])
            });
            let said = causes.filter(|causes| causes.bad > 0);
            let said = said.map_or(Document::Null, |causes| Document::Number(causes.said / causes.bad as f64));
            let unexplained = causes.map_or(Document::Null, |causes| number(causes.unexplained));
            Document::of_entries([
                ("name", filter.name.as_str().into()),
                ("lost", lost.number()),
                ("stopped", stopped.number()),
                ("parameters", Document::List(parameters.collect())),
                ("verdicts", Document::List(verdicts.collect())),
                ("causes", Document::List(named.collect())),
                ("mean_probability", said),
                ("unexplained", unexplained),
            ])
        });
        let text = Document::json_lines(&Document::of_entries([
            ("members", number(self.statistics.done())),
            ("impossible", number(self.statistics.impossible())),
            ("drawn", Document::List(drawn.collect())),
            ("filters", Document::List(filters.collect())),
        ]))?;
        Ok(text + "\n")
    }
}

impl Share {
    fn number(self) -> Document {
        Document::Number(self.count as f64 / self.of as f64)
    }
}

fn near(errors: &[LastError]) -> Share {
    Share { count: errors.iter().filter(|last| last.is_within(NEAR)).count(), of: errors.len() }
}

fn covered(errors: &[LastError]) -> Share {
    Share { count: errors.iter().filter(|last| last.is_covered()).count(), of: errors.len() }
}

fn number(count: usize) -> Document {
    i64::try_from(count).map_or(Document::Null, Document::Integer)
}

/// A share with its 95 % interval.
fn line(text: &mut String, name: &str, Share { count, of }: Share) -> fmt::Result {
    if of == 0 {
        return writeln!(text, "  {name:<42}     –");
    }
    let [low, high] = share_interval(count, of);
    let share = 100.0 * count as f64 / of as f64;
    writeln!(text, "  {name:<42}{share:>6.1} %   ({:.1} to {:.1})", 100.0 * low, 100.0 * high)
}
