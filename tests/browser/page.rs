//! The page in the browser: its state, and actions on its controls.

use std::collections::HashMap;
use std::path::Path;
use std::time::{Duration, Instant};

use base64::Engine as _;
use serde_json::{Value, json};

use crate::driver::Client;
use crate::pictures;

pub(crate) struct Page {
    client: Client,
}

/// The rectangle of a control \[CSS pixels\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    fn at(self, fraction: f64) -> (f64, f64) {
        (self.x + fraction * self.width, self.y + 0.5 * self.height)
    }
}

/// The places of all controls, as text.
const PLACES: &str = "JSON.stringify(JSON.parse(wasmBindings.kalmanscope_summary()).controls)";

/// What the app says of itself, also where it has not started or has stopped.
const STATE: &str =
    "(() => { try { return wasmBindings.kalmanscope_summary(); } catch (error) { return String(error); } })()";

impl Page {
    pub(crate) fn new(client: Client) -> Self {
        Self { client }
    }

    pub(crate) async fn go(&self, address: &str) {
        self.client.post("url", &json!({ "url": address })).expect("the page can be opened");
    }

    pub(crate) async fn enter_frame(&self) {
        self.post("frame", json!({ "id": 0 })).await;
    }

    pub(crate) async fn leave_frame(&self) {
        self.post("frame/parent", json!({})).await;
    }

    pub(crate) async fn value(&self, expression: &str) -> Value {
        let script = format!("return {expression};");
        let body = json!({ "script": script, "args": [] });
        self.client.post("execute/sync", &body).unwrap_or_else(|error| panic!("`{expression}`: {error}"))
    }

    pub(crate) async fn wait_until(&self, expression: &str, limit: Duration) -> Result<(), String> {
        let begun = Instant::now();
        while self.value(expression).await != true {
            if begun.elapsed() > limit {
                let state = self.value(STATE).await;
                return Err(format!("`{expression}` has not come true in {} s: {state}", limit.as_secs()));
            }
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        Ok(())
    }

    /// Waits for the app's next two frames, so that the screen reflects all input so far.
    pub(crate) async fn settle(&self) {
        let script = "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));";
        self.client.post("execute/async", &json!({ "script": script, "args": [] })).expect("frames are drawn");
    }

    /// Waits until no control has moved for some frames: windows have grown to their size, and what scrolls rests.
    pub(crate) async fn rest(&self) {
        const STILL: u32 = 4;
        let begun = Instant::now();
        let (mut before, mut still) = (Value::Null, 0);
        while still < STILL && begun.elapsed() < Duration::from_secs(20) {
            self.settle().await;
            let places = self.value(PLACES).await;
            still = if places == before { still + 1 } else { 0 };
            before = places;
        }
    }

    pub(crate) async fn summary(&self) -> Value {
        let text = self.value("window.wasmBindings.kalmanscope_summary()").await;
        let summary: Value = serde_json::from_str(text.as_str().expect("the summary is text")).expect("it is JSON");
        assert!(summary.is_object(), "the app has no summary");
        summary
    }

    async fn screenshot(&self) -> Vec<u8> {
        let answer = self.execute("Page.captureScreenshot", json!({})).await;
        let text = answer["data"].as_str().expect("a screenshot is text");
        base64::prelude::BASE64_STANDARD.decode(text).expect("it is base64")
    }

    /// Writes a PNG of the window beside the other pictures, and returns it.
    pub(crate) async fn save(&self, name: &str) -> Vec<u8> {
        let png = self.screenshot().await;
        std::fs::write(pictures().join(name), &png).expect("a picture can be written");
        png
    }

    /// The messages on the console since the last call, as (level, message).
    pub(crate) async fn console(&self) -> Vec<(String, String)> {
        let entries = self.post("se/log", json!({ "type": "browser" })).await;
        let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        let entries = entries.as_array().expect("the log is a list");
        entries.iter().map(|entry| (text(entry, "level"), text(entry, "message"))).collect()
    }

    /// Makes the window's content exactly this large. (A device scale emulated like this would not reach the canvas's
    /// resize observer, and the app would draw twice as large.)
    pub(crate) async fn resize(&self, width: u32, height: u32) {
        let params = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.execute("Emulation.setDeviceMetricsOverride", params).await;
        let resized = format!("innerWidth === {width} && innerHeight === {height}");
        self.wait_until(&resized, Duration::from_secs(10)).await.expect("the window can be resized");
        self.settle().await;
    }

    /// Makes the window one of this size on a phone, whose pointer is a finger.
    pub(crate) async fn become_phone(&self, (width, height): (u32, u32)) {
        let params = json!({ "enabled": true, "maxTouchPoints": 5 });
        self.execute("Emulation.setTouchEmulationEnabled", params).await;
        let params = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": true });
        self.execute("Emulation.setDeviceMetricsOverride", params).await;
    }

    pub(crate) async fn tap(&self, name: &str) {
        let at = self.rect(name).await.at(0.5);
        self.touch(at, at).await;
    }

    /// Taps a control that may move, or not listen yet, until the summary is as asked.
    pub(crate) async fn tap_until(&self, name: &str, is_reached: impl Fn(&Value) -> bool, limit: Duration) {
        let begun = Instant::now();
        loop {
            let summary = self.summary().await;
            if is_reached(&summary) {
                return;
            }
            assert!(begun.elapsed() < limit, "`{name}` does nothing: {summary}");
            match place(&summary, name).map(|rect| rect.at(0.5)) {
                Some(at) => self.touch(at, at).await,
                None => self.rest().await,
            }
        }
    }

    pub(crate) async fn touch(&self, from: (f64, f64), to: (f64, f64)) {
        const STEPS: u32 = 8;
        let points = |(x, y): (f64, f64)| json!([{ "x": x, "y": y }]);
        let mut events = vec![("touchStart", points(from))];
        for step in 1..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            let at = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            if from != to {
                events.push(("touchMove", points(at)));
            }
        }
        events.push(("touchEnd", json!([])));
        for (kind, points) in events {
            let params = json!({ "type": kind, "touchPoints": points });
            self.execute("Input.dispatchTouchEvent", params).await;
            self.settle().await;
        }
        self.rest().await;
    }

