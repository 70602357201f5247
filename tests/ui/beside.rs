//! Work beside the frames: on real threads, and at workers that never answer.

use std::rc::Rc;
use std::time::{Duration, Instant};

use kalmanscope::team::{Handle, Report, Team};
use kalmanscope_core::import::Loaded;
use kalmanscope_core::suggest::Suggestion;
use kalmanscope_core::{FilterSettings, Record, Tape};
use kalmanscope_lab::Threads;

use super::files::drop_file;
use super::*;

const PATIENCE: Duration = Duration::from_secs(300);

struct OnThreads(Threads, egui::Context);

impl Team for OnThreads {
    fn threads(&self) -> Option<(&Threads, &egui::Context)> {
        Some((&self.0, &self.1))
    }
}

/// Workers that begin any task and never answer.
struct Stuck;

fn never<T>() -> Option<Handle<T>> {
    Some(Handle::new(|| Ok(None)))
}

impl Team for Stuck {
    fn is_beside(&self) -> bool {
        true
    }

    fn filter(&self, _: &Scenario, _: usize, _: &Record) -> Option<Handle<Tape>> {
        never()
    }

    fn load(&self, _: &[u8]) -> Option<Handle<Report<f64, Result<Loaded, String>>>> {
        never()
    }

    fn suggest(&self, _: &Scenario, _: &Record) -> Option<Handle<Report<f64, Suggestion>>> {
        never()
    }
}

/// A screen with a team, half a second of a fake clock a frame.
fn screen_with(team: impl FnOnce(&egui::Context) -> Rc<dyn Team> + 'static) -> Screen {
    let mut screen = Harness::builder().with_size(DESKTOP).with_step_dt(0.5).build_eframe(|creation| {
        let app = App::new(creation).expect("the default scenario can be run");
        app.working_with(team(&creation.egui_ctx))
    });
    screen.state_mut().session_mut().pause();
    screen.run_steps(4);
    screen
}

fn record(rows: usize, zeros: usize) -> Vec<u8> {
    let mut text = "t,force,displacement\n".to_owned();
    let zeros = "0".repeat(zeros);
    for k in 0..rows {
        let t = 0.01 * k as f64;
        text.push_str(&format!("{t:.2}{zeros},{:.4}{zeros},{:.6}\n", (3.0 * t).sin(), 0.01 * (3.0 * t - 0.2).sin()));
    }
    text.into_bytes()
}

#[test]
fn large_files_and_long_records_are_imported_on_threads() {
    for (bytes, is_large) in [(record(1500, 1700), true), (record(60_000, 0), false)] {
        assert_eq!(bytes.len() > 5_000_000, is_large);
        let mut screen = screen_with(|ctx| Rc::new(OnThreads(Threads::new(2, 1).expect("threads"), ctx.clone())));
        drop_file(&mut screen, "record.csv", &bytes);
        let begin = Instant::now();
        let wait = |screen: &mut Screen, is_over: &dyn Fn(&Screen) -> bool| {
            while !is_over(screen) {
                screen.step();
                assert!(begin.elapsed() < PATIENCE);
            }
        };
        let is_read = |screen: &Screen| {
            screen.query_by_label("Open the record").is_some_and(|node| !node.accesskit_node().is_disabled())
        };
        wait(&mut screen, &is_read);
        // The window comes to rest around its contents.
        screen.run_steps(3);
        screen.get_by_label("Open the record").click();
        screen.run_steps(2);
        wait(&mut screen, &|screen| screen.state().session().is_measured());
        assert!(screen.query_by_label("Open a measured record").is_none());
    }
}

#[test]
fn an_import_that_stands_still_says_so_and_can_be_cancelled() {
    let said = "It has made no progress for 10 s. Esc stops it.";
    for key in [true, false] {
        let mut screen = screen_with(|_| Rc::new(Stuck));
        drop_file(&mut screen, "record.csv", &record(1500, 1700));
        screen.run_steps(8);
        assert!(screen.query_by_label(said).is_none() && screen.query_by_label("Cancel the import").is_some());
        screen.run_steps(16);
        screen.get_by_label(said);
        if key {
            screen.key_press(Key::Escape);
        } else {
            screen.get_by_label("Cancel the import").click();
        }
        screen.run_steps(2);
        assert!(screen.query_by_label("Open a measured record").is_none());
    }
}

#[test]
fn plots_that_stand_still_say_so_and_can_be_stopped() {
    for key in [true, false] {
        let mut screen = screen_with(|_| Rc::new(Stuck));
        let before = scenario(&screen).clone();
        let mut long = Scenario { duration: 40.0, ..before.clone() };
        long.filters.truncate(1);
        let particles = FilterSettings { kind: FilterKind::PF, ensemble_size: 2000, ..long.filters[0].clone() };
        long.filters[0] = particles;
        let session = screen.state_mut().session_mut();
        // All that the frames have to do is done in the first one.
        session.set_budget(Budget::Unlimited);
        session.set_mode(Mode::Whole);
        session.set_scenario(long);
        screen.run_steps(12);
        assert_eq!(screen.state().notice(), None);
        screen.run_steps(14);
        let notice = screen.state().notice().expect("it is said");
        assert_eq!(notice, "The computation of the plots has made no progress for 10 s. Esc stops it.");
        if key {
            screen.key_press(Key::Escape);
        } else {
            screen.get_by_label("Stop").click();
        }
        screen.run_steps(3);
        assert!(!screen.state().session().behind() && screen.state().notice().is_none());
        assert_eq!(scenario(&screen).filters, before.filters);
    }
}
