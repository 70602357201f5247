//! A white force in the state of a filter.

use super::Course;
use crate::mathematics::linalg::Matrix;
use crate::{Channel, Hold, Model, Quantity};

/// A force over mass that is not recorded and is independent from sample to sample: wind, traffic, ground noise. It is
/// the component w of the state ([`Channel::WHITE_FORCE`]), so that a sensor that feels it, such as an accelerometer,
/// reads the same force that moves the plant.
///
/// ```text
/// w ~ N(0, s²) drawn again for each sample,  s² = q / dt
/// x⁺ = Φ x + Γ w,  z = h(x) + D w + v,  cov(Γ w, D w + v) = Γ s² Dᵀ
/// Γ Γᵀ s² = q [dt³/4, dt²/2; dt²/2, dt] of a light oscillator, and D = 1 of an accelerometer on it
/// ```
///
/// with the intensity q of the white force \[m²/s³\]: its two-sided spectral density. The filter of the state with w is
/// that of correlated process noise and sensor noise, with the covariance Γ s² Dᵀ: the covariance of x and w after an
/// update is the term that textbooks subtract from the next prediction.
///
/// The course of the force between samples depends on input and sensors ([`Course`]).
///
/// Source: Anderson and Moore (1979), *Optimal Filtering*, section 5.5; Simon (2006), *Optimal State Estimation*, section
/// 7.1 (correlated process and measurement noise); Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to
/// Tracking and Navigation*, sections 6.2.2 and 6.3.2 (white acceleration, continuous and held).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct White {
    /// The place of w in the state.
    pub place: usize,
    /// s², the variance of w \[(m/s²)²\].
    pub variance: f64,
    /// The course of the force between samples.
    pub course: Course,
}

impl White {
    /// The white force of a filter with this model, whose standard deviation is `std` \[m/s²\], and these sensors, if it has one.
    pub(crate) fn of(model: &Model, std: f64, hold: Hold, sensors: &[Quantity]) -> Option<Self> {
        let place = model.place(Channel::WHITE_FORCE)?;
        let feels = |quantity: &Quantity| model.reading(*quantity).is_some_and(|reading| reading.is_of_rates());
        let course = match hold {
            Hold::Zero => Course::Held,
            Hold::First if sensors.iter().any(feels) => Course::Centred,
            Hold::First => Course::Continuous,
        };
        Some(Self { place, variance: std * std, course })
    }

    /// Adds the effect of the force's deviation from its mean over a sample, which enters through the plant's input.
    pub(crate) fn add_rest(self, model: &Model, state: &[f64], dt: f64, process: &mut Matrix) {
        if self.course != Course::Continuous {
            return;
        }
        let by_force = model.by_force(state);
        let moved = |place: usize| {
            let velocity = model.channels()[place].rate()?;
            Some((place, by_force[model.place(velocity)?]))
        };
        let moved: Vec<(usize, f64)> = (0..model.motion()).filter_map(moved).collect();
        let variance = self.variance * dt * dt * dt * dt / 12.0;
        for &(i, a) in &moved {
            for &(j, b) in &moved {
                process[(i, j)] += variance * a * b;
            }
        }
    }

    /// Sets the row and the column of w in Q to zero, since the prediction does not move w.
    pub(crate) fn leave_out(self, process: &mut Matrix) {
        process.row_mut(self.place).fill(0.0);
        process.column_mut(self.place).fill(0.0);
    }
}
