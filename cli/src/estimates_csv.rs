//! Every estimate of every filter as a CSV file.

use std::io::Write;

use kalmanscope_core::{Channel, Estimates, Run};

/// Writes one row per filter and sample, first the filters, then the smoothers, under the header `filter, k, t`, the
/// means and standard deviations of all channels of truth and filters, `nis, log_likelihood`. Numbers have 17
/// significant digits, so that every bit survives; undefined values are `nan`. Means are in canonical form
/// ([`Estimates::canonical_mean`]), as in the table.
///
/// # Errors
/// [`csv::Error`] where `output` cannot be written.
pub fn write_estimates(run: &Run, output: impl Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(output);
    let channels = run.channels();
    let means = channels.iter().map(|c| c.key().to_owned());
    let stds = channels.iter().map(|c| format!("std_{}", c.key()));
    let header = ["filter", "k", "t"].map(str::to_owned).into_iter().chain(means).chain(stds);
    writer.write_record(header.chain(["nis", "log_likelihood"].map(str::to_owned)))?;
    for estimates in run.estimates().iter().chain(&run.smoothed()) {
        for k in 0..estimates.len() {
            writer.write_field(estimates.name())?;
            writer.write_field(k.to_string())?;
            writer.write_field(number(run.record().time(k)))?;
            for value in values(estimates, &channels, k) {
                writer.write_field(number(value))?;
            }
            writer.write_record(None::<&[u8]>)?;
        }
    }
    writer.flush()?;
    Ok(())
}

/// The numbers of one row, from the first mean on.
fn values(estimates: &Estimates, channels: &[Channel], k: usize) -> impl Iterator<Item = f64> {
    let mean = move |c: &Channel| estimates.place(*c).map_or(f64::NAN, |place| estimates.canonical_mean(k, place));
    let std = move |c: &Channel| estimates.place(*c).map_or(f64::NAN, |place| estimates.std(k, place));
    let ends = [estimates.nis()[k], estimates.log_likelihood(k)];
    channels.iter().map(mean).chain(channels.iter().map(std)).chain(ends)
}

fn number(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { format!("{value:.16e}") }
}
