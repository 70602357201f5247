//! The page under its policy, and in the frame of another page.

use std::fs;
use std::path::Path;

use serde_json::json;

use crate::page::Page;
use crate::server::Server;
use crate::{START, starts};

/// Collects what the policy has forbidden.
pub(crate) const WATCH: &str = "
    window.forbidden = [];
    document.addEventListener('securitypolicyviolation', event => {
        window.forbidden.push(`${event.effectiveDirective}: ${event.blockedURI} ${event.sourceFile}:${event.lineNumber}`);
    });";

/// The page starts under its policy, which allows no other script: neither from an attribute, nor from a text.
pub(crate) async fn policy_is_strict(page: &Page, address: &str) {
    starts(page, address).await;
    assert_eq!(page.value("window.forbidden").await, json!([]), "the page keeps its own policy");
    let add = "(script => { script.textContent = 'window.intruder = 1'; document.body.append(script); return 1; })
        (document.createElement('script'))";
    page.value(add).await;
    page.value(
        "(button => { button.setAttribute('onclick', 'window.intruder = 2'); button.click(); return 1; })
        (document.createElement('button'))",
    )
    .await;
    page.value(
        "(style => { document.body.append(style); style.textContent = 'canvas { display: none }'; return 1; })
        (document.createElement('style'))",
    )
    .await;
    let forbidden = page.value("window.forbidden.map(text => text.split(':')[0])").await;
    for directive in ["script-src-elem", "script-src-attr", "style-src-elem"] {
        assert!(forbidden.to_string().contains(directive), "{directive} is not among {forbidden}");
    }
    assert_eq!(page.value("window.intruder === undefined").await, true, "no other script runs");
    let fetched = "fetch('https://example.org/').then(() => 'sent', error => error.name)";
    assert_eq!(page.value(fetched).await, "TypeError", "nothing is sent elsewhere");
    // The console has all of this.
    page.console().await;
}

pub(crate) async fn in_a_frame(page: &Page, address: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("notes");
    fs::create_dir_all(&folder).expect("a folder can be made");
    let frame = format!("<iframe width=900 height=600 src=\"{address}?embed&scenario=duffing\"></iframe>");
    let host = format!("<!doctype html><title>Lecture notes</title><link rel=icon href=\"data:,\">{frame}");
    fs::write(folder.join("index.html"), host).expect("a file can be written");
    let notes = Server::start(folder).expect("a port is free");
    page.go(&notes.page()).await;
    page.enter_frame().await;
    page.wait_until("!document.getElementById('loading')", START).await.expect("the frame starts");
    assert!(page.summary().await["filters"].to_string().contains("UKF, Duffing"));
    page.leave_frame().await;
    let console = page.console().await;
    assert!(console.iter().all(|(level, _)| level != "SEVERE"), "{console:?}");
}
