//! Kalmanscope's entry points: a window or a web page.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    native::main()
}

#[cfg(target_arch = "wasm32")]
fn main() {
    web::main();
}

#[cfg(all(test, not(target_arch = "wasm32")))]
#[path = "../tests/ui/memory.rs"]
mod memory;
#[cfg(not(target_arch = "wasm32"))]
mod native;

#[cfg(target_arch = "wasm32")]
mod web {
    mod file_input;
    mod microphone;
    mod motion;
    mod object;
    mod record_store;
    mod tables;
    mod workers;

    use std::cell::RefCell;
    use std::rc::Rc;

    use kalmanscope::sensor::Sensors;
    use kalmanscope::share::address;
    use kalmanscope::theme;
    use wasm_bindgen::JsCast as _;
    use wasm_bindgen::prelude::*;

    use microphone::Microphone;
    use motion::MotionSensor;
    use tables::Tables;

    fn sensors(ctx: &egui::Context) -> Sensors {
        Sensors {
            accelerometer: MotionSensor::of_page(ctx).map(|motion| Rc::new(motion) as Rc<_>),
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

    struct Page {
        app: kalmanscope::App,
        tables: Option<Tables>,
        fragment: String,
    }

    impl Page {
        fn read_dropped_files(&mut self, ctx: &egui::Context) {
            // The explorer reads dropped files by their paths, which they do not have on a page: they are taken before.
            let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
            for file in dropped.iter().filter_map(|file| file.web_file()) {
                file_input::open(file.clone(), ctx, &self.app.inbox);
            }
        }
    }

    impl eframe::App for Page {
        fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
            self.read_dropped_files(ctx);
            let fragment = &frame.info().web_info.location.hash;
            // A link within the open page changes the fragment alone, and the browser loads nothing.
            if *fragment != self.fragment {
                self.fragment.clone_from(fragment);
                self.app.open_address(fragment);
            }
            self.app.logic(ctx, frame);
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

    #[wasm_bindgen]
    #[expect(unreachable_pub, reason = "JavaScript reaches it")]
    pub fn kalmanscope_summary() -> String {
        let summary = RUNNER.with_borrow(|runner| {
            let (runner, ctx) = runner.as_ref()?;
            let page = runner.app_mut::<Page>()?;
            kalmanscope_core::document::to_json(&page.app.screen_state(ctx)).ok()
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
            let mut app = app.on_cleared_window().delivering(file_input::download()).at_page(address::page(&address));
            let choose = web_sys::window()
                .and_then(|window| window.document())
                .and_then(|document| file_input::choose(&document, &creation.egui_ctx, &app.inbox));
            let team = workers::team(address::allows_software_graphics(&address), &creation.egui_ctx);
            app = app.choosing(choose).working_with(team);
            if !embedded {
                app = app.keeping_records(Box::new(record_store::Browser), &creation.egui_ctx);
                app = app.measuring_with(sensors(&creation.egui_ctx));
            }
            if is_match("(pointer: coarse)") {
                theme::expect_fingers(&creation.egui_ctx);
            }
            if is_match("(prefers-reduced-motion: reduce)") {
                app.reduce_motion(&creation.egui_ctx);
            }
            app.open_address(&address);
            let fragment = creation.integration_info.web_info.location.hash.clone();
            RUNNER.with_borrow_mut(|runner| {
                if let Some((_, ctx)) = runner {
                    *ctx = creation.egui_ctx.clone();
                }
            });
            Ok(Box::new(Page { app, tables, fragment }))
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