    pub(crate) async fn choose_file(&self, selector: &str, path: &Path) {
        let body = json!({ "using": "css selector", "value": selector });
        let input = self.client.post("element", &body).expect("the input exists");
        let id = input.as_object().and_then(|input| input.values().next()?.as_str()).expect("it has an id");
        let body = json!({ "text": path.display().to_string() });
        self.client.post(&format!("element/{id}/value"), &body).expect("the file can be chosen");
    }

    pub(crate) async fn click(&self, name: &str, fraction: f64) {
        let place = self.bring_into_view(name).await.at(fraction);
        self.client.act("pointer", &[go(place, 0), pause(100), button("pointerDown"), button("pointerUp")]);
        self.settle().await;
    }

    pub(crate) async fn drag(&self, name: &str, from: f64, to: f64) {
        let rect = self.bring_into_view(name).await;
        let mut actions = vec![go(rect.at(from), 0), pause(100), button("pointerDown")];
        actions.extend((1..=5).map(|step| go(rect.at(from + (to - from) * f64::from(step) / 5.0), 50)));
        actions.extend([pause(100), button("pointerUp")]);
        self.client.act("pointer", &actions);
        self.settle().await;
    }

    /// Drags a control to and fro between two fractions of its width, as fast as the page processes it.
    pub(crate) async fn sweep(&self, name: &str, (from, to): (f64, f64), duration: Duration) {
        const STEPS: usize = 60;
        let rect = self.bring_into_view(name).await;
        let begun = Instant::now();
        self.client.act("pointer", &[go(rect.at(from), 8), button("pointerDown")]);
        let ways = (1..=STEPS).map(|step| 2.0 * step as f64 / STEPS as f64).map(|way| way.min(2.0 - way));
        let to_and_fro: Vec<Value> = ways.map(|way| go(rect.at(from + (to - from) * way), 8)).collect();
        while begun.elapsed() < duration {
            self.client.act("pointer", &to_and_fro);
        }
        self.client.act("pointer", &[button("pointerUp")]);
        self.settle().await;
    }

    pub(crate) async fn allow_downloads(&self, folder: &Path) {
        let params = json!({ "behavior": "allow", "downloadPath": folder.to_string_lossy() });
        self.execute("Browser.setDownloadBehavior", params).await;
    }

