//! Work of an import: in a worker or thread, or in slices of the frames.

use kalmanscope_core::Task;

use crate::elsewhere::{Report, Work};

/// Work with an outcome. A worker or thread does it; if that fails, it starts again in slices of the frames.
pub(super) struct Running<H: Task, T> {
    here: Option<H>,
    /// Converts the outcome to the form in which a worker sends it.
    outcome: fn(H::Outcome) -> T,
    there: Option<Box<dyn Work<Report<T>>>>,
    share: f64,
}

impl<H: Task, T> Running<H, T> {
    /// Work that can be done here, and that a worker or thread may have begun.
    pub(super) fn new(here: H, outcome: fn(H::Outcome) -> T, there: Option<Box<dyn Work<Report<T>>>>) -> Self {
        Self { here: Some(here), outcome, there, share: 0.0 }
    }

    /// Whether frames only show its progress.
    pub(super) fn is_elsewhere(&self) -> bool {
        self.there.is_some()
    }

    /// The share that is done, from 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        self.share
    }

    /// Goes on until `while_time` returns false. Returns the outcome once.
    pub(super) fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Option<T> {
        while let Some(there) = &mut self.there {
            match there.next() {
                Ok(Some(Report::Share(share))) => self.share = share,
                Ok(Some(Report::Done(outcome))) => {
                    (self.here, self.there) = (None, None);
                    return Some(outcome);
                }
                Ok(None) => return None,
                Err(_) => self.there = None,
            }
        }
        let here = self.here.as_mut()?;
        let is_done = here.advance(while_time);
        self.share = here.progress();
        if is_done { self.here.take().map(|here| (self.outcome)(here.finish())) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::import::{ImportError, Loaded, Loading};

    use super::*;
    use crate::elsewhere::Lost;

    type Outcome = Result<Loaded, ImportError>;

    /// Sends what it is given, then fails.
    struct Fake(Vec<Option<Report<Outcome>>>);

    impl Work<Report<Outcome>> for Fake {
        fn next(&mut self) -> Result<Option<Report<Outcome>>, Lost> {
            if self.0.is_empty() { Err(Lost) } else { Ok(self.0.remove(0)) }
        }
    }

    fn file() -> Loading {
        Loading::new(b"t,x\n0,1\n0.1,2\n".to_vec())
    }

    /// Frames until the outcome, with the share that each of them shows.
    fn frames(there: Option<Vec<Option<Report<Outcome>>>>) -> (Vec<f64>, Outcome) {
        let there = there.map(|reports| Box::new(Fake(reports)) as Box<dyn Work<Report<Outcome>>>);
        let mut task = Running::new(file(), |outcome| outcome, there);
        let mut shares = vec![task.progress()];
        loop {
            if let Some(outcome) = task.advance(&mut || false) {
                assert!(task.advance(&mut || true).is_none(), "once");
                return (shares, outcome);
            }
            shares.push(task.progress());
        }
    }

    #[test]
    fn the_outcome_comes_from_elsewhere() {
        let there = vec![Some(Report::Share(0.25)), None, None, Some(Report::Share(0.5)), None];
        let there = there.into_iter().chain([Some(Report::Done(Err(ImportError::Matlab)))]).collect();
        let (shares, outcome) = frames(Some(there));
        assert_eq!(shares, [0.0, 0.25, 0.25, 0.5]);
        assert_eq!(outcome.unwrap_err().to_string(), ImportError::Matlab.to_string());
    }

    #[test]
    fn work_that_is_lost_is_done_here_from_its_beginning() {
        let whole = file().finish().unwrap();
        for there in [None, Some(vec![]), Some(vec![Some(Report::Share(0.9)), None])] {
            let (shares, outcome) = frames(there);
            assert_eq!(outcome.unwrap(), whole);
            assert!(shares.len() > 1);
        }
    }
}
