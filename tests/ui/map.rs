//! The laboratory: a map that fills, a dot that is dragged, cells that are clicked.

use egui::Pos2;
use kalmanscope::laboratory::{Choice, Slices};
use kalmanscope_core::Source;
use kalmanscope_lab::{Axis, Ensemble, Measure, Plan, Runner};

use super::*;

/// A paused screen of a short record with a coarse map; each frame computes all of it.
fn laboratory(size: Vec2, theme: Theme, second: Option<u32>) -> Screen {
    let mut screen =
        Harness::builder().with_size(size).with_theme(theme).with_step_dt(1.0 / 60.0).build_eframe(|creation| {
            let app = App::new(creation).expect("the default scenario can be run");
            app.computing_with(Box::new(Slices(Budget::Unlimited)))
        });
    *screen.state_mut().layout_mut() = Layout::of(Arrangement::Laboratory);
    let session = screen.state_mut().session_mut();
    session.set_budget(Budget::Unlimited);
    session.set_scenario(Scenario { duration: 5.0, ..Scenario::default() });
    session.set_mode(Mode::Whole);
    session.pause();
    session.seek(5.0);
    let axes = ["filters.*.initial_mean.natural_frequency=2:14:9", "filters.*.process_std=0.01:100:7:log"];
    let axes = axes.map(|text| Axis::parse(text).expect("it is an axis"));
    let measure = Measure::Rmse(Channel::NATURAL_FREQUENCY);
    screen.state_mut().laboratory_mut().choose(Some(Choice { axes, measure, filter: 1, second }));
    screen.run_steps(4);
    screen
}

#[test]
fn zz_pictures() {
    for (name, size, theme, second) in [
        ("light", DESKTOP, Theme::Light, None),
        ("dark", DESKTOP, Theme::Dark, Some(2)),
        ("phone", PHONE, Theme::Light, None),
    ] {
        let mut screen = laboratory(size, theme, second);
        screen.state_mut().session_mut().set_scenario(Scenario { duration: 20.0, ..Scenario::default() });
        let mut choice = screen.state().laboratory().choice().unwrap().clone();
        choice.axes.iter_mut().for_each(|axis| axis.count = 32);
        screen.state_mut().laboratory_mut().choose(Some(choice));
        screen.run_steps(6);
        screen.render().unwrap().save(format!("/tmp/h/map-{name}.png")).unwrap();
    }
}