    pub(crate) async fn theme(&self, theme: &str) {
        let params = json!({ "features": [{ "name": "prefers-color-scheme", "value": theme }] });
        self.execute("Emulation.setEmulatedMedia", params).await;
    }

    /// Makes the network as slow as this: bits per second, and the time to an answer.
    pub(crate) async fn network(&self, slow: Option<(f64, Duration)>) {
        let (bytes, latency) = slow.map_or((-1.0, 0), |(bits, latency)| (bits / 8.0, latency.as_millis()));
        let params = json!({ "offline": false, "latency": latency as u64, "downloadThroughput": bytes, "uploadThroughput": bytes });
        self.execute("Network.enable", json!({})).await;
        self.execute("Network.emulateNetworkConditions", params).await;
    }

    /// Runs a script before any other, on every page opened from now on.
    pub(crate) async fn prepare(&self, script: &str) {
        self.execute("Page.addScriptToEvaluateOnNewDocument", json!({ "source": script })).await;
    }

    /// Scrolls the panel with a control until all of it is visible. Returns its rectangle.
    async fn bring_into_view(&self, name: &str) -> Rect {
        let height = self.value("innerHeight").await.as_f64().expect("the window has a height");
        for _ in 0..40 {
            let rect = self.rect(name).await;
            let over = (rect.y + rect.height - height).ceil();
            if over <= 0.0 {
                return rect;
            }
            let (x, y) = (rect.at(0.5).0 as i64, (0.5 * height) as i64);
            let scroll = json!({ "type": "scroll", "x": x, "y": y, "deltaX": 0, "deltaY": over.min(100.0) as i64 });
            self.client.act("wheel", &[scroll]);
            // The app scrolls smoothly, and the pointer would miss a control in motion.
            self.rest().await;
        }
        panic!("`{name}` cannot be scrolled into view");
    }

    pub(crate) async fn rect(&self, name: &str) -> Rect {
        let summary = self.summary().await;
        place(&summary, name).unwrap_or_else(|| panic!("there is no control `{name}` among {}", summary["controls"]))
    }

    async fn execute(&self, command: &str, params: Value) -> Value {
        self.post("goog/cdp/execute", json!({ "cmd": command, "params": params })).await
    }

    async fn post(&self, command: &str, body: Value) -> Value {
        self.client.post(command, &body).unwrap_or_else(|error| panic!("{error}"))
    }
}

fn go((x, y): (f64, f64), milliseconds: u64) -> Value {
    json!({ "type": "pointerMove", "duration": milliseconds, "origin": "viewport", "x": x, "y": y })
}

fn pause(milliseconds: u64) -> Value {
    json!({ "type": "pause", "duration": milliseconds })
}

fn button(kind: &str) -> Value {
    json!({ "type": kind, "button": 0 })
}

pub(crate) fn has(name: &str) -> String {
    format!("JSON.parse(wasmBindings.kalmanscope_summary()).controls.some(it => it.name === '{name}')")
}

/// The `mean` or `std` of a channel of a filter in a summary.
pub(crate) fn estimate(filter: &Value, channel: &str, number: &str) -> f64 {
    let estimates = filter["estimates"].as_array().expect("estimates are a list");
    let one = estimates.iter().find(|one| one["channel"] == channel).expect("it is estimated");
    one[number].as_f64().expect("it is a number")
}

pub(crate) fn place(summary: &Value, name: &str) -> Option<Rect> {
    let controls = summary["controls"].as_array().expect("controls are a list");
    let control = controls.iter().find(|control| control["name"] == name)?;
    let number = |key: &str| control[key].as_f64().expect("a rectangle is numbers");
    Some(Rect { x: number("x"), y: number("y"), width: number("width"), height: number("height") })
}

pub(crate) fn colours(png: &[u8]) -> HashMap<[u8; 3], usize> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(png));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().expect("a screenshot is a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("it fits into memory")];
    let info = reader.next_frame(&mut pixels).expect("it is whole");
    let mut counts = HashMap::new();
    for pixel in pixels[..info.buffer_size()].chunks_exact(info.color_type.samples()) {
        *counts.entry([pixel[0], pixel[1], pixel[2]]).or_default() += 1;
    }
    counts
}
