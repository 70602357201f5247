//! A phone: fingers are expected from the first frame, a swipe on a lesson leaves the plots in sight, and a free decay is
//! measured with the accelerometer and the microphone.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use kalmanscope_core::import::wav;
use serde_json::Value;

use crate::page::{Page, estimate, has, place};
use crate::sounds::ring;
use crate::{OVER, START};

/// The size of the window \[CSS pixels\].
const SIZE: (u32, u32) = (390, 844);

/// The share of the window that a lesson leaves to the plots.
const FOR_PLOTS: f64 = 0.45;

/// The height of what a finger presses \[CSS pixels\].
const FINGER: f64 = 39.5;

pub(crate) async fn opens(page: &Page, address: &str) {
    page.prepare(TELL).await;
    page.become_phone(SIZE).await;
    page.go(address).await;
    page.wait_until(OVER, START).await.expect("the page starts");
    assert_eq!(page.value("matchMedia('(pointer: coarse)').matches").await, true, "fingers point here");
    page.settle().await;
}

/// The first touch moves nothing: what is pressed has the size of a finger before it.
pub(crate) async fn fingers_are_expected(page: &Page) {
    const CONTROLS: [&str; 5] = ["Settings", "Scenario", "Views", "Lessons", "Restart"];
    let mut before = Vec::new();
    for control in CONTROLS {
        before.push(page.rect(control).await);
    }
    assert!(before[4].height >= FINGER, "{before:?}");
    page.save("phone-start.png").await;
    page.touch((195.0, 830.0), (195.0, 830.0)).await;
    for (control, before) in CONTROLS.into_iter().zip(before) {
        assert_eq!(page.rect(control).await, before, "{control} has moved");
    }
}

pub(crate) async fn a_lesson_leaves_the_plots_their_room(page: &Page) {
    page.tap("First lesson").await;
    let before = page.rect("Handle of the lesson").await;
    let bar = page.rect("Scenario").await;
    let between = before.y - (bar.y + bar.height);
    assert!(between >= FOR_PLOTS * f64::from(SIZE.1), "{between} points between bar and lesson");
    let at = (150.0, before.y + 100.0);
    for way in [-250.0, -250.0, 150.0] {
        page.touch(at, (at.0, at.1 + way)).await;
        assert_eq!(page.rect("Handle of the lesson").await, before, "after a swipe by {way}");
    }
    page.save("phone-lesson.png").await;
}

const PATIENCE: Duration = Duration::from_secs(120);

/// `tell(k, rate)` sends the k-th motion event of a swing of 6 rad/s with 1 % damping beside gravity, after two seconds of rest: what a
/// phone's browser sends, with jitter.
const TELL: &str = "window.tell = (k, rate) => {
        const t = (k + 0.4 * Math.sin(91.7 * k)) / rate;
        const a = t < 2 ? 0 : 2 * Math.exp(-0.06 * (t - 2)) * Math.cos(6 * (t - 2));
        const noise = n => 0.05 * Math.sin(12.9898 * (k + 1) * n);
        const accelerationIncludingGravity = { x: 0.3 + 0.6 * a + noise(3), y: 9.7 + 0.8 * a + noise(5), z: noise(7) };
        const event = new DeviceMotionEvent('devicemotion', { accelerationIncludingGravity, interval: 1000 / rate });
        Object.defineProperty(event, 'timeStamp', { value: 1000 * t });
        window.dispatchEvent(event);
    };";

/// Half a minute of it at once.
const SWING: &str = "(() => { for (let k = 0; k < 1800; k += 1) tell(k, 60); return true; })()";

/// The same from now on, some events at once.
const STREAM: &str = "(begin => {
        let k = 0;
        setInterval(() => { for (; k < 0.06 * (performance.now() - begin); k += 1) tell(k, 60); }, 10);
        return true;
    })(performance.now())";

