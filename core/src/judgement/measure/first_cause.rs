//! The first cause of a bad verdict, as a number.

use crate::judgement::diagnosis::{CAUSES, Search};
use crate::{Diagnosis, Diagnostics, Estimates, Record, Scenario, Task};

/// A search for the causes of the verdict on a filter, of which the first one counts. It takes up to seconds.
pub struct FirstCause(Option<Box<Search>>);

impl FirstCause {
    /// Before a search. There is none where the verdict is good or not known.
    pub fn new(scenario: &Scenario, place: usize, estimates: &Estimates, record: &Record) -> Self {
        Self::with(scenario, place, (&Diagnostics::new(estimates, record), estimates), record)
    }

    pub(super) fn with(
        scenario: &Scenario,
        place: usize,
        (diagnostics, estimates): (&Diagnostics, &Estimates),
        record: &Record,
    ) -> Self {
        let diagnosis = Diagnosis::new(diagnostics, estimates, record, None);
        let is_bad = |diagnosis: &Diagnosis| diagnosis.verdict.as_ref().is_some_and(|verdict| !verdict.kind.is_good());
        let diagnosis = diagnosis.filter(is_bad);
        let search = diagnosis.and_then(|one| one.search(scenario, place, diagnostics, estimates, record).ok());
        Self(search.map(Box::new))
    }
}

impl Task for FirstCause {
    /// The place of the cause in [`CAUSES`]; `None` where there is none.
    type Outcome = Option<usize>;

    fn progress(&self) -> f64 {
        self.0.as_ref().map_or(1.0, |search| search.progress())
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        self.0.as_mut().is_none_or(|search| search.advance(while_time))
    }

    fn finish(self) -> Option<usize> {
        let remedies = self.0?.finish();
        let key = remedies.first()?.first.cause.key;
        CAUSES.iter().position(|cause| cause.key == key)
    }
}
