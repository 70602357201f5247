//! The laboratory: a map that fills, a dot that is dragged, cells that are clicked.

use std::cell::Cell;
use std::rc::Rc;
use std::sync::Arc;

use egui::{Context, Pos2};
use kalmanscope::laboratory::MapChoice;
use kalmanscope::team::{CellBatch, CellRows, Computer, Finding, Frames, Graphics, Handle, Lost, Precision, Team};
use kalmanscope_core::{Axis, Source};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::{Ensemble, Plan, Runner};

use super::*;

fn laboratory(second: Option<u32>) -> Screen {
    laboratory_by(Rc::new(Frames(Budget::Unlimited)), second)
}

fn laboratory_by(team: Rc<dyn Team>, second: Option<u32>) -> Screen {
    let mut screen = started(DESKTOP, Theme::Light, |app, _| app.working_with(team));
    *screen.state_mut().layout_mut() = ViewLayout::of(Arrangement::Laboratory);
    show_whole(&mut screen, Scenario { duration: 5.0, ..Scenario::default() });
    screen.state_mut().session_mut().seek(5.0);
    let axes = ["filters.*.initial_mean.natural_frequency=2:14:9", "filters.*.process_std=0.01:100:7:log"];
    let axes = axes.map(|text| Axis::parse(text).expect("it is an axis"));
    let measure = Measure::rmse(Channel::NATURAL_FREQUENCY);
    screen.state_mut().laboratory.choose(Some(MapChoice {
        axes,
        measure,
        filter: 1,
        second,
        precision: Precision::default(),
    }));
    screen.run_steps(4);
    screen
}

fn map_rect(screen: &Screen, filter: &str) -> egui::Rect {
    screen.get_by_label(&format!("Map of {filter}, RMS error of ωₙ [rad/s]")).rect()
}

fn middle(screen: &Screen, [across, up]: [usize; 2]) -> Pos2 {
    let rect = map_rect(screen, "EKF");
    let share = |place: usize, count: usize| (place as f32 + 0.5) / count as f32;
    egui::pos2(rect.left() + share(across, 9) * rect.width(), rect.bottom() - share(up, 7) * rect.height())
}

fn guess(screen: &Screen, filter: usize) -> f64 {
    scenario(screen).filters[filter].initial_mean[Channel::NATURAL_FREQUENCY]
}

fn dot(screen: &Screen) -> Pos2 {
    screen.get_by_label_contains("Setting on screen, EKF").rect().center()
}

#[test]
fn the_map_has_the_numbers_of_a_sweep_of_the_scenario() {
    let screen = laboratory(Some(2));
    let laboratory = &screen.state().laboratory;
    assert_eq!((laboratory.progress(), laboratory.state.problem.as_deref()), (None, None));
    let survey = laboratory.shown().expect("there is a map");
    for (at, name) in ["EKF", "UKF"].into_iter().enumerate() {
        let axes = survey.axes().map(|axis| Axis { key: axis.key.replace('*', name), ..axis.clone() }).to_vec();
        let measures = vec![Measure::rmse(Channel::NATURAL_FREQUENCY), Measure::NIS, Measure::DIVERGED];
        let plan = Plan { filters: vec![at], measures: measures.clone(), axes, ..Plan::default() };
        let ensemble = Ensemble::new(scenario(&screen).clone(), plan).expect("it is possible");
        let runner = Runner::new(ensemble, Source::Simulated).expect("it is possible");
        for cell in 0..63 {
            let shown = measures.iter().map(|measure| survey.value(cell, at, *measure).map(f64::to_bits));
            let expected = runner.rows(&[cell]).into_iter().map(|number| Some(number.to_bits()));
            assert!(shown.eq(expected), "cell {cell} of {name}");
        }
    }
}

