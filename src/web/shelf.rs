//! The record's file in the browser's store, which no server sees.

use std::rc::Rc;

use egui::Context;
use js_sys::{Array, JsString, Uint8Array, decode_uri_component, encode_uri_component};
use kalmanscope::inbox::{Arrival, Inbox};
use kalmanscope::shelf::Shelf;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{Cache, Request, Response};

/// The name of the store. The page's own files are in others.
const STORE: &str = "kalmanscope's record";

/// The beginning of the address under which the file is kept; nothing is ever loaded from there.
const ADDRESS: &str = "/kalmanscope-record?";

/// The store of this browser.
pub(super) struct Browser;

impl Shelf for Browser {
    fn keep(&self, name: &str, bytes: Rc<[u8]>) {
        let address = format!("{ADDRESS}{}", String::from(encode_uri_component(name)));
        say(async move {
            let store = emptied().await?;
            let mut contents = Uint8Array::from(&*bytes).to_vec();
            let response = Response::new_with_opt_u8_array(Some(&mut contents))?;
            JsFuture::from(store.put_with_str(&address, &response)).await.map(drop)
        });
    }

    fn fetch(&self, ctx: &Context, inbox: &Inbox) {
        let (ctx, inbox) = (ctx.clone(), inbox.clone());
        say(async move {
            let store = opened().await?;
            let kept: Array = JsFuture::from(store.keys()).await?.dyn_into()?;
            let Ok(request) = kept.get(0).dyn_into::<Request>() else { return Ok(()) };
            let url = request.url();
            let name = url.split_once('?').map_or("record", |(_, name)| name);
            let name = decode_uri_component(name).map_or_else(|_| "record".to_owned(), JsString::into);
            let response: Response = JsFuture::from(store.match_with_request(&request)).await?.dyn_into()?;
            let buffer = JsFuture::from(response.array_buffer()?).await?;
            inbox.put(Arrival::Kept(name, Uint8Array::new(&buffer).to_vec()), &ctx);
            Ok(())
        });
    }

    fn forget(&self) {
        say(async { emptied().await.map(drop) });
    }

    fn place(&self) -> &'static str {
        "this browser"
    }
}

async fn opened() -> Result<Cache, JsValue> {
    let window = web_sys::window().ok_or("there is no window")?;
    JsFuture::from(window.caches()?.open(STORE)).await?.dyn_into()
}

async fn emptied() -> Result<Cache, JsValue> {
    let store = opened().await?;
    let kept: Array = JsFuture::from(store.keys()).await?.dyn_into()?;
    for request in kept {
        JsFuture::from(store.delete_with_request(&request.dyn_into()?)).await?;
    }
    Ok(store)
}

/// Does some work beside the frames, and logs why it fails: a private window may have no store.
fn say(work: impl Future<Output = Result<(), JsValue>> + 'static) {
    spawn_local(async move {
        if let Err(error) = work.await {
            log::warn!("The record is not kept: {error:?}");
        }
    });
}
