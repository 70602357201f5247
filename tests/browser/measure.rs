//! A phone measures a free decay with its accelerometer and its microphone.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use kalmanscope_core::import::wav;
use serde_json::Value;

use crate::page::Page;

/// Limits the time until something is there.
const PATIENCE: Duration = Duration::from_secs(120);

/// Half a minute of a swing of 6 rad/s with 1 % damping beside gravity, after two seconds of rest: what a phone's browser tells.
const SWING: &str = "(() => {
    for (let k = 0; k < 1800; k += 1) {
        const t = (k + 0.4 * Math.sin(91.7 * k)) / 60;
        const a = t < 2 ? 0 : 2 * Math.exp(-0.06 * (t - 2)) * Math.cos(6 * (t - 2));
        const noise = n => 0.05 * Math.sin(12.9898 * (k + 1) * n);
        const accelerationIncludingGravity = { x: 0.3 + 0.6 * a + noise(3), y: 9.7 + 0.8 * a + noise(5), z: noise(7) };
        const event = new DeviceMotionEvent('devicemotion', { accelerationIncludingGravity, interval: 16 });
        Object.defineProperty(event, 'timeStamp', { value: 1000 * t });
        window.dispatchEvent(event);
    }
    return true;
})()";

/// Permission that comes after the measurement was cancelled begins nothing.
pub(crate) async fn a_late_permission_begins_nothing(page: &Page) {
    let asks = "(() => {
        window.listeners = 0;
        const add = window.addEventListener;
        window.addEventListener = function (kind, ...rest) {
            window.listeners += kind === 'devicemotion';
            return add.call(this, kind, ...rest);
        };
        DeviceMotionEvent.requestPermission = () => new Promise(answer => { window.answer = answer; });
        return true;
    })()";
    assert_eq!(page.value(asks).await, true);
    page.tap("Scenario").await;
    page.tap("Measure with this device…").await;
    page.tap("Begin to measure").await;
    page.tap("Cancel").await;
    assert_eq!(page.value("(() => { window.answer('granted'); return true; })()").await, true);
    page.settle().await;
    assert_eq!(page.value("window.listeners").await, 0);
    assert_eq!(page.value("delete DeviceMotionEvent.requestPermission").await, true);
}

/// Taps, measures, and finds the parameters.
pub(crate) async fn a_decay_is_identified(page: &Page, picture: &Path) {
    page.tap("Scenario").await;
    page.tap("Measure with this device…").await;
    page.tap("Begin to measure").await;
    assert_eq!(page.value(SWING).await, true);
    page.settle().await;
    page.settle().await;
    std::fs::write(picture, page.screenshot().await).expect("a picture can be written");
    page.tap("Stop and identify").await;
    let [frequency, damping] = identified(page).await;
    assert!((frequency / 6.0 - 1.0).abs() < 0.002 && (damping / 0.01 - 1.0).abs() < 0.15, "{frequency} {damping}");
    std::fs::write(picture.with_file_name("phone-measured.png"), page.screenshot().await)
        .expect("a picture can be written");
}

/// Opens the record that was measured. Returns ωₙ and ζ of the first filter.
async fn identified(page: &Page) -> [f64; 2] {
    identified_if_heard(page).await.expect("there is something to identify")
}

/// The same; `None` where the page says that there is nothing to identify.
async fn identified_if_heard(page: &Page) -> Option<[f64; 2]> {
    let asks = "JSON.parse(wasmBindings.kalmanscope_summary()).controls.some(it => ['Open the record', 'Again'].includes(it.name))";
    page.wait_until(asks, PATIENCE).await.expect("the record is read, or the reason why not is said");
    if page.summary().await["controls"].as_array().is_some_and(|all| all.iter().any(|it| it["name"] == "Again")) {
        page.tap("Close").await;
        return None;
    }
    // The button moves while the file is read, and it ignores a tap before the file is read to its end.
    let asked = Instant::now();
    loop {
        let summary = page.summary().await;
        let controls = summary["controls"].as_array().expect("there are controls");
        // A busy machine may have heard little: that is for the caller to judge.
        if summary["mode"] == "whole" && !controls.iter().any(|control| control["name"] == "Open the record") {
            break;
        }
        assert!(asked.elapsed() < PATIENCE, "the record does not open: {summary}");
        page.tap_if_there("Open the record").await;
        page.rest().await;
    }
    page.settle().await;
    // The filters go through it in the frames.
    let begin = Instant::now();
    let mut summary = page.summary().await;
    loop {
        tokio::time::sleep(Duration::from_millis(500)).await;
        let later = page.summary().await;
        if later["filters"] == summary["filters"] {
            break;
        }
        assert!(begin.elapsed() < PATIENCE, "the filters come to no end");
        summary = later;
    }
    Some(estimated(&summary))
}

