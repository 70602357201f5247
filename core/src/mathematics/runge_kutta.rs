//! Classical Runge-Kutta steps.

#[derive(Clone, Debug, Default)]
pub(crate) struct RungeKutta {
    stage: Vec<f64>,
    rates: [Vec<f64>; 4],
}

impl RungeKutta {
    /// One classical fourth-order step of `ẏ = rate(s, y)` over `dt` \[s\], in place; s is the share of the step that has passed,
    /// from 0 to 1. The first `moving` components move; `rate` writes their rates into the slice.
    ///
    /// Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.1.
    pub(crate) fn advance(
        &mut self,
        state: &mut [f64],
        moving: usize,
        dt: f64,
        rate: impl Fn(f64, &[f64], &mut [f64]),
    ) {
        let Self { stage, rates } = self;
        stage.clear();
        stage.extend_from_slice(state);
        rates.iter_mut().for_each(|rate| rate.resize(moving, 0.0));
        let [k1, k2, k3, k4] = rates;
        let half = 0.5 * dt;
        let state = &mut state[..moving];
        rate(0.0, stage, k1);
        rate(0.5, moved(stage, state, k1, half), k2);
        rate(0.5, moved(stage, state, k2, half), k3);
        rate(1.0, moved(stage, state, k3, dt), k4);
        for ((((state, k1), k2), k3), k4) in state.iter_mut().zip(&*k1).zip(&*k2).zip(&*k3).zip(&*k4) {
            *state += (k1 + (k2 + k3) * 2.0 + k4) * (dt / 6.0);
        }
    }
}

/// `state + k dt` in place of the components of `stage` that move.
fn moved<'a>(stage: &'a mut [f64], state: &[f64], k: &[f64], dt: f64) -> &'a [f64] {
    for ((stage, state), k) in stage.iter_mut().zip(state).zip(k) {
        *stage = state + k * dt;
    }
    stage
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runge_kutta_is_of_fourth_order() {
        let error = |steps: u32| {
            let dt = 1.0 / f64::from(steps);
            let (mut y, mut method) = ([1.0, 0.0], RungeKutta::default());
            for _ in 0..steps {
                method.advance(&mut y, 2, dt, |_, y, rate| rate.copy_from_slice(&[y[1], -4.0 * y[0]]));
            }
            (y[0] - libm::cos(2.0)).abs()
        };
        let order = libm::log2(error(20) / error(40));
        assert!((order - 4.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn a_rate_that_is_linear_in_time_is_integrated_exactly() {
        let mut y = [0.0];
        RungeKutta::default().advance(&mut y, 1, 0.5, |s, _, rate| rate[0] = 2.0 + 3.0 * s);
        assert_eq!(y[0], 0.5 * 3.5);
    }
}
