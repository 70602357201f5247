//! Smoothed estimates: each sample's estimate uses the whole record.

pub(crate) mod book;

use crate::samples::waste::Piecewise;
use crate::{Estimates, FilterError, Record, Stop};

/// Limits the samples freed in one call, which takes about a millisecond.
const FREED: usize = 4_000;

/// A smoother in progress: the filter goes forward, the smoother backward ([`crate::samples::smoother::book`]). Sampled
/// filters have no smoother here: they give no estimates. If the filter stops, the smoother begins with the last sample
/// before.
pub(crate) struct Smoother {
    beliefs: Box<dyn Beliefs>,
    input_delay: i32,
    stop: Option<Stop>,
    stage: Stage,
}

/// The beliefs of one filter at every sample of a record: its own, then the smoother's.
pub(crate) trait Beliefs: Send {
    /// The number of samples that have a belief.
    fn len(&self) -> usize;

    /// Filters sample `k`, the next one, under the forces over mass of the sample before it and of its own \[m/s²\].
    fn filter(&mut self, forces: [f64; 2], record: &Record, k: usize) -> Result<(), FilterError>;

    /// Smooths sample `k`, after sample `k + 1`.
    fn smooth(&mut self, k: usize);

    /// Frees the memory of up to this many of the last samples that still have some. Returns whether there were any.
    fn free(&mut self, samples: usize) -> bool;

    /// Appends sample `k` in the channels' units.
    fn report(&self, k: usize, estimates: &mut Estimates);
}

/// The progress of a smoother.
#[derive(Clone, Copy)]
enum Stage {
    /// The filter is under way.
    Forth,
    /// The samples before this one are to be smoothed.
    Back(usize),
    /// The samples from this one on are to be written down.
    Report(usize),
}

impl Smoother {
    /// A smoother before its first sample.
    pub(crate) fn new(beliefs: Box<dyn Beliefs>, input_delay: i32) -> Self {
        Self { beliefs, input_delay, stop: None, stage: Stage::Forth }
    }

    /// Goes on for at most `steps` steps over the first `samples` samples of a record. Both must be the same in each
    /// call. The last call appends to `estimates`. Returns whether all is done.
    pub(crate) fn advance(&mut self, record: &Record, samples: usize, steps: usize, estimates: &mut Estimates) -> bool {
        let Self { beliefs, input_delay, stop, stage } = self;
        let force = |k: usize| record.delayed_force(k, *input_delay);
        for _ in 0..steps {
            match *stage {
                Stage::Forth => {
                    let k = beliefs.len();
                    if k == samples || stop.is_some() {
                        *stage = Stage::Back(k.saturating_sub(1));
                    } else if let Err(reason) = beliefs.filter([force(k.saturating_sub(1)), force(k)], record, k) {
                        *stop = Some(Stop { sample: k, reason });
                    }
                }
                Stage::Back(0) => *stage = Stage::Report(0),
                Stage::Back(k) => {
                    beliefs.smooth(k - 1);
                    *stage = Stage::Back(k - 1);
                }
                Stage::Report(k) if k == beliefs.len() => {
                    if let Some(stop) = *stop {
                        estimates.set_stop(stop);
                    }
                    return true;
                }
                Stage::Report(k) => {
                    beliefs.report(k, estimates);
                    *stage = Stage::Report(k + 1);
                }
            }
        }
        false
    }

    /// The share that is done, from 0 to 1.
    pub(crate) fn progress(&self, samples: usize) -> f64 {
        let of = |done: usize| done as f64 / samples.max(1) as f64;
        match self.stage {
            // The way forth takes the most time.
            Stage::Forth => 0.6 * of(self.beliefs.len()),
            Stage::Back(k) => 0.6 + 0.3 * (1.0 - of(k)),
            Stage::Report(k) => 0.9 + 0.1 * of(k),
        }
    }
}

impl Piecewise for Smoother {
    fn free_piece(&mut self) -> bool {
        self.beliefs.free(FREED)
    }
}
