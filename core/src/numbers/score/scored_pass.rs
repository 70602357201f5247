//! A filter's run over a record of which scores alone remain, in portions.

use super::{Look, Outcome, Scores};
use crate::{Pass, Record, RunError, Scenario};

/// A filter's run over a record, as far as it has come. The outcome does not depend on how the work is divided.
pub struct ScoredPass {
    pass: Pass,
    scores: Scores,
    /// The samples at which to look at the filter, in order.
    samples: Vec<usize>,
    looks: Vec<Look>,
}

impl ScoredPass {
    /// The filter at `place` of a scenario before the first sample of a record, to be looked at after these samples, which are in
    /// order.
    ///
    /// # Errors
    /// Those of [`Pass::new`].
    pub fn new(scenario: &Scenario, place: usize, record: &Record, samples: &[usize]) -> Result<Self, RunError> {
        let scores = Scores::new(&Pass::history(scenario, place)?, record);
        let pass = Pass::new(scenario, place, record)?;
        Ok(Self { pass, scores, samples: samples.to_vec(), looks: Vec::new() })
    }

    /// The number of samples done, counted from the record's beginning.
    pub fn done(&self) -> usize {
        self.pass.done()
    }

    /// Goes on until `samples` samples, counted from the record's beginning, are done, or to the end of the record, which is the
    /// same in all calls. Returns whether the end is reached.
    pub fn advance(&mut self, record: &Record, samples: usize) -> bool {
        let Self { pass, scores, samples: asked, looks } = self;
        while let Some(&sample) = asked.get(looks.len()).filter(|sample| **sample < samples) {
            pass.follow(record, sample.saturating_add(1), &mut scores.against(record));
            if scores.len() != sample.saturating_add(1) {
                // The filter has stopped, or the record has ended.
                asked.truncate(looks.len());
                break;
            }
            looks.push(scores.look());
        }
        pass.follow(record, samples, &mut scores.against(record));
        pass.done() >= record.forgotten() + record.len()
    }

    /// The outcome so far.
    pub fn outcome(self) -> Outcome {
        Outcome { looks: self.looks, ..self.scores.outcome() }
    }
}

impl Outcome {
    /// Runs the filter at `place` of a scenario over the whole of a record.
    ///
    /// ```
    /// use kalmanscope_core::score::Outcome;
    /// use kalmanscope_core::{Run, Scenario};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scenario = Scenario { duration: 5.0, ..Scenario::default() };
    /// let mut run = Run::new(&scenario)?;
    /// run.finish();
    /// let outcome = Outcome::of(&scenario, 0, run.record())?;
    /// assert_eq!(outcome.mean, run.estimates()[0].mean(500));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Those of [`Pass::new`](crate::Pass::new).
    pub fn of(scenario: &Scenario, place: usize, record: &Record) -> Result<Self, RunError> {
        Self::at(scenario, place, record, &[])
    }

    /// [`Self::of`], with a look at the filter at each of these samples, which are in order.
    ///
    /// # Errors
    /// Those of [`Pass::new`](crate::Pass::new).
    pub fn at(scenario: &Scenario, place: usize, record: &Record, samples: &[usize]) -> Result<Self, RunError> {
        let mut pass = ScoredPass::new(scenario, place, record, samples)?;
        pass.advance(record, usize::MAX);
        Ok(pass.outcome())
    }
}
