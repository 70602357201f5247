//! The record's file in the browser's store, which no server sees.

use std::rc::Rc;

use egui::Context;
use js_sys::{Array, JsString, Uint8Array, decode_uri_component, encode_uri_component};
use kalmanscope::inbox::{Arrival, Done, Inbox};
use kalmanscope::record_store::RecordStore;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{Cache, Request, Response};

use super::object::words;

/// The name of the store. The page's own files are in others.
const STORE: &str = "kalmanscope's record";

/// The beginning of the address under which the file is kept; nothing is ever loaded from there.
const ADDRESS: &str = "/kalmanscope-record?";

pub(super) struct Browser;

impl RecordStore for Browser {
    fn keep(&self, name: &str, bytes: Rc<[u8]>, done: Done) {
        let address = format!("{ADDRESS}{}", String::from(encode_uri_component(name)));
        spawn_local(async move { done(place(keep(&address, &bytes).await)) });
    }

    fn fetch(&self, ctx: &Context, inbox: &Inbox) {
        let (ctx, inbox) = (ctx.clone(), inbox.clone());
        spawn_local(async move {
            match kept().await {
                Ok(Some((name, bytes))) => inbox.put(Arrival::Kept(name, bytes), &ctx),
                Ok(None) => {}
                Err(error) => {
                    let sentence = format!("The record that was kept cannot be read: {}.", words(&error));
                    inbox.put(Arrival::Failure(sentence), &ctx);
                }
            }
        });
    }

    fn forget(&self, done: Done) {
        spawn_local(async move { done(place(forget_all_but(0).await)) });
    }
}

/// The place in words, or the reason: a private window may have no store.
fn place(end: Result<(), JsValue>) -> Result<String, String> {
    end.map(|()| "this browser".to_owned()).map_err(|error| words(&error))
}

async fn keep(address: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let mut contents = Uint8Array::from(bytes).to_vec();
    let response = Response::new_with_opt_u8_array(Some(&mut contents))?;
    JsFuture::from(opened().await?.put_with_str(address, &response)).await?;
    forget_all_but(1).await
}

async fn kept() -> Result<Option<(String, Vec<u8>)>, JsValue> {
    let store = opened().await?;
    let kept: Array = JsFuture::from(store.keys()).await?.dyn_into()?;
    let Ok(request) = kept.pop().dyn_into::<Request>() else { return Ok(None) };
    let url = request.url();
    let name = url.split_once('?').map_or("record", |(_, name)| name);
    let name = decode_uri_component(name).map_or_else(|_| "record".to_owned(), JsString::into);
    let response: Response = JsFuture::from(store.match_with_request(&request)).await?.dyn_into()?;
    let buffer = JsFuture::from(response.array_buffer()?).await?;
    Ok(Some((name, Uint8Array::new(&buffer).to_vec())))
}

async fn opened() -> Result<Cache, JsValue> {
    let window = web_sys::window().ok_or("there is no window")?;
    JsFuture::from(window.caches()?.open(STORE)).await?.dyn_into()
}

async fn forget_all_but(last: u32) -> Result<(), JsValue> {
    let store = opened().await?;
    let kept: Array = JsFuture::from(store.keys()).await?.dyn_into()?;
    for request in kept.slice(0, kept.length().saturating_sub(last)) {
        JsFuture::from(store.delete_with_request(&request.dyn_into()?)).await?;
    }
    Ok(())
}
