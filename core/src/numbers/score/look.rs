//! A run at one sample.

/// One filter at one sample of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// NEES; NaN without a known truth.
    pub nees: f64,
    /// NIS; NaN without a measurement.
    pub nis: f64,
    /// Error, mean minus truth, and standard deviation of every channel, in its unit and in the filter's order; NaN where the
    /// truth is not known.
    pub channels: Vec<[f64; 2]>,
}
