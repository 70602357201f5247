//! The course of a white force between samples.

/// The course of a white force between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// It is held from its sample to the next, as a simulated disturbance is: where the input is held
    /// ([`Hold::Zero`](crate::Hold::Zero)).
    Held,
    /// It is continuous white noise, and w its mean from a sample to the next: where the input is not held
    /// ([`Hold::First`](crate::Hold::First)) and no sensor feels the force. Its deviation from the mean moves x too,
    /// and completes the process noise:
    ///
    /// ```text
    /// Q = q [dt³/12, 0; 0, 0],  Q + Γ Γᵀ s² = q [dt³/3, dt²/2; dt²/2, dt]
    /// ```
    Continuous,
    /// It is held from half a sample before its own to half a sample after it: where the input is not held and a sensor feels
    /// the force. A sampled accelerometer with a filter against aliases feels it on both sides of its sample.
    Centred,
}

impl Course {
    /// The number of steps of a prediction of `substeps` steps, and after how many of them w is drawn again.
    pub fn steps(self, substeps: usize) -> (usize, usize) {
        match self {
            Self::Held | Self::Continuous => (substeps, substeps),
            Self::Centred => (2 * substeps.div_ceil(2), substeps.div_ceil(2)),
        }
    }
}
