//! The version of this page.

/// The hash in the program's name, which is in the addresses of scripts whose names have none. Empty if the page does not say.
pub(super) fn version() -> String {
    let document = web_sys::window().and_then(|window| window.document());
    let meta = document.and_then(|document| document.query_selector("meta[name=version]").ok().flatten());
    meta.and_then(|meta| meta.get_attribute("content")).unwrap_or_default()
}
