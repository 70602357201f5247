//! A free decay that this device measures or hears, from the tap to the parameters.

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::rc::Rc;

use kalmanscope::sensor::{Acceleration, Happened, Reading as _, Readings, Sensor, Sensors, Sound};
use kalmanscope_core::{Run, Scenario};

use super::files::drop_file;
use super::*;

/// A device that is played by the test.
struct Device<T>(RefCell<Option<Readings<T>>>);

impl<T> Device<T> {
    fn new() -> Rc<Self> {
        Rc::new(Self(RefCell::default()))
    }
}

impl<T> Sensor<T> for Device<T> {
    fn begin(&self, _: &egui::Context, to: &Readings<T>) {
        *self.0.borrow_mut() = Some(to.clone());
    }

    fn end(&self) {
        *self.0.borrow_mut() = None;
    }

    fn hint(&self) -> String {
        "Nothing is there.".to_owned()
    }
}

fn measuring(size: Vec2) -> (Screen, Rc<Device<Acceleration>>) {
    let device = Device::new();
    let sensors = Sensors { accelerometer: Some(Rc::clone(&device) as Rc<_>), ..Sensors::default() };
    (with_sensors(size, sensors), device)
}

/// A screen with the window of a measurement.
fn with_sensors(size: Vec2, sensors: Sensors) -> Screen {
    let mut screen = Harness::builder().with_size(size).with_theme(Theme::Light).with_step_dt(1.0 / 60.0).build_eframe(
        move |creation| App::new(creation).expect("the default scenario can be run").measuring_with(sensors),
    );
    screen.state_mut().session_mut().set_budget(Budget::Unlimited);
    screen.run_steps(3);
    click(&mut screen, "Scenario");
    click(&mut screen, "Measure with this device…");
    screen.run_steps(3);
    screen
}