/// ωₙ and ζ of the first filter.
fn estimated(summary: &Value) -> [f64; 2] {
    ["natural_frequency", "damping_ratio"].map(|channel| {
        let estimates = summary["filters"][0]["estimates"].as_array().expect("there are estimates");
        let one = estimates.iter().find(|it| it["channel"] == channel).expect("it is estimated");
        one["mean"].as_f64().expect("it is a number")
    })
}

/// Whether there is a control with this name.
fn has(name: &str) -> String {
    format!("JSON.parse(wasmBindings.kalmanscope_summary()).controls.some(it => it.name === '{name}')")
}

/// Motion events of a swing at some rate from now on, four at once.
const STREAM: &str = "(rate => {
    const begin = performance.now();
    let k = 0;
    setInterval(() => {
        for (; k < rate * 1e-3 * (performance.now() - begin); k += 1) {
            const t = k / rate;
            const a = t < 2 ? 0 : 2 * Math.exp(-0.06 * (t - 2)) * Math.cos(6 * (t - 2));
            const noise = n => 0.05 * Math.sin(12.9898 * (k + 1) * n);
            const accelerationIncludingGravity = { x: 0.3 + 0.6 * a + noise(3), y: 9.7 + 0.8 * a + noise(5), z: noise(7) };
            const event = new DeviceMotionEvent('devicemotion', { accelerationIncludingGravity, interval: 1000 / rate });
            Object.defineProperty(event, 'timeStamp', { value: 1000 * t });
            window.dispatchEvent(event);
        }
    }, 10);
    return true;
})";

/// Begins to measure while readings come at this rate \[1/s\], and waits until it swings.
pub(crate) async fn stream(page: &Page, rate: u32) {
    page.tap("Scenario").await;
    page.tap("Measure with this device…").await;
    page.tap("Begin to measure").await;
    page.value(&format!("{STREAM}({rate})")).await;
    page.wait_until(&has("Watch the filters"), PATIENCE).await.expect("it swings");
}

/// The filters are on screen while it swings, and their record grows.
pub(crate) async fn filters_are_watched(page: &Page, picture: &Path) {
    stream(page, 60).await;
    page.tap("Watch the filters").await;
    for samples in [300, 420] {
        let grows = format!(
            "(it => it.mode === 'live' && it.samples > {samples})(JSON.parse(wasmBindings.kalmanscope_summary()))"
        );
        page.wait_until(&grows, PATIENCE).await.expect("the record grows");
    }
    std::fs::write(picture, page.screenshot().await).expect("a picture can be written");
    page.tap("Stop and identify").await;
    identified(page).await;
}

/// White noise from -1/2 to 1/2. Source: Steele, Lea and Flood (2014), Fast splittable pseudorandom number generators (its mix).
fn noise(k: u32) -> f64 {
    let mut bits = (u64::from(k) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    for factor in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
        bits = (bits ^ (bits >> 29)).wrapping_mul(factor);
    }
    (bits >> 40) as f64 / f64::from(1 << 24) - 0.5
}

/// A sound for the browser's microphone: a fork of 440 Hz with a damping of 0.05 % and a second mode, struck after a second.
pub(crate) fn fork(folder: &Path) -> PathBuf {
    let sample = |k: u32| {
        let since = f64::from(k) / 48_000.0 - 1.0;
        let mode = |hertz: f64, damping: f64| {
            let w = TAU * hertz;
            (-damping * w * since).exp() * (w * since).sin()
        };
        let rings = if since < 0.0 { 0.0 } else { 0.4 * mode(440.0, 5e-4) + 0.1 * mode(2756.0, 1e-3) };
        (rings + 0.004 * noise(k)) as f32
    };
    let path = folder.join("fork.wav");
    let bytes = wav(48_000, &(0..384_000).map(sample).collect::<Vec<f32>>()).expect("a sound");
    std::fs::write(&path, bytes).expect("it can be written");
    path
}

/// A busy machine may drop some of the sound: it listens so often at most.
const ATTEMPTS: usize = 3;

/// Listens to what the browser's microphone tells, and finds the parameters of the fork.
pub(crate) async fn a_ring_is_identified(page: &Page, picture: &Path) {
    let mut found = None;
    for _ in 0..ATTEMPTS {
        page.tap("Scenario").await;
        page.tap("Measure with this device…").await;
        page.tap("It rings").await;
        page.tap("Begin to listen").await;
        // The length of the sound.
        tokio::time::sleep(Duration::from_secs(8)).await;
        std::fs::write(picture, page.screenshot().await).expect("a picture can be written");
        page.tap("Stop and identify").await;
        found = identified_if_heard(page).await;
        std::fs::write(picture.with_file_name("phone-heard.png"), page.screenshot().await)
            .expect("a picture can be written");
        let Some([frequency, damping]) = found else { continue };
        if (frequency / TAU / 440.0 - 1.0).abs() < 0.002 && (damping / 5e-4 - 1.0).abs() < 0.15 {
            return;
        }
    }
    panic!("{found:?}, {ATTEMPTS} times");
}