#[test]
fn the_dot_is_dragged_and_everything_follows_in_one_step_of_undo() {
    let mut screen = laboratory(None);
    screen.run_steps(90);
    let checksum = screen.state().session().run().checksum();
    let known = screen.state().laboratory.state.version;
    let (from, to) = (dot(&screen), middle(&screen, [5, 2]));
    drag(&mut screen, from, to - from);
    assert!((guess(&screen, 0) - 9.5).abs() < 0.05, "{}", guess(&screen, 0));
    let factor = scenario(&screen).filters[0].process_std[Channel::VELOCITY]
        / Scenario::default().filters[0].process_std[Channel::VELOCITY];
    // The legend has a new entry, so that the map has moved under the hand.
    let rect = map_rect(&screen, "EKF");
    let share = f64::from((rect.bottom() - to.y) / rect.height());
    let expected = 10_f64.powf(-2.0 + 4.0 * (7.0 * share - 0.5) / 6.0);
    assert!((factor / expected - 1.0).abs() < 0.02, "{factor} instead of {expected}");
    assert_eq!(guess(&screen, 1), 8.0, "the filter that is not on the map stays");
    assert_ne!(screen.state().session().run().checksum(), checksum, "the run follows");
    assert_eq!(screen.state().laboratory.state.version, known, "the map stays");
    assert!((dot(&screen) - to).length() < 2.0);
    screen.run_steps(90);
    click(&mut screen, "Undo");
    assert_eq!(guess(&screen, 0), 8.0);
}

#[test]
fn a_click_on_a_cell_takes_its_setting() {
    let mut screen = laboratory(Some(2));
    let at = middle(&screen, [6, 1]);
    screen.hover_at(at);
    screen.run_steps(3);
    assert!(screen.query_by_label_contains("guess of ωₙ 11 rad/s").is_some(), "pointing shows the cell");
    screen.drag_at(at);
    screen.drop_at(at);
    screen.run_steps(4);
    assert_eq!([guess(&screen, 0), guess(&screen, 1)], [11.0, 11.0], "both filters are on the map");
    let run = screen.state().session().run();
    let estimates = &run.estimates()[1];
    let expected = kalmanscope_core::Diagnostics::new(estimates, run.record()).mean_nis().expect("it is measured");
    let survey = screen.state().laboratory.shown().expect("there is a map");
    let shown = survey.value(survey.ensemble.cell(&[6, 1]), 1, Measure::NIS).expect("it is known");
    assert!((shown - expected.mean / expected.expected).abs() < 1e-12 * shown, "the run is that of the cell");
}

#[test]
fn axes_score_and_filters_are_chosen_by_menus_and_the_dot_moves_by_arrows() {
    let mut screen = laboratory(None);
    choose(&mut screen, "Score", "log likelihood");
    choose(&mut screen, "Setting up", "fading factor λ");
    choose(&mut screen, "Second filter", "and UKF");
    let choice = screen.state().laboratory.choice.as_ref().expect("there is one").clone();
    assert_eq!((choice.measure, choice.second), (Measure::LOG_LIKELIHOOD, Some(2)));
    assert_eq!(choice.axes[1].key, "filters.*.fading");
    for name in ["EKF", "UKF", "comparison"] {
        assert!(screen.query_by_label(&format!("Map of {name}, log likelihood")).is_some(), "{name}");
    }
    screen.get_by_label_contains("Setting on screen, EKF").focus();
    screen.run_steps(2);
    let time = screen.state().session().time();
    press(&mut screen, Key::ArrowRight);
    assert_eq!(guess(&screen, 0), 9.5, "the next cell");
    assert_eq!(screen.state().session().time(), time, "playback stays");
}

#[test]
fn out_of_sight_the_laboratory_rests() {
    let mut screen = laboratory(None);
    let done = screen.state().laboratory.state.version;
    *screen.state_mut().layout_mut() = ViewLayout::of(Arrangement::Teach);
    set_scenario(&mut screen, Scenario { duration: 6.0, ..Scenario::default() });
    assert_eq!(screen.state().laboratory.state.version, done);
    show(&mut screen, &[ViewKind::Map]);
    let shown = screen.state().laboratory.shown().expect("there is a map");
    assert_eq!(shown.ensemble.scenario().duration, 6.0);
    assert!(shown.sheet.is_complete());
}

