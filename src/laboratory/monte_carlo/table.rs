//! The statistics over seeds as CSV.

use std::fmt::Write as _;

use super::SeedRuns;

const SHARES: [f64; 3] = [0.025, 0.5, 0.975];

impl SeedRuns {
    /// One row for each filter and time: the seeds so far, mean NEES and NIS, and for each channel the quantiles of its error,
    /// the root mean square error and the filter's own σ. An empty cell has no number.
    pub fn to_csv(&self) -> String {
        let (scenario, statistics) = (self.scenario(), self.statistics());
        let channels = self.ensemble.channels();
        let mut text = "filter,t,seeds,mean_nees,mean_nis".to_owned();
        for channel in &channels {
            for column in ["error_2.5", "error_50", "error_97.5", "rmse", "std"] {
                // Writing to a string cannot fail.
                let _ = write!(text, ",{}.{column}", channel.key());
            }
        }
        text.push('\n');
        for (nth, filter) in scenario.filters.iter().enumerate() {
            let columns: Vec<Option<Vec<[f64; 5]>>> = channels
                .iter()
                .map(|channel| {
                    let at = statistics.channels(nth).iter().position(|other| other == channel)?;
                    let quantiles = statistics.quantiles(nth, at, SHARES).into_iter();
                    let both = statistics.rmse(nth, at).zip(statistics.std(nth, at));
                    Some(quantiles.zip(both).map(|([a, b, c], (rmse, std))| [a, b, c, rmse, std]).collect())
                })
                .collect();
            let squares = statistics.nees(nth).zip(statistics.nis(nth));
            for (time, (sample, (nees, nis))) in statistics.samples().iter().zip(squares).enumerate() {
                let t = *sample as f64 * scenario.dt;
                let _ = write!(text, "{},{t},{}", super::super::table::quoted(&filter.name), statistics.done());
                let of_channels = columns.iter().flat_map(|column| match column {
                    Some(rows) => rows[time],
                    None => [f64::NAN; 5],
                });
                for number in [nees, nis].into_iter().chain(of_channels) {
                    let _ = if number.is_nan() { write!(text, ",") } else { write!(text, ",{number}") };
                }
                text.push('\n');
            }
        }
        text
    }
}
