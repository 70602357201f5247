//! The state of work that the user sees: whether it has been stopped, why it is not possible, and whether there is something
//! new to show.

#[derive(Debug, Default)]
pub struct WorkState {
    is_stopped: bool,
    problem: Option<String>,
    version: u64,
}

impl WorkState {
    pub fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// A number that changes whenever the view has to be drawn again.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Stops or continues the work. Returns whether that changes anything: complete work cannot be stopped.
    pub(super) fn set_stopped(&mut self, stopped: bool, is_incomplete: bool) -> bool {
        let changes = self.is_stopped != stopped && is_incomplete;
        if changes {
            self.is_stopped = stopped;
        }
        changes
    }

    /// Continues, because the user has chosen other work.
    pub(super) fn go_on(&mut self) {
        self.is_stopped = false;
    }

    pub(super) fn begin(&mut self) {
        (self.is_stopped, self.problem) = (false, None);
    }

    pub(super) fn fail(&mut self, problem: String) {
        if self.problem.as_ref() != Some(&problem) {
            self.problem = Some(problem);
            self.version += 1;
        }
    }

    pub(super) fn show_new(&mut self) {
        self.version += 1;
    }
}
