//! A task under way: beside the frames, or in slices of them.

use kalmanscope_core::Task;

use super::{Handle, Lost, Priority, Report, Team, waking};

/// A task under way, and what is seen of it. A team does it if it can, else the frames do.
pub struct Running<T: Task, L = f64> {
    here: Option<T>,
    there: Option<Handle<Report<L, T::Outcome>>>,
    look: fn(&T) -> L,
    seen: L,
}

impl<T: Task, L> Running<T, L> {
    /// A task in the frames, of which `look` sees something, such as its progress.
    pub fn here(task: T, look: fn(&T) -> L) -> Self {
        Self { seen: look(&task), here: Some(task), there: None, look }
    }

    /// The same that workers may have begun. If they fail, it begins again in the frames.
    pub fn in_workers(self, there: Option<Handle<Report<L, T::Outcome>>>) -> Self {
        Self { there, ..self }
    }

    /// A task on a thread of the team, or in the frames where there are no threads.
    pub fn begin(team: &dyn Team, priority: Priority, task: T, look: fn(&T) -> L) -> Self
    where
        T: Send + 'static,
        T::Outcome: Send,
        L: Send + 'static,
    {
        // A page has no threads.
        match team.threads().filter(|_| cfg!(not(target_arch = "wasm32"))) {
            Some((threads, ctx)) => {
                let seen = look(&task);
                let there = threads.task(priority, task, look, waking(ctx)).into();
                Self { here: None, there: Some(there), look, seen }
            }
            None => Self::here(task, look),
        }
    }

    /// Whether frames only show its progress.
    pub fn is_beside(&self) -> bool {
        self.there.is_some()
    }

    /// What `look` has returned last.
    pub fn seen(&self) -> &L {
        &self.seen
    }

    /// Goes on until `while_time` returns false. Returns the outcome once.
    ///
    /// # Errors
    /// [`Lost`] if its thread has failed.
    pub fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Result<Option<T::Outcome>, Lost> {
        while let Some(there) = &mut self.there {
            match there.take() {
                Ok(Some(Report::Look(seen))) => self.seen = seen,
                Ok(Some(Report::Done(outcome))) => {
                    (self.here, self.there) = (None, None);
                    return Ok(Some(outcome));
                }
                Ok(None) => return Ok(None),
                Err(Lost) if self.here.is_none() => return Err(Lost),
                Err(Lost) => self.there = None,
            }
        }
        let Some(here) = &mut self.here else { return Ok(None) };
        let is_done = here.advance(while_time);
        self.seen = (self.look)(here);
        Ok(if is_done { self.here.take().map(Task::finish) } else { None })
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::import::{ImportError, Loaded, Loading};

    use super::*;

    type Outcome = Result<Loaded, ImportError>;

    fn file() -> Loading {
        Loading::new(b"t,x\n0,1\n0.1,2\n".to_vec())
    }

    /// Frames until the outcome, with the share that each of them shows. A worker sends what it is given, then fails.
    fn frames(there: Option<Vec<Option<Report<f64, Outcome>>>>) -> (Vec<f64>, Outcome) {
        let there = there.map(|reports| {
            let mut reports = reports.into_iter();
            Handle::new(move || reports.next().ok_or(Lost))
        });
        let mut task = Running::here(file(), Task::progress).in_workers(there);
        let mut shares = vec![*task.seen()];
        loop {
            if let Some(outcome) = task.advance(&mut || false).unwrap() {
                assert!(task.advance(&mut || true).unwrap().is_none(), "once");
                return (shares, outcome);
            }
            shares.push(*task.seen());
        }
    }

    #[test]
    fn the_outcome_comes_from_a_worker() {
        let there = vec![Some(Report::Look(0.25)), None, None, Some(Report::Look(0.5)), None];
        let there = there.into_iter().chain([Some(Report::Done(Err(ImportError::Matlab)))]).collect();
        let (shares, outcome) = frames(Some(there));
        assert_eq!(shares, [0.0, 0.25, 0.25, 0.5]);
        assert_eq!(outcome.unwrap_err().to_string(), ImportError::Matlab.to_string());
    }

    #[test]
    fn work_that_is_lost_is_done_here_from_its_beginning() {
        let whole = file().finish().unwrap();
        for there in [None, Some(vec![]), Some(vec![Some(Report::Look(0.9)), None])] {
            let (shares, outcome) = frames(there);
            assert_eq!(outcome.unwrap(), whole);
            assert!(shares.len() > 1);
        }
    }
}
