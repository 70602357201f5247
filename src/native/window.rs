//! The window of the desktop program.

use std::path::PathBuf;
use std::rc::Rc;

use eframe::NativeOptions;
use egui::{Context, IconData, ViewportBuilder};
use kalmanscope::App;
use kalmanscope::sensor::{Sensor, Sensors};
use kalmanscope_gpu::Software;
use kalmanscope_sources::Accelerations;

use super::crash;
use super::desktop::Desktop;
use super::listen::{Listened, Listening, OfScenario};
use super::{file_dialog, team};

const ID: &str = "kalmanscope";

#[derive(Default)]
pub(super) struct Beginning {
    pub(super) address: Option<String>,
    pub(super) file: Option<PathBuf>,
    pub(super) source: Option<Listening>,
}

pub(super) fn open(Beginning { address, file, source }: Beginning) -> eframe::Result {
    let viewport = ViewportBuilder::default()
        .with_title("Kalmanscope")
        .with_app_id(ID)
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([360.0, 420.0])
        .with_icon(icon());
    let folder = eframe::storage_dir(ID).ok_or_else(|| "there is no folder for it".to_owned());
    let options = NativeOptions { viewport, ..NativeOptions::default() };
    let creator: eframe::AppCreator<'_> = Box::new(|creation| {
        let ctx = &creation.egui_ctx;
        let folder = folder.as_deref().map_err(Clone::clone);
        if let Ok(folder) = &folder {
            crash::note_panics(folder);
        }
        let desktop = Desktop::new(ctx, folder, |app| {
            let app = app.delivering(file_dialog::save()).choosing(Some(file_dialog::choose()));
            let mut app = app.working_with(team::team(Software::Refused, ctx));
            if let Some(address) = address {
                app.open_address(&address);
            }
            if let Some(path) = file {
                app.read_file(&path, ctx);
            }
            if let Some(source) = source {
                app = listening(app, source, ctx);
            }
            app
        })?;
        #[cfg(unix)]
        super::desktop::close_at_signals(ctx);
        Ok(Box::new(desktop))
    });
    eframe::run_native(ID, options, creator)
}

fn listening(app: App, Listening { source, scenario, keep }: Listening, ctx: &Context) -> App {
    let Some(scenario) = scenario else {
        let accelerometer: Rc<dyn Sensor<_>> = Rc::new(Listened::new(&source, Accelerations::default(), keep));
        let mut app = app.measuring_with(Sensors { accelerometer: Some(accelerometer), ..Sensors::default() });
        app.measure();
        return app;
    };
    let stream: Rc<dyn Sensor<_>> = Rc::new(Listened::new(&source, OfScenario::new(&scenario), keep));
    let mut app = app.measuring_with(Sensors { stream: Some((stream, Rc::new(scenario))), ..Sensors::default() });
    app.watch(ctx);
    app
}

fn icon() -> IconData {
    eframe::icon_data::from_png_bytes(include_bytes!("../../assets/icon-256.png")).unwrap_or_default()
}
