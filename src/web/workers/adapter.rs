//! The browser's offer of a graphics processor, asked for before a worker is started for it.

use js_sys::{Function, Promise, Reflect};
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::JsFuture;

/// Asks the browser for a graphics processor, or for a software adapter if that is accepted.
///
/// # Errors
/// The reason in words if it offers none.
pub(super) async fn ask(software: bool) -> Result<(), String> {
    let navigator = web_sys::window().map(|window| JsValue::from(window.navigator())).unwrap_or_default();
    let gpu = get(&navigator, "gpu").filter(JsValue::is_object).ok_or("this browser has no WebGPU")?;
    let adapter = request(&gpu).await.filter(JsValue::is_object);
    let adapter = adapter.ok_or("this browser's WebGPU finds no graphics processor")?;
    let info = get(&adapter, "info").unwrap_or_default();
    let is_software = get(&info, "isFallbackAdapter").is_some_and(|is| is.is_truthy());
    if is_software && !software {
        return Err("this browser's WebGPU has a program in place of a graphics processor".to_owned());
    }
    Ok(())
}

async fn request(gpu: &JsValue) -> Option<JsValue> {
    let request: Function = get(gpu, "requestAdapter")?.dyn_into().ok()?;
    let promise: Promise = request.call0(gpu).ok()?.dyn_into().ok()?;
    JsFuture::from(promise).await.ok()
}

fn get(object: &JsValue, key: &str) -> Option<JsValue> {
    Reflect::get(object, &key.into()).ok()
}
