//! Numbers of every sample, channel by channel.

/// One number per channel and sample. The numbers of one channel are contiguous, so that drawing or adding up a channel
/// reads no other memory.
#[derive(Clone, Debug)]
pub(crate) struct ByChannel(Vec<Vec<f64>>);

impl ByChannel {
    /// Empty columns for this number of channels.
    pub(crate) fn new(channels: usize) -> Self {
        Self(vec![Vec::new(); channels])
    }

    /// The columns.
    pub(crate) fn columns(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        self.0.iter_mut()
    }

    /// The numbers of one channel.
    #[inline]
    pub(crate) fn of(&self, channel: usize) -> &[f64] {
        &self.0[channel]
    }

    /// Appends a sample, one number per channel.
    #[inline]
    pub(crate) fn push(&mut self, sample: impl Iterator<Item = f64>) {
        for (values, value) in self.0.iter_mut().zip(sample) {
            values.push(value);
        }
    }

    /// Forgets the first samples, at most all.
    pub(crate) fn forget(&mut self, samples: usize) {
        for values in &mut self.0 {
            values.drain(..samples.min(values.len()));
        }
    }

    /// Takes over the memory of another, with room for this many samples.
    pub(crate) fn recycle(&mut self, old: Self, samples: usize) {
        let mut old = old.0.into_iter();
        for values in &mut self.0 {
            *values = old.next().unwrap_or_default();
            values.clear();
            values.reserve(samples);
        }
    }
}
