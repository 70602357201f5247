//! The desktop program: its arguments and its window.

mod crash;
mod desktop;
mod file_dialog;
mod graphics;
mod listen;
mod shelf;
mod state_file;
mod team;
mod window;

use std::fs::File;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use kalmanscope::share::address;
use kalmanscope_core::Scenario;

use listen::Listening;
use window::Beginning;

const INVALID: u8 = 2;

/// The interactive explorer of system identification with Kalman filters.
#[derive(Parser)]
#[command(name = "kalmanscope", version)]
struct Arguments {
    /// An address with #link=…, ?lesson=NAME or ?scenario=NAME, or a file: a measured record, a scenario, a session or
    /// a lesson. With --listen: a scenario, whose filters follow the source
    #[arg(value_name = "LINK or FILE")]
    target: Option<String>,
    /// Follow lines with a time and three accelerations, or with a scenario the time, the input and the readings of its
    /// sensors, under a header such as `t,force,displacement`. From serial:/dev/ttyUSB0?baud=115200, tcp://HOST:PORT,
    /// udp://HOST:PORT, or - for standard input
    #[arg(long, value_name = "SOURCE")]
    listen: Option<String>,
    /// Write every line to a new file
    #[arg(long, value_name = "FILE", requires = "listen")]
    keep: Option<String>,
}

pub(super) fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let beginning = match begin(Arguments::parse()) {
        Ok(beginning) => beginning,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(INVALID);
        }
    };
    let Err(error) = window::open(beginning) else {
        return ExitCode::SUCCESS;
    };
    // The message follows the last colon; a place in the toolkit's source comes before it.
    let error = error.to_string();
    let reason = error.rsplit(": ").next().unwrap_or(&error).trim_end_matches('.');
    eprintln!("error: no window can be opened ({reason}); kalmanscope-cli runs scenarios without one");
    ExitCode::FAILURE
}

fn begin(Arguments { target, listen, keep }: Arguments) -> Result<Beginning, String> {
    if let Some(source) = listen {
        let scenario = target.as_deref().map(read_scenario).transpose()?;
        let keep = keep.map(|file| match File::create_new(&file) {
            Ok(kept) => Ok((file, kept)),
            Err(error) => Err(format!("{file} cannot be made: {error}")),
        });
        let source = Some(Listening { source, scenario, keep: keep.transpose()? });
        return Ok(Beginning { source, ..Beginning::default() });
    }
    let Some(target) = target else { return Ok(Beginning::default()) };
    if Path::new(&target).is_file() {
        return Ok(Beginning { file: Some(target.into()), ..Beginning::default() });
    }
    match address::target(&target) {
        Ok(Some(_)) => Ok(Beginning { address: Some(target), ..Beginning::default() }),
        Ok(None) => {
            Err(format!("“{target}” is neither a file nor an address with #link=…, ?lesson=NAME or ?scenario=NAME"))
        }
        Err(error) => Err(error.to_string()),
    }
}

fn read_scenario(file: &str) -> Result<Scenario, String> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{file} cannot be read: {error}"))?;
    let scenario = Scenario::from_toml(&text).map_err(|error| format!("{file}: {error}"))?;
    scenario.validate().map_err(|error| format!("{file}: {error}"))?;
    Ok(scenario)
}
