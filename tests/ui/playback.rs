//! Time, the axis that the plots share, ready-made scenarios and what survives a restart.

use super::*;

#[test]
fn the_transport_does_what_it_says() {
    let mut screen = screen(DESKTOP, Theme::Dark);
    let position = |screen: &Screen| screen.state().session().position();
    let begin = position(&screen);
    screen.run_steps(30);
    assert!(
        position(&screen) > begin + 50,
        "it plays by itself, {} samples in half a second",
        position(&screen) - begin
    );
    screen.get_by_label("Pause").click();
    screen.run_steps(3);
    let paused = position(&screen);
    screen.run_steps(10);
    assert_eq!(position(&screen), paused);
    screen.get_by_label("Step").click();
    screen.run_steps(3);
    assert_eq!(position(&screen), paused + 1);
    screen.key_press(Key::ArrowRight);
    screen.run_steps(3);
    assert_eq!(position(&screen), paused + 2);
    set(&mut screen, "Time", 20.0);
    assert_eq!(position(&screen), 2000);
    assert_eq!(screen.state().session().run().len(), 2001);
    screen.get_by_label("Whole record").click();
    screen.run_steps(3);
    assert_eq!(screen.state().session().run().len(), 6001);
    screen.get_by_label("Restart").click();
    screen.run_steps(3);
    assert_eq!(position(&screen), 0);
    screen.get_by_label("Live").click();
    screen.run_steps(3);
    assert_eq!(screen.state().session().run().len(), 1);
    choose(&mut screen, "Speed", "10×");
    assert_eq!(screen.state().session().speed(), 10.0);
}

#[derive(Default)]
struct Memory(HashMap<String, String>);

impl eframe::Storage for Memory {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

#[test]
fn settings_survive_and_what_cannot_be_read_is_the_default() {
    let mut edited = Scenario { seed: 5, force: Force::None, ..Scenario::default() };
    edited.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(3.0));
    edited.add_sensor(kalmanscope_core::Sensor { measures: Quantity::ACCELERATION, noise_std: 0.2 });
    let mut app = App::with_scenario(edited.clone()).expect("the scenario can be run");
    app.session_mut().set_mode(Mode::Whole);
    app.session_mut().set_speed(5.0);
    app.layout_mut().toggle(ViewKind::Gain);
    let shown = app.layout_mut().shown();
    let mut memory = Memory::default();
    app.save(&mut memory);
    let mut restored = App::restored(Some(&memory)).expect("the default can be run");
    assert_eq!(restored.layout_mut().shown(), shown);
    let session = restored.session();
    assert_eq!((session.scenario(), session.mode(), session.speed()), (&edited, Mode::Whole, 5.0));

    for broken in ["gibberish".to_owned(), memory.0["kalmanscope"].replacen("dt = 0.01", "dt = -1.0", 1)] {
        assert_ne!(broken, memory.0["kalmanscope"]);
        memory.set_string("kalmanscope", broken);
        let restored = App::restored(Some(&memory)).expect("the default can be run");
        assert_eq!(restored.session().scenario(), &Scenario::default());
    }
}

#[test]
fn a_paused_screen_comes_to_rest() {
    let mut screen = screen(DESKTOP, Theme::Light);
    screen.get_by_label("Pause").click();
    screen.run_steps(3);
    screen.hover_at(egui::pos2(600.0, 400.0));
    screen.run_steps(3);
    screen.remove_cursor();
    assert!(screen.try_run().is_ok(), "nothing moves, but frame after frame is drawn");
}

#[test]
fn pointing_and_zooming_do_what_they_say() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let session = screen.state_mut().session_mut();
    session.toggle_play();
    session.seek(20.0);
    screen.run_steps(3);
    let plot = screen.get_by_label("Plot of the displacement").rect();
    screen.hover_at(plot.center());
    screen.run_steps(3);
    let pointed = screen.state().axis().pointed.expect("the user points at a plot");
    assert!((5.0..15.0).contains(&pointed), "{pointed} s is not in the middle of the plot");
    screen.drag_at(plot.center());
    screen.run_steps(2);
    screen.hover_at(plot.center() + Vec2::new(80.0, 30.0));
    screen.run_steps(2);
    screen.drop_at(plot.center() + Vec2::new(80.0, 30.0));
    screen.run_steps(3);
    assert!(!screen.state().axis().follows, "a dragged axis stays where it is put");
    screen.get_by_label("Restart").click();
    screen.run_steps(3);
    assert!(screen.state().axis().follows, "a new start is seen from its start");
}

#[test]
fn every_built_in_scenario_opens_and_plays() {
    let mut screen = screen(DESKTOP, Theme::Light);
    for entry in kalmanscope::library::ENTRIES {
        screen.get_by_label("Scenario").click();
        screen.run_steps(3);
        screen.get_by_label(entry.name).click();
        screen.run_steps(10);
        assert_eq!(scenario(&screen), &entry.scenario().expect("tested with the library"), "{}", entry.name);
        assert!(screen.state().session().playing());
    }
}
