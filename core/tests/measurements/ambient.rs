//! Records without an input: buildings with one sensor or two, and light masses.

use kalmanscope_core::{Quantity, VerdictKind};

use crate::ambient::Accelerometer;
use crate::ambient_end::{End, SETS, building, end, mass};

/// Prints the errors of the guess and of the end for each kind of record.
pub(crate) fn print() {
    ambient_records_of_many_kinds();
    two_sensors_of_a_building();
    masses_of_three_hertz();
}

fn ambient_records_of_many_kinds() {
    for rate in [20.0, 50.0] {
        for sensors in SETS {
            use Accelerometer::{BandLimited, Filtered, Held, Instant, Mean};
            let kinds = if sensors.contains(&Quantity::ACCELERATION) {
                &[Mean, BandLimited, Filtered, Instant, Held][..]
            } else {
                &[Mean]
            };
            for &kind in kinds {
                let ends: Vec<End> = (1300..1306).map(|seed| end(&building(rate, sensors, kind, seed), 0)).collect();
                let names: Vec<&str> = sensors.iter().map(|sensor| sensor.key()).collect();
                report(&format!("{rate} Hz {} {kind:?}", names.join("+")), &ends);
            }
        }
    }
}

fn two_sensors_of_a_building() {
    for rate in [20.0, 50.0] {
        for kind in [Accelerometer::Mean, Accelerometer::BandLimited, Accelerometer::Filtered, Accelerometer::Instant] {
            let ends: Vec<End> = (1350..1354).map(|seed| end(&building(rate, SETS[3], kind, seed), 0)).collect();
            report(&format!("{rate} Hz displacement+acceleration {kind:?}"), &ends);
        }
    }
}

fn masses_of_three_hertz() {
    for kind in [Accelerometer::Mean, Accelerometer::BandLimited, Accelerometer::Filtered, Accelerometer::Instant] {
        for rate in [50.0, 100.0] {
            let ends: Vec<End> = (1300..1308).map(|seed| end(&mass(kind, rate, seed), 0)).collect();
            report(&format!("3.1 Hz, {rate} Hz, {kind:?}"), &ends);
        }
    }
}

fn report(name: &str, ends: &[End]) {
    let n = ends.len() as f64;
    let rms = |of: &dyn Fn(&End) -> f64| (ends.iter().map(|end| of(end).powi(2)).sum::<f64>() / n).sqrt();
    let mean = |of: &dyn Fn(&End) -> f64| ends.iter().map(of).sum::<f64>() / n;
    let good = ends.iter().filter(|end| end.verdict == VerdictKind::Consistent).count();
    println!(
        "{name}: guess rms {:.2} % {:.0} %; end mean {:+.2} % {:+.1} %, rms {:.2} % {:.1} %, in σ {:.1} {:.1}, within 0.5 %/20 %: {}, \
         consistent {good} of {n}",
        100.0 * rms(&|end| end.guess[0]),
        100.0 * rms(&|end| end.guess[1]),
        100.0 * mean(&|end| end.errors[0]),
        100.0 * mean(&|end| end.errors[1]),
        100.0 * rms(&|end| end.errors[0]),
        100.0 * rms(&|end| end.errors[1]),
        rms(&|end| end.sigmas[0]),
        rms(&|end| end.sigmas[1]),
        ends.iter().filter(|end| end.errors[0].abs() < 0.005 && end.errors[1].abs() < 0.2).count(),
    );
    let count = |of: &dyn Fn(&End) -> bool| ends.iter().filter(|end| of(end)).count();
    let (low_pass, white) = (count(&|end| end.reasons.contains("low-pass")), count(&|end| end.is_white));
    println!("    a low pass is said of {low_pass} of {n}, a white force is taken for {white}");
    ends.iter().take(2).for_each(|end| println!("    {}", end.text));
}
