//! Numbers of every sample, channel by channel.

/// One number a channel and sample. Those of one channel are in one piece: who draws it or adds it up reads nothing else.
#[derive(Clone, Debug)]
pub(crate) struct ByChannel(Vec<Vec<f64>>);

impl ByChannel {
    /// No sample yet of so many channels.
    pub(crate) fn new(channels: usize) -> Self {
        Self(vec![Vec::new(); channels])
    }

    /// Those of one channel.
    #[inline]
    pub(crate) fn of(&self, channel: usize) -> &[f64] {
        &self.0[channel]
    }

    /// Adds a sample, one number a channel.
    #[inline]
    pub(crate) fn push(&mut self, sample: impl Iterator<Item = f64>) {
        for (values, value) in self.0.iter_mut().zip(sample) {
            values.push(value);
        }
    }

    /// Forgets the first samples, or as many as there are.
    pub(crate) fn forget(&mut self, samples: usize) {
        for values in &mut self.0 {
            values.drain(..samples.min(values.len()));
        }
    }

    /// Takes over the memory of others, with room for so many samples.
    pub(crate) fn recycle(&mut self, old: Self, samples: usize) {
        let mut old = old.0.into_iter();
        for values in &mut self.0 {
            *values = old.next().unwrap_or_default();
            values.clear();
            values.reserve(samples);
        }
    }
}
