use super::*;

fn trial(mass: f64, frequency: f64, std: f64) -> Trial {
    let damping = Estimated { mean: 0.01, std: 0.001 };
    Trial { name: String::new(), mass, frequency: Estimated { mean: frequency, std }, damping, is_believed: true }
}

/// Numbers with mean 0 and variance 1, about normal.
fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        let sum: f64 = (0..12)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            })
            .sum();
        sum - 6.0
    }
}

/// By `numpy.polyfit(m, T², 1, w=1/σ, cov="unscaled")` of numpy 2.
#[test]
fn the_line_is_that_of_numpy() {
    let trials = [trial(0.0, 7.05, 0.01), trial(0.05, 6.31, 0.012), trial(0.1, 5.74, 0.009), trial(0.15, 5.33, 0.02)];
    let spring = Spring::of(&trials).expect("the masses differ");
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * b.abs(), "{a} {b}");
    near(spring.stiffness.mean, 9.832_444_459_335_347);
    near(spring.stiffness.std, 0.094_058_934_744_130_12);
    near(spring.own_mass.mean, 0.197_724_833_245_117_9);
    near(spring.own_mass.std, 0.002_261_248_260_611_837);
    near(spring.chi_squared, 1.671_004_595_263_179_6);
    let there = spring.period_squared(0.3);
    near(there.mean, 1.998_423_576_169_194_9);
    near(there.std, 0.010_338_301_899_949_286);
    assert_eq!((spring.freedom, spring.excess()), (2, 1.0));
}

#[test]
fn bands_of_the_stiffness_cover_it() {
    let (k, own) = (24.0, 0.21);
    for (masses, least, most) in [(&[0.0, 0.1][..], 0.94, 0.965), (&[0.0, 0.05, 0.1, 0.15, 0.2, 0.3], 0.94, 0.99)] {
        let mut normal = normals(7);
        let mut covered = [0, 0];
        for _ in 0..4000 {
            let trials: Vec<Trial> = masses
                .iter()
                .map(|&mass| {
                    let (frequency, std): (f64, f64) = (f64::sqrt(k / (own + mass)), 0.02);
                    trial(mass, frequency + std * normal(), std)
                })
                .collect();
            let spring = Spring::of(&trials).expect("the masses differ");
            for (count, (found, truth)) in covered.iter_mut().zip([(spring.stiffness, k), (spring.own_mass, own)]) {
                *count += u32::from((found.mean - truth).abs() <= found.band());
            }
        }
        for count in covered {
            let share = f64::from(count) / 4000.0;
            assert!((least..most).contains(&share), "{masses:?}: {share}");
        }
    }
}

#[test]
fn bands_that_are_too_narrow_are_widened() {
    let right: Vec<Trial> =
        (0..5).map(|i| trial(0.1 * f64::from(i), f64::sqrt(20.0 / (0.3 + 0.1 * f64::from(i))), 0.01)).collect();
    let mut off = right.clone();
    off[2].frequency.mean += 0.1;
    let [right, off] = [right, off].map(|trials| Spring::of(&trials).expect("the masses differ"));
    assert!((right.stiffness.mean - 20.0).abs() < 1e-9 && right.excess() == 1.0);
    assert!(off.excess() > 3.0, "{}", off.excess());
    assert!((off.stiffness.mean - 20.0).abs() < off.stiffness.band(), "{off:?}");
}

#[test]
fn without_two_masses_or_with_a_period_that_falls_there_is_no_spring() {
    assert_eq!(Spring::of(&[]), None);
    assert_eq!(Spring::of(&[trial(0.1, 5.0, 0.1)]), None);
    assert_eq!(Spring::of(&[trial(0.1, 5.0, 0.1), trial(0.1, 5.1, 0.1)]), None);
    assert_eq!(Spring::of(&[trial(0.1, 5.0, 0.1), trial(0.2, 6.0, 0.1)]), None);
}

#[test]
fn all_that_is_possible_has_a_finite_line() {
    let ends = |mean: f64| [1.1e-12, 1.0, 999.0].map(|share| share * mean);
    for first in [1e-9, 1.0, 1e9] {
        for second in [1e-9, 1.0, 1e9] {
            for (a, b) in ends(first).into_iter().zip(ends(second)) {
                for mass in [1e-300, 1.0, Trial::HEAVIEST] {
                    let trials = [trial(0.0, first, a), trial(mass, second, b)];
                    trials.iter().for_each(|trial| assert_eq!(trial.check(), Ok(())));
                    let spring = Spring::of(&trials);
                    assert!(spring.is_none_or(|spring| spring.own_mass.mean.is_finite()), "{trials:?} {spring:?}");
                }
            }
        }
    }
}

#[test]
fn a_spread_has_both_kinds_of_doubt() {
    let of = |mean: f64, std: f64| Estimated { mean, std };
    assert_eq!(Spread::of(&[of(1.0, 0.1)]), None);
    let spread = Spread::of(&[of(1.0, 0.3), of(2.0, 0.4), of(3.0, 0.0)]).expect("there are three");
    assert_eq!((spread.count, spread.ends, spread.mean, spread.among), (3, [1.0, 3.0], 2.0, 1.0));
    assert!((spread.own - f64::sqrt(0.25 / 3.0)).abs() < 1e-12);
}

#[test]
fn impossible_trials_are_refused() {
    let good = trial(0.1, 6.0, 0.1);
    assert_eq!(good.check(), Ok(()));
    let with = |change: &dyn Fn(&mut Trial)| {
        let mut bad = good.clone();
        change(&mut bad);
        bad.check().expect_err("it is impossible")
    };
    assert!(with(&|bad| bad.mass = f64::NAN).contains("mass"));
    assert!(with(&|bad| bad.frequency.mean = 0.0).contains("frequency"));
    assert!(with(&|bad| bad.frequency.std = 0.0).contains("frequency"));
    assert!(with(&|bad| bad.damping.std = -1.0).contains("damping"));
    assert!(with(&|bad| bad.name = "x".repeat(41)).contains("name"));
    assert!(with(&|bad| bad.name = "a\nb".to_owned()).contains("name"));
}
