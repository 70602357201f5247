//! Kalmanscope's entry points: native and web.
#[cfg(not(target_arch = "wasm32"))]
fn main() {}

#[cfg(target_arch = "wasm32")]
fn main() {
    use wasm_bindgen::JsCast as _;
    let canvas = web_sys::window()
        .and_then(|w| w.document())
        .and_then(|d| d.get_element_by_id("kalmanscope"))
        .and_then(|e| e.dyn_into::<web_sys::HtmlCanvasElement>().ok());
    struct App;
    impl eframe::App for App {
        fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
            egui::CentralPanel::default().show(ui, |ui| {
                ui.label("hello");
                let _ = egui_plot::Plot::new("p").show(ui, |_| ());
            });
        }
    }
    wasm_bindgen_futures::spawn_local(async move {
        if let Some(c) = canvas {
            let _ =
                eframe::WebRunner::new().start(c, eframe::WebOptions::default(), Box::new(|_| Ok(Box::new(App)))).await;
        }
    });
}
