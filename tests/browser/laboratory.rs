//! The laboratory in the page's workers.

use std::time::{Duration, Instant};

use kalmanscope_core::Source;
use kalmanscope_lab::{Ensemble, Runner, Sheet};
use serde_json::Value;

use crate::page::Page;

/// Limits the time until a map is complete, on a slow machine.
const PATIENCE: Duration = Duration::from_secs(90);

/// A map in a real browser has the bits of this machine's, and comes from workers.
pub(crate) async fn a_map_is_made_in_workers(page: &Page) {
    page.click("Views", 0.5).await;
    let begun = Instant::now();
    page.click("Map", 0.5).await;
    page.click("Views", 0.5).await;
    let complete = "(map => map !== null && map.done > 0 && map.done === map.cells)\
                    (JSON.parse(wasmBindings.kalmanscope_summary()).map)";
    page.wait_until(complete, PATIENCE).await.unwrap();
    println!("the map is complete after {:.1} s", begun.elapsed().as_secs_f64());
    let map = page.summary().await["map"].clone();
    let ensemble = Ensemble::from_json(map["ensemble"].as_str().unwrap()).unwrap();
    assert_eq!(map["cells"], Value::from(ensemble.cells()));
    assert!(ensemble.cells() >= 32 * 32);
    let cells: Vec<usize> = (0..ensemble.cells()).collect();
    let mut sheet = Sheet::new(&ensemble);
    let runner = Runner::new(ensemble, Source::Simulated).unwrap();
    sheet.fill(&cells, &runner.rows(&cells));
    assert_eq!(map["checksum"], Value::from(format!("{:016x}", sheet.checksum())));
    let loaded = page.value("performance.getEntriesByType('resource').map(it => it.name).join(' ')").await;
    assert!(loaded.as_str().unwrap().contains("laboratory-worker.js?v="), "{loaded}");
}
