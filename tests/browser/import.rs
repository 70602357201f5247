//! A measured record that is chosen, or dropped on the page.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

use kalmanscope_core::{Run, Scenario};

use crate::page::Page;

/// Limits the time until a record is open.
const PATIENCE: Duration = Duration::from_secs(30);

/// The record of an oscillator of 6 rad/s as a spreadsheet writes it, with semicolons, decimal commas and millimetres.
fn sheet() -> String {
    let text = "duration = 40.0\ndt = 0.05\nhold = \"first\"\n[plant]\nnatural_frequency = 6.0\n[[sensors]]\n\
                measures = \"displacement\"\nnoise_std = 0.002\n";
    let mut run = Run::new(&Scenario::from_toml(text).unwrap()).unwrap();
    run.finish();
    let record = run.record();
    let mut sheet = "Zeit [s];Kraft;Weg [mm]\n".to_owned();
    for k in 0..record.len() {
        let row = format!("{:.3};{:.5};{:.5}", record.time(k), record.input()[k], 1000.0 * record.measured(0)[k]);
        writeln!(sheet, "{}", row.replace('.', ",")).unwrap();
    }
    sheet
}

/// The button asks the browser for a file, and the file that is chosen there is read.
pub(crate) async fn a_record_is_chosen(page: &Page, folder: &Path) {
    // No test can answer the browser's own dialog.
    page.value("(window.asked = 0, document.getElementById('file').click = () => { window.asked += 1; })").await;
    page.click("Open a file", 0.5).await;
    page.wait_until("window.asked === 1", PATIENCE).await.unwrap();
    std::fs::create_dir_all(folder).unwrap();
    let path = folder.join("chosen.csv");
    std::fs::write(&path, sheet()).unwrap();
    page.choose_file("#file", &path).await;
    let button = "JSON.parse(wasmBindings.kalmanscope_summary()).controls.some(it => it.name === 'Cancel the import')";
    page.wait_until(button, PATIENCE).await.unwrap();
    // The window grows to its size and moves to the middle meanwhile.
    tokio::time::sleep(Duration::from_secs(1)).await;
    page.click("Cancel the import", 0.5).await;
    page.wait_until(&format!("!{button}"), PATIENCE).await.unwrap();
}

/// A dropped file opens with one click, and its natural frequency is found.
pub(crate) async fn a_record_is_opened_by_drop(page: &Page) {
    let drop = format!(
        "(data => {{
            data.items.add(new File([{}], 'record.csv'));
            const canvas = document.querySelector('canvas');
            for (const type of ['dragover', 'drop']) {{
                canvas.dispatchEvent(new DragEvent(type, {{ dataTransfer: data, bubbles: true, cancelable: true }}));
            }}
            return data.files.length;
        }})(new DataTransfer())",
        serde_json::to_string(&sheet()).unwrap()
    );
    assert_eq!(page.value(&drop).await, 1);
    let button = "JSON.parse(wasmBindings.kalmanscope_summary()).controls.some(it => it.name === 'Open the record')";
    page.wait_until(button, PATIENCE).await.unwrap();
    // The window grows to its size and moves to the middle meanwhile.
    tokio::time::sleep(Duration::from_secs(1)).await;
    page.click("Open the record", 0.5).await;
    let all = "JSON.parse(wasmBindings.kalmanscope_summary()).samples === 801";
    page.wait_until(all, PATIENCE).await.unwrap();
    page.settle().await;
    let summary = page.summary().await;
    assert_eq!(summary["mode"], "whole");
    for filter in summary["filters"].as_array().unwrap() {
        let estimates = filter["estimates"].as_array().unwrap();
        let of =
            |channel: &str| estimates.iter().find(|it| it["channel"] == channel).unwrap()["mean"].as_f64().unwrap();
        assert!((of("natural_frequency") / 6.0 - 1.0).abs() < 0.01, "{summary}");
    }
}
