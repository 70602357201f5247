//! The estimates of one filter, sample by sample.

mod growth;

use kalmanscope_filters::{Channel, FilterKind, Quantity, Stop};
use kalmanscope_records::Record;
use kalmanscope_records::hash::Hash;
use kalmanscope_records::record::Delays;

use crate::run::remarks::{Monitor, Remark, Trouble};
use crate::run::sink::Sample;
use crate::scenario::SMOOTHED;
use crate::{FilterColor, FilterSettings, PlantKind, Scenario};
use growth::History;

/// The estimates of one filter: the results of every sample, from k = 0 on.
///
/// Where a run has forgotten samples, `k` counts from the first one that is kept; [`Stop`] and [`Remark`] count from the run's beginning.
///
/// With n channels and m sensors a sample has n means, an n × n covariance, m innovations, their m × m covariance and an
/// n × m gain. At the run's first sample and where nothing was measured, innovations and likelihood are NaN and the gain is zero.
/// Covariances and gains take more than half of the memory; [`Self::drop_matrices`] returns it where they have been used.
#[derive(Clone, Debug, Default)]
pub struct Estimates {
    settings: FilterSettings,
    smoothed: bool,
    /// The filter's kind.
    pub kind: FilterKind,
    /// The kind of plant that the filter takes the truth for.
    pub plant: PlantKind,
    channels: Vec<Channel>,
    frequency: Option<usize>,
    sensors: Vec<Quantity>,
    forgotten: usize,
    /// The number of kept samples, from the first one on, whose matrices have been dropped.
    dropped: usize,
    initial_mean: Vec<f64>,
    initial_std: Vec<f64>,
    history: History,
    /// The means in canonical form and the diagonals of the covariances, each channel a column, so that drawing or adding up one reads no other memory.
    canonical: Vec<Vec<f64>>,
    variance: Vec<Vec<f64>>,
    /// The samples with several readings of a sensor, and how many more; and those with a ln det S of their own.
    earlier: Vec<(usize, u32, f64)>,
    /// Whether the filter weighs its readings.
    pub weighs: bool,
    /// Whether the filter learns R.
    pub learns_sensor_noise: bool,
    /// Whether the filter reports how large Q is ([`FilterSettings::process_scales`]).
    pub has_process_scale: bool,
    /// The number of particles of a particle filter; 0 for any other filter.
    pub particles: usize,
    monitor: Monitor,
    stop: Option<Stop>,
}

impl Estimates {
    /// No estimates yet, of a filter of a scenario with these settings and sensors.
    pub fn new(settings: &FilterSettings, scenario: &Scenario, sensors: Vec<Quantity>) -> Self {
        let model = settings.model(&scenario.plant.kind, scenario.input);
        let (plant, channels) = (model.plant(), model.channels());
        Self {
            settings: settings.clone(),
            kind: settings.kind,
            plant: plant.clone(),
            channels: channels.to_vec(),
            frequency: model.place(Channel::NATURAL_FREQUENCY),
            monitor: Monitor::new(settings, &model, &sensors),
            sensors,
            canonical: vec![Vec::new(); channels.len()],
            variance: vec![Vec::new(); channels.len()],
            weighs: settings.robust.is_on(),
            learns_sensor_noise: settings.adaptation.sensor_noise,
            has_process_scale: settings.process_scales > 1,
            particles: if settings.kind.has_own_likelihood() { settings.ensemble_size } else { 0 },
            ..Self::default()
        }
    }

    /// The same, as a smoother's.
    pub fn of_smoother(mut self) -> Self {
        self.settings.name += SMOOTHED;
        Self { smoothed: true, weighs: false, learns_sensor_noise: false, has_process_scale: false, ..self }
    }

    /// The filter's id.
    pub fn id(&self) -> u32 {
        self.settings.id
    }

    /// Takes the name and the colour of these settings.
    pub fn call(&mut self, settings: &FilterSettings) {
        self.settings.name = settings.name.clone() + if self.smoothed { SMOOTHED } else { "" };
        self.settings.color = settings.color;
    }

    /// The name on screen: the filter's, with ", smoothed" for smoothed estimates.
    pub fn name(&self) -> &str {
        &self.settings.name
    }

    /// The colour of the filter.
    pub fn color(&self) -> FilterColor {
        self.settings.color.unwrap_or(FilterColor::of(self.id()))
    }

    /// The channels, in the order of every mean and covariance.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The place of a channel, if the filter estimates it.
    pub fn place(&self, channel: Channel) -> Option<usize> {
        channel.place_in(&self.channels)
    }

