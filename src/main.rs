//! Kalmanscope's entry points: a window or a web page.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    native::main()
}

#[cfg(target_arch = "wasm32")]
fn main() {
    web::main();
}

#[cfg(not(target_arch = "wasm32"))]
mod native {
    mod crash;
    mod crash_page;
    mod desktop;
    mod file_dialog;
    mod graphics;
    mod keeper;
    mod listen;
    mod shelf;
    mod signals;
    mod slot;
    mod state_file;
    mod team;
    mod window;

    use std::fs::File;
    use std::path::Path;
    use std::process::ExitCode;

    use kalmanscope::share::address;
    use kalmanscope_core::Scenario;

    use listen::Listening;
    use window::Beginning;

    const USAGE: &str = "usage: kalmanscope [LINK or FILE]\n       kalmanscope --listen SOURCE [SCENARIO.toml] [--keep FILE]\n\nLINK is an address with #link=…, ?lesson=NAME or \
                         ?scenario=NAME; FILE is a measured record, a scenario or a lesson. SOURCE tells lines with a time and three \
                         accelerations, such as serial:/dev/ttyUSB0?baud=115200, tcp://HOST:PORT, \
                         udp://HOST:PORT, or - for standard input; with a scenario its filters follow the time, \
                         the input and the readings of its sensors, under a header such as `t,force,displacement`. FILE gets every line, and must not exist.";

    /// The exit code for an argument that cannot be used.
    const INVALID: u8 = 2;

    pub(super) fn main() -> ExitCode {
        env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
        let mut arguments = std::env::args().skip(1);
        let mut argument = arguments.next();
        let mut beginning = Beginning::default();
        if argument.as_deref() == Some("--listen") {
            // Without a source, the usage is told.
            if let Some(source) = arguments.next() {
                argument = None;
                beginning.source = match listening(source, arguments) {
                    Ok(listening) => Some(listening),
                    Err(error) => {
                        eprintln!("error: {error}");
                        return ExitCode::from(INVALID);
                    }
                }
            }
        }
        beginning.file = argument.as_deref().map(Path::new).filter(|path| path.is_file()).map(Path::to_owned);
        beginning.address = argument.filter(|_| beginning.file.is_none());
        match beginning.address.as_deref().map(address::target).transpose() {
            Ok(Some(None)) => {
                eprintln!("{USAGE}");
                return ExitCode::from(INVALID);
            }
            Err(error) => {
                eprintln!("error: {error}");
                return ExitCode::from(INVALID);
            }
            Ok(_) => {}
        }
        let Err(error) = window::open(beginning) else {
            return ExitCode::SUCCESS;
        };
        // The message follows the last colon; a place in the toolkit's source comes before it.
        let error = error.to_string();
        let reason = error.rsplit(": ").next().unwrap_or(&error).trim_end_matches('.');
        eprintln!("error: no window can be opened ({reason}); kalmanscope-cli runs scenarios without one");
        ExitCode::FAILURE
    }

    /// A source with what follows it: a scenario, a file for the lines.
    fn listening(source: String, mut arguments: impl Iterator<Item = String>) -> Result<Listening, String> {
        let mut listening = Listening { source, scenario: None, keep: None };
        while let Some(argument) = arguments.next() {
            if argument == "--keep" {
                let file = arguments.next().ok_or("--keep needs a file")?;
                let kept = File::create_new(&file).map_err(|error| format!("{file} cannot be made: {error}"))?;
                listening.keep = Some((file, kept));
            } else {
                listening.scenario = Some(read_scenario(&argument)?);
            }
        }
        Ok(listening)
    }

    fn read_scenario(file: &str) -> Result<Scenario, String> {
        let text = std::fs::read_to_string(file).map_err(|error| format!("{file} cannot be read: {error}"))?;
        let scenario = Scenario::from_toml(&text).map_err(|error| format!("{file}: {error}"))?;
        scenario.validate().map_err(|error| format!("{file}: {error}"))?;
        Ok(scenario)
    }
}

#[cfg(target_arch = "wasm32")]
mod web {
    mod download;
    mod file_input;
    mod messages;
    mod microphone;
    mod motion;
    mod object;
    mod shelf;
    mod tables;
    mod version;
    mod workers;

    use std::cell::RefCell;
    use std::rc::Rc;

    use kalmanscope::sensor::Sensors;
    use kalmanscope::share::address;
    use kalmanscope::theme;
    use wasm_bindgen::JsCast as _;
    use wasm_bindgen::prelude::*;

    use messages::{Message, Messages};
    use microphone::Microphone;
    use motion::Motion;
    use tables::Tables;

    /// The sensors of this page.
    fn sensors(ctx: &egui::Context) -> Sensors {
        Sensors {
            accelerometer: Motion::of_page(ctx).map(|motion| Rc::new(motion) as Rc<_>),
            microphone: Microphone::of_page().map(|microphone| Rc::new(microphone) as Rc<_>),
            stream: None,
        }
    }

    #[wasm_bindgen]
    extern "C" {
        #[wasm_bindgen(js_name = kalmanscopeFailed)]
        fn show_failure(message: &str);
        #[wasm_bindgen(js_name = kalmanscopeStarted)]
        fn show_first_frame();
    }

    thread_local! {
        static RUNNER: RefCell<Option<(eframe::WebRunner, egui::Context)>> = const { RefCell::new(None) };
    }

