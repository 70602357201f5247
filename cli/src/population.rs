//! The command `kalmanscope-cli population`: what becomes of the filters of many members of a population.

use std::fmt::{self, Write as _};
use std::sync::Arc;

use kalmanscope_cli::significant;
use kalmanscope_core::document::{self, Document, DocumentError, json};
use kalmanscope_core::{Channel, Scenario, Source};
use kalmanscope_diagnosis::CAUSES;
use kalmanscope_diagnosis::VerdictKind;
use kalmanscope_lab::{LastError, MonteCarlo, RunVerdicts, Runner, share_interval};

use crate::args::PopulationArgs;
use crate::files::{InputError, print};
use crate::prepared::scenario_and_record;
use crate::sweep::{filters, run_in_order};

struct MemberRuns {
    runner: Arc<Runner>,
    statistics: MonteCarlo,
}

pub(crate) fn population(args: &PopulationArgs) -> Result<(), InputError> {
    let PopulationArgs { input, members, filter, causes, json, threads, quiet } = args;
    let bad = |reason: &dyn ToString| InputError::bad(&input.scenario, reason);
    let (mut scenario, imported) = scenario_and_record(input, &Vec::new())?;
    // Draws name filters by their ids.
    scenario.number_filters();
    let places = filters(&scenario, filter).map_err(|reason| bad(&reason))?;
    scenario.filters = places.iter().filter_map(|&place| scenario.filters.get(place).cloned()).collect();
    // A draw of a filter that does not run would name nothing.
    scenario.keep_draws();
    let source = imported.map_or(Source::Simulated, |imported| Source::Measured(Arc::new(imported.record)));
    let all = (0..scenario.filters.len()).collect();
    let judged = if *causes { RunVerdicts::Causes } else { RunVerdicts::Verdicts };
    let ensemble = MonteCarlo::ensemble(scenario, all, *members as usize, 0, judged);
    let runner = ensemble.and_then(|ensemble| Runner::new(ensemble, source)).map_err(|error| bad(&error))?;
    let runner = Arc::new(runner);
    let mut statistics = MonteCarlo::new(runner.ensemble());
    // Sums in the order of the seeds have the same bits on any number of threads.
    run_in_order(&runner, 0..runner.ensemble().cells(), *threads, (*quiet || *json, "members"), &mut |slice| {
        statistics.take(runner.ensemble(), slice);
        Ok(())
    })
    .map_err(|error| bad(&error))?;
    let population = MemberRuns { runner: Arc::clone(&runner), statistics };
    print(&if *json { population.json().map_err(|error| bad(&error))? } else { population.text() })
}

const NEAR: f64 = 0.01;

#[derive(Clone, Copy)]
struct Share {
    count: usize,
    of: usize,
}

impl MemberRuns {
    fn scenario(&self) -> &Scenario {
        self.runner.ensemble().scenario()
    }

    fn parameters(&self, nth: usize) -> impl Iterator<Item = (Channel, &[LastError])> {
        let channels = self.statistics.channels(nth).iter().enumerate();
        channels.filter(|(_, channel)| channel.is_parameter() || channel.is_augmentation()).filter_map(
            move |(place, &channel)| {
                let errors = self.statistics.last_errors(nth, place);
                (!errors.is_empty()).then_some((channel, errors))
            },
        )
    }

    fn lost(&self, nth: usize) -> [Share; 2] {
        let of = self.statistics.runs();
        self.statistics.diverged(nth).map(|share| Share { count: (share * of as f64).round() as usize, of })
    }

    /// The shares of the members in which a filter is lost, near the truth, sure of it, and has a verdict: key, words and share.
    fn shares(&self, nth: usize) -> Vec<(String, String, Share)> {
        let [lost, stopped] = self.lost(nth);
        let mut shares = vec![
            ("lost".to_owned(), "lost the truth, or stopped".to_owned(), lost),
            ("stopped".to_owned(), "of these, stopped".to_owned(), stopped),
        ];
        for (channel, errors) in self.parameters(nth) {
            let (key, symbol) = (channel.key(), channel.symbol());
            let count = |is: fn(&LastError) -> bool| Share {
                count: errors.iter().filter(|last| is(last)).count(),
                of: errors.len(),
            };
            if channel.is_parameter() {
                let near = count(|last| last.is_within(NEAR));
                shares.push((format!("{key}.within_1_percent"), format!("{symbol} within 1 % at the end"), near));
            }
            let covered = count(LastError::is_covered);
            shares.push((format!("{key}.inside_2_sigma"), format!("{symbol} inside ±2σ at the end"), covered));
        }
        let counts = self.statistics.verdicts(nth);
        let of = counts.iter().sum();
        for (kind, &count) in VerdictKind::ALL.into_iter().zip(counts).filter(|(_, count)| **count > 0) {
            let share = Share { count, of };
            shares.push((format!("verdict.{}", kind.key()), format!("verdict: {}", kind.name()), share));
        }
        shares
    }

