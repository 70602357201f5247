//! Runs ensembles on the threads of this machine.

use std::num::NonZero;
use std::rc::Rc;
use std::sync::Arc;
use std::thread;

use egui::Context;
use kalmanscope::laboratory::{Accelerated, Computer, Engine, Rows, Slices, Task, Work};
use kalmanscope_gpu::Software;
use kalmanscope_lab::{Crew, EnsembleError, Runner};

use super::graphics::Processor;

/// Threads that serve all maps.
struct Threads(Crew);

/// The graphics processor for the maps that it serves, and threads, or slices of the frames if the system gives no
/// threads. With more than two processors, one is left to the frames.
pub(super) fn engine(software: Software) -> Box<dyn Engine> {
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    let threads = if processors > 2 { processors - 1 } else { processors };
    let other: Rc<dyn Engine> = match Crew::new(threads) {
        Ok(crew) => Rc::new(Threads(crew)),
        Err(error) => {
            log::warn!("The laboratory has no threads: {error}");
            Rc::new(Slices::FRAME)
        }
    };
    Box::new(Accelerated::new(Rc::new(Processor::new(software)), other))
}

impl Engine for Threads {
    fn start(&self, task: Task<'_>, ctx: &Context) -> Result<Box<dyn Work>, EnsembleError> {
        let runner = Arc::new(Runner::new(task.ensemble.clone(), task.source.clone())?);
        let ctx = ctx.clone();
        let work = self.0.start(&runner, task.order, move || ctx.request_repaint());
        Ok(Box::new(ThreadedWork { work, threads: self.0.threads() }))
    }

    fn usual_count(&self) -> usize {
        64
    }
}

struct ThreadedWork {
    work: kalmanscope_lab::Work,
    threads: usize,
}

impl Work for ThreadedWork {
    fn poll(&mut self) -> Vec<Rows> {
        let by = Computer::Threads(self.threads);
        self.work.poll().map(|slice| Rows { cells: slice.cells, numbers: slice.rows, by: by.clone() }).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;
    use std::time::{Duration, Instant};

    use kalmanscope::laboratory::{Finding, Precision};
    use kalmanscope_core::{Axis, Scenario, Source};
    use kalmanscope_lab::{Ensemble, Measure, Plan, Sheet};

    use super::*;

    /// Limits the time until a map is complete, on a slow machine.
    const PATIENCE: Duration = Duration::from_secs(120);

    fn ensemble(measure: Measure, side: usize) -> Ensemble {
        let scenario = Scenario { duration: 10.0, ..Scenario::default() };
        let axes =
            [format!("filters.EKF.process_std=0.1:10:{side}:log"), format!("filters.EKF.sensor_std=0.2:5:{side}")];
        let axes = axes.iter().map(|text| Axis::parse(text).expect("it is an axis")).collect();
        let plan = Plan { filters: vec![0], measures: vec![measure], axes, ..Plan::default() };
        Ensemble::new(scenario, plan).expect("it is possible")
    }

    /// Computes an ensemble; returns the sheet and the cells that each has computed.
    fn compute(engine: &dyn Engine, ensemble: &Ensemble, precision: Precision) -> (Sheet, HashMap<String, usize>) {
        let order = ensemble.coarse_to_fine();
        let task = Task { ensemble, source: &Source::Simulated, order, precision };
        let mut work = engine.start(task, &Context::default()).expect("it can be run");
        let (mut sheet, mut by, begin) = (Sheet::new(ensemble), HashMap::new(), Instant::now());
        while !sheet.is_complete() {
            for rows in work.poll() {
                sheet.fill(&rows.cells, &rows.numbers);
                *by.entry(rows.by.to_string()).or_default() += rows.cells.len();
            }
            assert!(begin.elapsed() < PATIENCE, "{} of {} cells, {by:?}", sheet.done(), sheet.len());
            thread::sleep(Duration::from_millis(2));
        }
        (sheet, by)
    }

    fn is_by_graphics(by: &str) -> bool {
        by.starts_with("in single precision by ")
    }

    fn rows(ensemble: &Ensemble) -> Vec<f64> {
        let cells: Vec<usize> = (0..ensemble.cells()).collect();
        Runner::new(ensemble.clone(), Source::Simulated).expect("it is possible").rows(&cells)
    }

    fn all(sheet: &Sheet) -> Vec<f64> {
        (0..sheet.len()).flat_map(|cell| sheet.row(cell).expect("it is known").to_vec()).collect()
    }

    /// Needs a Vulkan driver; a software one such as Mesa's lavapipe is enough.
    #[test]
    fn a_processor_takes_over_and_serves_the_next_map_from_the_beginning() {
        let engine = engine(Software::Allowed);
        let ensemble = ensemble(Measure::Nis, 24);
        assert_eq!(engine.graphics(), Some(Finding::Searching), "nobody looks before the first map");
        let begin = Instant::now();
        let (first, _) = compute(&*engine, &ensemble, Precision::Fastest);
        while engine.graphics() == Some(Finding::Searching) && begin.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(10));
        }
        assert_eq!(engine.graphics(), Some(Finding::Ready));
        let (second, by) = compute(&*engine, &ensemble, Precision::Fastest);
        assert!(by.len() == 1 && by.keys().all(|by| is_by_graphics(by)), "{by:?}");
        for (number, exact) in all(&first).iter().chain(&all(&second)).zip(rows(&ensemble).iter().cycle()) {
            assert!((number - exact).abs() <= 1e-3 * exact, "{number} {exact}");
        }
        let (exact, by) = compute(&*engine, &ensemble, Precision::Double);
        assert!(by.keys().all(|by| !is_by_graphics(by)), "{by:?}");
        assert_eq!(all(&exact), rows(&ensemble));
    }

    #[test]
    fn a_map_that_is_not_served_goes_to_the_threads() {
        let engine = engine(Software::Allowed);
        let ensemble = ensemble(Measure::Verdict, 4);
        for _ in 0..2 {
            let (sheet, by) = compute(&*engine, &ensemble, Precision::Fastest);
            assert!(by.keys().all(|by| !is_by_graphics(by)), "{by:?}");
            assert_eq!(all(&sheet), rows(&ensemble));
            let begin = Instant::now();
            while engine.graphics() == Some(Finding::Searching) && begin.elapsed() < PATIENCE {
                thread::sleep(Duration::from_millis(10));
            }
        }
    }
}