    /// The app, accessible from JavaScript, and its tables in the page.
    struct Page {
        app: kalmanscope::App,
        tables: Option<Tables>,
        /// The fragment of the page's address.
        fragment: String,
        /// The messages of the page that embeds this one.
        messages: Option<Messages>,
    }

    impl Page {
        /// Reads the files that were dropped in this frame.
        fn read_dropped_files(&mut self, ctx: &egui::Context) {
            let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
            for file in dropped.iter().filter_map(|file| file.web_file()) {
                file_input::open(file.clone(), ctx, self.app.inbox());
            }
        }
    }

    impl eframe::App for Page {
        fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
            self.read_dropped_files(ctx);
            let fragment = &frame.info().web_info.location.hash;
            if *fragment != self.fragment {
                self.fragment.clone_from(fragment);
                self.app.open_address(fragment);
            }
            // One message a frame, so that its answer shows its effect.
            let message = self.messages.as_ref().and_then(Messages::next);
            let taken = message.as_ref().map(|Message { text, .. }| self.app.take_message(text));
            self.app.logic(ctx, frame);
            if let (Some(message), Some(taken)) = (message, taken) {
                match taken {
                    Ok(taken) => message.answer(&self.app.answer_message(&taken)),
                    Err(refusal) => message.refuse(&refusal),
                }
                ctx.request_repaint();
            }
        }

        fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
            self.app.ui(ui, frame);
            if let Some(tables) = &mut self.tables {
                tables.follow(&self.app, ui.ctx());
            }
        }

        fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
            self.app.clear_color(visuals)
        }

        fn save(&mut self, storage: &mut dyn eframe::Storage) {
            self.app.save(storage);
        }

        fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
            Some(self)
        }
    }

    /// The state of the screen as JSON; `null` before the app has started.
    #[wasm_bindgen]
    #[expect(unreachable_pub, reason = "JavaScript reaches it")]
    pub fn kalmanscope_summary() -> String {
        let summary = RUNNER.with_borrow(|runner| {
            let (runner, ctx) = runner.as_ref()?;
            let page = runner.app_mut::<Page>()?;
            kalmanscope_core::Document::json(&page.app.screen_state(ctx)).ok()
        });
        summary.unwrap_or_else(|| "null".to_owned())
    }

    pub(super) fn main() {
        eframe::WebLogger::init(log::LevelFilter::Warn).ok();
        if web_sys::window().is_none() {
            return kalmanscope_worker::serve();
        }
        wasm_bindgen_futures::spawn_local(async {
            if let Err(error) = start().await {
                show_failure(&error);
            }
        });
    }

    /// Whether a media query matches: `(pointer: coarse)` where fingers point, for example.
    fn is_match(query: &str) -> bool {
        let asked = web_sys::window().and_then(|window| window.match_media(query).ok()?);
        asked.is_some_and(|query| query.matches())
    }

    async fn start() -> Result<(), String> {
        let document = web_sys::window().and_then(|window| window.document()).ok_or("there is no document")?;
        let canvas = document
            .get_element_by_id("kalmanscope")
            .and_then(|element| element.dyn_into::<web_sys::HtmlCanvasElement>().ok())
            .ok_or("the page has no canvas")?;
        let runner = eframe::WebRunner::new();
        let tables = Tables::new(&document);
        let address = web_sys::window().and_then(|window| window.location().href().ok()).unwrap_or_default();
        let creator: eframe::AppCreator<'static> = Box::new(move |creation| {
            let embedded = address::is_embedded(&address);
            let app = if embedded { kalmanscope::App::embedded(creation)? } else { kalmanscope::App::new(creation)? };
            let mut app =
                app.on_cleared_window().delivering(Box::new(download::download)).at_page(address::page(&address));
            let choose = web_sys::window()
                .and_then(|window| window.document())
                .and_then(|document| file_input::choose(&document, &creation.egui_ctx, app.inbox()));
            let team = workers::team(address::allows_software_graphics(&address), &creation.egui_ctx);
            app = app.choosing(choose).working_with(team);
            if !embedded {
                app = app.keeping_records(Box::new(shelf::Browser), &creation.egui_ctx);
            }
            if !embedded {
                app = app.measuring_with(sensors(&creation.egui_ctx));
            }
            if is_match("(pointer: coarse)") {
                theme::expect_fingers(&creation.egui_ctx);
            }
            if is_match("(prefers-reduced-motion: reduce)") {
                app.reduce_motion(&creation.egui_ctx);
            }
            app.open_address(&address);
            let messages = embedded.then(|| Messages::listen(&creation.egui_ctx)).flatten();
            let fragment = creation.integration_info.web_info.location.hash.clone();
            RUNNER.with_borrow_mut(|runner| {
                if let Some((_, ctx)) = runner {
                    *ctx = creation.egui_ctx.clone();
                }
            });
            Ok(Box::new(Page { app, tables, fragment, messages }))
        });
        RUNNER.set(Some((runner.clone(), egui::Context::default())));
        // Dithering costs time for every pixel, and there are no gradients.
        let options = eframe::WebOptions { dithering: false, ..eframe::WebOptions::default() };
        runner
            .start(canvas, options, creator)
            .await
            .map_err(|error| error.as_string().unwrap_or_else(|| format!("{error:?}")))?;
        // The toolkit's own field, which receives the keys typed into the picture.
        if let Ok(Some(field)) = document.query_selector("#kalmanscope + input") {
            field.set_attribute("aria-label", "Text for the field that is edited in the picture").ok();
        }
        show_first_frame();
        Ok(())
    }
}
