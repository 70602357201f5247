//! What a frame costs without a screen: the median of 200, split into an edit before it and the app's `logic` and `ui`.
//!
//! Six views, four filters and 6,000 samples, which is the most that a lecture shows at once.

use std::time::{Duration, Instant};

use eframe::App as _;
use egui::{Context, Event, Pos2, RawInput, Rect, Theme, Vec2, pos2};
use kalmanscope::App;
use kalmanscope::layout::Layout;
use kalmanscope::request::ViewKind;
use kalmanscope::session::Mode;
use kalmanscope_core::{FilterKind, FilterSettings, Scenario};

const FRAMES: usize = 200;
const SIZE: Vec2 = Vec2::new(1280.0, 800.0);
const VIEWS: [ViewKind; 6] = [
    ViewKind::Oscillator,
    ViewKind::Parameters,
    ViewKind::States,
    ViewKind::Errors,
    ViewKind::Innovations,
    ViewKind::Consistency,
];

/// A way to change something before a frame.
type Change = fn(&mut App, usize, &mut RawInput);

fn main() {
    println!("{:<44} {:>9} {:>9} {:>9} {:>9}", "median of 200 frames [ms]", "change", "logic", "ui", "sum");
    let cases: [(&str, Mode, Change); 6] = [
        ("whole record, nothing changes", Mode::Whole, |_, _, _| {}),
        ("whole record, the pointer moves", Mode::Whole, |_, i, input| {
            input.events.push(Event::PointerMoved(pos2(500.0 + i as f32, 300.0)));
        }),
        ("whole record, one filter recomputed", Mode::Whole, |app, i, _| {
            edit(app, |scenario| scenario.filters[0].fading = 1.0 + 1e-5 * (i + 1) as f64);
        }),
        ("whole record, everything recomputed", Mode::Whole, |app, i, _| {
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
    let wanted = std::env::args().nth(1).filter(|arg| !arg.starts_with('-')).unwrap_or_default();
    for (name, mode, change) in cases.into_iter().filter(|(name, ..)| name.contains(&wanted)) {
        let [change, logic, ui] = frame_times(mode, change).map(median);
        println!("{name:<44} {change:>9.2} {logic:>9.2} {ui:>9.2} {:>9.2}", change + logic + ui);
    }
}

/// Times of each frame's change, logic and ui \[ms\].
fn frame_times(mode: Mode, change: Change) -> [Vec<f64>; 3] {
    let ctx = Context::default();
    kalmanscope::theme::install(&ctx);
    ctx.set_theme(Theme::Light);
    let mut app = App::with_scenario(scenario()).expect("the scenario can be run");
    *app.layout_mut() = Layout::column(&VIEWS);
    app.session_mut().toggle_play();
    app.session_mut().set_mode(mode);
    app.session_mut().seek(60.0);
    let mut frame = eframe::Frame::_new_kittest();
    let mut times = [const { Vec::new() }; 3];
    const WARM_UP: usize = 10;
    for i in 0..WARM_UP + FRAMES {
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SIZE)),
            time: Some(i as f64 / 60.0),
            ..RawInput::default()
        };
        let begin = Instant::now();
        if let Some(i) = i.checked_sub(WARM_UP) {
            change(&mut app, i, &mut input);
        }
        let changed = begin.elapsed();
        let (mut logic, mut ui) = (Duration::ZERO, Duration::ZERO);
        let _ = ctx.run_ui(input, |root| {
            let begin = Instant::now();
            app.logic(root.ctx(), &mut frame);
            logic += begin.elapsed();
            let begin = Instant::now();
            app.ui(root, &mut frame);
            ui += begin.elapsed();
        });
        if i >= WARM_UP {
            for (times, time) in times.iter_mut().zip([changed, logic, ui]) {
                times.push(1e3 * time.as_secs_f64());
            }
        }
    }
    times
}

fn scenario() -> Scenario {
    let mut scenario = Scenario::default();
    let sensor_std = scenario.true_sensor_std();
    for (name, kind, fading) in [("EKF, λ 1.005", FilterKind::EKF, 1.005), ("UKF, λ 1.005", FilterKind::UKF, 1.005)] {
        let sensor_std = sensor_std.clone();
        scenario.filters.push(FilterSettings {
            name: name.to_owned(),
            kind,
            fading,
            sensor_std,
            ..FilterSettings::default()
        });
    }
    assert_eq!((scenario.filters.len(), scenario.samples()), (4, 6001));
    scenario
}

fn edit(app: &mut App, edit: impl FnOnce(&mut Scenario)) {
    let mut scenario = app.session().scenario().clone();
    edit(&mut scenario);
    app.session_mut().set_scenario(scenario);
}

fn median(mut times: Vec<f64>) -> f64 {
    let middle = times.len() / 2;
    *times.select_nth_unstable_by(middle, f64::total_cmp).1
}
