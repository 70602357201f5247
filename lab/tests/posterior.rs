use kalmanscope_core::filter::{Normal, Robust};
use kalmanscope_core::scenario::Between;
use kalmanscope_core::{Channel, FilterKind, FilterSettings, PlantKind, Run, Scenario, Signal, Values, simulate};
use kalmanscope_lab::posterior::{NoPosterior, Sampled, Solutions, Target};

fn scenario(plant: PlantKind, kind: FilterKind, seed: u64) -> Scenario {
    let mut scenario = Scenario { duration: 12.0, seed, ..Scenario::default() };
    scenario.filters.truncate(1);
    scenario.set_plant(plant);
    scenario.filters[0].kind = kind;
    scenario.filters[0].process_std = Values::ZERO;
    scenario.filters[0].sensor_std = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
    scenario
}

fn sampled(scenario: &Scenario) -> Sampled {
    Target::new(scenario, 0, &simulate(scenario)).unwrap().sample().unwrap()
}

fn on_grid(scenario: &Scenario, about: &Sampled) -> ([[f64; 2]; 2], f64) {
    const STEPS: i32 = 40;
    let target = Target::new(scenario, 0, &simulate(scenario)).unwrap();
    let belief = [0, 1].map(|i| {
        let (filter, channel) = (&scenario.filters[0], about.channels[i]);
        [filter.initial_mean[channel], filter.initial_std[channel]]
    });
    let centre = [0, 1].map(|i| {
        let [mean, std] = about.moments(about.channels[i]).unwrap();
        [(mean - belief[i][0]) / belief[i][1], 6.0 * std / belief[i][1]]
    });
    let mut points = Vec::new();
    for i in -STEPS..=STEPS {
        for j in -STEPS..=STEPS {
            let share = [i, j].map(|step| f64::from(step) / f64::from(STEPS));
            points.push(vec![centre[0][0] + centre[0][1] * share[0], centre[1][0] + centre[1][1] * share[1]]);
        }
    }
    let log = |(likelihood, at): (f64, &Vec<f64>)| likelihood - 0.5 * (at[0] * at[0] + at[1] * at[1]);
    let logs: Vec<f64> = target.log_likelihoods(&points).into_iter().zip(&points).map(log).collect();
    let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = logs.iter().map(|log| (log - highest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    let mean = |i: usize| weights.iter().zip(&points).map(|(w, at)| w * at[i]).sum::<f64>() / sum;
    let moments = [0, 1].map(|i| {
        let mean = mean(i);
        let squares = weights.iter().zip(&points).map(|(w, at)| w * (at[i] - mean) * (at[i] - mean));
        [belief[i][0] + belief[i][1] * mean, belief[i][1] * (squares.sum::<f64>() / sum).sqrt()]
    });
    let cell = centre.iter().map(|[_, half]| half / f64::from(STEPS)).product::<f64>();
    (moments, highest + (sum * cell / std::f64::consts::TAU).ln())
}

#[test]
fn points_have_the_moments_and_the_evidence_of_a_fine_grid() {
    for (plant, kind, seed) in [
        (PlantKind::SDOF, FilterKind::EKF, 1),
        (PlantKind::SDOF, FilterKind::UKF, 2),
        (PlantKind::SDOF, FilterKind::PF, 3),
        (PlantKind::SDOF, FilterKind::EKF, 4),
    ] {
        let scenario = scenario(plant, kind, seed);
        let points = sampled(&scenario);
        let (moments, evidence) = on_grid(&scenario, &points);
        for (&channel, [mean, std]) in points.channels.iter().zip(moments) {
            let [own_mean, own_std] = points.moments(channel).unwrap();
            assert!((own_mean - mean).abs() < 0.2 * std, "{channel:?}");
            assert!((own_std / std - 1.0).abs() < 0.15, "{channel:?}");
        }
        assert!((points.log_evidence - evidence).abs() < 0.7, "{} {evidence}", points.log_evidence);
        assert_eq!(points.solutions(), None);
    }
}

/// Source: Talts, Betancourt, Simpson, Vehtari and Gelman (2018), Validating Bayesian inference algorithms with simulation-based
/// calibration.
#[test]
fn a_truth_from_the_initial_belief_has_any_rank_among_the_points() {
    const SEEDS: u64 = 16;
    for plant in [PlantKind::SDOF, PlantKind::DUFFING] {
        let mut ranks = Vec::new();
        for seed in 0..SEEDS {
            let mut scenario = Scenario { duration: 2.0, ..scenario(plant.clone(), FilterKind::UKF, 100 + seed) };
            let mut random = Normal::from_seed(seed);
            for channel in plant.parameters() {
                let filter = &mut scenario.filters[0];
                filter.initial_std[channel] = 0.1 * filter.initial_mean[channel];
                let truth = filter.initial_mean[channel] + filter.initial_std[channel] * random.sample();
                scenario.plant.set(channel, Signal::Constant(truth));
            }
            let sampled = sampled(&scenario);
            for &channel in &sampled.channels {
                let truth = scenario.plant.parameter(channel).unwrap().at(0.0);
                let values = sampled.values(channel).unwrap();
                let below = values.iter().filter(|value| **value < truth).count();
                ranks.push(below as f64 / values.len() as f64);
            }
        }
        // The largest distance of the distribution from the uniform one, by Kolmogorov's test at 0.1 %.
        ranks.sort_by(f64::total_cmp);
        let count = ranks.len() as f64;
        let distance =
            |(i, rank): (usize, &f64)| (rank - i as f64 / count).abs().max((rank - (i + 1) as f64 / count).abs());
        let furthest = ranks.iter().enumerate().map(distance).fold(0.0, f64::max);
        assert!(furthest < 1.95 / count.sqrt(), "{plant:?}: {furthest}");
        let inside = ranks.iter().filter(|rank| (0.025..0.975).contains(*rank)).count() as f64 / count;
        assert!(inside > 0.88, "{plant:?}: {inside}");
    }
}

/// A free oscillation that is read at 2 Hz has two frequencies: read so, 4 rad/s and 2 π 2 - 4 = 8.57 rad/s are the same.
#[test]
fn a_frequency_and_its_alias_are_two_solutions() {
    for seed in 1..=4 {
        let mut scenario = Scenario::from_toml(ALIASED).unwrap();
        scenario.seed = seed;
        let sampled = sampled(&scenario);
        let (channel, Solutions { means, shares, .. }) = sampled.solutions().expect("there are two");
        assert_eq!(channel, Channel::NATURAL_FREQUENCY);
        assert!((means[0] - 4.0).abs() < 0.03 && (means[1] - 8.57).abs() < 0.05, "{means:?}");
        assert!(shares.iter().all(|share| *share > 0.1), "{shares:?}");
        scenario.filters[0].initial_std[Channel::NATURAL_FREQUENCY] = 0.3;
        scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 4.2;
        assert_eq!(self::sampled(&scenario).solutions(), None, "the initial belief knows which");
    }
}

const ALIASED: &str = r#"
dt = 0.5
duration = 30.0
force = "none"
[plant]
kind = "sdof"
initial = { displacement = 1.0, velocity = 0.0 }
natural_frequency = 4.0
damping_ratio = 0.01
[[sensors]]
measures = "displacement"
noise_std = 0.02
[[filters]]
kind = "ekf"
initial_mean = { displacement = 0.0, velocity = 0.0, natural_frequency = 6.3, damping_ratio = 0.02 }
initial_std = { displacement = 2.0, velocity = 6.0, natural_frequency = 2.0, damping_ratio = 0.02 }
process_std = { displacement = 0.0, velocity = 0.0, natural_frequency = 0.0, damping_ratio = 0.0 }
sensor_std = [0.02]
"#;

#[test]
fn bounds_are_those_of_the_posterior() {
    let mut scenario = Scenario { duration: 10.0, ..scenario(PlantKind::SDOF, FilterKind::UKF, 11) };
    scenario.sensors.truncate(1);
    scenario.sensors[0].noise_std = 0.4;
    let filter = &mut scenario.filters[0];
    let set = |values: &Values, frequency: f64, damping: f64| {
        values.clone().with([(Channel::NATURAL_FREQUENCY, frequency), (Channel::DAMPING_RATIO, damping)])
    };
    (filter.sensor_std, filter.fading) = (vec![0.4], 1.0);
    (filter.initial_mean, filter.initial_std) =
        (set(&filter.initial_mean, 6.0, 0.0), set(&filter.initial_std, 0.02, 0.01));
    scenario.plant.set(Channel::DAMPING_RATIO, Signal::Constant(0.0));
    let free = sampled(&scenario);
    let ends = Between { least: Some(0.0), most: None };
    scenario.filters[0].bounds.set(Channel::DAMPING_RATIO, ends);
    let points = sampled(&scenario);
    let values = |points: &Sampled| points.values(Channel::DAMPING_RATIO).unwrap();
    let share = |points: &Sampled| {
        values(points).iter().filter(|value| **value >= 0.0).count() as f64 / values(points).len() as f64
    };
    assert!((0.2..0.95).contains(&share(&free)), "{}: the end must matter here", share(&free));
    assert_eq!(share(&points), 1.0);
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    let told = &run.estimates()[0];
    let (last, place) = (told.len() - 1, told.place(Channel::DAMPING_RATIO).unwrap());
    let [mean, std] = points.moments(Channel::DAMPING_RATIO).unwrap();
    let (found, spread) = (told.mean(last)[place], told.std(last, place));
    assert!((found - mean).abs() < 0.25 * std && (spread / std - 1.0).abs() < 0.25, "{found} {spread}, {mean} {std}");
    // p(z) = p(z | within) P(within) / P(within | z), and half of the belief lies within.
    let expected = free.log_evidence + (share(&free) / 0.5).ln();
    assert!((points.log_evidence - expected).abs() < 0.3, "{} {expected}", points.log_evidence);
}

#[test]
fn equal_arguments_give_equal_points_on_any_number_of_threads() {
    let scenario = Scenario { duration: 2.0, ..scenario(PlantKind::SDOF, FilterKind::EKF, 7) };
    let [one, three] = [1, 3].map(|threads| {
        let mut target = Target::new(&scenario, 0, &simulate(&scenario)).unwrap();
        target.threads = threads;
        target.sample()
    });
    assert_eq!(one, three);
}

#[test]
fn filters_without_a_likelihood_of_constant_parameters_are_refused() {
    let plain = Scenario { duration: 1.0, ..scenario(PlantKind::SDOF, FilterKind::EKF, 1) };
    let record = simulate(&plain);
    let reason = |change: fn(&mut FilterSettings)| {
        let mut scenario = plain.clone();
        change(&mut scenario.filters[0]);
        Target::new(&scenario, 0, &record).err().unwrap().to_string()
    };
    assert!(reason(|filter| filter.kind = FilterKind::KF).contains("estimates no parameter"));
    assert!(reason(|filter| filter.initial_std = Values::ZERO).contains("estimates no parameter"));
    assert!(reason(|filter| filter.robust = Robust::HUBER).contains("weighs"));
    assert!(reason(|filter| filter.consider = vec![Channel::DAMPING_RATIO]).contains("considers"));
    assert!(reason(|filter| filter.adaptation.sensor_noise = true).contains("learns"));
    assert!(matches!(Target::new(&plain, 1, &record), Err(NoPosterior::Run(_))));
}

#[test]
fn a_record_that_nothing_explains_has_no_posterior() {
    let mut scenario = Scenario { duration: 1.0, ..scenario(PlantKind::SDOF, FilterKind::EKF, 1) };
    let record = simulate(&scenario).with_measured(|_, _, _| 1e200);
    scenario.filters[0].sensor_std.fill(1e-3);
    assert_eq!(Target::new(&scenario, 0, &record).unwrap().sample(), None);
}

#[test]
fn one_group_is_no_two_solutions_and_two_are() {
    for seed in 0..200 {
        let mut random = Normal::from_seed(seed);
        let count = 128 + (seed as usize % 3) * 128;
        let normal: Vec<f64> = (0..count).map(|_| random.sample()).collect();
        let uniform: Vec<f64> = (0..count).map(|_| random.uniform()).collect();
        let skewed: Vec<f64> = normal.iter().map(|x| libm::exp(0.6 * x)).collect();
        for values in [normal.clone(), uniform, skewed] {
            assert_eq!(Solutions::of(values), None, "seed {seed}");
        }
        let two = normal.iter().enumerate().map(|(i, x)| if i % 4 == 0 { 12.0 + x } else { 2.0 + x });
        let found = Solutions::of(two.collect()).expect("they are ten standard deviations apart");
        assert!((found.means[0] - 2.0).abs() < 0.3 && (found.means[1] - 12.0).abs() < 0.6, "{found:?}");
        assert!((found.shares[1] - 0.25).abs() < 0.01, "{found:?}");
    }
    assert_eq!(Solutions::of(vec![1.0; 64]), None);
    assert_eq!(Solutions::of(Vec::new()), None);
}
