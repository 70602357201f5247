//! The longest frame of the heaviest case that the explorer shows as a whole: six filters, one of them a particle filter,
//! 200,000 samples and six views. No frame may take more than 50 ms.

use eframe::App as _;
use egui::{Event, Key, Modifiers, RawInput};
use kalmanscope::App;
use kalmanscope::session::{Budget, Mode, Session};
use kalmanscope_core::{FilterKind, FilterSettings, Scenario};
use kalmanscope_lessons::BUILT_IN;

use crate::memory::Memory;
use crate::screen::{Phase, Screen, edit};

/// The particles of one that takes minutes, and of one that is soon complete.
const PARTICLES: [usize; 2] = [2_000, 20];

type Change = fn(&mut App, usize, &mut RawInput);

/// Phases: a name, the frames of each, and what changes before a frame.
const PHASES: [(&str, usize, Change); 11] = [
    ("the first frame", 1, |_, _, _| {}),
    ("the cheap filters are computed", 300, |_, _, _| {}),
    ("the particle filter is computed", 300, |_, _, _| {}),
    ("the pointer moves", 100, |_, i, input| {
        input.events.push(Event::PointerMoved(egui::pos2(500.0 + i as f32, 300.0)));
    }),
    ("a filter is edited", 100, |app, i, _| {
        if i == 0 {
            edit(app, |scenario| scenario.filters[0].fading = 1.001);
        }
    }),
    ("a filter is dragged", 100, |app, i, _| {
        edit(app, |scenario| scenario.filters[0].fading = 1.0 + 1e-5 * (i + 1) as f64);
    }),
    ("a sensor is dragged", 200, |app, i, _| {
        edit(app, |scenario| scenario.sensors[0].noise_std = 0.01 + 1e-5 * (i + 1) as f64);
    }),
    ("Esc", 30, |_, i, input| {
        let key = |pressed| {
            let (key, modifiers) = (Key::Escape, Modifiers::NONE);
            Event::Key { key, physical_key: None, pressed, repeat: false, modifiers }
        };
        input.events.extend([true, false].map(key).into_iter().filter(|_| i == 0));
    }),
    ("live, and whole again", 100, |app, i, _| match i {
        0 => app.session_mut().set_mode(Mode::Live),
        30 => app.session_mut().set_mode(Mode::Whole),
        _ => {}
    }),
    ("the session is saved", 1, |app, _, _| app.save(&mut Memory::default())),
    ("another scenario is opened", 100, |app, i, _| {
        if i == 0 {
            app.session_mut().set_scenario(BUILT_IN[1].scenario().expect("a built-in scenario"));
            app.session_mut().play_from_start();
        }
    }),
];

pub(crate) fn run(wanted: &str) {
    for particles in PARTICLES {
        let name = format!("six filters, one of {particles} particles, 200,000 samples");
        if !name.contains(wanted) {
            continue;
        }
        println!("\n{name}");
        Phase::head();
        let mut screen = start(&saved(&scenario(particles)));
        for (name, frames, change) in PHASES {
            Phase::of(&mut screen, frames, change).print(name);
        }
    }
}

fn scenario(particles: usize) -> Scenario {
    let mut scenario = Scenario::default();
    let sensor_std = scenario.true_sensor_std();
    let kinds =
        [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF, FilterKind::IEKF, FilterKind::PF];
    let filter = |kind: FilterKind| {
        let (name, sensor_std) = (kind.name().to_owned(), sensor_std.clone());
        FilterSettings { name, kind, ensemble_size: particles, sensor_std, ..FilterSettings::default() }
    };
    scenario.filters = kinds.map(filter).to_vec();
    scenario.duration = scenario.dt * Session::LONGEST_WHOLE as f64;
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
