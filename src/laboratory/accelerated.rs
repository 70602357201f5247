//! A graphics processor with another engine behind it, for the work that the processor does not serve.

use std::rc::Rc;

use egui::Context;
use kalmanscope_core::Source;
use kalmanscope_lab::{Ensemble, EnsembleError};

use super::engine::{Engine, Finding, Graphics, GraphicsWork, Precision, Rows, Task, Work};

/// Gives maps to a graphics processor. The other engine computes until the processor is found, and after it gives up.
pub struct Accelerated {
    graphics: Rc<dyn Graphics>,
    other: Rc<dyn Engine>,
}

impl Accelerated {
    /// A graphics processor, and the engine that stands in for it.
    pub fn new(graphics: Rc<dyn Graphics>, other: Rc<dyn Engine>) -> Self {
        Self { graphics, other }
    }
}

impl Engine for Accelerated {
    fn start(&self, task: Task<'_>, ctx: &Context) -> Result<Box<dyn Work>, EnsembleError> {
        if task.precision == Precision::Double {
            return self.other.start(task, ctx);
        }
        let Self { graphics, other } = self;
        let finding = graphics.find(ctx);
        let mut work = AcceleratedWork {
            graphics: Rc::clone(graphics),
            other: Rc::clone(other),
            ensemble: task.ensemble.clone(),
            source: task.source.clone(),
            is_done: vec![false; task.ensemble.cells()],
            order: task.order.clone(),
            may_accelerate: true,
            on_graphics: None,
            on_other: None,
            ctx: ctx.clone(),
        };
        if finding == Finding::Ready {
            work.on_graphics = graphics.start(task.clone(), ctx);
        }
        if work.on_graphics.is_none() {
            work.on_other = Some(other.start(task, ctx)?);
        }
        Ok(Box::new(work))
    }

    fn usual_count(&self) -> usize {
        self.other.usual_count()
    }

    fn graphics(&self) -> Option<Finding> {
        Some(self.graphics.found())
    }
}

struct AcceleratedWork {
    graphics: Rc<dyn Graphics>,
    other: Rc<dyn Engine>,
    ensemble: Ensemble,
    source: Source,
    order: Vec<usize>,
    /// For each cell of the ensemble, whether its row has come.
    is_done: Vec<bool>,
    /// Whether the graphics processor has not given up this map.
    may_accelerate: bool,
    on_graphics: Option<Box<dyn GraphicsWork>>,
    on_other: Option<Box<dyn Work>>,
    ctx: Context,
}

impl Work for AcceleratedWork {
    fn poll(&mut self) -> Vec<Rows> {
        let mut rows = Vec::new();
        match self.on_graphics.as_mut().map(|work| work.poll()) {
            Some(Ok(new)) => {
                if !new.is_empty() {
                    // The graphics processor has begun: the other engine stops.
                    self.on_other = None;
                }
                rows = new;
            }
            Some(Err(_)) => {
                (self.on_graphics, self.may_accelerate) = (None, false);
                if self.on_other.is_none() && self.is_done.contains(&false) {
                    self.on_other = self.other.start(self.task(), &self.ctx).ok();
                }
            }
            None if self.may_accelerate && self.graphics.found() == Finding::Ready => {
                self.on_graphics = self.graphics.start(self.task(), &self.ctx);
                self.may_accelerate = self.on_graphics.is_some();
            }
            None => {}
        }
        if let Some(work) = &mut self.on_other {
            rows.extend(work.poll());
        }
        for cell in rows.iter().flat_map(|rows| &rows.cells) {
            self.is_done[*cell] = true;
        }
        rows
    }
}

impl AcceleratedWork {
    /// The cells without a row.
    fn task(&self) -> Task<'_> {
        let order = self.order.iter().copied().filter(|cell| !self.is_done[*cell]).collect();
        Task { ensemble: &self.ensemble, source: &self.source, order, precision: Precision::Fastest }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::sync::Arc;

    use kalmanscope_core::{Axis, Scenario};
    use kalmanscope_lab::{Measure, Plan, Runner, Sheet};

    use super::*;
    use crate::laboratory::engine::{Computer, GivenUp};
    use crate::laboratory::{Rows, Slices};
    use crate::session::Budget;

    /// A graphics processor that is ready and fails as the test wants.
    struct Played {
        finding: RefCell<Finding>,
        /// The portions of two cells that it computes before it gives up.
        portions: usize,
    }

