//! The page in `dist/`, in a real headless browser.
#![expect(clippy::unwrap_used, reason = "a step that fails is a test that fails")]

mod accessible;
mod driver;
mod elsewhere;
mod embed;
mod files;
mod frames;
mod laboratory;
mod loading;
mod page;
mod phone;
mod server;
mod share;
#[path = "../ui/sounds.rs"]
mod sounds;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use kalmanscope::share::address;
use kalmanscope_core::Run;
use kalmanscope_lessons::BuiltIn;

use driver::Driver;
use page::{Page, colours, estimate};
use server::Server;

const START: Duration = Duration::from_secs(60);
const FAILURE: &str = "document.getElementById('failure').hidden ? '' : document.getElementById('failure').innerText";

const OVER: &str = "!document.getElementById('loading') || !document.getElementById('failure').hidden";

/// Opens a browser with these arguments, in which a folder is served and scripts run before those of the page.
fn visit(folder: &Path, scripts: &[&str], arguments: &[&str], what: impl AsyncFnOnce(&Page, &str, &Driver)) {
    let address = Server::start(folder.to_owned()).unwrap().page();
    let driver = Driver::start();
    runtime().block_on(async {
        let page = driver.open(arguments).await;
        for script in scripts {
            page.prepare(script).await;
        }
        what(&page, &address, &driver).await;
    });
}

#[test]
fn the_page_works_in_a_browser() {
    let server = Server::start(dist()).unwrap();
    let address = server.page();
    let driver = Driver::start();
    runtime().block_on(async {
        let page = driver.open(&[]).await;
        accessible::prepare(&page).await;
        loading::prepare(&page).await;
        starts(&page, &address).await;
        loading::first_load(&page).await;
        accessible::cover_can_be_read(&page).await;
        draws(&page, "desktop.png").await;
        computes_the_same_bits_as_this_machine(&page).await;
        accessible::tables_tell_what_the_canvas_shows(&page).await;
        a_slider_moves_the_estimates(&page).await;
        files::a_figure_is_downloaded(&page, &driver.downloads()).await;
        laboratory::a_map_is_made_in_workers(&page).await;
        draws(&page, "laboratory.png").await;
        page.resize(390, 844).await;
        draws(&page, "phone.png").await;
        reports_no_problems(&page, &address).await;
        page.theme("dark").await;
        loading::opens_without_a_network(&page, &server).await;
        accessible::cover_can_be_read(&page).await;
        loading::failures_can_be_read(&page).await;
        accessible::failure_can_be_read(&page).await;
    });
}

#[test]
fn a_program_that_does_not_come_whole_is_said() {
    for (damage, sentence) in loading::DAMAGES {
        let folder = loading::damaged(&dist(), damage);
        visit(folder.path(), &[], &[], async |page, address, _| {
            loading::says_why_it_does_not_start(page, address, sentence).await;
        });
    }
}

#[test]
fn an_open_page_outlives_a_new_version() {
    let folder = loading::copied(&dist());
    visit(folder.path(), &[], &[], async |page, address, _| {
        loading::an_open_page_keeps_its_version(page, address, folder.path()).await;
    });
}

#[test]
fn links_frames_and_files_work_in_a_browser() {
    visit(&dist(), &[embed::WATCH], &[], async |page, address, driver| {
        embed::policy_is_strict(page, address).await;
        share::links(page, address).await;
        embed::in_a_frame(page, address).await;
        starts(page, address).await;
        files::a_record_is_chosen(page, &driver.downloads()).await;
        files::a_record_is_opened_by_drop(page).await;
    });
}

#[test]
fn a_phone_keeps_its_plots_in_sight() {
    visit(&dist(), &[], &[], async |page, address, _| {
        phone::opens(page, address).await;
        phone::fingers_are_expected(page).await;
        phone::a_lesson_leaves_the_plots_their_room(page).await;
        phone::a_late_permission_begins_nothing(page).await;
        phone::a_decay_is_identified(page).await;
        phone::filters_are_watched(page).await;
        reports_no_problems(page, address).await;
    });
}

#[test]
fn a_page_hears_a_ring() {
    let sound = format!("--use-file-for-fake-audio-capture={}", phone::fork(&pictures()).display());
    let hears = ["--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream", &sound];
    visit(&dist(), &[], &hears, async |page, address, _| {
        phone::opens(page, address).await;
        phone::a_ring_is_identified(page).await;
        reports_no_problems(page, address).await;
    });
}

#[test]
fn maps_are_computed_by_web_gpu() {
    visit(&dist(), &[], &laboratory::WEB_GPU, async |page, address, driver| {
        starts(page, &format!("{address}?gpu=software")).await;
        laboratory::a_map_is_computed_by_web_gpu(page, &driver.downloads()).await;
        reports_no_problems(page, address).await;
    });
}

#[test]
fn long_work_goes_in_workers() {
    visit(&dist(), &[elsewhere::WATCH], &[], async |page, address, _| {
        elsewhere::a_long_filter_is_computed_in_a_worker(page, address).await;
        laboratory::maps_of_other_filters(page, address).await;
    });
    for (trouble, is_begun) in [(elsewhere::NONE, false), (elsewhere::FAILS, true)] {
        visit(&dist(), &[elsewhere::WATCH, trouble], &[], async |page, address, _| {
            elsewhere::the_page_computes_where_workers_do_not(page, address, is_begun).await;
        });
    }
}

