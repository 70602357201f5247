//! What the runs of a batch share.

use serde::{Deserialize, Serialize};

use super::model::{Reading, StateModel};

/// The motion of a linearising filter's mean, and the transition matrix of its covariance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Propagation {
    /// `y⁻ = y + dt φ₁(A dt) g(y, f)` and `Φ = exp(A dt)`: exact where the parameters are known and the plant is linear.
    LocalLinearisation,
    /// One classical Runge-Kutta step, and its derivative.
    RungeKutta,
    /// `y⁻ = y + dt g(y, f)` and `Φ = I + A dt`: the textbooks' first example, and unstable for a long dt.
    Euler,
}

impl Propagation {
    /// Every way.
    pub const ALL: [Self; 3] = [Self::LocalLinearisation, Self::RungeKutta, Self::Euler];
}

/// The course of a white force between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// It is held from its sample to the next, as a simulated disturbance is: where the input is held.
    Held,
    /// It is continuous white noise, and w its mean from a sample to the next: where the input is not held and no sensor feels the force.
    /// Its deviation from the mean moves x too, and completes the process noise:
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

/// The places and weights of sigma points.
///
/// ```text
/// χ₀ = y,  χ± = y ± c L e_i,  L Lᵀ = P
/// dᵢ = g(χᵢ) - g(χ₀),  s = Σ W dᵢ,  mean = g(χ₀) + s,  cov = Σ W dᵢ dᵢᵀ + o s sᵀ
/// ```
///
/// Means and covariances are taken about the centre's image: in exact arithmetic that is the weighted sum of the
/// textbooks, in floating point it leaves a constant component exactly as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// c², the square of their distance in standard deviations; each but the centre weighs `W = 1/(2 c²)`.
    pub spread: f64,
    /// o, the part of `s sᵀ` in a covariance.
    pub offset: f64,
}

impl Rule {
    /// The scaled unscented transform with α = 1, β = 2, κ = 3 - n: points √3 standard deviations away. With these
    /// constants the covariance is a sum of squares, `o = W₀ᶜ + 2nW - 2 = 1`, and never turns negative.
    ///
    /// Source: Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation; van der Merwe (2004), section 3.2.
    pub const UNSCENTED: Self = Self { spread: 3.0, offset: 1.0 };

    /// The third-degree spherical-radial cubature rule: 2n points √n standard deviations away, no centre, `o = -1`.
    ///
    /// Source: Arasaratnam and Haykin (2009), Cubature Kalman filters.
    pub fn cubature(n: usize) -> Self {
        Self { spread: n as f64, offset: -1.0 }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// KF, EKF and IEKF: linearised. An update linearises the sensors this many times, each time at the last result.
    Linearised(Propagation, usize),
    /// UKF and CKF.
    SigmaPoints(Rule),
    /// SR-UKF, by a rule whose o is one.
    SquareRoot(Rule),
}

/// The part of a setup that is the same for all runs of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Design<P> {
    pub model: StateModel<P>,
    pub method: Method,
    /// Time between samples \[s\].
    pub dt: f64,
    pub has_slope: bool,
    pub substeps: usize,
    pub readings: Vec<Reading>,
    /// The place of a white force and its course between samples.
    pub white: Option<(usize, Course)>,
}
