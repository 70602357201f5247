//! Files as downloads of the browser.

use kalmanscope::export::{Deliver, File};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, BlobPropertyBag, HtmlAnchorElement, Url};

use super::object::call;

/// The contents are given up after this time \[ms\].
const AFTER: u32 = 60_000;

pub(super) fn download() -> Deliver {
    Box::new(|file, done| {
        let given = give(&file).map(|()| format!("{}, among the browser's downloads", file.name));
        done(given.map_err(|error| error.as_string().unwrap_or_else(|| format!("{error:?}"))));
    })
}

fn give(file: &File) -> Result<(), JsValue> {
    let document = web_sys::window().and_then(|window| window.document()).ok_or("there is no document")?;
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(file.contents.as_slice()));
    let options = BlobPropertyBag::new();
    options.set_type(file.kind);
    let blob = Blob::new_with_u8_array_sequence_and_options(&parts, &options)?;
    let address = Url::create_object_url_with_blob(&blob)?;
    let link: HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&address);
    link.set_download(&file.name);
    link.click();
    // Safari fetches the contents after this turn: revoked at once, the address gives an empty file.
    let revoke = Closure::once_into_js(move || _ = Url::revoke_object_url(&address).ok());
    call(&js_sys::global(), "setTimeout", &[&revoke, &AFTER.into()])?;
    Ok(())
}
