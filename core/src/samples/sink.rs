//! Receivers of a filter's results.

mod last;

use crate::{Estimates, Stop};

pub use crate::samples::sample::{AssumedNoise, Sample};
pub use last::LastSample;

/// Receives the samples of one filter in turn: a full history ([`Estimates`]), or running sums
/// ([`Scores`](crate::Scores)).
///
/// ```
/// use kalmanscope_core::{Sample, Sink};
/// use kalmanscope_core::{Pass, Run, Scenario, Stop};
///
/// /// The largest NIS so far.
/// struct Largest(f64);
///
/// impl Sink for Largest {
///     fn push(&mut self, sample: &Sample<'_>) {
///         self.0 = self.0.max(sample.nis);
///     }
///
///     fn stop_at(&mut self, _: Stop) {}
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scenario = Scenario { duration: 5.0, ..Scenario::default() };
/// let mut run = Run::new(&scenario)?;
/// run.finish();
/// let mut largest = Largest(0.0);
/// Pass::new(&scenario, 0, run.record())?.follow(run.record(), 501, &mut largest);
/// assert_eq!(largest.0, run.estimates()[0].nis()[1..].iter().copied().fold(0.0, f64::max));
/// # Ok(())
/// # }
/// ```
pub trait Sink {
    /// Takes in the next sample. The first one is the initial belief.
    fn push(&mut self, sample: &Sample<'_>);

    /// Notes that the filter has stopped; there are no more samples.
    fn stop_at(&mut self, stop: Stop);

    /// Whether samples are to have the belief before the update too, `prior_mean` and `prior_cov`. It is copied for a sink
    /// that asks, and costs nothing else.
    fn wants_prior(&self) -> bool {
        false
    }

    /// The history that samples are appended to, if the sink is one. A filter of fixed sizes then appends each sample
    /// without checks of lengths.
    fn history(&mut self) -> Option<&mut Estimates> {
        None
    }
}

impl Sink for Estimates {
    fn push(&mut self, sample: &Sample<'_>) {
        self.append(sample);
    }

    fn stop_at(&mut self, stop: Stop) {
        self.set_stop(stop);
    }

    fn history(&mut self) -> Option<&mut Estimates> {
        Some(self)
    }
}
