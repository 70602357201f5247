//! Nanoseconds per step of every kernel, of the book's filter of the same size, and the ratio of both: one table, one run.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use kalmanscope_core::filter::FilterInfo;
use kalmanscope_core::{FilterKind, FilterSettings, PlantKind, Record, Run, Scenario};

const PLANTS: [PlantKind; 6] = [
    PlantKind::SDOF,
    PlantKind::DUFFING,
    PlantKind::SHEAR_2,
    PlantKind::BOUC_WEN,
    PlantKind::SHEAR_3,
    PlantKind::SHEAR_4,
];

const KINDS: [FilterKind; 5] =
    [FilterKind::EKF, FilterKind::IEKF, FilterKind::UKF, FilterKind::CKF, FilterKind::SR_UKF];

/// Time to spend on one number \[s\].
const BUDGET: f64 = 0.15;

fn main() {
    println!("{:<28}{:>3}  {:<8}{:>10}{:>10}{:>8}", "plant", "n", "filter", "kernel ns", "book ns", "ratio");
    for plant in PLANTS {
        let mut scenario = Scenario { duration: 2.0, ..Scenario::default() };
        scenario.set_plant(plant);
        scenario.filters.truncate(1);
        let record = Arc::new(finished(Run::new(&scenario).expect("the scenario is valid")).record().clone());
        for kind in KINDS {
            let settings = FilterSettings { kind, fading: 1.005, ..scenario.filters[0].clone() };
            let time = |kind| {
                let filters = vec![FilterSettings { kind, ..settings.clone() }];
                step_time(&Scenario { filters, ..scenario.clone() }, &record)
            };
            let (kernel, book) = (time(kind), time(by_the_book(kind)));
            let (name, n) = (plant.name(), plant.channels().len());
            println!("{name:<28}{n:>3}  {:<8}{kernel:>10.0}{book:>10.0}{:>8.2}", kind.name(), book / kernel);
        }
    }
}

/// The same kind of filter under a name that no kernel has, so that it goes by the book.
fn by_the_book(kind: FilterKind) -> FilterKind {
    let key = format!("book_{}", kind.key()).leak();
    FilterKind::new(Box::leak(Box::new(FilterInfo { key, ..*kind.info() })))
}

fn finished(mut run: Run) -> Run {
    run.finish();
    run
}

/// Nanoseconds per step of the scenario's filter over a record, its report included: the fastest of many passes, since
/// whatever else the machine does only adds.
fn step_time(scenario: &Scenario, record: &Arc<Record>) -> f64 {
    let mut run = finished(Run::on_record(scenario, Arc::clone(record)).expect("the scenario is valid"));
    assert_eq!(run.len(), record.len(), "the filter goes on");
    let begin = Instant::now();
    let mut fastest = f64::INFINITY;
    while begin.elapsed().as_secs_f64() < BUDGET {
        run.restart(scenario).expect("the scenario is valid");
        let start = Instant::now();
        while run.step() {}
        fastest = fastest.min(start.elapsed().as_secs_f64());
        black_box(&run);
    }
    fastest * 1e9 / record.len() as f64
}
