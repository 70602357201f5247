//! A phone measures a free decay with its accelerometer.

use std::path::Path;
use std::time::Duration;

use crate::page::Page;

/// Limits the time until something is there.
const PATIENCE: Duration = Duration::from_secs(30);

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
    let asks = "JSON.parse(wasmBindings.kalmanscope_summary()).controls.some(it => it.name === 'Open the record')";
    page.wait_until(asks, PATIENCE).await.expect("the record is read");
    tokio::time::sleep(Duration::from_secs(1)).await;
    page.tap("Open the record").await;
    let measured = "(it => it.mode === 'whole' && it.samples > 1000 && it.samples < 1800)(JSON.parse(wasmBindings.kalmanscope_summary()))";
    page.wait_until(measured, PATIENCE).await.expect("the record is open");
    page.settle().await;
    let summary = page.summary().await;
    for filter in summary["filters"].as_array().expect("there are filters") {
        let estimates = filter["estimates"].as_array().expect("they have estimates");
        let of = |channel: &str| {
            let one = estimates.iter().find(|it| it["channel"] == channel).expect("it is estimated");
            one["mean"].as_f64().expect("it is a number")
        };
        assert!((of("natural_frequency") / 6.0 - 1.0).abs() < 0.002, "{summary}");
        assert!((of("damping_ratio") / 0.01 - 1.0).abs() < 0.15, "{summary}");
    }
    std::fs::write(picture.with_file_name("phone-measured.png"), page.screenshot().await)
        .expect("a picture can be written");
}
