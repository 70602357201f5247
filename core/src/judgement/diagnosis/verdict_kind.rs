//! The kinds of verdicts.

/// The trust that a filter's estimates and standard deviations deserve, in order of gravity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VerdictKind {
    /// Its errors are as large as its σ says.
    Consistent,
    /// It is consistent except for a time from which it has recovered.
    Recovered,
    /// The record does not determine a parameter: its σ is as large as at first.
    NotIdentifiable,
    /// Its errors are smaller than its σ says.
    Underconfident,
    /// Its innovations are no larger than it expects, but they have a pattern: something is left that the model does not explain.
    PatternLeft,
    /// Its errors are larger than its σ says.
    Overconfident,
    /// It forgets a parameter faster than the sensors give information on it.
    WoundUp,
    /// Its particles have become one, so that σ says nothing.
    Collapsed,
    /// Its estimates are not those of an oscillator: negative, beyond what the samples can show, or far from any start.
    Lost,
    /// It has lost the truth, or has stopped.
    Diverged,
}

impl VerdictKind {
    /// Every verdict, the gravest last.
    pub const ALL: [Self; 10] = [
        Self::Consistent,
        Self::Recovered,
        Self::NotIdentifiable,
        Self::Underconfident,
        Self::PatternLeft,
        Self::Overconfident,
        Self::WoundUp,
        Self::Collapsed,
        Self::Lost,
        Self::Diverged,
    ];

    /// The verdict in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Consistent => "consistent",
            Self::Recovered => "recovered",
            Self::NotIdentifiable => "not identifiable",
            Self::Underconfident => "underconfident",
            Self::PatternLeft => "pattern left",
            Self::Overconfident => "overconfident",
            Self::WoundUp => "wound up",
            Self::Collapsed => "collapsed",
            Self::Lost => "lost",
            Self::Diverged => "diverged",
        }
    }

    /// The verdict as an argument: its name with `-` in place of spaces.
    pub const fn key(self) -> &'static str {
        match self {
            Self::NotIdentifiable => "not-identifiable",
            Self::PatternLeft => "pattern-left",
            Self::WoundUp => "wound-up",
            _ => self.name(),
        }
    }

    /// The verdict on a filter of this name, as a sentence without its full stop.
    pub fn on(self, name: &str) -> String {
        match self {
            Self::PatternLeft => format!("{name} leaves a pattern"),
            Self::Recovered | Self::Collapsed | Self::Diverged => format!("{name} has {}", self.name()),
            _ => format!("{name} is {}", self.name()),
        }
    }

    /// Whether the standard deviations may be believed, now.
    pub const fn is_good(self) -> bool {
        matches!(self, Self::Consistent | Self::Recovered)
    }
}