    /// The sensors, in the order of every innovation.
    pub fn sensors(&self) -> &[Quantity] {
        &self.sensors
    }

    /// The number of samples with an estimate that are kept.
    pub fn len(&self) -> usize {
        self.history.nis.len()
    }

    /// Whether there is no estimate.
    pub fn is_empty(&self) -> bool {
        self.history.nis.is_empty()
    }

    /// The number of forgotten samples, which is also the number of the first one that is kept.
    pub fn forgotten(&self) -> usize {
        self.forgotten
    }

    /// The mean of one channel at the run's first sample, kept or not; NaN before it.
    pub fn initial_mean(&self, channel: usize) -> f64 {
        self.initial_mean.get(channel).copied().unwrap_or(f64::NAN)
    }

    /// The standard deviation of one channel at the run's first sample, kept or not; NaN before the first sample.
    pub fn initial_std(&self, channel: usize) -> f64 {
        self.initial_std.get(channel).copied().unwrap_or(f64::NAN)
    }

    /// Where and why the filter stopped, if it did.
    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Remarks on problems that the filter survived, in the order in which they were noticed.
    pub fn remarks(&self) -> &[Remark] {
        &self.monitor.remarks
    }

    /// The samples, counted from the run's beginning, at which the filter widened P ([`FilterSettings::jump`]).
    pub fn jumps(&self) -> impl Iterator<Item = usize> + '_ {
        self.remarks().iter().filter(|remark| remark.what == Trouble::Widened).map(|remark| remark.sample)
    }

    /// The mean at sample `k`, one number per channel.
    #[inline]
    pub fn mean(&self, k: usize) -> &[f64] {
        chunk(&self.history.mean, k, self.channels.len())
    }

    /// The mean of one channel at sample `k` in canonical form, with ωₙ ≥ 0: (-ωₙ, -ζ) and (ωₙ, ζ) describe the same oscillator.
    #[inline]
    pub fn canonical_mean(&self, k: usize, channel: usize) -> f64 {
        self.canonical[channel][k]
    }

    /// [`Self::canonical_mean`] of one channel at every sample.
    pub fn canonical_means(&self, channel: usize) -> &[f64] {
        &self.canonical[channel]
    }

    /// The sign that takes one channel at sample `k` to its canonical form; a covariance is multiplied by those of both channels.
    #[inline]
    pub fn canonical_sign(&self, k: usize, channel: usize) -> f64 {
        let negative = || self.frequency.is_some_and(|place| self.mean(k)[place] < 0.0);
        if self.channels[channel].is_mirrored() && negative() { -1.0 } else { 1.0 }
    }

    /// The standard deviation of one channel at sample `k`.
    #[inline]
    pub fn std(&self, k: usize, channel: usize) -> f64 {
        self.variance[channel][k].sqrt()
    }

    /// The variance of one channel at every sample.
    pub fn variances(&self, channel: usize) -> &[f64] {
        &self.variance[channel]
    }

    /// The covariance at sample `k`, n × n; empty where it has been dropped.
    #[inline]
    pub fn cov(&self, k: usize) -> &[f64] {
        let n = self.channels.len();
        k.checked_sub(self.dropped).map_or(&[], |k| chunk(&self.history.cov, k, n * n))
    }

    /// The innovations e at sample `k`, one per sensor.
    #[inline]
    pub fn innovation(&self, k: usize) -> &[f64] {
        chunk(&self.history.innovation, k, self.sensors.len())
    }

    /// The number of readings in the update at sample `k`, of which a sensor may have several.
    #[inline]
    pub fn readings(&self, k: usize) -> u32 {
        self.sample(k).readings()
    }

    pub(crate) fn sample(&self, k: usize) -> Sample<'_> {
        let History { nis, determinant, log_likelihood, .. } = &self.history;
        let place = self.earlier.binary_search_by_key(&(self.forgotten + k), |(sample, ..)| *sample);
        let (_, earlier, ln_determinant) = place.map_or((0, 0, f64::NAN), |place| self.earlier[place]);
        let (innovation, innovation_cov) = (self.innovation(k), self.innovation_cov(k));
        let log_likelihood = log_likelihood.get(k).copied().unwrap_or(f64::NAN);
        let unmeasured = Sample { innovation, innovation_cov, ..Sample::unmeasured(self.mean(k), self.cov(k)) };
        Sample { earlier, ln_determinant, log_likelihood, nis: nis[k], determinant: determinant[k], ..unmeasured }
    }

    /// The innovations' covariance S at sample `k`, m × m.
    #[inline]
    pub fn innovation_cov(&self, k: usize) -> &[f64] {
        let m = self.sensors.len();
        chunk(&self.history.innovation_cov, k, m * m)
    }

    /// The gain K at sample `k`: for each sensor in turn, n numbers; empty where it has been dropped.
    #[inline]
    pub fn gain(&self, k: usize) -> &[f64] {
        let size = self.channels.len() * self.sensors.len();
        k.checked_sub(self.dropped_gains()).map_or(&[], |k| chunk(&self.history.gain, k, size))
    }

    /// The number of kept samples without a gain: a particle filter keeps all, since its diagnosis reads them.
    fn dropped_gains(&self) -> usize {
        if self.kind.has_own_likelihood() { 0 } else { self.dropped }
    }

    /// The normalised innovation squared of every sample.
    pub fn nis(&self) -> &[f64] {
        &self.history.nis
    }

    /// The determinant of S at every sample; NaN where nothing was measured, zero or infinite beyond the range of numbers.
    pub fn determinant(&self) -> &[f64] {
        &self.history.determinant
    }

    /// The log likelihood of the measurements at sample `k`, as in [`Sample::ln_likelihood`]; NaN where there was none.
    pub fn log_likelihood(&self, k: usize) -> f64 {
        let own = self.history.log_likelihood.get(k).copied();
        own.unwrap_or_else(|| self.sample(k).ln_likelihood())
    }

    /// The effective sample size of a particle filter at every sample, before it resampled; empty for any other filter.
    pub fn effective_samples(&self) -> &[f64] {
        &self.history.effective_samples
    }

    /// Whether the filter only counts the uncertainty of a channel, and does not estimate it.
    pub fn considers(&self, channel: Channel) -> bool {
        self.settings.consider.contains(&channel)
    }

    /// A hash of every bit of the means and covariances that are kept (64-bit FNV-1a), to compare platforms.
    pub fn checksum(&self) -> u64 {
        let mut hash = Hash::default();
        self.history.mean.iter().chain(&self.history.cov).for_each(|x| hash.add(&x.to_bits().to_le_bytes()));
        hash.value()
    }

    /// The std of a sensor's noise that the filter has learnt by sample `k`, and its own: `√R` and `√var R / (2 √R)`, in its unit.
    pub fn sensor_noise(&self, k: usize, sensor: usize) -> Option<[f64; 2]> {
        let m = self.sensors.len();
        let of_sample = self.history.learnt.get(2 * m * k..2 * m * (k + 1))?;
        let [std, spread] = [*of_sample.get(sensor)?, of_sample[m + sensor]].map(f64::sqrt);
        Some([std, if std > 0.0 { spread / (2.0 * std) } else { 0.0 }])
    }

    /// Mean and std of ln s at sample `k`, s the factor on the settings' √Q. `None` for a filter with one scale of Q.
    pub fn process_scale(&self, k: usize) -> Option<[f64; 2]> {
        let &[mean, std] = self.history.process_scale.get(2 * k..2 * (k + 1))? else { return None };
        Some([mean, std])
    }

    /// The weight of each sensor's reading at sample `k`, from 0 to about 1, NaN for none; empty for a filter that weighs none.
    pub fn weights(&self, k: usize) -> &[f64] {
        let m = self.sensors.len();
        self.history.weights.get(k * m..(k + 1) * m).unwrap_or(&[])
    }

    /// Readings `dt` \[s\] apart, or with `apart` samples between two of each sensor. `option` makes the filter count in samples.
    pub(crate) fn over(self, apart: Option<&[usize]>, dt: f64, option: Option<&'static str>) -> Self {
        let has_parts = self.delays(dt).sensors.iter().any(|steps| libm::trunc(*steps) != *steps);
        let trouble = match (apart, option) {
            (Some(_), option) => option.map(Trouble::Moved),
            (None, Some(option)) if has_parts => Some(Trouble::Rounded(option)),
            (None, _) => None,
        };
        Self { monitor: self.monitor.with_clocks(apart, trouble), ..self }
    }

    /// The readings of a sensor by its place: where the filter takes it to be late, each sample has its own, to the nearest.
    pub fn measured<'a>(&self, record: &'a Record, place: usize) -> Option<impl Fn(usize) -> f64 + Copy + 'a> {
        let quantity = self.sensors.get(place)?;
        let column = quantity.place_in(record.sensors())?;
        let late = self.delays(record.dt()).of(place);
        Some(move |k| record.late_reading(column, k, late))
    }

    fn delays(&self, dt: f64) -> Delays {
        Delays::new(0, self.settings.sensor_delay.iter().map(|late| late / dt))
    }
}

fn chunk(values: &[f64], k: usize, size: usize) -> &[f64] {
    &values[k * size..(k + 1) * size]
}