#[test]
fn large_records_are_read_in_workers() {
    for (trouble, told) in [("", [1, 1]), (elsewhere::NONE, [0, 0]), (elsewhere::FAILS, [1, 1])] {
        visit(&dist(), &[elsewhere::WATCH, trouble], &[], async |page, address, driver| {
            files::a_large_record_is_opened(page, address, &driver.downloads(), told).await;
        });
    }
    visit(&dist(), &[elsewhere::WATCH, elsewhere::HOLDS], &[], async |page, address, driver| {
        files::an_import_is_given_up_in_its_worker(page, address, &driver.downloads()).await;
    });
}

/// `cargo test --test browser -- --ignored --nocapture`: frames a second over the whole record.
#[test]
#[ignore = "a measurement, which wants the machine for itself"]
fn frames_while_a_slider_is_dragged() {
    visit(&dist(), &[frames::STOPWATCH], &[], async |page, address, _| {
        starts(page, address).await;
        page.click("Whole record", 0.5).await;
        println!("{:<50} {:>6} {:>9} {:>9}", "", "1/s", "page [ms]", "most [ms]");
        frames_of_each_slider(page, "default views").await;
        page.click("Views", 0.5).await;
        for view in ["Errors", "Innovations", "Scores"] {
            page.click(view, 0.5).await;
        }
        page.click("Views", 0.5).await;
        frames_of_each_slider(page, "six views").await;
    });
}

async fn frames_of_each_slider(page: &Page, views: &str) {
    for (slider, between) in [("λ of fading EKF", (0.05, 0.6)), ("Loss of stiffness", (0.3, 0.7))] {
        let [per_second, own, longest] = frames::drag(page, slider, between, Duration::from_secs(5)).await;
        println!("{:<50} {per_second:>6.1} {own:>9.1} {longest:>9.1}", format!("{views}, {slider}"));
    }
}

fn pictures() -> PathBuf {
    let pictures = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/browser");
    fs::create_dir_all(&pictures).unwrap();
    pictures
}

fn dist() -> PathBuf {
    let dist = Path::new(env!("CARGO_MANIFEST_DIR")).join("dist");
    assert!(dist.join("index.html").is_file(), "there is no page in {}: run ./check, which builds it", dist.display());
    dist
}

fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap()
}

async fn starts(page: &Page, address: &str) {
    page.go(address).await;
    let waited = page.wait_until(OVER, START).await;
    reports_no_problems(page, address).await;
    waited.unwrap();
    // The window's frame takes part of its size.
    page.resize(1280, 800).await;
}

async fn reports_no_problems(page: &Page, address: &str) {
    let failure = page.value(FAILURE).await;
    assert_eq!(failure, "", "the page shows a failure");
    for (level, message) in page.console().await {
        println!("console: {level}: {message}");
        assert_ne!(level, "SEVERE", "an error in the console: {message}");
    }
    let resources = page.value("performance.getEntriesByType('resource').map(entry => entry.name)").await;
    for name in resources.as_array().unwrap().iter().map(|name| name.as_str().unwrap()) {
        assert!(name.starts_with(address::page(address)), "{name} is of another origin");
    }
}

/// Text and curves have hundreds of colours between them; a page that failed to draw has one or two.
async fn draws(page: &Page, picture: &str) {
    page.settle().await;
    let scrolls =
        "document.scrollingElement.scrollHeight > innerHeight || document.scrollingElement.scrollWidth > innerWidth";
    assert_eq!(page.value(scrolls).await, false, "the page has a scroll bar");
    let colours = colours(&page.save(picture).await);
    let total: usize = colours.values().sum();
    let most = colours.values().max().unwrap();
    println!("{picture}: {} colours, {:.3} of one", colours.len(), *most as f64 / total as f64);
    assert!(colours.len() > 300, "{picture} has only {} colours", colours.len());
    assert!(10 * most < 9 * total, "{picture} is nearly empty");
}

async fn computes_the_same_bits_as_this_machine(page: &Page) {
    let mut run = Run::new(&BuiltIn::FIRST.scenario().unwrap()).unwrap();
    run.finish();
    // At the end of the record, the filters have processed all of it.
    page.click("Time", 1.0).await;
    let samples = "JSON.parse(window.wasmBindings.kalmanscope_summary()).samples";
    page.wait_until(&format!("{samples} === {}", run.len()), START).await.expect("the record is played to its end");
    let summary = page.summary().await;
    assert_eq!(
        summary["checksum"].as_str().unwrap(),
        format!("{:016x}", run.checksum()),
        "WebAssembly and this machine disagree"
    );
}

async fn a_slider_moves_the_estimates(page: &Page) {
    let before = page.summary().await;
    page.drag("λ of fading EKF", 0.05, 0.6).await;
    let after = page.summary().await;
    assert_eq!(before["samples"], after["samples"], "only estimates of the same sample can be compared");
    let [before, after] = [before, after].map(|summary| std_of_natural_frequency(&summary));
    println!("std of the natural frequency: {before}, then {after}");
    assert!(after > 1.5 * before, "a filter that forgets is less certain: {before}, then {after}");
}

fn std_of_natural_frequency(summary: &serde_json::Value) -> f64 {
    let filters = summary["filters"].as_array().unwrap();
    let filter = filters.iter().find(|filter| filter["name"] == "fading EKF").unwrap();
    estimate(filter, "natural_frequency", "std")
}
