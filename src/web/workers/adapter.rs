//! The browser's offer of a graphics processor, asked for before a worker is started for it.

use wasm_bindgen::JsValue;

use super::super::object::{awaited, call, get};

/// Asks the browser for a graphics processor, or for a software adapter if that is accepted.
///
/// # Errors
/// The reason in words if it offers none.
pub(super) async fn ask(software: bool) -> Result<(), String> {
    let navigator = web_sys::window().map(|window| JsValue::from(window.navigator())).unwrap_or_default();
    let gpu = get(&navigator, "gpu").filter(JsValue::is_object).ok_or("this browser has no WebGPU")?;
    let adapter = awaited(call(&gpu, "requestAdapter", &[])).await.ok().filter(JsValue::is_object);
    let adapter = adapter.ok_or("this browser's WebGPU finds no graphics processor")?;
    let info = get(&adapter, "info").unwrap_or_default();
    let is_software = get(&info, "isFallbackAdapter").is_some_and(|is| is.is_truthy());
    if is_software && !software {
        return Err("this browser's WebGPU has a program in place of a graphics processor".to_owned());
    }
    Ok(())
}
