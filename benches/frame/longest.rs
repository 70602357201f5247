//! The longest frame of the heaviest case that the explorer shows as a whole: six filters, one of them a particle filter of
//! 2,000 particles, 200,000 samples and six views. No frame may take more than 50 ms.

use eframe::App as _;
use egui::{Event, Key, Modifiers, RawInput, pos2};
use kalmanscope::App;
use kalmanscope::session::{Budget, Mode, Session};
use kalmanscope_core::{FilterKind, FilterSettings, Scenario};
use kalmanscope_lessons::BUILT_IN;

use crate::clock::Moment;
use crate::memory::Memory;
use crate::screen::{Phase, Screen, edit};

const PARTICLES: usize = 2_000;
const EKF: usize = 0;
const PF: usize = 5;

pub(crate) fn run(wanted: &str) {
    let cases: [(&str, fn()); 4] = [
        ("six filters, one of 2,000 particles, 200,000 samples", six_filters),
        ("six filters, the whole picture of 200,000 samples", whole_picture),
        ("six filters, three smoothers, 200,000 samples", smoothers),
        ("six filters, a live record of 200,000 samples", live),
    ];
    for (name, case) in cases.into_iter().filter(|(name, _)| name.contains(wanted)) {
        println!();
        println!("{name}");
        Phase::head();
        case();
    }
}

/// From program start on, with everything that a user may do while the particle filter is computed.
fn six_filters() {
    let saved = saved(&scenario(PARTICLES));
    let begin = Moment::now();
    let mut screen = start(&saved);
    Phase::once(begin.elapsed()).print("program start");
    Phase::of(&mut screen, 1, |_, _, _| {}).print("first frame");
    Phase::of(&mut screen, 300, |_, _, _| {}).print("the cheap filters are computed");
    Phase::of(&mut screen, 300, |_, _, _| {}).print("the particle filter is computed");
    Phase::of(&mut screen, 100, first(|app| edit_filter(app, EKF, 0))).print("a filter is edited");
    Phase::of(&mut screen, 100, first(|app| edit_sensor(app, 0))).print("a sensor is edited");
    Phase::of(&mut screen, 200, |app, i, _| edit_sensor(app, i + 1)).print("a sensor is dragged");
    Phase::of(&mut screen, 30, |_, i, input| escape(i, input)).print("Esc");
    Phase::of(&mut screen, 100, first(|app| app.session_mut().set_mode(Mode::Whole))).print("whole");
    Phase::of(&mut screen, 30, first(|app| app.session_mut().set_mode(Mode::Live))).print("live");
    Phase::of(&mut screen, 100, first(|app| app.session_mut().set_mode(Mode::Whole))).print("whole again");
    Phase::of(&mut screen, 100, first(open_another)).print("another scenario is opened");
}

/// The whole picture of a record as long, with few particles so that it comes soon, and what a user may do with it.
fn whole_picture() {
    let mut saved = saved(&scenario(20));
    let mut screen = start(&saved);
    Phase::until_complete(&mut screen, |_, _| {}).print("from program start until complete");
    Phase::of(&mut screen, 100, |_, _, _| {}).print("nothing changes");
    Phase::of(&mut screen, 100, point).print("the pointer moves");
    let begin = Moment::now();
    screen.app.save(&mut saved);
    Phase::once(begin.elapsed()).print("the session is saved");
    Phase::until_complete(&mut screen, |app, _| edit_filter(app, EKF, 1)).print("a filter is edited, until complete");
    Phase::of(&mut screen, 100, |app, i, _| edit_filter(app, EKF, i + 2)).print("a filter is dragged");
    Phase::until_complete(&mut screen, |app, _| edit_sensor(app, 1)).print("a sensor is edited, until complete");
    Phase::of(&mut screen, 60, first(|app| edit_filter(app, PF, 1))).print("the particle filter is edited");
    Phase::of(&mut screen, 60, first(|app| edit_sensor(app, 2))).print("a sensor is edited");
    Phase::of(&mut screen, 30, |_, i, input| escape(i, input)).print("Esc");
    Phase::of(&mut screen, 100, first(|app| app.session_mut().set_mode(Mode::Live))).print("live");
    Phase::until_complete(&mut screen, |app, _| app.session_mut().set_mode(Mode::Whole)).print("whole, until complete");
    Phase::of(&mut screen, 100, first(open_another)).print("another scenario is opened");
}

