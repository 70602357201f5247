//! Files that come to the page, and those that leave it as downloads.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use kalmanscope_core::import::{Mapping, build, hash, read};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Hold, Run, Scenario};

use crate::elsewhere::told;
use crate::page::{Page, estimate, has};
use crate::share::shows;
use crate::{reports_no_problems, starts};

/// Limits the time until a record is open, or a download is there.
const PATIENCE: Duration = Duration::from_secs(30);

/// The record of an oscillator of 6 rad/s as a spreadsheet writes it, with semicolons, decimal commas and millimetres. Its clock tells
/// times that are off by up to so many seconds.
fn sheet(duration: f64, jitter: f64) -> String {
    let text = "dt = 0.05\nhold = \"first\"\n[plant]\nnatural_frequency = 6.0\n[[sensors]]\n\
                measures = \"displacement\"\nnoise_std = 0.002\n";
    let scenario = Scenario { duration, ..Scenario::from_toml(text).unwrap() };
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    let record = run.record();
    let mut sheet = "Zeit [s];Kraft;Weg [mm]\n".to_owned();
    for k in 0..record.len() {
        let time = record.time(k) + jitter * (k * 7919 % 101) as f64 / 100.0;
        let row = format!("{time:.5};{:.12};{:.12}", record.input()[k], 1000.0 * record.measured(0)[k]);
        writeln!(sheet, "{}", row.replace('.', ",")).unwrap();
    }
    sheet
}

pub(crate) async fn a_record_is_chosen(page: &Page, folder: &Path) {
    // No test can answer the browser's own dialog.
    page.value("(window.asked = 0, document.getElementById('file').click = () => { window.asked += 1; })").await;
    page.click("Open a file", 0.5).await;
    page.wait_until("window.asked === 1", PATIENCE).await.unwrap();
    let path = folder.join("chosen.csv");
    fs::write(&path, sheet(40.0, 0.0)).unwrap();
    page.choose_file("#file", &path).await;
    let button = has("Cancel the import");
    page.wait_until(&button, PATIENCE).await.unwrap();
    // The window grows to its size and moves to the middle meanwhile.
    page.rest().await;
    page.click("Cancel the import", 0.5).await;
    page.wait_until(&format!("!{button}"), PATIENCE).await.unwrap();
}

async fn is_asked(page: &Page) {
    page.wait_until(&has("Open the record"), PATIENCE).await.unwrap();
}

async fn opens(page: &Page) {
    is_asked(page).await;
    // The window grows to its size and moves to the middle meanwhile.
    page.rest().await;
    page.click("Open the record", 0.5).await;
}

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
        serde_json::to_string(&sheet(40.0, 0.0)).unwrap()
    );
    assert_eq!(page.value(&drop).await, 1);
    opens(page).await;
    let all = "JSON.parse(wasmBindings.kalmanscope_summary()).samples === 801";
    page.wait_until(all, PATIENCE).await.unwrap();
    page.settle().await;
    let summary = page.summary().await;
    assert_eq!(summary["mode"], "whole");
    for filter in summary["filters"].as_array().unwrap() {
        assert!((estimate(filter, "natural_frequency", "mean") / 6.0 - 1.0).abs() < 0.01, "{summary}");
    }
}

/// A large file of uneven times is read, and its start values are made, in workers as often as is said, and with the bits of this machine.
pub(crate) async fn a_large_record_is_opened(
    page: &Page,
    address: &str,
    folder: &Path,
    [files, suggestions]: [u64; 2],
) {
    let (name, text) = ("large.csv", sheet(6000.0, 0.02));
    assert!(text.len() > 4_500_000);
    fs::write(folder.join(name), &text).unwrap();
    starts(page, address).await;
    let before = [told(page, "file").await, told(page, "suggest").await];
    page.choose_file("#file", &folder.join(name)).await;
    opens(page).await;
    shows(page, &checksum(name, text.as_bytes())).await;
    assert_eq!(told(page, "file").await - before[0], files);
    assert_eq!(told(page, "suggest").await - before[1], suggestions);
    reports_no_problems(page, address).await;
}

pub(crate) async fn an_import_is_given_up_in_its_worker(page: &Page, address: &str, folder: &Path) {
    let path = folder.join("large.csv");
    fs::write(&path, sheet(6000.0, 0.0)).unwrap();
    starts(page, address).await;
    page.choose_file("#file", &path).await;
    page.wait_until("told.held === 1", PATIENCE).await.unwrap();
    page.rest().await;
    page.click("Cancel the import", 0.5).await;
    page.wait_until(&format!("!({})", has("Cancel the import")), PATIENCE).await.unwrap();
    page.value("window.hold = false").await;
    page.choose_file("#file", &path).await;
    is_asked(page).await;
    assert_eq!((told(page, "file").await, told(page, "held").await), (2, 1));
    reports_no_problems(page, address).await;
}

fn checksum(name: &str, bytes: &[u8]) -> String {
    let table = read(bytes, None).unwrap();
    let (mapping, input) = Mapping::guess(&table);
    let mapping = Mapping { file: name.to_owned(), hash: hash(bytes), ..mapping };
    let record = |mapping: &Mapping, hold| build(&table, mapping, input, hold, &[]).unwrap().record;
    let raw = record(&mapping, Hold::First);
    assert!(raw.clocks().is_some(), "it keeps its times");
    let scenario = Scenario { input, hold: Hold::First, record: Some(mapping), ..scenario_for(&raw) };
    let scenario = suggest(&scenario, &raw).scenario;
    let mut run = Run::on_record(&scenario, record(scenario.record.as_ref().unwrap(), scenario.hold).into()).unwrap();
    run.finish();
    format!("{:016x}", run.checksum())
}

pub(crate) async fn a_figure_is_downloaded(page: &Page, folder: &Path) {
    page.allow_downloads(folder).await;
    let svg = downloaded(page, folder, &["Figure…", "Paper, 84 mm", "Save as SVG"], "kalmanscope-84mm.svg").await;
    let svg = String::from_utf8(svg).unwrap();
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>") && svg.contains("width=\"84mm\""), "{svg}");
    assert!(svg.contains("natural frequency") && !svg.contains("NaN"), "the views on screen are in it");
    let estimates = downloaded(page, folder, &["Data…", "Estimates (CSV)"], "estimates.csv").await;
    assert!(estimates.starts_with(b"filter,k,t,"), "{}", String::from_utf8_lossy(&estimates[..80]));
}

/// Clicks from the menu of exports on, and waits until the file has its contents: the browser makes it empty first.
pub(crate) async fn downloaded(page: &Page, folder: &Path, clicks: &[&str], name: &str) -> Vec<u8> {
    for control in std::iter::once(&"Export").chain(clicks) {
        page.click(control, 0.5).await;
        // A menu or a window opens.
        page.rest().await;
    }
    let (path, begun) = (folder.join(name), Instant::now());
    while fs::metadata(&path).map_or(0, |file| file.len()) == 0 {
        assert!(begun.elapsed() < PATIENCE, "{name} has not come");
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    println!("{name}: {} bytes after {:.1} s", fs::metadata(&path).unwrap().len(), begun.elapsed().as_secs_f64());
    fs::read(path).unwrap()
}
