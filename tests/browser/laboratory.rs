//! The laboratory in the page's workers, and by WebGPU on a program in place of a graphics processor.

use std::path::Path;
use std::time::{Duration, Instant};

use kalmanscope::App;
use kalmanscope::laboratory::MapChoice;
use kalmanscope::layout::ViewLayout;
use kalmanscope::request::ViewKind;
use kalmanscope::session::Mode;
use kalmanscope_core::{Channel, FilterKind, Hold, PlantKind, Robust, Scenario, Source};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::{Ensemble, EnsembleRows, Runner};
use serde_json::Value;

use crate::files::downloaded;
use crate::page::Page;
use crate::starts;

const PATIENCE: Duration = Duration::from_secs(90);

async fn show_the_map(page: &Page) {
    for name in ["Views", "Laboratory", "Views"] {
        page.click(name, 0.5).await;
    }
}

pub(crate) async fn a_map_is_made_in_workers(page: &Page) {
    let begun = Instant::now();
    show_the_map(page).await;
    page.wait_until(COMPLETE, PATIENCE).await.unwrap();
    println!("the map is complete after {:.1} s", begun.elapsed().as_secs_f64());
    has_the_bits_of_this_machine(page).await;
    has_workers(page).await;
}

/// Maps of filters that only the engine runs side by side have the bits of this machine's too.
pub(crate) async fn maps_of_other_filters(page: &Page, address: &str) {
    let edits: [fn(&mut Scenario); 3] = [
        |scenario| {
            scenario.hold = Hold::First;
            scenario.filters[0].augment = vec![Channel::INPUT_GAIN];
        },
        |scenario| {
            scenario.set_plant(PlantKind::BOUC_WEN);
            scenario.filters[0].kind = FilterKind::UKF;
        },
        |scenario| {
            scenario.set_plant(PlantKind::DUFFING);
            scenario.filters[0].robust = Robust::STUDENT_T;
        },
    ];
    for edit in edits {
        let mut scenario = Scenario { duration: 5.0, ..Scenario::default() };
        scenario.filters.truncate(1);
        edit(&mut scenario);
        starts(page, &format!("{address}{}", map_of(scenario, 32))).await;
        page.wait_until(COMPLETE, PATIENCE).await.unwrap();
        has_the_bits_of_this_machine(page).await;
    }
}

async fn has_workers(page: &Page) {
    let loaded = page.value("performance.getEntriesByType('resource').map(it => it.name).join(' ')").await;
    assert!(loaded.as_str().unwrap().contains("/worker.js?program=kalmanscope-"), "{loaded}");
}

const COMPLETE: &str = "(map => map !== null && map.done > 0 && map.done === map.cells)\
                        (JSON.parse(wasmBindings.kalmanscope_summary()).map)";

async fn has_the_bits_of_this_machine(page: &Page) {
    let map = page.summary().await["map"].clone();
    let ensemble = Ensemble::from_json(map["ensemble"].as_str().unwrap()).unwrap();
    assert_eq!(map["cells"], Value::from(ensemble.cells()));
    assert!(ensemble.cells() >= 32 * 32);
    let cells: Vec<usize> = (0..ensemble.cells()).collect();
    let mut sheet = EnsembleRows::new(&ensemble);
    let runner = Runner::new(ensemble, Source::Simulated).unwrap();
    sheet.fill(&cells, &runner.rows(&cells));
    assert_eq!(map["checksum"], Value::from(format!("{:016x}", sheet.checksum())));
}

/// A link that opens the usual map of a scenario's first filter. The map has `cells` rows and as many columns.
fn map_of(scenario: Scenario, cells: usize) -> String {
    let mut app = App::with_scenario(scenario).unwrap();
    *app.layout_mut() = ViewLayout::column(&[ViewKind::Map]);
    let run = app.session().run();
    let choice = MapChoice::usual(run.scenario(), run.record(), false, cells).unwrap();
    app.laboratory.choose(Some(choice));
    // A picture that moves takes time from the workers where there is no graphics processor.
    app.session_mut().set_mode(Mode::Whole);
    app.session_mut().pause();
    app.link().unwrap()
}

/// Chromium's arguments for WebGPU without a graphics processor.
pub(crate) const WEB_GPU: [&str; 4] = [
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
];

