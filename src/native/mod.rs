//! The desktop program: its arguments and its window.

mod desktop;
mod file_dialog;
mod listen;
mod record_store;
mod state_file;
mod team;

use std::path::Path;
use std::process::ExitCode;
use std::rc::Rc;

use clap::Parser;
use desktop::Desktop;
use eframe::NativeOptions;
use egui::{Context, ViewportBuilder};
use kalmanscope::App;
use kalmanscope::sensor::{SensorDevice, Sensors};
use kalmanscope::share::address;
use kalmanscope_core::Scenario;
use kalmanscope_gpu::Software;
use kalmanscope_sources::Accelerations;
use listen::{Listening, ScenarioParser, SensorListener};

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
    let Err(error) = open(beginning) else {
        return ExitCode::SUCCESS;
    };
    // The message follows the last colon; a place in the toolkit's source comes before it.
    let error = error.to_string();
    let reason = error.rsplit(": ").next().unwrap_or(&error).trim_end_matches('.');
    eprintln!("error: no window can be opened ({reason}); kalmanscope-cli runs scenarios without one");
    ExitCode::FAILURE
}

fn begin(Arguments { target, listen }: Arguments) -> Result<LaunchPlan, String> {
    if let Some(source) = listen {
        let scenario = target.as_deref().map(read_scenario).transpose()?;
        return Ok(LaunchPlan { target: None, source: Some(Listening { source, scenario }) });
    }
    if let Some(address) = target.as_deref().filter(|target| !Path::new(target).is_file())
        && address::target(address).map_err(|error| error.to_string())?.is_none()
    {
        return Err(format!(
            "“{address}” is neither a file nor an address with #link=…, ?lesson=NAME or ?scenario=NAME"
        ));
    }
    Ok(LaunchPlan { target, source: None })
}

fn read_scenario(file: &str) -> Result<Scenario, String> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{file} cannot be read: {error}"))?;
    let scenario = Scenario::from_toml(&text).map_err(|error| format!("{file}: {error}"))?;
    scenario.validate().map_err(|error| format!("{file}: {error}"))?;
    Ok(scenario)
}

const ID: &str = "kalmanscope";

struct LaunchPlan {
    target: Option<String>,
    source: Option<Listening>,
}

fn open(LaunchPlan { target, source }: LaunchPlan) -> eframe::Result {
    let viewport = ViewportBuilder::default()
        .with_title("Kalmanscope")
        .with_app_id(ID)
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([360.0, 420.0])
        .with_icon(eframe::icon_data::from_png_bytes(include_bytes!("../../assets/icon-256.png")).unwrap_or_default());
    let folder = eframe::storage_dir(ID).ok_or_else(|| "there is no folder for it".to_owned());
    let options = NativeOptions { viewport, ..NativeOptions::default() };
    let creator: eframe::AppCreator<'_> = Box::new(|creation| {
        let ctx = &creation.egui_ctx;
        let folder = folder.as_deref().map_err(Clone::clone);
        let desktop = Desktop::new(ctx, folder, |app| {
            let app = app.delivering(file_dialog::save()).choosing(Some(file_dialog::choose()));
            let mut app = app.working_with(team::team(Software::Refused, ctx));
            match target {
                Some(path) if Path::new(&path).is_file() => app.read_file(Path::new(&path), ctx),
                Some(address) => app.open_address(&address),
                None => {}
            }
            if let Some(source) = source {
                app = listening(app, source, ctx);
            }
            app
        })?;
        #[cfg(unix)]
        desktop::close_at_signals(ctx);
        Ok(Box::new(desktop))
    });
    eframe::run_native(ID, options, creator)
}

fn listening(app: App, Listening { source, scenario }: Listening, ctx: &Context) -> App {
    let Some(scenario) = scenario else {
        let accelerometer: Rc<dyn SensorDevice<_>> = Rc::new(SensorListener::new(&source, Accelerations::default()));
        let mut app = app.measuring_with(Sensors { accelerometer: Some(accelerometer), ..Sensors::default() });
        app.measure();
        return app;
    };
    let stream: Rc<dyn SensorDevice<_>> = Rc::new(SensorListener::new(&source, ScenarioParser::new(&scenario)));
    let mut app = app.measuring_with(Sensors { stream: Some((stream, Rc::new(scenario))), ..Sensors::default() });
    app.watch(ctx);
    app
}
