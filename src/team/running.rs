//! A task under way: beside the frames, or in slices of them.

use kalmanscope_core::Task;

use super::{Handle, Lost, Priority, Report, Team, waking};

pub struct RunningTask<T: Task, L = f64> {
    place: TaskPlace<T, L>,
    look: fn(&T) -> L,
    pub seen: L,
}

/// The place of a task. One that is not in the frames has a worker, so nobody waits for a task that nobody does.
enum TaskPlace<T: Task, L> {
    Here(T),
    /// At a worker; the frames begin the second one if that worker fails.
    Beside(Handle<Report<L, T::Outcome>>, Option<T>),
    Over,
}

impl<T: Task, L> RunningTask<T, L> {
    pub fn here(task: T, look: fn(&T) -> L) -> Self {
        Self { seen: look(&task), place: TaskPlace::Here(task), look }
    }

    pub fn in_worker(worker: Handle<Report<L, T::Outcome>>, task: T, look: fn(&T) -> L) -> Self {
        Self { seen: look(&task), place: TaskPlace::Beside(worker, Some(task)), look }
    }

    pub fn begin(team: &dyn Team, priority: Priority, task: T, look: fn(&T) -> L) -> Self
    where
        T: Send + 'static,
        T::Outcome: Send,
        L: Send + 'static,
    {
        match team.threads() {
            Some((threads, ctx)) => {
                let seen = look(&task);
                let worker = threads.task(priority, task, look, waking(ctx)).into();
                Self { place: TaskPlace::Beside(worker, None), look, seen }
            }
            None => Self::here(task, look),
        }
    }

    pub fn is_beside(&self) -> bool {
        matches!(self.place, TaskPlace::Beside(..))
    }

    pub fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Result<Option<T::Outcome>, Lost> {
        while let TaskPlace::Beside(worker, spare) = &mut self.place {
            match worker.take() {
                Ok(Some(Report::Look(seen))) => self.seen = seen,
                Ok(Some(Report::Done(outcome))) => {
                    self.place = TaskPlace::Over;
                    return Ok(Some(outcome));
                }
                Ok(None) => return Ok(None),
                Err(Lost) => self.place = spare.take().map_or(TaskPlace::Over, TaskPlace::Here),
            }
        }
        if let TaskPlace::Here(task) = &mut self.place {
            let is_done = task.advance(while_time);
            self.seen = (self.look)(task);
            if !is_done {
                return Ok(None);
            }
        }
        match std::mem::replace(&mut self.place, TaskPlace::Over) {
            TaskPlace::Here(task) => Ok(Some(task.finish())),
            TaskPlace::Beside(..) | TaskPlace::Over => Err(Lost),
        }
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::Work;
    use kalmanscope_core::import::{ImportError, Loaded, load};

    use super::*;

    type Outcome = Result<Loaded, ImportError>;

    fn file() -> Work<Outcome> {
        // More lines than are read at a time.
        let rows = (0..1000).map(|k| format!("{k},{}\n", k % 7));
        load(("t,x\n".to_owned() + &rows.collect::<String>()).into_bytes())
    }

    /// Frames until the outcome, with the share that each of them shows. A worker sends its reports, then fails.
    fn frames(there: Option<Vec<Option<Report<f64, Outcome>>>>) -> (Vec<f64>, Outcome) {
        let there = there.map(|reports| {
            let mut reports = reports.into_iter();
            Handle::new(move || reports.next().ok_or(Lost))
        });
        let mut task = match there {
            Some(there) => RunningTask::in_worker(there, file(), Task::progress),
            None => RunningTask::here(file(), Task::progress),
        };
        let mut shares = vec![task.seen];
        loop {
            if let Some(outcome) = task.advance(&mut || false).unwrap() {
                assert!(task.advance(&mut || true).is_err(), "nobody waits for it again");
                return (shares, outcome);
            }
            shares.push(task.seen);
        }
    }

    #[test]
    fn the_outcome_comes_from_a_worker() {
        let there = vec![Some(Report::Look(0.25)), None, None, Some(Report::Look(0.5)), None];
        let there = there.into_iter().chain([Some(Report::Done(Err(ImportError::NoTime(String::new()))))]).collect();
        let (shares, outcome) = frames(Some(there));
        assert_eq!(shares, [0.0, 0.25, 0.25, 0.5]);
        assert_eq!(outcome.unwrap_err().to_string(), ImportError::NoTime(String::new()).to_string());
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
