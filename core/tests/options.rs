//! Options of filters: every pair of them works, or the table of exclusions refuses it.

use kalmanscope_core::scenario::Between;
use kalmanscope_core::scenario::option::{BOUNDED, CONSIDERED, EXCLUSIONS, GUESSED};
use kalmanscope_core::setting::Change;
use kalmanscope_core::{Channel, FilterKind, FilterSettings, Quantity, Robust, Run, Scenario};

type Setting = (&'static str, fn(&mut FilterSettings));

const SETTINGS: [Setting; 18] = [
    ("jump", |filter| filter.jump = true),
    ("walk", |filter| filter.walk = 0.1),
    ("guesses", |filter| filter.guesses = 3),
    ("scales", |filter| filter.process_scales = 3),
    ("weights", |filter| filter.robust = Robust::GATE),
    ("smoother", |filter| filter.smoother = true),
    ("look-ahead", |filter| (filter.smoother, filter.look_ahead) = (true, 0.1)),
    ("considered", |filter| filter.consider.push(Channel::DAMPING_RATIO)),
    ("bounds", |filter| filter.bounds.set(Channel::DAMPING_RATIO, Between { least: Some(0.0), most: None })),
    ("plucks", |filter| filter.plucks = vec![0.2]),
    ("logarithms", |filter| filter.log_parameters = true),
    ("learnt R", |filter| filter.adaptation.sensor_noise = true),
    ("learnt Q", |filter| filter.adaptation.process_noise = true),
    ("delays", |filter| (filter.sensor_delay, filter.input_delay) = (vec![0.013, 0.0], 2)),
    ("bias", |filter| filter.augment.push(Quantity::VELOCITY.bias())),
    ("white force", |filter| filter.augment.push(Channel::WHITE_FORCE)),
    ("forgotten offset", |filter| {
        filter.augment.push(Channel::INPUT_OFFSET);
        filter.correlation_time[Channel::INPUT_OFFSET] = 1.0;
    }),
    ("fading and decay", |filter| (filter.fading, filter.eta) = (1.02, 0.01)),
];

#[test]
fn every_pair_of_options_works_or_is_refused_by_the_table() {
    let mut refused = 0;
    for kind in FilterKind::ALL {
        for (place, (one, set_one)) in SETTINGS.iter().enumerate() {
            for (other, set_other) in &SETTINGS[place + 1..] {
                let name = format!("{} with {one} and {other}", kind.name());
                let mut scenario = Scenario { duration: 0.5, ..Scenario::default() };
                scenario.filters.truncate(1);
                let filter = &mut scenario.filters[0];
                (filter.kind, filter.ensemble_size) = (kind, 50);
                set_one(filter);
                set_other(filter);
                // A KF knows its frequency and its damping: it has no guesses, bounds or uncertainty of them.
                let has_own = [&GUESSED, &CONSIDERED, &BOUNDED].iter().any(|option| (option.is_on)(filter));
                if kind == FilterKind::KF && has_own {
                    continue;
                }
                let excluded = EXCLUSIONS.iter().find(|(first, others, _)| {
                    (first.is_on)(filter) && others.iter().any(|other| (other.is_on)(filter))
                });
                if let Some((first, _, reason)) = excluded {
                    let error = scenario.validate().expect_err(&name).to_string();
                    assert!(error.ends_with(&format!("a filter that {}: {reason}", first.words)), "{name}: {error}");
                    Change::default().apply(&mut scenario).expect("it turns off what is excluded");
                    refused += 1;
                }
                let mut run = Run::new(&scenario).expect(&name);
                run.finish();
                let estimates = &run.estimates()[0];
                assert_eq!((estimates.stop(), estimates.len()), (None, scenario.samples()), "{name}");
            }
        }
    }
    assert!(refused > 200, "{refused}");
}
