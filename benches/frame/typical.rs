//! The median of 200 frames, split into an edit before it, the app's `logic` and `ui`, and the triangles.
//!
//! Six views, four filters and 6,000 samples, which is the most that a lecture shows at once.

use egui::{Event, Modifiers, PointerButton, RawInput, pos2};
use kalmanscope::App;
use kalmanscope::session::Mode;
use kalmanscope_core::{FilterKind, FilterSettings, Scenario};

use crate::screen::{Frame, Screen, edit};

const WARM_UP: usize = 10;
const FRAMES: usize = 200;

/// A way to change something before a frame.
type Change = fn(&mut App, usize, &mut RawInput);

pub(crate) fn run(wanted: &str) {
    println!(
        "{:<44} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "median of 200 frames [ms]", "change", "logic", "ui", "triangles", "sum"
    );
    let cases: [(&str, Mode, Change); 6] = [
        ("whole record, nothing changes", Mode::Whole, |_, _, _| {}),
        ("whole record, the pointer moves", Mode::Whole, |_, i, input| {
            input.events.push(Event::PointerMoved(pos2(500.0 + i as f32, 300.0)));
        }),
        ("whole record, one filter recomputed", Mode::Whole, |app, i, input| {
            press(i, input);
            edit(app, |scenario| scenario.filters[0].fading = 1.0 + 1e-5 * (i + 1) as f64);
        }),
        ("whole record, everything recomputed", Mode::Whole, |app, i, input| {
            press(i, input);
            edit(app, |scenario| scenario.sensors[0].noise_std = 0.01 + 1e-5 * (i + 1) as f64);
        }),
        ("live, at the end, nothing changes", Mode::Live, |_, _, _| {}),
        ("live, playing", Mode::Live, |app, i, _| {
            if i == 0 {
                app.session_mut().play_from_start();
                app.session_mut().seek(30.0);
            }
        }),
    ];
    for (name, mode, change) in cases.into_iter().filter(|(name, ..)| name.contains(wanted)) {
        let frames = frames(mode, change);
        let [change, logic, ui, triangles] =
            [0, 1, 2, 3].map(|part| median(frames.iter().map(|frame| frame[part].wall).collect()));
        println!(
            "{name:<44} {change:>9.2} {logic:>9.2} {ui:>9.2} {triangles:>9.2} {:>9.2}",
            change + logic + ui + triangles
        );
    }
}

/// Presses the pointer in the first frame, as one who drags a slider does.
fn press(frame: usize, input: &mut RawInput) {
    if frame == 0 {
        let pos = pos2(1279.0, 799.0);
        let button =
            Event::PointerButton { pos, button: PointerButton::Primary, pressed: true, modifiers: Modifiers::NONE };
        input.events.extend([Event::PointerMoved(pos), button]);
    }
}

fn frames(mode: Mode, change: Change) -> Vec<Frame> {
    let mut screen = Screen::new(|_| App::with_scenario(scenario()).expect("the scenario can be run"));
    let session = screen.app.session_mut();
    session.toggle_play();
    session.set_mode(mode);
    session.seek(60.0);
    for _ in 0..WARM_UP {
        screen.frame(|_, _| {});
    }
    (0..FRAMES).map(|i| screen.frame(|app, input| change(app, i, input))).collect()
}

fn scenario() -> Scenario {
    let mut scenario = Scenario::default();
    let sensor_std = scenario.true_sensor_std();
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        let (name, sensor_std) = (format!("{}, λ 1.005", kind.name()), sensor_std.clone());
        scenario.filters.push(FilterSettings { name, kind, fading: 1.005, sensor_std, ..FilterSettings::default() });
    }
    assert_eq!((scenario.filters.len(), scenario.samples()), (4, 6001));
    scenario
}

fn median(mut times: Vec<f64>) -> f64 {
    let middle = times.len() / 2;
    *times.select_nth_unstable_by(middle, f64::total_cmp).1
}
