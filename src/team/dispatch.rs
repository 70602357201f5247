//! Cells that go from one computer to the next: to a graphics processor, to the team, to the frames.

use std::rc::Rc;

use egui::Context;

use super::{CellBatch, CellRows, Finding, Frames, Handle, Lost, Precision, Team};

pub struct Dispatch {
    team: Rc<dyn Team>,
    next: By,
    work: Option<Handle<CellRows>>,
    cells: CellBatch,
    is_done: Vec<bool>,
    ctx: Context,
}

#[derive(Clone, Copy)]
enum By {
    Graphics,
    Team,
    Frames,
}

impl Dispatch {
    /// The graphics processor serves if single precision will do. The context is woken when rows have come.
    pub fn new(team: &Rc<dyn Team>, cells: CellBatch, ctx: &Context) -> Self {
        let graphics = team.graphics().filter(|_| cells.precision == Precision::Fastest);
        // The first map begins the search, and its result runs the next ones.
        let is_ready = graphics.is_some_and(|graphics| graphics.find(ctx) == Finding::Ready);
        let mut is_done = vec![true; cells.runner.ensemble().cells()];
        cells.order.iter().for_each(|cell| is_done[*cell] = false);
        let next = if is_ready { By::Graphics } else { By::Team };
        Self { team: Rc::clone(team), next, work: None, cells, is_done, ctx: ctx.clone() }
    }

    pub fn take(&mut self) -> Vec<CellRows> {
        let mut rows = Vec::new();
        loop {
            let is_lost = self.work.as_mut().is_none_or(|work| all(work, &mut rows).is_err());
            rows.iter().flat_map(|rows| &rows.cells).for_each(|cell| self.is_done[*cell] = true);
            if !is_lost || !self.is_done.contains(&false) {
                return rows;
            }
            self.begin();
        }
    }

    fn begin(&mut self) {
        let Self { team, next, cells, is_done, ctx, .. } = self;
        let order = cells.order.iter().copied().filter(|cell| !is_done[*cell]).collect();
        let cells = CellBatch { order, ..cells.clone() };
        (self.work, *next) = match next {
            By::Graphics => (team.graphics().and_then(|graphics| graphics.cells(&cells, ctx)), By::Team),
            By::Team => (team.cells(&cells, ctx), By::Frames),
            By::Frames => (Frames::FRAME.cells(&cells, ctx), By::Frames),
        };
    }
}

fn all(work: &mut Handle<CellRows>, rows: &mut Vec<CellRows>) -> Result<(), Lost> {
    while let Some(new) = work.take()? {
        rows.push(new);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::sync::Arc;

    use kalmanscope_core::{Axis, Scenario, Source};
    use kalmanscope_diagnosis::Measure;
    use kalmanscope_lab::{Ensemble, EnsembleRows, Plan, Priority, Runner};

    use super::*;
    use crate::team::Budget;
    use crate::team::{Computer, Graphics};

    struct Played {
        finding: RefCell<Finding>,
        portions: usize,
    }

    struct Failing(usize);

    impl Team for Failing {
        fn cells(&self, cells: &CellBatch, _: &Context) -> Option<Handle<CellRows>> {
            let (CellBatch { runner, mut order, .. }, mut left) = (cells.clone(), self.0);
            Some(Handle::new(move || {
                left = left.checked_sub(1).ok_or(Lost)?;
                let cells = vec![order.remove(0)];
                Ok(Some(CellRows { numbers: runner.rows(&cells), cells, by: Computer::Workers(1) }))
            }))
        }
    }

    struct WithGraphics(Rc<Played>);

    impl Team for WithGraphics {
        fn cells(&self, cells: &CellBatch, ctx: &Context) -> Option<Handle<CellRows>> {
            Frames(Budget::Pieces(1)).cells(cells, ctx)
        }

        fn graphics(&self) -> Option<Rc<dyn Graphics>> {
            Some(Rc::<Played>::clone(&self.0))
        }
    }

    impl Graphics for Played {
        fn find(&self, _: &Context) -> Finding {
            self.found()
        }

        fn found(&self) -> Finding {
            self.finding.borrow().clone()
        }

        fn cells(&self, cells: &CellBatch, _: &Context) -> Option<Handle<CellRows>> {
            let (CellBatch { runner, mut order, .. }, mut portions) = (cells.clone(), self.portions);
            let mut is_over = false;
            Some(Handle::new(move || {
                // One portion a frame.
                if std::mem::take(&mut is_over) || order.is_empty() {
                    return Ok(None);
                }
                portions = portions.checked_sub(1).ok_or(Lost)?;
                is_over = true;
                let cells: Vec<usize> = order.drain(..order.len().min(2)).collect();
                Ok(Some(CellRows { numbers: runner.rows(&cells), cells, by: named() }))
            }))
        }
    }

    fn named() -> Computer {
        Computer::Graphics(Arc::from("a graphics processor"))
    }

    fn ensemble() -> Ensemble {
        let scenario = Scenario { duration: 1.0, ..Scenario::default() };
        let axes = vec![Axis::parse("filters.EKF.fading=1:1.1:10").unwrap()];
        Ensemble::new(scenario, Plan { filters: vec![0], measures: vec![Measure::NIS], axes, ..Plan::default() })
            .unwrap()
    }

    fn run(team: &Rc<dyn Team>, precision: Precision) -> Vec<(Computer, usize)> {
        let (ensemble, ctx, order) = (ensemble(), Context::default(), (0..10).collect());
        let runner = Arc::new(Runner::new(ensemble.clone(), Source::Simulated).unwrap());
        let cells = CellBatch { runner: Arc::clone(&runner), order, precision, priority: Priority::Map };
        let mut work = Dispatch::new(team, cells, &ctx);
        let (mut sheet, mut by) = (EnsembleRows::new(&ensemble), Vec::new());
        for _ in 0..40 {
            for rows in work.take() {
                sheet.fill(&rows.cells, &rows.numbers);
                by.push((rows.by, rows.cells.len()));
            }
            if sheet.is_complete() {
                break;
            }
        }
        let exact = runner.rows(&(0..10).collect::<Vec<_>>());
        let rows: Vec<f64> = (0..10).flat_map(|cell| sheet.row(cell).unwrap().to_vec()).collect();
        assert_eq!(rows, exact);
        by
    }

    fn played(finding: Finding, portions: usize) -> (Rc<Played>, Rc<dyn Team>) {
        let graphics = Rc::new(Played { finding: RefCell::new(finding), portions });
        (Rc::clone(&graphics), Rc::new(WithGraphics(graphics)))
    }

    #[test]
    fn one_that_is_ready_computes_all_in_single_precision_and_leaves_the_rest_to_the_other_if_it_gives_up() {
        let of = |portions, precision| run(&played(Finding::Ready, portions).1, precision);
        assert_eq!(of(99, Precision::Fastest), vec![(named(), 2); 5]);
        assert_eq!(of(2, Precision::Fastest), [vec![(named(), 2); 2], vec![(Computer::Frames, 1); 6]].concat());
        assert_eq!(of(99, Precision::Double), vec![(Computer::Frames, 1); 10]);
    }

    #[test]
    fn a_team_that_fails_leaves_the_rest_to_the_frames() {
        for rows in [0, 3] {
            let by = run(&(Rc::new(Failing(rows)) as Rc<dyn Team>), Precision::Fastest);
            assert_eq!(by[..rows], vec![(Computer::Workers(1), 1); rows]);
            assert!(by[rows..].iter().all(|(by, _)| *by == Computer::Frames));
        }
    }
}