    struct PlayedWork(Runner, Vec<usize>, usize);

    impl Graphics for Played {
        fn find(&self, _: &Context) -> Finding {
            self.found()
        }

        fn found(&self) -> Finding {
            self.finding.borrow().clone()
        }

        fn start(&self, task: Task<'_>, _: &Context) -> Option<Box<dyn GraphicsWork>> {
            let runner = Runner::new(task.ensemble.clone(), task.source.clone()).ok()?;
            Some(Box::new(PlayedWork(runner, task.order, self.portions)))
        }
    }

    impl GraphicsWork for PlayedWork {
        fn poll(&mut self) -> Result<Vec<Rows>, GivenUp> {
            let Self(runner, order, portions) = self;
            *portions = portions.checked_sub(1).ok_or(GivenUp)?;
            let cells: Vec<usize> = order.drain(..order.len().min(2)).collect();
            Ok(vec![Rows { numbers: runner.rows(&cells), cells, by: named() }])
        }
    }

    fn named() -> Computer {
        Computer::Graphics(Arc::from("a graphics processor"))
    }

    fn ensemble() -> Ensemble {
        let scenario = Scenario { duration: 1.0, ..Scenario::default() };
        let axes = vec![Axis::parse("filters.EKF.fading=1:1.1:10").unwrap()];
        Ensemble::new(scenario, Plan { filters: vec![0], measures: vec![Measure::Nis], axes, ..Plan::default() })
            .unwrap()
    }

    /// Polls until all cells are known; `before` is called before each poll. Returns the computer of each row.
    fn run(graphics: &Rc<Played>, precision: Precision, before: impl Fn(usize)) -> Vec<(Computer, usize)> {
        let (ensemble, ctx) = (ensemble(), Context::default());
        let engine = Accelerated::new(Rc::clone(graphics) as Rc<dyn Graphics>, Rc::new(Slices(Budget::Pieces(1))));
        let task = Task { ensemble: &ensemble, source: &Source::Simulated, order: (0..10).collect(), precision };
        let mut work = engine.start(task, &ctx).unwrap();
        let (mut sheet, mut by) = (Sheet::new(&ensemble), Vec::new());
        for nth in 0..40 {
            before(nth);
            for rows in work.poll() {
                sheet.fill(&rows.cells, &rows.numbers);
                by.push((rows.by, rows.cells.len()));
            }
            if sheet.is_complete() {
                break;
            }
        }
        let exact = Runner::new(ensemble, Source::Simulated).unwrap().rows(&(0..10).collect::<Vec<_>>());
        let rows: Vec<f64> = (0..10).flat_map(|cell| sheet.row(cell).unwrap().to_vec()).collect();
        assert_eq!(rows, exact);
        by
    }

    fn played(finding: Finding, portions: usize) -> Rc<Played> {
        Rc::new(Played { finding: RefCell::new(finding), portions })
    }

    #[test]
    fn one_that_is_ready_computes_all() {
        let by = run(&played(Finding::Ready, 99), Precision::Fastest, |_| {});
        assert_eq!(by, vec![(named(), 2); 5]);
    }

    #[test]
    fn one_that_gives_up_leaves_the_rest_to_the_other() {
        let by = run(&played(Finding::Ready, 2), Precision::Fastest, |_| {});
        assert_eq!(by[..2], [(named(), 2), (named(), 2)]);
        assert_eq!(by[2..], vec![(Computer::Frames, 1); 6]);
    }

    #[test]
    fn one_that_is_found_later_takes_over() {
        let graphics = played(Finding::Searching, 99);
        let found = Rc::clone(&graphics);
        let by = run(&graphics, Precision::Fastest, |nth| {
            if nth == 3 {
                *found.finding.borrow_mut() = Finding::Ready;
            }
        });
        let others: usize = by.iter().filter(|(by, _)| *by == Computer::Frames).map(|(_, cells)| cells).sum();
        assert!((3..=5).contains(&others), "{by:?}");
        assert_eq!(by.last().map(|(by, _)| by.clone()), Some(named()));
    }

    #[test]
    fn double_precision_is_for_the_other() {
        let by = run(&played(Finding::Ready, 99), Precision::Double, |_| {});
        assert_eq!(by, vec![(Computer::Frames, 1); 10]);
    }
}
