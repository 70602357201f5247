//! The frame rate of the page while a slider is dragged, and the cost of a frame.

use std::fs;
use std::time::Duration;

use serde_json::Value;

use crate::page::Page;

/// Adds up the time of the page's animation callbacks \[ms\], beginning before the page's first script.
pub(crate) const STOPWATCH: &str = "
    window.busy = { sum: 0, longest: 0 };
    const native = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = callback => native(time => {
        const begin = performance.now();
        callback(time);
        const took = performance.now() - begin;
        window.busy.sum += took;
        window.busy.longest = Math.max(window.busy.longest, took);
    });";

/// The clock ticks of `/proc` per second, a constant of Linux.
const TICKS: f64 = 100.0;

pub(crate) struct Frames {
    pub(crate) per_second: f64,
    /// Time of the page's own code per frame: arithmetic, widgets, triangles \[ms\].
    pub(crate) page: f64,
    /// The longest such time \[ms\].
    pub(crate) longest: f64,
    /// Processor time per frame, by kind of the browser's processes \[ms\].
    pub(crate) processes: Vec<(String, f64)>,
}

/// Drags a slider to and fro for about this time.
pub(crate) async fn drag(page: &Page, browser: u32, name: &str, between: (f64, f64), duration: Duration) -> Frames {
    during(page, browser, page.sweep(name, between, duration)).await
}

/// The cost of what a future does.
pub(crate) async fn during(page: &Page, browser: u32, what: impl Future<Output = ()>) -> Frames {
    let before = (Moment::now(page).await, processor_times(browser));
    page.value("void (window.busy.longest = 0)").await;
    what.await;
    let after = (Moment::now(page).await, processor_times(browser));
    let frames = after.0.frames - before.0.frames;
    let mut processes: Vec<(String, f64)> = Vec::new();
    for (id, kind, time) in after.1 {
        let earlier = before.1.iter().find(|(other, ..)| *other == id).map_or(0.0, |(.., time)| *time);
        match processes.iter_mut().find(|(other, _)| *other == kind) {
            Some((_, sum)) => *sum += (time - earlier) / frames,
            None => processes.push((kind, (time - earlier) / frames)),
        }
    }
    Frames {
        per_second: 1e3 * frames / (after.0.time - before.0.time),
        page: (after.0.busy - before.0.busy) / frames,
        longest: after.0.longest,
        processes,
    }
}

struct Moment {
    frames: f64,
    time: f64,
    busy: f64,
    longest: f64,
}

impl Moment {
    async fn now(page: &Page) -> Self {
        let all = "[performance.now(), window.busy.sum, window.busy.longest,
                   JSON.parse(window.wasmBindings.kalmanscope_summary()).frames]";
        let numbers: Vec<f64> =
            page.value(all).await.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        let [time, busy, longest, frames] = numbers[..] else { panic!("the page has a clock and frames: {numbers:?}") };
        Self { frames, time, busy, longest }
    }
}

/// Number, kind and processor time \[ms\] of all descendants of a process.
fn processor_times(ancestor: u32) -> Vec<(u32, String, f64)> {
    let all: Vec<(u32, u32, f64)> = fs::read_dir("/proc")
        .into_iter()
        .flatten()
        .filter_map(|entry| stat(entry.ok()?.file_name().to_str()?.parse().ok()?))
        .collect();
    let mut found = Vec::new();
    let mut open = vec![ancestor];
    while let Some(parent) = open.pop() {
        for (id, _, time) in all.iter().filter(|(_, of, _)| *of == parent) {
            open.push(*id);
            found.push((*id, kind(*id), *time));
        }
    }
    found
}

/// A process's id, that of its parent, and its processor time \[ms\].
fn stat(id: u32) -> Option<(u32, u32, f64)> {
    let text = fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The name, in brackets, may contain spaces.
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some((id, fields.get(1)?.parse().ok()?, 1e3 * ticks / TICKS))
}

fn kind(id: u32) -> String {
    let line = fs::read(format!("/proc/{id}/cmdline")).unwrap_or_default();
    let line = String::from_utf8_lossy(&line).replace('\0', " ");
    let kind = line.split_whitespace().find_map(|word| word.strip_prefix("--type="));
    kind.unwrap_or("browser").to_owned()
}
