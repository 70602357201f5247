//! Files that the user gives to the page, and those that it gives back as downloads of the browser.

use egui::Context;
use kalmanscope::export::{self, Deliver};
use kalmanscope::inbox::{self, Arrival, Choose, Inbox};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, BlobPropertyBag, Document, File, HtmlAnchorElement, HtmlInputElement, Url};

use super::object::{call, words};

pub(super) fn choose(document: &Document, ctx: &Context, inbox: &Inbox) -> Option<Choose> {
    let input: HtmlInputElement = document.get_element_by_id("file")?.dyn_into().ok()?;
    let (own, ctx, inbox) = (input.clone(), ctx.clone(), inbox.clone());
    let listener = Closure::<dyn FnMut()>::new(move || {
        let file = own.files().and_then(|files| files.get(0));
        if let Some(file) = file {
            open(file, &ctx, &inbox);
        }
        // The same file can be chosen again.
        own.set_value("");
    });
    input.add_event_listener_with_callback("change", listener.as_ref().unchecked_ref()).ok()?;
    // The page listens for as long as the function lives.
    Some(Box::new(move |_, _| {
        let _listens = &listener;
        input.click();
    }))
}

pub(super) fn open(file: File, ctx: &Context, inbox: &Inbox) {
    let (ctx, inbox) = (ctx.clone(), inbox.clone());
    wasm_bindgen_futures::spawn_local(async move {
        let contents = read(&file).await;
        inbox.put(Arrival::File(file.name(), contents), &ctx);
    });
}

async fn read(file: &File) -> Result<Vec<u8>, String> {
    if file.size() > inbox::LARGEST as f64 {
        return Err(inbox::TOO_LARGE.to_owned());
    }
    let buffer = JsFuture::from(file.array_buffer()).await;
    let buffer = buffer.map_err(|error| words(&error))?;
    Ok(js_sys::Uint8Array::new(&buffer).to_vec())
}

/// The contents are given up after this time \[ms\].
const AFTER: u32 = 60_000;

pub(super) fn download() -> Deliver {
    Box::new(|file, done| {
        let given = give(&file).map(|()| format!("{}, among the browser's downloads", file.name));
        done(given.map_err(|error| words(&error)));
    })
}

fn give(file: &export::ExportFile) -> Result<(), JsValue> {
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
