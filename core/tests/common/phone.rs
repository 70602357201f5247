//! The raw readings of a phone on an oscillator that is plucked.

use nalgebra::Vector2;

use crate::numbers::{Random, transition};

#[derive(Clone, Copy)]
pub(crate) struct Phone {
    pub(crate) seed: u64,
    /// \[rad/s\]
    pub(crate) frequency: f64,
    pub(crate) damping: f64,
    /// Readings a second, the share of a step by which they come too early or too late, their noise and their grain \[m/s²\].
    pub(crate) rate: f64,
    pub(crate) jitter: f64,
    pub(crate) noise: f64,
    pub(crate) grain: f64,
    /// The acceleration after it is let go at 2 s \[m/s²\].
    pub(crate) amplitude: f64,
    pub(crate) seconds: f64,
    /// A second pluck at this time \[s\].
    pub(crate) again: Option<f64>,
}

pub(crate) const USUAL: Phone = Phone {
    seed: 1,
    frequency: 8.0,
    damping: 0.004,
    rate: 60.0,
    jitter: 0.2,
    noise: 0.02,
    grain: 0.01,
    amplitude: 1.5,
    seconds: 30.0,
    again: None,
};

impl Phone {
    pub(crate) fn readings(&self) -> Vec<[f64; 4]> {
        let mut random = Random::new(self.seed);
        let direction = {
            let v: [f64; 3] = std::array::from_fn(|_| random.normal());
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            v.map(|x| x / length)
        };
        let [w, z] = [self.frequency, self.damping];
        let free = |t: f64| {
            let state = transition([w, z], t) * Vector2::new(self.amplitude / (w * w), 0.0);
            -2.0 * z * w * state[1] - w * w * state[0]
        };
        let count = (self.seconds * self.rate) as usize;
        (0..count)
            .map(|k| {
                let t = (k as f64 + self.jitter * (random.uniform() - 0.5)) / self.rate;
                let since = self.again.filter(|again| t >= *again).unwrap_or(2.0);
                let a = match t {
                    t if t < 1.4 => 0.0,
                    // The hand pulls, not evenly.
                    t if t < 2.0 => 0.8 * self.amplitude * (9.0 * (t - 1.4)).sin() * random.uniform(),
                    t => free(t - since),
                };
                let told = |x: f64| (x / self.grain).round() * self.grain;
                let gravity = [1.2, 9.6, -0.7];
                let [x, y, z] =
                    std::array::from_fn(|i| told(gravity[i] + direction[i] * a + self.noise * random.normal()));
                [t, x, y, z]
            })
            .collect()
    }
}
