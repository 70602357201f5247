//! A spring's stiffness from the periods with several masses.

use std::f64::consts::PI;

use super::{Estimated, Trial};

/// The line `T² = 4π² (m + m₀) / k` through some trials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// k \[N/m\]
    pub stiffness: Estimated,
    /// m₀, all that swings beside the added mass: a third of a coil spring's own mass counts \[kg\].
    pub own_mass: Estimated,
    /// The weighted squares of the distances from the line: about as large as `freedom` where the bands are right.
    pub chi_squared: f64,
    /// The trials beyond the two that make a line.
    pub freedom: usize,
    /// The mean of the masses by weight \[kg\], T² there and the slope, which do not depend on each other.
    centre: f64,
    height: Estimated,
    slope: Estimated,
}

impl Spring {
    /// The line by least squares, each trial weighted by `1 / σ²` of its T². Where the points lie further from it than their
    /// σ allow, all σ of the result are larger by [`Self::excess`]. `None` if all masses are alike, or if the period does not
    /// grow with the mass.
    ///
    /// Source: Bevington and Robinson (2003), *Data Reduction and Error Analysis for the Physical Sciences*, chapter 6; for
    /// the excess Birge (1932), The calculation of errors by the method of least squares.
    pub fn of(trials: &[Trial]) -> Option<Self> {
        let points: Vec<[f64; 3]> = trials
            .iter()
            .map(|trial| {
                let Estimated { mean, std } = trial.period_squared();
                [trial.mass, mean, (std * std).recip()]
            })
            .collect();
        let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|&[m, y, w]| w * of(m, y)).sum::<f64>();
        let weight = sum(&|_, _| 1.0);
        let (centre, height) = (sum(&|m, _| m) / weight, sum(&|_, y| y) / weight);
        let square = sum(&|m, _| (m - centre) * (m - centre));
        let slope = sum(&|m, y| (m - centre) * (y - height)) / square;
        let differ = trials.iter().any(|trial| trial.mass != trials[0].mass);
        // NaN is no slope either.
        if !(differ && slope > 0.0 && slope.is_finite()) {
            return None;
        }
        let chi_squared = sum(&|m, y| (y - height - slope * (m - centre)).powi(2));
        let freedom = trials.len() - 2;
        let excess = excess(chi_squared, freedom);
        let slope = Estimated { mean: slope, std: excess * square.sqrt().recip() };
        let height = Estimated { mean: height, std: excess * weight.sqrt().recip() };
        let share = slope.std / slope.mean;
        let length = height.mean / slope.mean;
        Some(Self {
            stiffness: Estimated { mean: 4.0 * PI * PI / slope.mean, std: 4.0 * PI * PI / slope.mean * share },
            own_mass: Estimated { mean: length - centre, std: (height.std / slope.mean).hypot(length * share) },
            chi_squared,
            freedom,
            centre,
            height,
            slope,
        })
    }

    /// By how much the points lie further from the line than their σ allow; 1 where they do not, or where only two points make
    /// the line.
    pub fn excess(&self) -> f64 {
        excess(self.chi_squared, self.freedom)
    }

    /// T² with a mass \[kg\] on the line \[s²\].
    pub fn period_squared(&self, mass: f64) -> Estimated {
        let Self { centre, height, slope, .. } = self;
        let apart = mass - centre;
        Estimated { mean: height.mean + slope.mean * apart, std: height.std.hypot(slope.std * apart) }
    }
}

fn excess(chi_squared: f64, freedom: usize) -> f64 {
    if freedom == 0 { 1.0 } else { (chi_squared / freedom as f64).sqrt().max(1.0) }
}
