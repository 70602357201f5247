//! Keeps the results of several records: those of the user, and those from other people's links.

use std::fmt::Write as _;

use kalmanscope_cli::harmless;
use kalmanscope_core::{Channel, VerdictKind};
use kalmanscope_lab::{Estimated, Trial};

use super::table::quoted;
use crate::session::Session;

/// A table of trials.
#[derive(Debug, Default)]
pub struct Trials {
    rows: Vec<Trial>,
    /// The rows from before some were removed.
    earlier: Option<Vec<Trial>>,
}

impl Trials {
    /// A table of some rows.
    pub fn of(rows: Vec<Trial>) -> Self {
        Self { rows, earlier: None }
    }

    /// Whether rows from outside are possible.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn check(rows: &[Trial]) -> Result<(), String> {
        if rows.len() > Trial::MOST {
            return Err(format!("it has {} trials, but must have at most {}", rows.len(), Trial::MOST));
        }
        rows.iter().try_for_each(Trial::check)
    }

    /// The rows, in their order.
    pub fn rows(&self) -> &[Trial] {
        &self.rows
    }

    /// Keeps other rows. If there are fewer than before, the earlier ones can be restored.
    pub fn keep(&mut self, mut rows: Vec<Trial>) {
        rows.truncate(Trial::MOST);
        if rows.len() != self.rows.len() {
            self.earlier = (rows.len() < self.rows.len()).then(|| std::mem::take(&mut self.rows));
        }
        self.rows = rows;
    }

    /// Adds the rows that are not there yet, as long as there is room. Returns their number.
    pub fn add(&mut self, rows: Vec<Trial>) -> usize {
        let before = self.rows.len();
        for row in rows {
            if self.rows.len() < Trial::MOST && !self.rows.contains(&row) {
                self.rows.push(row);
            }
        }
        self.rows.len() - before
    }

    /// Whether rows have been removed that can be restored.
    pub fn can_restore(&self) -> bool {
        self.earlier.is_some()
    }

    /// Restores the rows from before some were removed.
    pub fn restore(&mut self) {
        if let Some(earlier) = self.earlier.take() {
            self.rows = earlier;
        }
    }

    /// One row for each trial; a column that ends in `2sigma` is the half width of a band.
    pub fn to_csv(&self) -> String {
        let names = "name,mass_kg,natural_frequency_hz,natural_frequency_hz_2sigma,period_s,period_s_2sigma,damping_ratio,damping_ratio_2sigma,believed";
        let mut text = format!("{names}\n");
        for trial in &self.rows {
            // Writing to a string cannot fail. Names come from other people's links.
            let _ = write!(text, "{},{}", quoted(&harmless(&trial.name)), trial.mass);
            for number in [trial.hertz(), trial.period(), trial.damping] {
                let _ = write!(text, ",{},{}", short(number.mean), short(number.band()));
            }
            text.push_str(if trial.is_believed { ",yes\n" } else { ",no\n" });
        }
        text
    }
}

/// A number to nine digits, which are enough for a band and keep links short.
fn short(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

/// The estimates of ωₙ and ζ of the run so far. They are of the first filter with a good verdict, else of the first one that has
/// not lost them.
///
/// # Errors
/// The reason why there is nothing to keep, as a part of a sentence.
pub fn trial_of(session: &Session) -> Result<Trial, String> {
    let mut reason = "no filter estimates a natural frequency and a damping ratio".to_owned();
    let mut found: Option<Trial> = None;
    for (place, estimates) in session.run().estimates().iter().enumerate() {
        let of = |channel: Channel| {
            let (at, last) = (estimates.place(channel)?, estimates.len().checked_sub(1)?);
            let (mean, std) = (estimates.canonical_mean(last, at), estimates.std(last, at));
            Some(Estimated { mean: short(mean), std: short(std) })
        };
        let Some((frequency, damping)) = of(Channel::NATURAL_FREQUENCY).zip(of(Channel::DAMPING_RATIO)) else {
            continue;
        };
        let verdict = session.diagnosis(place).and_then(|diagnosis| diagnosis.verdict.as_ref());
        let kind = verdict.map(|verdict| verdict.kind);
        if estimates.stop().is_some() || matches!(kind, Some(VerdictKind::Lost | VerdictKind::Diverged)) {
            reason = format!("{} is lost", estimates.name());
            continue;
        }
        let is_believed = kind.is_some_and(|kind| kind.is_good() || kind == VerdictKind::Underconfident);
        let trial = Trial { name: String::new(), mass: 0.0, frequency, damping, is_believed };
        if let Err(problem) = trial.check() {
            reason = problem;
        } else if is_believed || found.is_none() {
            found = Some(trial);
            if is_believed {
                break;
            }
        }
    }
    found.ok_or(reason)
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use super::*;
    use crate::laboratory::{Choices, Laboratory};
    use crate::session::Budget;
    use crate::team::Frames;

    fn trial(name: &str, frequency: f64) -> Trial {
        let of = |mean: f64, std: f64| Estimated { mean, std };
        Trial {
            name: name.to_owned(),
            mass: 0.05,
            frequency: of(frequency, 0.01 * frequency),
            damping: of(0.01, 0.001),
            is_believed: true,
        }
    }

    #[test]
    fn a_table_quotes_names_and_has_bands() {
        let turn = std::f64::consts::TAU;
        let named = Trial { is_believed: false, ..trial("Ann \"A\", 2", turn) };
        let text = Trials::of(vec![named, trial("=1+1", 0.5 * turn)]).to_csv();
        let rows: Vec<&str> = text.lines().skip(1).collect();
        assert_eq!(
            rows,
            ["\"Ann \"\"A\"\", 2\",0.05,1,0.02,1,0.02,0.01,0.002,no", "'=1+1,0.05,0.5,0.01,2,0.04,0.01,0.002,yes"]
        );
    }

    #[test]
    fn removed_rows_come_back_and_others_are_added_once() {
        let mut trials = Trials::of(vec![trial("a", 1.0), trial("b", 2.0)]);
        assert_eq!(trials.add(vec![trial("b", 2.0), trial("c", 3.0)]), 1);
        trials.keep(vec![trial("c", 3.0)]);
        assert!(trials.can_restore());
        trials.keep(vec![trial("d", 3.0)]);
        trials.restore();
        assert_eq!((trials.rows().len(), trials.can_restore()), (3, false));
        let many: Vec<Trial> = (1..=300).map(|i| trial("many", f64::from(i))).collect();
        assert!(Trials::check(&many).is_err());
        trials.add(many);
        assert_eq!(trials.rows().len(), Trial::MOST);
    }

    #[test]
    fn a_link_or_a_session_adds_trials_and_replaces_none() {
        let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Unlimited)));
        laboratory.trials_mut().add(vec![trial("mine", 1.0)]);
        laboratory.restore(Choices::default());
        laboratory.restore(Choices { trials: vec![trial("hers", 2.0)], ..Choices::default() });
        let names: Vec<&str> = laboratory.trials().rows().iter().map(|trial| &*trial.name).collect();
        assert_eq!(names, ["mine", "hers"]);
    }
}