    /// The bad verdicts on a filter, and their first causes, the commonest first.
    fn causes(&self, nth: usize) -> (usize, Vec<(&'static str, usize)>) {
        let (counts, none) = self.statistics.causes(nth);
        let named = CAUSES.iter().zip(counts).map(|(cause, count)| (cause.name, *count));
        let mut causes: Vec<_> = named.chain([("no cause found", none)]).filter(|(_, count)| *count > 0).collect();
        causes.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        (causes.iter().map(|(_, count)| count).sum(), causes)
    }

    fn text(&self) -> String {
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
            some => writeln!(text, "; {some} are impossible scenarios and were left out")?,
        }
        if scenario.draw.is_empty() {
            writeln!(text, "only the noise differs: the scenario has no [draw]")?;
        }
        for (key, law) in &scenario.draw {
            let [a, b] = law.numbers().map(|number| significant(number, 6, 9));
            let [what, other] = law.info().numbers;
            writeln!(text, "drawn: {}, {}: {what} {a}, {other} {b}", scenario.address_by_name(key), law.info().name)?;
        }
        for (nth, filter) in scenario.filters.iter().enumerate() {
            writeln!(text, "\n{}", filter.name)?;
            self.shares(nth).iter().try_for_each(|(_, words, share)| line(text, words, *share))?;
            let (bad, causes) = self.causes(nth);
            if !causes.is_empty() {
                writeln!(text, "  first causes of the {bad} bad verdicts")?;
                let share = |count| Share { count, of: bad };
                causes.iter().try_for_each(|(name, count)| line(text, name, share(*count)))?;
            }
        }
        Ok(())
    }

    /// The numbers as JSON:
    ///
    /// ```text
    /// members, impossible, drawn: [{ key, law, numbers }]
    /// filters: [{ name, shares: { key: from 0 to 1 }, rmse: { channel: at the end }, causes: [{ name, first }] }]
    /// ```
    fn json(&self) -> Result<String, DocumentError> {
        let scenario = self.scenario();
        let drawn = scenario.draw.iter().map(|(key, law)| {
            json!({ "key": scenario.address_by_name(key), "law": law.info().key, "numbers": law.numbers() })
        });
        let filters = scenario.filters.iter().enumerate().map(|(nth, filter)| {
            let shares =
                self.shares(nth).into_iter().map(|(key, _, share)| (key, share.count as f64 / share.of as f64));
            let rmse = self.parameters(nth).map(|(channel, errors)| {
                let squares = errors.iter().map(|last| last.error * last.error).sum::<f64>();
                (channel.key(), (squares / errors.len() as f64).sqrt())
            });
            let (_, causes) = self.causes(nth);
            let causes = causes.into_iter().map(|(name, first)| json!({ "name": name, "first": first }));
            json!({
                "name": filter.name,
                "shares": Document::from_iter(shares),
                "rmse": Document::from_iter(rmse),
                "causes": Document::from_iter(causes),
            })
        });
        let text = document::to_json_lines(&json!({
            "members": self.statistics.done(),
            "impossible": self.statistics.impossible(),
            "drawn": Document::from_iter(drawn),
            "filters": Document::from_iter(filters),
        }))?;
        Ok(text + "\n")
    }
}

fn line(text: &mut String, name: &str, Share { count, of }: Share) -> fmt::Result {
    if of == 0 {
        return writeln!(text, "  {name:<42}     –");
    }
    let [low, high] = share_interval(count, of);
    let share = 100.0 * count as f64 / of as f64;
    writeln!(text, "  {name:<42}{share:>6.1} %   ({:.1} to {:.1})", 100.0 * low, 100.0 * high)
}