#[test]
fn the_row_and_the_column_through_the_dot_stand_above_and_beside_the_cells() {
    let mut screen = laboratory(None);
    show(&mut screen, &[ViewKind::Map]);
    let cells = map_rect(&screen, "EKF");
    let [across, up] = ["across", "up"].map(|way| screen.get_by_label(&format!("Score {way}, through the dot")).rect());
    assert!((across.x_range(), up.y_range()) == (cells.x_range(), cells.y_range()), "they share the axes");
    assert!(across.bottom() < cells.top() && up.left() > cells.right());
    // A verdict is no number: all room is for the cells.
    let mut choice = screen.state().laboratory.choice.as_ref().cloned().expect("there is a map");
    choice.measure = Measure::VERDICT;
    screen.state_mut().laboratory.choose(Some(choice));
    screen.run_steps(4);
    assert!(screen.query_by_label("Score across, through the dot").is_none());
}

#[test]
fn ranges_and_numbers_of_values_are_set_in_a_popup() {
    let mut screen = laboratory(None);
    click(&mut screen, "Ranges of the map");
    set(&mut screen, "last value across", 20.0);
    set(&mut screen, "Values up", 5.0);
    screen.run_steps(3);
    let shown = screen.state().laboratory.shown().expect("there is a map");
    let [x, y] = shown.axes();
    assert_eq!((x.from, x.to, x.count, y.count), (2.0, 20.0, 9, 5));
    assert!(shown.sheet.is_complete() && shown.sheet.len() == 45);
}

/// A graphics processor that computes all at once, until it is lost.
#[derive(Clone, Default)]
struct Card {
    is_lost: Rc<Cell<bool>>,
}

impl Graphics for Card {
    fn find(&self, _: &Context) -> Finding {
        self.found()
    }

    fn found(&self) -> Finding {
        if self.is_lost.get() { Finding::Lost("it was pulled out".to_owned()) } else { Finding::Ready }
    }

    fn cells(&self, cells: &CellBatch, _: &Context) -> Option<Handle<CellRows>> {
        let CellBatch { runner, order, .. } = cells.clone();
        let numbers = runner.rows(&order);
        let mut rows = Some(CellRows { cells: order, numbers, by: Computer::Graphics(Arc::from("the card")) });
        Some(Handle::new(move || rows.take().map(Some).ok_or(Lost)))
    }
}

impl Team for Card {
    fn cells(&self, cells: &CellBatch, ctx: &Context) -> Option<Handle<CellRows>> {
        Frames(Budget::Unlimited).cells(cells, ctx)
    }

    fn graphics(&self) -> Option<Rc<dyn Graphics>> {
        Some(Rc::new(self.clone()))
    }
}

#[test]
fn the_map_says_what_has_computed_it_and_does_without_the_graphics_processor() {
    let card = Card::default();
    let mut screen = laboratory_by(Rc::new(card.clone()), None);
    let computers = |screen: &Screen| {
        let survey = screen.state().laboratory.shown().expect("there is a map");
        assert!(survey.sheet.is_complete());
        survey.computers.to_vec()
    };
    assert_eq!(computers(&screen), [Computer::Graphics(Arc::from("the card"))]);
    screen.get_by_label("computed in single precision by the card");
    click(&mut screen, "Ranges of the map");
    click(&mut screen, "without the graphics processor");
    assert_eq!(screen.state().laboratory.choice.as_ref().map(|choice| choice.precision), Some(Precision::Double));
    assert_eq!(computers(&screen), [Computer::Frames]);
    click(&mut screen, "without the graphics processor");
    assert_eq!(computers(&screen), [Computer::Graphics(Arc::from("the card"))]);
    card.is_lost.set(true);
    screen.run_steps(2);
    screen.get_by_label("The graphics processor has failed; maps go on without it.");
}