async fn begin_to_measure(page: &Page) {
    page.tap("Scenario").await;
    // On a busy machine a tap may last longer than a click.
    let is_open = |summary: &Value| place(summary, "Start measuring").is_some();
    page.tap_until("Measure with this device…", is_open, PATIENCE).await;
    page.tap("Start measuring").await;
}

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
    begin_to_measure(page).await;
    page.tap("Cancel").await;
    assert_eq!(page.value("(() => { window.answer('granted'); return true; })()").await, true);
    page.settle().await;
    assert_eq!(page.value("window.listeners").await, 0);
    assert_eq!(page.value("delete DeviceMotionEvent.requestPermission").await, true);
}

pub(crate) async fn a_decay_is_identified(page: &Page) {
    begin_to_measure(page).await;
    assert_eq!(page.value(SWING).await, true);
    page.settle().await;
    page.settle().await;
    page.save("phone-measure.png").await;
    page.tap("Stop and identify").await;
    let [frequency, damping] = identified(page).await;
    assert!((frequency / 6.0 - 1.0).abs() < 0.002 && (damping / 0.01 - 1.0).abs() < 0.15, "{frequency} {damping}");
    page.save("phone-measured.png").await;
}

/// Waits for the record that was measured to open. Returns ωₙ and ζ of the first filter.
async fn identified(page: &Page) -> [f64; 2] {
    identified_if_heard(page).await.expect("there is something to identify")
}

/// The same; `None` where the page says that there is nothing to identify.
async fn identified_if_heard(page: &Page) -> Option<[f64; 2]> {
    let ends =
        "JSON.parse(wasmBindings.kalmanscope_summary()).controls.some(it => ['Columns…', 'Again'].includes(it.name))";
    page.wait_until(ends, PATIENCE).await.expect("the record is open, or the reason why not is said");
    if page.summary().await["controls"].as_array().is_some_and(|all| all.iter().any(|it| it["name"] == "Again")) {
        page.tap("Close").await;
        return None;
    }
    // A busy machine may have heard little: that is for the caller to judge.
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
    Some(["natural_frequency", "damping_ratio"].map(|channel| estimate(&summary["filters"][0], channel, "mean")))
}

pub(crate) async fn filters_are_watched(page: &Page) {
    begin_to_measure(page).await;
    page.value(STREAM).await;
    page.wait_until(&has("Watch the filters"), PATIENCE).await.expect("it swings");
    page.tap_until("Watch the filters", |summary| summary["mode"] == "live", PATIENCE).await;
    for samples in [300, 420] {
        let grows = format!(
            "(it => it.mode === 'live' && it.samples > {samples})(JSON.parse(wasmBindings.kalmanscope_summary()))"
        );
        page.wait_until(&grows, PATIENCE).await.expect("the record grows");
    }
    page.save("phone-live.png").await;
    page.tap("Stop and identify").await;
    identified(page).await;
}

/// A sound for the browser's microphone: a fork of 440 Hz with a damping of 0.05 % and a second mode, struck after a second.
pub(crate) fn fork(folder: &Path) -> PathBuf {
    let sound = ring([[0.4, 440.0, 5e-4], [0.1, 2756.0, 1e-3]], 0.004, 384_000);
    let path = folder.join("fork.wav");
    std::fs::write(&path, wav(48_000, &sound).expect("a sound")).expect("it can be written");
    path
}

/// A busy machine may drop some of the sound: it listens so often at most.
const ATTEMPTS: usize = 3;

pub(crate) async fn a_ring_is_identified(page: &Page) {
    let mut found = None;
    for _ in 0..ATTEMPTS {
        page.tap("Scenario").await;
        page.tap("Measure with this device…").await;
        page.tap("It rings").await;
        page.tap("Start listening").await;
        // The length of the sound.
        tokio::time::sleep(Duration::from_secs(8)).await;
        page.save("phone-ring.png").await;
        page.tap("Stop and identify").await;
        found = identified_if_heard(page).await;
        page.save("phone-heard.png").await;
        let Some([frequency, damping]) = found else { continue };
        if (frequency / TAU / 440.0 - 1.0).abs() < 0.002 && (damping / 5e-4 - 1.0).abs() < 0.15 {
            return;
        }
    }
    panic!("{found:?}, {ATTEMPTS} times");
}
