//! Kalmanscope on the command line: whole runs as a table, a CSV file or a picture.
//!
//! ```
//! use kalmanscope_cli::{Results, run_scenario};
//! use kalmanscope_diagnosis::{Analysis, Wanted};
//! use kalmanscope_core::Scenario;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let run = run_scenario(&Scenario::from_toml("duration = 5.0")?, None)?;
//! println!("{}", Results::of_run(&run, &Analysis::new(&run, Wanted::default()), Vec::new()).table(false));
//! # Ok(())
//! # }
//! ```

mod causes;
mod estimates_csv;
mod free_run;
#[cfg(feature = "program")]
mod in_turn;
mod in_words;
mod json;
mod number;
#[cfg(not(target_arch = "wasm32"))]
pub mod output;
mod plot;
mod report;
mod results;
mod rows;
mod series;
mod table;

use std::sync::Arc;

use kalmanscope_core::{Record, Run, RunError, Scenario};

pub use causes::causes;
pub use estimates_csv::{harmless, write_estimates};
pub use number::{significant, with_spread};
pub use plot::{pages, svg};
pub use report::{ReportParts, report};
pub use results::Results;

/// Runs a scenario from the first sample to the last: over its own simulated record, or over a measured one.
///
/// # Errors
/// [`RunError`] where the scenario is impossible or the record lacks one of its sensors.
pub fn run_scenario(scenario: &Scenario, record: Option<Record>) -> Result<Run, RunError> {
    let mut run = match record {
        Some(record) => Run::on_record(scenario, Arc::new(record))?,
        None => Run::new(scenario)?,
    };
    run.finish();
    Ok(run)
}
