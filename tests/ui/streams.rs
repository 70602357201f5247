//! The sensors of a scenario, whose readings come from elsewhere while its filters follow them.

use std::rc::Rc;

use kalmanscope::sensor::{ReadingQueue, SensorDevice, Sensors};
use kalmanscope_core::{Record, Run, Scenario};
use kalmanscope_sources::StreamRow;

use super::measure::Device;
use super::*;

fn following(scenario: &Scenario) -> (Screen, Rc<Device<StreamRow>>, ReadingQueue<StreamRow>) {
    let device = Device::new();
    let stream: (Rc<dyn SensorDevice<StreamRow>>, _) = (Rc::clone(&device) as Rc<_>, Rc::new(scenario.clone()));
    let sensors = Sensors { stream: Some(stream), ..Sensors::default() };
    let mut screen = started(DESKTOP, Theme::Light, |app, ctx| {
        let mut app = app.measuring_with(sensors);
        app.watch(ctx);
        app
    });
    screen.state_mut().session_mut().set_budget(Budget::Unlimited);
    screen.run_steps(3);
    screen.get_by_label_contains("Waiting for readings");
    let readings = device.0.borrow().clone().expect("it has begun");
    (screen, device, readings)
}

/// The readings of a sample, as a source of lines delivers them.
fn row(record: &Record, k: usize) -> StreamRow {
    let readings = vec![record.measured(0)[k], record.measured(1)[k]];
    StreamRow { time: record.time(k), input: record.input()[k], readings }
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
        let (mut screen, _, readings) = following(&scenario);
        let mut told = 0;
        for frame in 0..480 {
            let now = f64::from(frame) / 60.0;
            while told < record.len() && record.time(told) <= now {
                readings.put(&[row(&record, told)], &screen.ctx);
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

#[test]
fn the_sensors_of_a_scenario_are_followed_while_they_are_read() {
    let text = "dt = 0.01\nduration = 40.0\nhold = \"first\"\n[[filters]]\nname = \"one\"\nkind = \"ekf\"\n";
    let scenario = Scenario::from_toml(text).expect("it is a scenario");
    let record = kalmanscope_core::simulate(&scenario);
    let (mut screen, device, readings) = following(&scenario);
    let tell = |screen: &mut Screen, from: usize, until: usize| {
        for k in from..until {
            let happened = row(&record, k);
            readings.put(&[StreamRow { time: 3.0 + happened.time, ..happened }], &screen.ctx);
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
    readings.put(&[StreamRow { time: 5.0, input: 0.0, readings: vec![1e9, 1e9] }], &screen.ctx);
    screen.run_steps(3);
    screen.get_by_label_contains("which is too late");
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
