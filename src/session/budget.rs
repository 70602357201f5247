//! The amount of computation in one frame.

use web_time::{Duration, Instant};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    Unlimited,
    Time(Duration),
    Pieces(usize),
}

impl Budget {
    /// A frame computes for at most 12 ms, and draws charts again for at most 12 ms, so that it takes no more than 50
    /// ms in all.
    pub const FRAME: Self = Self::Time(Duration::from_millis(12));

    /// Whether there is time for more after `spent`. If pieces are counted, a frame draws everything.
    pub(crate) fn allows(self, spent: Duration) -> bool {
        match self {
            Self::Time(time) => spent < time,
            Self::Unlimited | Self::Pieces(_) => true,
        }
    }

    /// A function for one slice that begins now: it returns whether there is time for another piece of work.
    pub(crate) fn slice(self) -> impl FnMut() -> bool {
        let begin = Instant::now();
        let mut pieces = 0;
        move || match self {
            Self::Unlimited => true,
            Self::Time(time) => begin.elapsed() < time,
            Self::Pieces(most) => {
                pieces += 1;
                pieces < most
            }
        }
    }
}