fn smoothers() {
    let mut scenario = scenario(20);
    for filter in &mut scenario.filters[..3] {
        filter.smoother = true;
    }
    let mut screen = start(&saved(&scenario));
    Phase::until_complete(&mut screen, |_, _| {}).print("from program start until complete");
    Phase::until_complete(&mut screen, |app, _| edit_filter(app, EKF, 1)).print("a filter is edited, until complete");
    Phase::until_complete(&mut screen, |app, _| edit_sensor(app, 1)).print("a sensor is edited, until complete");
    Phase::of(&mut screen, 200, first(|app| edit_sensor(app, 2))).print("a sensor is edited");
    Phase::of(&mut screen, 30, |_, i, input| escape(i, input)).print("Esc");
    Phase::of(&mut screen, 60, first(|app| app.session_mut().set_mode(Mode::Live))).print("live");
}

/// A record longer than what is kept of it: half of the samples are forgotten while it plays.
fn live() {
    let mut scenario = scenario(20);
    scenario.duration *= 2.0;
    let mut screen = start(&saved(&scenario));
    let kept = scenario.dt * Session::KEPT as f64;
    Phase::until_complete(&mut screen, |app, _| {
        app.session_mut().pause();
        app.session_mut().set_mode(Mode::Live);
        app.session_mut().seek(kept - 2.0);
    })
    .print("until a distant time is reached");
    Phase::of(&mut screen, 200, |app, i, _| {
        if i == 0 {
            app.session_mut().set_speed(10.0);
            app.session_mut().toggle_play();
        }
    })
    .print("playing");
    assert!(screen.app.session().run().record().forgotten() > 0, "nothing has been forgotten");
}

/// A change before the first frame of a phase.
fn first(change: impl Fn(&mut App)) -> impl FnMut(&mut App, usize, &mut RawInput) {
    move |app, i, _| {
        if i == 0 {
            change(app);
        }
    }
}

fn edit_filter(app: &mut App, place: usize, i: usize) {
    edit(app, |scenario| scenario.filters[place].fading = 1.0 + 1e-5 * (i + 1) as f64);
}

fn edit_sensor(app: &mut App, i: usize) {
    edit(app, |scenario| scenario.sensors[0].noise_std = 0.01 + 1e-5 * (i + 1) as f64);
}

fn open_another(app: &mut App) {
    let scenario = BUILT_IN[1].scenario().expect("a built-in scenario");
    app.session_mut().set_scenario(scenario);
    app.session_mut().play_from_start();
}

fn escape(i: usize, input: &mut RawInput) {
    if i == 0 {
        let key = |pressed| Event::Key {
            key: Key::Escape,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        input.events.extend([key(true), key(false)]);
    }
}

fn point(_: &mut App, i: usize, input: &mut RawInput) {
    input.events.push(Event::PointerMoved(pos2(500.0 + i as f32, 300.0)));
}

fn scenario(particles: usize) -> Scenario {
    let mut scenario = Scenario::default();
    let sensor_std = scenario.true_sensor_std();
    let kinds = [
        ("EKF", FilterKind::EKF),
        ("UKF", FilterKind::UKF),
        ("SR-UKF", FilterKind::SR_UKF),
        ("CKF", FilterKind::CKF),
        ("IEKF", FilterKind::IEKF),
        ("PF", FilterKind::PF),
    ];
    scenario.filters = kinds
        .map(|(name, kind)| FilterSettings {
            name: name.to_owned(),
            kind,
            ensemble_size: particles,
            sensor_std: sensor_std.clone(),
            ..FilterSettings::default()
        })
        .to_vec();
    scenario.duration = scenario.dt * Session::LONGEST_WHOLE as f64;
    assert_eq!((scenario.filters.len(), scenario.samples()), (6, Session::LONGEST_WHOLE + 1));
    scenario
}

/// The program as it starts with what was saved.
fn start(saved: &Memory) -> Screen {
    Screen::new(|ctx| {
        let mut creation = eframe::CreationContext::_new_kittest(ctx.clone());
        creation.storage = Some(saved);
        App::new(&creation).expect("the scenario can be run")
    })
}

/// The saved state of an explorer that shows all of a scenario.
fn saved(scenario: &Scenario) -> Memory {
    let mut app = App::with_scenario(scenario.clone()).expect("the scenario can be run");
    app.session_mut().set_budget(Budget::FRAME);
    app.session_mut().set_mode(Mode::Whole);
    let mut memory = Memory::default();
    app.save(&mut memory);
    memory
}
