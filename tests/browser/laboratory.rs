//! The laboratory in the page's workers.

use std::time::{Duration, Instant};

use kalmanscope::App;
use kalmanscope::laboratory::Choice;
use kalmanscope::layout::Layout;
use kalmanscope::request::ViewKind;
use kalmanscope::session::Mode;
use kalmanscope_core::{Channel, FilterKind, Hold, PlantKind, Robust, Scenario, Source, Task as _, simulate};
use kalmanscope_lab::posterior::Posterior;
use kalmanscope_lab::{Ensemble, Runner, Sheet};
use serde_json::Value;

use crate::page::Page;
use crate::starts;

/// Limits the time until a map is complete, on a slow machine.
const PATIENCE: Duration = Duration::from_secs(90);

/// A map in a real browser has the bits of this machine's, and comes from workers.
pub(crate) async fn a_map_is_made_in_workers(page: &Page) {
    page.click("Views", 0.5).await;
    let begun = Instant::now();
    page.click("Map", 0.5).await;
    page.click("Views", 0.5).await;
    page.wait_until(COMPLETE, PATIENCE).await.unwrap();
    println!("the map is complete after {:.1} s", begun.elapsed().as_secs_f64());
    has_the_bits_of_this_machine(page).await;
    let loaded = page.value("performance.getEntriesByType('resource').map(it => it.name).join(' ')").await;
    assert!(loaded.as_str().unwrap().contains("/worker.js?program=kalmanscope-"), "{loaded}");
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

/// The points of a posterior come from a worker, and tell what this machine's do.
pub(crate) async fn a_posterior_is_found_in_a_worker(page: &Page, address: &str) {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    let mut app = App::with_scenario(scenario.clone()).unwrap();
    *app.layout_mut() = Layout::column(&[ViewKind::ParameterPlane]);
    let filter = app.session().run().scenario().filters[0].id;
    app.laboratory.posteriors.choose(Some(filter));
    app.session_mut().set_mode(Mode::Whole);
    app.session_mut().pause();
    app.session_mut().seek(20.0);
    starts(page, &format!("{address}{}", app.link().unwrap())).await;
    let begun = Instant::now();
    page.wait_until("JSON.parse(wasmBindings.kalmanscope_summary()).posterior !== null", PATIENCE).await.unwrap();
    println!("the posterior is there after {:.1} s", begun.elapsed().as_secs_f64());
    let found = page.summary().await["posterior"].clone();
    let expected = Posterior::new(&scenario, 0, &simulate(&scenario)).unwrap().run().unwrap();
    assert_eq!(found["points"], Value::from(expected.points.len()));
    let evidence = found["log_evidence"].as_f64().unwrap();
    assert_eq!(evidence.to_bits(), expected.log_evidence.to_bits(), "{evidence} {}", expected.log_evidence);
    let loaded = page.value("performance.getEntriesByType('resource').map(it => it.name).join(' ')").await;
    assert!(loaded.as_str().unwrap().contains("/worker.js?program=kalmanscope-"), "{loaded}");
}

/// Whether all cells of the map are there.
const COMPLETE: &str = "(map => map !== null && map.done > 0 && map.done === map.cells)\
                        (JSON.parse(wasmBindings.kalmanscope_summary()).map)";

async fn has_the_bits_of_this_machine(page: &Page) {
    let map = page.summary().await["map"].clone();
    let ensemble = Ensemble::from_json(map["ensemble"].as_str().unwrap()).unwrap();
    assert_eq!(map["cells"], Value::from(ensemble.cells()));
    assert!(ensemble.cells() >= 32 * 32);
    let cells: Vec<usize> = (0..ensemble.cells()).collect();
    let mut sheet = Sheet::new(&ensemble);
    let runner = Runner::new(ensemble, Source::Simulated).unwrap();
    sheet.fill(&cells, &runner.rows(&cells));
    assert_eq!(map["checksum"], Value::from(format!("{:016x}", sheet.checksum())));
}

/// Notes the time of the first rows of a map, of a picture from every eighth cell each way, and of the last row \[ms\]. It asks
/// seldom after the picture, since each answer describes the whole screen.
pub(crate) const STOPWATCH: &str = "
    window.rows = {};
    const look = () => {
        const map = window.wasmBindings?.kalmanscope_summary && JSON.parse(wasmBindings.kalmanscope_summary()).map;
        const note = (name, least) => { if (map?.done >= least) window.rows[name] ??= performance.now(); };
        note('first', 1);
        note('coarse', map?.cells / 256);
        note('picture', map?.cells / 64);
        note('last', map?.cells);
        setTimeout(look, window.rows.picture ? 250 : 20);
    };
    look();";

/// The link to a map of 128 × 128 runs of 2 001 samples by this filter of the usual scenario.
pub(crate) fn large_map(filter: &str) -> String {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    scenario.filters.retain(|other| other.name == filter);
    map_of(scenario, 128)
}

/// A link that opens the usual map of a scenario's first filter. The map has `cells` rows and as many columns.
fn map_of(scenario: Scenario, cells: usize) -> String {
    let mut app = App::with_scenario(scenario).unwrap();
    *app.layout_mut() = Layout::column(&[ViewKind::Map]);
    let run = app.session().run();
    let choice = Choice::usual(run.scenario(), run.record(), false, cells).unwrap();
    app.laboratory.choose(Some(choice));
    // A picture that moves takes time from the workers where there is no graphics processor.
    app.session_mut().set_mode(Mode::Whole);
    app.session_mut().pause();
    app.link().unwrap()
}

/// Prints how long a map takes from the first frame on, with the start of the workers.
pub(crate) async fn time_of_a_map(page: &Page, filter: &str) {
    page.wait_until("window.rows.last !== undefined", PATIENCE).await.unwrap();
    let times = "(frame => ['first', 'coarse', 'picture', 'last'].map(name => window.rows[name] - frame))\
                 (performance.getEntriesByName('first frame')[0].startTime)";
    println!("{filter}: first rows, first picture, the next one and all rows after [ms] {}", page.value(times).await);
}
