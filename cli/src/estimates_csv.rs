//! Every estimate of every filter as a CSV file.

use std::borrow::Cow;
use std::io::Write;

use kalmanscope_core::{Channel, Estimates, Quantity, Record, Run};

/// Writes one row per filter and sample, first the filters, then the smoothers, under the header `filter, k, t`, the
/// means and standard deviations of all channels of truth and filters, `nis, log_likelihood`, where a filter has several scales of Q
/// also `process_scale` and `process_scale_std`, mean and standard deviation of ln s where √Q is s times as large as set, and for each sensor
/// `innovation_`, `innovation_std_` and `predicted_`: the innovation, the root of its variance in S, and the reading that
/// the filter predicted; where a filter weighs its readings, also `weight_`, and where one learns R, `noise_` and `noise_std_`: the
/// learnt standard deviation of the sensor's noise, and that of this number. Numbers have 17 significant digits, so that every bit
/// survives; undefined values are `nan`. Means are in canonical form ([`Estimates::canonical_mean`]), as in the table.
///
/// # Errors
/// [`csv::Error`] where `output` cannot be written.
pub fn write_estimates(run: &Run, output: impl Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(output);
    let channels = run.channels();
    let means = channels.iter().map(|c| c.key().to_owned());
    let stds = channels.iter().map(|c| format!("std_{}", c.key()));
    let header = ["filter", "k", "t"].map(str::to_owned).into_iter().chain(means).chain(stds);
    let sensors = run.record().sensors();
    let columns: Vec<&ReadingColumn> =
        READING.iter().filter(|(_, is_written, _)| run.estimates().iter().any(is_written)).collect();
    let readings =
        columns.iter().flat_map(|(what, ..)| sensors.iter().map(move |sensor| format!("{what}_{}", sensor.key())));
    let scales = run.estimates().iter().any(|estimates| estimates.has_process_scale);
    let of_process: &[&str] = if scales { &["process_scale", "process_scale_std"] } else { &[] };
    let numbers = ["nis", "log_likelihood"].iter().chain(of_process).map(|name| (*name).to_owned());
    writer.write_record(header.chain(numbers).chain(readings))?;
    for estimates in run.estimates().iter().chain(&run.smoothed()) {
        let name = harmless(estimates.name());
        for k in 0..estimates.len() {
            writer.write_field(name.as_ref())?;
            writer.write_field(k.to_string())?;
            writer.write_field(number(run.record().time(k)))?;
            let readings: Vec<_> = sensors.iter().map(|s| SensorEstimate::of(estimates, run.record(), *s, k)).collect();
            let of_readings = columns.iter().flat_map(|(.., of)| readings.iter().map(of));
            let of_process = scales.then(|| estimates.process_scale(k).unwrap_or([f64::NAN; 2]));
            let of_process = of_process.into_iter().flatten();
            for value in values(estimates, &channels, k).chain(of_process).chain(of_readings) {
                writer.write_field(number(value))?;
            }
            // The csv crate ends a row of single fields where an empty record follows.
            writer.write_record(None::<&[u8]>)?;
        }
    }
    writer.flush()?;
    Ok(())
}

/// A name as the cell of a CSV file: one that a spreadsheet would take for a formula begins with an apostrophe.
pub fn harmless(name: &str) -> Cow<'_, str> {
    if name.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{name}").into() } else { name.into() }
}

/// A number of each sensor: its name, whether a filter has it, and the number.
type ReadingColumn = (&'static str, fn(&Estimates) -> bool, fn(&SensorEstimate) -> f64);

const READING: [ReadingColumn; 6] = [
    ("innovation", |_| true, |reading| reading.innovation),
    ("innovation_std", |_| true, |reading| reading.std),
    ("predicted", |_| true, |reading| reading.predicted),
    ("weight", |estimates| estimates.weighs, |reading| reading.weight),
    ("noise", |estimates| estimates.learns_sensor_noise, |reading| reading.noise[0]),
    ("noise_std", |estimates| estimates.learns_sensor_noise, |reading| reading.noise[1]),
];

/// A filter's view of one sensor at one sample; NaN where nothing was measured, or where it does not use the sensor.
pub(crate) struct SensorEstimate {
    pub(crate) innovation: f64,
    pub(crate) std: f64,
    pub(crate) predicted: f64,
    pub(crate) weight: f64,
    /// The standard deviation of the sensor's noise, if the filter learns it, and that of this number.
    pub(crate) noise: [f64; 2],
}

impl SensorEstimate {
    pub(crate) fn of(estimates: &Estimates, record: &Record, sensor: Quantity, k: usize) -> Self {
        let found = || {
            let place = estimates.sensors().iter().position(|own| *own == sensor)?;
            let innovation = *estimates.innovation(k).get(place)?;
            let variance = *estimates.innovation_cov(k).get(place * (estimates.sensors().len() + 1))?;
            let measured = record.measured_quantity(sensor)?[k];
            let weight = estimates.weights(k).get(place).copied().unwrap_or(f64::NAN);
            let noise = estimates.sensor_noise(k, place).unwrap_or([f64::NAN; 2]);
            Some(Self { innovation, std: variance.sqrt(), predicted: measured - innovation, weight, noise })
        };
        let nan = f64::NAN;
        found().unwrap_or(Self { innovation: nan, std: nan, predicted: nan, weight: nan, noise: [nan; 2] })
    }
}

fn values(estimates: &Estimates, channels: &[Channel], k: usize) -> impl Iterator<Item = f64> {
    let mean = move |c: &Channel| estimates.place(*c).map_or(f64::NAN, |place| estimates.canonical_mean(k, place));
    let std = move |c: &Channel| estimates.place(*c).map_or(f64::NAN, |place| estimates.std(k, place));
    let ends = [estimates.nis()[k], estimates.log_likelihood(k)];
    channels.iter().map(mean).chain(channels.iter().map(std)).chain(ends)
}

fn number(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { format!("{value:.16e}") }
}
