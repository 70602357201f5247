//! The frame rate of the page while a slider is dragged, and the time of a frame.

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

/// Drags a slider to and fro for about this time. Returns the frames a second, the time of the page's own code per frame, and the
/// longest such time \[ms\].
pub(crate) async fn drag(page: &Page, name: &str, between: (f64, f64), duration: Duration) -> [f64; 3] {
    let before = now(page).await;
    page.value("void (window.busy.longest = 0)").await;
    page.sweep(name, between, duration).await;
    let after = now(page).await;
    let [time, busy, frames] = [0, 1, 3].map(|place| after[place] - before[place]);
    [1e3 * frames / time, busy / frames, after[2]]
}

/// The time, the sum of the callbacks' times, the longest of them \[ms\], and the number of frames.
async fn now(page: &Page) -> [f64; 4] {
    let all = "[performance.now(), window.busy.sum, window.busy.longest,
               JSON.parse(window.wasmBindings.kalmanscope_summary()).frames]";
    let numbers: Vec<f64> = page.value(all).await.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    numbers.try_into().expect("the page has a clock and frames")
}