/// Limits the maps until one is computed by WebGPU alone: workers begin before it is ready.
const MAPS: usize = 8;

/// A map by WebGPU has the classes and scores of this machine's processor, and the view says what has computed it.
pub(crate) async fn a_map_is_computed_by_web_gpu(page: &Page, folder: &Path) {
    page.allow_downloads(folder).await;
    show_the_map(page).await;
    let mut map = complete(page, &Value::Null).await;
    for nth in 0..MAPS {
        if is_by_graphics(&map["computers"]) {
            break;
        }
        println!("map {nth}: computed {}", map["computers"]);
        // Another setting of the filter is another map.
        let from = 0.05 + 0.02 * nth as f64;
        page.drag("λ of fading EKF", from, from + 0.02).await;
        map = complete(page, &map["ensemble"]).await;
    }
    let computers = &map["computers"];
    println!("computed {computers}");
    assert!(is_by_graphics(computers), "{computers}");
    assert_eq!(said(page).await, format!("computed {}", computers[0].as_str().unwrap()));
    let ensemble = Ensemble::from_json(map["ensemble"].as_str().unwrap()).unwrap();
    assert!(ensemble.cells() >= 48 * 48);
    let csv = String::from_utf8(downloaded(page, folder, &["Data…", "Map (CSV)"], "map.csv").await).unwrap();
    agrees(&csv, ensemble);
}

/// The map, when it is complete and not the one before.
async fn complete(page: &Page, before: &Value) -> Value {
    let complete = format!(
        "(map => map !== null && map.done > 0 && map.done === map.cells && map.ensemble !== {before})\
         (JSON.parse(wasmBindings.kalmanscope_summary()).map)"
    );
    page.wait_until(&complete, PATIENCE).await.unwrap();
    page.summary().await["map"].clone()
}

fn is_by_graphics(computers: &Value) -> bool {
    let computers = computers.as_array().unwrap();
    computers.len() == 1 && computers[0].as_str().unwrap().starts_with("in single precision by ")
}

async fn said(page: &Page) -> String {
    let summary = page.summary().await;
    let names = summary["controls"].as_array().unwrap().iter().filter_map(|control| control["name"].as_str());
    let said: Vec<&str> = names.filter(|name| name.starts_with("computed ")).collect();
    assert_eq!(said.len(), 1, "{said:?}");
    said[0].to_owned()
}

fn agrees(csv: &str, ensemble: Ensemble) {
    let rows: Vec<Vec<f64>> = csv.lines().skip(1).map(|line| line.split(',').map(number).collect()).collect();
    let (cells, width, axes) = (ensemble.cells(), ensemble.width(), ensemble.plan().axes.len());
    assert_eq!(rows.len(), cells);
    let measures = ensemble.plan().measures.clone();
    let exact = Runner::new(ensemble, Source::Simulated).unwrap().rows(&(0..cells).collect::<Vec<_>>());
    let of = |row: &[f64], measure: Measure| row[measures.iter().position(|other| *other == measure).unwrap()];
    let (mut same, mut converged, mut close) = (0, 0, 0);
    for (row, exact) in rows.iter().map(|row| &row[axes..]).zip(exact.chunks(width)) {
        let channel = Channel::NATURAL_FREQUENCY;
        let class = |row: &[f64]| {
            let is_near = of(row, Measure::error(channel)).abs() <= 0.05 * of(row, Measure::estimate(channel));
            (of(row, Measure::STOPPED) > 0.0, of(row, Measure::DIVERGED) > 0.0, is_near)
        };
        same += usize::from(class(row) == class(exact));
        if class(row) == (false, false, true) && class(exact) == class(row) {
            converged += 1;
            let scores = [Measure::rmse(channel), Measure::NIS, Measure::NEES, Measure::std(channel)];
            let is_close = |measure: Measure| (of(row, measure) / of(exact, measure) - 1.0).abs() <= 0.02;
            close += usize::from(scores.into_iter().all(is_close));
        }
    }
    println!("of {cells} cells {same} of the same class; of {converged} converged {close} close");
    assert!(same as f64 >= 0.99 * cells as f64 && converged > cells / 10);
    assert!(close as f64 >= 0.98 * converged as f64);
}

/// A number that is not known is empty.
fn number(text: &str) -> f64 {
    if text.is_empty() { f64::NAN } else { text.parse().unwrap() }
}
