//! The way to the first frame: progress by bytes, and the page without a network.

use std::fs;
use std::path::Path;
use std::time::Duration;

use tempfile::TempDir;

use crate::page::Page;
use crate::server::Server;
use crate::{FAILURE, START};

/// The network on which the first load is timed: bits per second, and the time to an answer.
const NETWORK: (f64, Duration) = (9e6, Duration::from_millis(20));

/// Collects all texts about bytes, beginning before the page's first script.
const WATCH: &str = "
    window.texts = [];
    new MutationObserver(() => {
        const text = document.getElementById('loading-bytes')?.textContent.trim();
        if (text && text !== window.texts.at(-1)) window.texts.push(text);
    }).observe(document, { subtree: true, childList: true, characterData: true });";

/// The version that the page shows while it loads and where it fails.
const VERSION: &str = "document.querySelector('#failure .version').textContent";

/// Makes the network slow, until [`first_load`] has been checked.
pub(crate) async fn prepare(page: &Page) {
    page.prepare(WATCH).await;
    page.network(Some(NETWORK)).await;
}

pub(crate) async fn first_load(page: &Page) {
    page.network(None).await;
    let (bits, latency) = NETWORK;
    let loaded = "performance.getEntriesByType('resource').find(entry => entry.name.endsWith('_bg.wasm')).responseEnd";
    println!(
        "at {} Mbit/s with {} ms: all bytes after {:.2} s, first frame after {:.2} s",
        bits / 1e6,
        latency.as_millis(),
        page.value(loaded).await.as_f64().unwrap() / 1e3,
        first_frame(page).await
    );
    let texts = page.value("window.texts").await;
    let texts: Vec<&str> = texts.as_array().unwrap().iter().filter_map(|text| text.as_str()).collect();
    println!("{} texts, such as {:?}", texts.len(), texts.get(texts.len() / 2));
    let last = texts.last().unwrap();
    assert!(texts.len() > 3, "progress is shown on the way: {texts:?}");
    assert_eq!(*last, "100 %", "progress ends with all bytes");
}

/// The time of the first frame \[s\].
async fn first_frame(page: &Page) -> f64 {
    page.value("performance.getEntriesByName('first frame')[0].startTime").await.as_f64().unwrap() / 1e3
}

/// The page is kept, replaces what is kept of older versions, and opens when the server is gone.
pub(crate) async fn opens_without_a_network(page: &Page, server: &Server) {
    let limit = Duration::from_secs(20);
    let version = page.value(VERSION).await;
    assert_eq!(version.as_str().unwrap().len(), 16, "the version is a hash: {version}");
    page.wait_until("navigator.serviceWorker.controller !== null", limit).await.expect("the page is kept");
    let names = "caches.keys().then(keys => keys.length === 1 && keys[0].endsWith(document.querySelector('.version').textContent))";
    page.wait_until(names, limit).await.expect("one version is kept");

    let old = format!("'kalmanscope {} 0123456789abcdef'", server.page());
    page.value(&format!("caches.open({old}).then(() => true)")).await;
    page.value("navigator.serviceWorker.ready.then(it => it.unregister())").await;
    page.go(&server.page()).await;
    page.wait_until("navigator.serviceWorker.controller !== null", limit).await.expect("the page is kept again");
    page.wait_until(&format!("caches.has({old}).then(has => !has)"), limit).await.expect("older versions are removed");

    server.stop();
    page.go(&server.page()).await;
    page.wait_until("performance.getEntriesByName('first frame').length > 0", limit).await.expect("it opens again");
    println!("first frame after {:.2} s without a network", first_frame(page).await);
    assert_eq!(page.value(VERSION).await, version);
    assert!(page.summary().await["samples"].as_u64().unwrap() > 0);
    let script =
        "fetch('./worker.js?program=' + document.querySelector('meta[name=version]').content).then(it => it.ok)";
    assert_eq!(page.value(script).await, true, "its workers start too");
}

/// The page of another version in the same folder neither takes over an open page nor deletes its files.
pub(crate) async fn an_open_page_keeps_its_version(page: &Page, address: &str, folder: &Path) {
    let limit = Duration::from_secs(20);
    page.go(address).await;
    page.wait_until("navigator.serviceWorker.controller !== null", limit).await.expect("the page is kept");
    let version = page.value(VERSION).await.as_str().unwrap().to_owned();
    let next = "0123456789abcdef";
    for file in fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()) {
        let name = file.file_name().unwrap().to_string_lossy().replace(&version, next);
        let is_text = name.ends_with(".html") || name.ends_with(".js");
        if let Some(text) = fs::read_to_string(&file).ok().filter(|_| is_text) {
            fs::remove_file(&file).unwrap();
            fs::write(folder.join(name), text.replace(&version, next)).unwrap();
        } else if name.contains(next) {
            fs::rename(&file, folder.join(name)).unwrap();
        } else if name.starts_with("index.html.") {
            fs::remove_file(&file).unwrap();
        }
    }
    page.value(&format!("navigator.serviceWorker.register('offline.js?version={next}').then(() => true)")).await;
    let waits = "navigator.serviceWorker.getRegistration().then(it => it.waiting !== null)";
    page.wait_until(waits, limit).await.expect("the new version is kept, and waits");
    let old = "fetch('./' + document.querySelector('meta[name=version]').content).then(it => it.ok)";
    assert_eq!(page.value(old).await, true, "the open page has its files");
}

/// Makes what the server sends of the program; `None` if it has no such file.
type Damage = fn(&[u8]) -> Option<Vec<u8>>;

/// Damages, and words of the sentence about each.
pub(crate) const DAMAGES: [(Damage, &str); 3] = [
    (|_| None, "404"),
    (|bytes| Some(bytes[..bytes.len() / 2].to_vec()), "WebAssembly"),
    (|_| Some(b"<!doctype html><title>Please log in</title>".to_vec()), "WebAssembly"),
];

pub(crate) async fn says_why_it_does_not_start(page: &Page, address: &str, sentence: &str) {
    page.go(address).await;
    page.wait_until(&format!("({FAILURE}) !== ''"), START).await.expect("the page says that it failed");
    let text = page.value(FAILURE).await;
    let text = text.as_str().unwrap();
    assert!(text.contains("could not start") && text.contains(sentence), "{text}");
}

pub(crate) fn copied(dist: &Path) -> TempDir {
    damaged(dist, |bytes| Some(bytes.to_vec()))
}

pub(crate) fn damaged(dist: &Path, damage: Damage) -> TempDir {
    let copy = tempfile::tempdir().unwrap();
    for file in fs::read_dir(dist).unwrap().map(|file| file.unwrap().path()) {
        let to = copy.path().join(file.file_name().unwrap());
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with("kalmanscope-") && name.contains("_bg.wasm") {
            // Neither the file nor a compressed one.
            if !name.ends_with(".wasm") {
                continue;
            }
            if let Some(bytes) = damage(&fs::read(file).unwrap()) {
                fs::write(to, bytes).unwrap();
            }
        } else {
            fs::copy(file, to).unwrap();
        }
    }
    copy
}

pub(crate) async fn failures_can_be_read(page: &Page) {
    page.value("window.kalmanscopeFailed('the reason in full')").await;
    let text = page.value(FAILURE).await;
    let text = text.as_str().unwrap();
    assert!(text.contains("Kalmanscope has stopped") && text.contains("the reason in full"), "{text}");
}