/// A swing of 6 rad/s with 1 % damping beside gravity, after two seconds of rest, 60 readings a second with jitter.
fn swing(k: usize) -> [f64; 4] {
    let noise = |n: usize| f64::from((n as u32).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5;
    let t = (k as f64 + 0.4 * noise(7 * k)) / 60.0;
    let (w, z) = (6.0, 0.01);
    let a = if t < 2.0 { 0.0 } else { 2.0 * (-z * w * (t - 2.0)).exp() * (w * (t - 2.0)).cos() };
    [t, 0.3 + 0.6 * a + 0.06 * noise(3 * k + 1), 9.7 + 0.8 * a + 0.06 * noise(3 * k + 2), 0.06 * noise(3 * k + 3)]
}

#[test]
fn a_decay_is_measured_and_identified() {
    for size in [PHONE, DESKTOP] {
        let (mut screen, device) = measuring(size);
        click(&mut screen, "Begin to measure");
        let readings = device.0.borrow().clone().expect("it has begun");
        for k in 0..1800 {
            assert!(readings.put(&[swing(k)], &screen.ctx));
        }
        screen.run_steps(4);
        screen.get_by_label_contains("60.0 readings a second");
        screen.get_by_label_contains(" Hz");
        screen.get_by_label_contains("% damping");
        click(&mut screen, "Stop and identify");
        assert!(device.0.borrow().is_none(), "it has stopped");
        screen.run_steps(30);
        click(&mut screen, "Open the record");
        screen.run_steps(30);
        let session = screen.state().session();
        assert!(session.is_measured());
        let estimates = &session.run().estimates()[0];
        let last = estimates.len() - 1;
        let of = |channel| estimates.canonical_mean(last, estimates.place(channel).expect("it is estimated"));
        let (frequency, damping) = (of(Channel::NATURAL_FREQUENCY), of(Channel::DAMPING_RATIO));
        assert!((frequency / 6.0 - 1.0).abs() < 0.002 && (damping / 0.01 - 1.0).abs() < 0.15, "{frequency} {damping}");
    }
}

/// The explorer watches while it is measured: the record grows, stands still while one looks at the past, takes edits, and is
/// imported at the end.
#[test]
fn filters_are_watched_while_it_swings() {
    for size in [PHONE, DESKTOP] {
        let (mut screen, device) = measuring(size);
        click(&mut screen, "Begin to measure");
        let readings = device.0.borrow().clone().expect("it has begun");
        let mut told = 0;
        let mut tell = |screen: &mut Screen, until: usize| {
            while told < until {
                readings.put(&[swing(told)], &screen.ctx);
                told += 1;
                if told % 3 == 0 {
                    screen.run_steps(1);
                }
            }
            screen.run_steps(2);
        };
        tell(&mut screen, 500);
        click(&mut screen, "Watch the filters");
        screen.run_steps(3);
        let seconds = |screen: &Screen| screen.state().session().time();
        let before = seconds(&screen);
        assert!(screen.state().session().is_live() && before > 3.0, "{before}");
        screen.get_by_label_contains("% damping");
        tell(&mut screen, 800);
        let later = seconds(&screen);
        assert!((later - before - 5.0).abs() < 0.3, "it follows: from {before} s to {later} s");
        screen.state_mut().session_mut().seek(4.0);
        tell(&mut screen, 900);
        assert!((seconds(&screen) - 4.0).abs() < 0.1, "the past stands still: {} s", seconds(&screen));
        let mut scenario = screen.state().session().scenario().clone();
        scenario.filters[0].fading = 1.001;
        screen.state_mut().session_mut().edit(scenario);
        screen.state_mut().session_mut().toggle_play();
        tell(&mut screen, 1200);
        let session = screen.state().session();
        assert!(session.is_live() && session.problem().is_none());
        assert_eq!(session.run().scenario().filters[0].fading, 1.001);
        assert!((session.time() - later - 400.0 / 60.0).abs() < 0.3, "{} s", session.time());
        assert!(session.diagnosis(0).is_some(), "it is judged while it grows");
        tell(&mut screen, 1800);
        click(&mut screen, "Stop and identify");
        screen.run_steps(30);
        assert!(!screen.state().session().is_live());
        click(&mut screen, "Open the record");
        screen.run_steps(30);
        assert!(screen.state().session().is_measured());
    }
}

/// A screen that follows the sensors of a scenario.
fn following(scenario: &Scenario) -> (Screen, Rc<Device<Happened>>) {
    let device = Device::new();
    let stream: (Rc<dyn Sensor<Happened>>, _) = (Rc::clone(&device) as Rc<_>, Rc::new(scenario.clone()));
    let sensors = Sensors { stream: Some(stream), ..Sensors::default() };
    let mut screen =
        Harness::builder().with_size(DESKTOP).with_theme(Theme::Light).with_step_dt(1.0 / 60.0).build_eframe(
            move |creation| {
                let mut app = App::new(creation).expect("the default scenario can be run").measuring_with(sensors);
                app.watch(&creation.egui_ctx);
                app
            },
        );
    screen.state_mut().session_mut().set_budget(Budget::Unlimited);
    screen.run_steps(3);
    screen.get_by_label_contains("Waiting for readings");
    (screen, device)
}

/// In the clock of the readings: what a frame takes to compute and to draw comes on top, as the benchmark of frames tells.
#[test]
fn a_reading_is_on_screen_in_the_frame_in_which_it_comes() {
    for (rate, hold) in [(60, Hold::Zero), (100, Hold::First), (400, Hold::Zero)] {
        let hold = if hold == Hold::First { "first" } else { "zero" };
        let dt = 1.0 / f64::from(rate);
        let text =
            format!("dt = {dt}\nduration = 8.0\nhold = \"{hold}\"\n[[filters]]\nname = \"one\"\nkind = \"ekf\"\n");
        let scenario = Scenario::from_toml(&text).expect("it is a scenario");
        let record = kalmanscope_core::simulate(&scenario);
        let (mut screen, device) = following(&scenario);
        let readings = device.0.borrow().clone().expect("it has begun");
        let mut told = 0;
        for frame in 0..480 {
            let now = f64::from(frame) / 60.0;
            while told < record.len() && record.time(told) <= now {
                let measured = vec![record.measured(0)[told], record.measured(1)[told]];
                let (time, input) = (record.time(told), record.input()[told]);
                readings.put(&[Happened { time, input, readings: measured }], &screen.ctx);
                told += 1;
            }
            screen.run_steps(1);
            let session = screen.state().session();
            if frame > 120 {
                let shown = session.time() - session.run().record().time_of(0);
                let late = record.time(told - 1) - shown;
                assert!(late <= dt + 1e-9, "{rate} Hz: {late} s late at {now} s");
            }
        }
    }
}

/// A socket of this device tells the readings of the scenario on screen.
#[test]
fn the_scenario_on_screen_follows_a_socket() {
    for size in [DESKTOP, PHONE] {
        let device: Rc<Device<Happened>> = Device::new();
        let asked = Rc::new(std::cell::Cell::new((0, 0.0)));
        let connect = {
            let (device, asked) = (Rc::clone(&device), Rc::clone(&asked));
            Rc::new(move |scenario: &Scenario, port: u16| {
                asked.set((port, scenario.dt));
                Rc::clone(&device) as Rc<dyn Sensor<Happened>>
            })
        };
        let microphone: Rc<Device<f32>> = Device::new();
        let (socket, microphone) = (Some(connect as kalmanscope::sensor::Connect), Some(microphone as Rc<_>));
        let mut screen = with_sensors(size, Sensors { socket, microphone, ..Sensors::default() });
        click(&mut screen, "A socket");
        screen.run_steps(2);
        screen.get_by_label_contains("Known columns: t, force, displacement, velocity");
        click(&mut screen, "Connect");
        screen.run_steps(3);
        assert_eq!(asked.get(), (8765, 0.01));
        screen.get_by_label_contains("Waiting for readings … Nothing is there.");
        let scenario = Scenario { duration: 20.0, ..Scenario::default() };
        let record = kalmanscope_core::simulate(&scenario);
        let readings = device.0.borrow().clone().expect("it has begun");
        for k in 0..record.len() {
            let measured = vec![record.measured(0)[k], record.measured(1)[k]];
            readings
                .put(&[Happened { time: 0.01 * k as f64, input: record.input()[k], readings: measured }], &screen.ctx);
        }
        screen.run_steps(10);
        assert!(screen.state().session().is_live());
        let estimates = &screen.state().session().run().estimates()[0];
        assert!(
            (estimates.mean(estimates.len() - 1)[2] - 6.0).abs() < 0.3,
            "{}",
            estimates.mean(estimates.len() - 1)[2]
        );
        readings.end(&screen.ctx);
        screen.run_steps(3);
        screen.get_by_label_contains("The source has ended.");
        click(&mut screen, "Stop");
        screen.run_steps(3);
        assert!(device.0.borrow().is_none(), "it is closed");
        // Nobody answers.
        click(&mut screen, "Scenario");
        click(&mut screen, "Measure with this device…");
        screen.run_steps(2);
        click(&mut screen, "A socket");
        click(&mut screen, "Connect");
        screen.run_steps(2);
        let readings = device.0.borrow().clone().expect("it has begun");
        readings.refuse("Nothing answers at ws://localhost:8765".to_owned(), &screen.ctx);
        screen.run_steps(3);
        screen.get_by_label_contains("Nothing answers at ws://localhost:8765.");
        click(&mut screen, "Close");
    }
}

/// The sensors of a scenario, with clocks of their own and an input, are followed from the first reading on.
#[test]
fn the_sensors_of_a_scenario_are_followed_while_they_are_read() {
    let text = "dt = 0.01\nduration = 40.0\nhold = \"first\"\n[[filters]]\nname = \"one\"\nkind = \"ekf\"\n";
    let scenario = Scenario::from_toml(text).expect("it is a scenario");
    let record = kalmanscope_core::simulate(&scenario);
    let (mut screen, device) = following(&scenario);
    let readings = device.0.borrow().clone().expect("it has begun");
    let tell = |screen: &mut Screen, from: usize, until: usize| {
        for k in from..until {
            let happened = Happened {
                time: 3.0 + record.time(k),
                input: record.input()[k],
                readings: vec![record.measured(0)[k], record.measured(1)[k]],
            };
            readings.put(&[happened], &screen.ctx);
            if k % 10 == 0 {
                screen.run_steps(1);
            }
        }
        screen.run_steps(3);
    };
    tell(&mut screen, 0, 1000);
    screen.get_by_label_contains("100.0 readings a second");
    assert!(screen.state().session().is_live());
    tell(&mut screen, 1000, 2000);
    let session = screen.state().session();
    assert!((session.time() - 19.9).abs() < 0.2, "{} s", session.time());
    let sample = session.run().done() - 1;
    let mut whole = Run::new(&scenario).expect("it can be run");
    whole.advance_to(sample + 1);
    let numbers = |run: &Run, sample: usize| [0, 1].map(|place| run.estimates()[0].canonical_mean(sample, place));
    let (followed, simulated) = (numbers(session.run(), sample), numbers(&whole, sample));
    assert!((followed[0] - simulated[0]).abs() < 1e-9, "{followed:?} for {simulated:?}");
    // A reading that goes back is refused in a sentence, and nothing else changes.
    readings.put(&[Happened { time: 5.0, input: 0.0, readings: vec![1e9, 1e9] }], &screen.ctx);
    screen.run_steps(3);
    screen.get_by_label_contains("it comes too late");
    readings.end(&screen.ctx);
    screen.run_steps(3);
    screen.get_by_label_contains("The source has ended.");
    assert!(screen.state().session().is_live(), "what was read stays on screen");
    let sample = screen.state().session().run().done() - 1;
    let followed = numbers(screen.state().session().run(), sample);
    click(&mut screen, "Stop");
    screen.run_steps(20);
    let session = screen.state().session();
    assert!(!session.is_live() && session.is_measured() && session.problem().is_none());
    let mapping = session.scenario().record.as_ref().expect("it is a record");
    assert_eq!((mapping.file.as_str(), mapping.hash.is_empty()), ("measured.csv", false));
    assert_eq!(session.scenario().filters[0].name, "one");
    assert!(numbers(session.run(), sample) == followed, "the filters and the record are the same");
    assert!(device.0.borrow().is_none(), "it has stopped");
}

/// White noise from -1/2 to 1/2. Source: Steele, Lea and Flood (2014), Fast splittable pseudorandom number generators (its mix).
fn noise(k: u32) -> f64 {
    let mut bits = (u64::from(k) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    for factor in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
        bits = (bits ^ (bits >> 29)).wrapping_mul(factor);
    }
    (bits >> 40) as f64 / f64::from(1 << 24) - 0.5
}

/// A thing that rings at 523 Hz with a damping of 0.06 % after a second of silence, and a second mode.
fn ring() -> Vec<Sound> {
    let mode = |t: f64, hertz: f64, damping: f64| {
        let w = TAU * hertz;
        (-damping * w * t).exp() * (w * t).sin()
    };
    let sample = |k: u32| {
        let since = f64::from(k) / 48_000.0 - 1.0;
        let rings = if since < 0.0 { 0.0 } else { 0.3 * mode(since, 523.0, 6e-4) + 0.1 * mode(since, 3100.0, 1e-3) };
        (rings + 0.002 * noise(k)) as Sound
    };
    (0..240_000).map(sample).collect()
}

#[test]
fn a_ring_is_heard_and_identified() {
    for size in [PHONE, DESKTOP] {
        let device = Device::new();
        let sensors = Sensors {
            accelerometer: Some(Device::new() as Rc<dyn Sensor<Acceleration>>),
            microphone: Some(Rc::clone(&device) as Rc<_>),
            ..Sensors::default()
        };
        let mut screen = with_sensors(size, sensors);
        click(&mut screen, "It rings");
        click(&mut screen, "Begin to listen");
        screen.get_by_label("Waiting for the microphone …");
        let readings = device.0.borrow().clone().expect("it has begun");
        readings.set_rate(48_000.0);
        for some in ring().chunks(24_000) {
            assert!(readings.put(some, &screen.ctx));
            screen.run_steps(2);
        }
        screen.get_by_label("523.0 Hz");
        screen.get_by_label_contains("48000 samples a second");
        click(&mut screen, "Stop and identify");
        assert!(device.0.borrow().is_none(), "it has stopped");
        screen.run_steps(30);
        screen.get_by_label_contains("A sound that rings at 523.0 Hz");
        click(&mut screen, "Open the record");
        screen.run_steps(60);
        let session = screen.state().session();
        assert!(session.is_measured());
        let estimates = &session.run().estimates()[0];
        let last = estimates.len() - 1;
        let of = |channel| estimates.canonical_mean(last, estimates.place(channel).expect("it is estimated"));
        let (frequency, damping) = (of(Channel::NATURAL_FREQUENCY) / TAU, of(Channel::DAMPING_RATIO));
        assert!(
            (frequency / 523.0 - 1.0).abs() < 0.002 && (damping / 6e-4 - 1.0).abs() < 0.15,
            "{frequency} {damping}"
        );
    }
}

#[test]
fn silence_has_no_ring_and_is_said_to_have_none() {
    let device = Device::new();
    let sensors = Sensors { microphone: Some(Rc::clone(&device) as Rc<_>), ..Sensors::default() };
    let mut screen = with_sensors(PHONE, sensors);
    click(&mut screen, "Begin to listen");
    let readings = device.0.borrow().clone().expect("it has begun");
    readings.set_rate(44_100.0);
    readings.put(&vec![0.0; 200_000], &screen.ctx);
    screen.run_steps(3);
    click(&mut screen, "Stop and identify");
    screen.get_by_label_contains("Nothing rings in it");
    click(&mut screen, "Again");
    screen.get_by_label("Begin to listen");
    click(&mut screen, "Begin to listen");
    let readings = device.0.borrow().clone().expect("it has begun again");
    readings.set_rate(48_000.0);
    let minute = vec![1.0; Sound::MOST];
    assert!(readings.put(&minute, &screen.ctx) && !readings.put(&minute[..5], &screen.ctx));
    screen.run_steps(2);
    screen.get_by_label_contains("It is full.");
    screen.get_by_label_contains("It is too loud");
}

#[test]
fn what_cannot_be_measured_is_said() {
    let (mut screen, device) = measuring(PHONE);
    click(&mut screen, "Begin to measure");
    screen.run_steps(260);
    screen.get_by_label_contains("No reading has come yet. Nothing is there.");
    device.0.borrow().clone().expect("it has begun").refuse("It was not allowed".to_owned(), &screen.ctx);
    screen.run_steps(3);
    screen.get_by_label("It was not allowed.");
    click(&mut screen, "Again");
    click(&mut screen, "Begin to measure");
    let readings = device.0.borrow().clone().expect("it has begun again");
    for k in 0..600 {
        let [t, ..] = swing(k);
        readings.put(&[[t, 0.0, 9.81, 0.01 * f64::from(k as u32 % 2)]], &screen.ctx);
    }
    screen.run_steps(3);
    click(&mut screen, "Stop and identify");
    screen.get_by_label_contains("Nothing swung");
    screen.key_press(Key::Escape);
    screen.run_steps(3);
    assert!(screen.query_by_label("Again").is_none(), "the window is closed");
}

#[test]
fn the_file_of_a_phone_is_dropped_and_its_decay_is_taken() {
    let mut text =
        "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z (m/s^2)\"\n".to_owned();
    for [t, x, y, z] in (0..1800).map(swing) {
        writeln!(text, "{t:E},{x:E},{y:E},{z:E}").expect("memory");
    }
    let mut screen = screen(DESKTOP, Theme::Light);
    drop_file(&mut screen, "phone.csv", text.as_bytes());
    screen.run_steps(10);
    click(&mut screen, "Take its free decay");
    screen.run_steps(20);
    assert!(screen.query_by_label("Take its free decay").is_none(), "the decay has one axis");
    click(&mut screen, "Open the record");
    screen.run_steps(20);
    super::records::check_result(&screen, "phone.csv");
}
