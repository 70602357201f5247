//! Numbers of a story that can be dragged.

use kalmanscope_core::signal::Step;
use kalmanscope_core::{Channel, Scenario, Signal};
use kalmanscope_diagnosis::{Adjustable, Phrase, Story};

use crate::run::finished;

fn change(from: f64, to: f64) -> Adjustable {
    let mut scenario = Scenario { duration: 2.0, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(Step { from, to, at: 1.0 }));
    let story = Story::of(&finished(&scenario), &[], &[]);
    let mut settings = story.sentences.iter().flatten().filter_map(Phrase::setting);
    settings.find(|one| one.address == "plant.natural_frequency.step.to").unwrap().clone()
}

#[test]
fn a_share_of_the_stiffness_is_a_natural_frequency() {
    let loss = change(6.0, 4.8);
    assert_eq!((loss.to_string().as_str(), loss.value(loss.shown)), ("36 %", 4.8));
    assert!((loss.value(75.0) - 3.0).abs() < 1e-12 && loss.value(100.0) == 0.0);
    let gain = change(4.0, 6.0);
    assert_eq!((gain.to_string().as_str(), gain.value(gain.shown)), ("125 %", 6.0));
    assert_eq!(loss.showing(50.0).to_string(), "50 %");
    assert!((loss.at(3.0).shown - 75.0).abs() < 1e-12 && (gain.at(4.0).shown).abs() < 1e-12);
}
