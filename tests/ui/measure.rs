//! A free decay that this device measures or hears, from the tap to the parameters.

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::rc::Rc;

use kalmanscope::sensor::{Acceleration, ReadingQueue, SensorDevice, SensorReading as _, Sensors, Sound};
use kalmanscope_core::setting::Change;

use super::files::drop_file;
use super::records::{check_result, open_record};
use super::sounds::ring;
use super::*;

/// A device that is played by the test.
pub(crate) struct Device<T>(pub(crate) RefCell<Option<ReadingQueue<T>>>);

impl<T> Device<T> {
    pub(crate) fn new() -> Rc<Self> {
        Rc::new(Self(RefCell::default()))
    }
}

impl<T> SensorDevice<T> for Device<T> {
    fn begin(&self, _: &egui::Context, to: &ReadingQueue<T>) {
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

pub(crate) fn with_sensors(size: Vec2, sensors: Sensors) -> Screen {
    let mut screen = started(size, Theme::Light, |app, _| app.measuring_with(sensors));
    screen.state_mut().session_mut().set_budget(Budget::Unlimited);
    screen.run_steps(3);
    click(&mut screen, "Scenario");
    click(&mut screen, "Measure with this device…");
    screen.run_steps(3);
    screen
}

/// Begins by a button. Returns where readings go.
fn begin<T: Clone>(screen: &mut Screen, device: &Device<T>, button: &str) -> ReadingQueue<T> {
    click(screen, button);
    device.0.borrow().clone().expect("it has begun")
}

/// ωₙ and ζ of the first filter at the end of the record, which has opened without a question.
fn identified(screen: &mut Screen) -> [f64; 2] {
    screen.run_steps(60);
    assert!(screen.query_by_label("Open the record").is_none() && screen.query_all_by_label("Columns…").count() > 0);
    let session = screen.state().session();
    assert!(session.is_measured());
    let estimates = &session.run().estimates()[0];
    let of = |channel| estimates.place(channel).map(|place| estimates.canonical_mean(estimates.len() - 1, place));
    [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(|channel| of(channel).expect("it is estimated"))
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
        let readings = begin(&mut screen, &device, "Start measuring");
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
        let [frequency, damping] = identified(&mut screen);
        assert!((frequency / 6.0 - 1.0).abs() < 0.002 && (damping / 0.01 - 1.0).abs() < 0.15, "{frequency} {damping}");
    }
}

/// The explorer watches while it is measured: the record grows, stands still while one looks at the past, takes edits, and is
/// imported at the end.
#[test]
fn filters_are_watched_while_it_swings() {
    for size in [PHONE, DESKTOP] {
        let (mut screen, device) = measuring(size);
        let readings = begin(&mut screen, &device, "Start measuring");
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
        let mut change = Change::default();
        change.set(screen.state().session().scenario(), "filters.1.fading", 1.001);
        screen.state_mut().session_mut().edit(&change).unwrap();
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
        identified(&mut screen);
    }
}

#[test]
fn a_ring_is_heard_and_identified() {
    for size in [PHONE, DESKTOP] {
        let device = Device::new();
        let sensors = Sensors {
            accelerometer: Some(Device::new() as Rc<dyn SensorDevice<Acceleration>>),
            microphone: Some(Rc::clone(&device) as Rc<_>),
            ..Sensors::default()
        };
        let mut screen = with_sensors(size, sensors);
        click(&mut screen, "It rings");
        let readings = begin(&mut screen, &device, "Start listening");
        screen.get_by_label("Waiting for the microphone …");
        readings.set_rate(48_000.0);
        // A second mode rings with it.
        for some in ring([[0.3, 523.0, 6e-4], [0.1, 3100.0, 1e-3]], 0.002, 240_000).chunks(24_000) {
            assert!(readings.put(some, &screen.ctx));
            screen.run_steps(2);
        }
        screen.get_by_label("523.0 Hz");
        screen.get_by_label_contains("48000 samples a second");
        click(&mut screen, "Stop and identify");
        assert!(device.0.borrow().is_none(), "it has stopped");
        screen.run_steps(30);
        screen.get_by_label_contains("A sound that rings at 523.0 Hz");
        let [frequency, damping] = identified(&mut screen);
        let hertz = frequency / TAU;
        assert!((hertz / 523.0 - 1.0).abs() < 0.002 && (damping / 6e-4 - 1.0).abs() < 0.15, "{hertz} {damping}");
    }
}

#[test]
fn silence_has_no_ring_and_is_said_to_have_none() {
    let device = Device::new();
    let sensors = Sensors { microphone: Some(Rc::clone(&device) as Rc<_>), ..Sensors::default() };
    let mut screen = with_sensors(PHONE, sensors);
    let readings = begin(&mut screen, &device, "Start listening");
    readings.set_rate(44_100.0);
    readings.put(&vec![0.0; 200_000], &screen.ctx);
    screen.run_steps(3);
    click(&mut screen, "Stop and identify");
    screen.get_by_label_contains("No ringing tone was found");
    click(&mut screen, "Again");
    let readings = begin(&mut screen, &device, "Start listening");
    readings.set_rate(48_000.0);
    let minute = vec![1.0; Sound::MOST];
    assert!(readings.put(&minute, &screen.ctx) && !readings.put(&minute[..5], &screen.ctx));
    screen.run_steps(2);
    screen.get_by_label_contains("It is full.");
}

#[test]
fn what_cannot_be_measured_is_said() {
    let (mut screen, device) = measuring(PHONE);
    let readings = begin(&mut screen, &device, "Start measuring");
    screen.run_steps(260);
    screen.get_by_label_contains("No reading has come yet. Nothing is there.");
    readings.refuse("It was not allowed".to_owned(), &screen.ctx);
    screen.run_steps(3);
    screen.get_by_label("It was not allowed.");
    click(&mut screen, "Again");
    let readings = begin(&mut screen, &device, "Start measuring");
    for k in 0..600 {
        let [t, ..] = swing(k);
        readings.put(&[[t, 0.0, 9.81, 0.01 * f64::from(k as u32 % 2)]], &screen.ctx);
    }
    screen.run_steps(3);
    click(&mut screen, "Stop and identify");
    screen.get_by_label_contains("othing moved");
    press(&mut screen, Key::Escape);
    assert!(screen.query_by_label("Again").is_none(), "the window is closed");
}

#[test]
fn the_file_of_a_phone_is_dropped_and_its_decay_is_taken() {
    let mut text =
        "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z (m/s^2)\"\n".to_owned();
    // A hand stops it after 15 s, and plucks it again.
    for k in 0..1800 {
        let [t, x, y, z] = swing(k % 900);
        writeln!(text, "{:E},{x:E},{y:E},{z:E}", t + if k < 900 { 0.0 } else { 15.0 }).expect("memory");
    }
    let mut screen = screen(DESKTOP, Theme::Light);
    drop_file(&mut screen, "phone.csv", text.as_bytes());
    screen.run_steps(10);
    click(&mut screen, "Take its free decay");
    screen.run_steps(20);
    assert!(screen.query_by_label("Take its free decay").is_none(), "the decay has one axis");
    open_record(&mut screen);
    check_result(&screen, "phone.csv");
    let session = screen.state().session();
    let plucks = &session.scenario().filters[0].plucks;
    assert!(plucks.len() == 1 && (13.0..16.0).contains(&plucks[0]), "{plucks:?}");
}
