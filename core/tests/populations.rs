//! Populations, and the ids and names of filters.

use kalmanscope_core::scenario::{Law, shown};
use kalmanscope_core::{Channel, FilterSettings, Scenario, ScenarioError};

fn population(draw: &str) -> Result<Scenario, ScenarioError> {
    Scenario::from_toml(&format!("[[filters]]\nkind = \"ekf\"\n[[filters]]\nkind = \"ukf\"\n[draw]\n{draw}"))
}

#[test]
fn each_seed_has_a_member_of_its_own() {
    let one = "\"plant.natural_frequency\" = { lognormal = [6.0, 0.2] }\n";
    let two = format!("{one}\"filters.1.initial_mean.natural_frequency\" = {{ normal = [8.0, 2.0] }}\n");
    let (one, two) = (population(one).unwrap(), population(&two).unwrap());
    let keys: Vec<&str> = two.draw.keys().map(String::as_str).collect();
    assert_eq!(keys, ["filters#1.initial_mean.natural_frequency", "plant.natural_frequency"]);
    let mut numbered = two.clone();
    numbered.number_filters();
    let member = numbered.member(7);
    assert_eq!((member.seed, member.draw.len()), (7, 0));
    assert_eq!(member, numbered.member(7));
    assert_ne!(member.plant, numbered.member(8).plant);
    assert_eq!(member.plant, one.member(7).plant);
    let guess = |scenario: &Scenario, place: usize| scenario.filters[place].initial_mean[Channel::NATURAL_FREQUENCY];
    assert_ne!(guess(&member, 0), guess(&numbered, 0));
    assert_eq!(guess(&member, 1), guess(&numbered, 1));
    assert_eq!(Scenario::from_toml(&two.to_toml().unwrap()).unwrap(), two);
}

#[test]
fn numbers_have_their_laws() {
    for (law, is_log, mean, std) in [
        ("normal = [0.05, 0.01]", false, 0.05, 0.01),
        ("lognormal = [0.05, 0.2]", true, 0.05_f64.ln(), 0.2),
        ("uniform = [0.02, 0.08]", false, 0.05, 0.06 / 12.0_f64.sqrt()),
        ("log_uniform = [0.02, 0.08]", true, 0.04_f64.ln(), 4.0_f64.ln() / 12.0_f64.sqrt()),
    ] {
        let scale = |value: f64| if is_log { value.ln() } else { value };
        let scenario = population(&format!("\"plant.damping_ratio\" = {{ {law} }}")).unwrap();
        let n = 4000;
        let values: Vec<f64> = (0..n).map(|seed| scale(scenario.drawn(seed)[0].1)).collect();
        let of = values.iter().sum::<f64>() / n as f64;
        let spread = (values.iter().map(|value| (value - of).powi(2)).sum::<f64>() / n as f64).sqrt();
        assert!((of - mean).abs() < 4.0 * std / (n as f64).sqrt(), "{law}: {of}");
        assert!((spread / std - 1.0).abs() < 0.06, "{law}: {spread}");
        for value in scenario.drawn(3) {
            assert_eq!(format!("{:.8e}", value.1).parse::<f64>().unwrap(), value.1);
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let told = |draw: &str| population(draw).unwrap_err().to_string();
    assert!(told("\"plant.mass\" = { normal = [1.0, 0.1] }").contains("no number `plant.mass`"));
    assert!(told("\"filters.KF.fading\" = { normal = [1.0, 0.1] }").contains("its filters are `EKF` and `UKF`"));
    assert!(told("\"dt\" = { uniform = [0.1, 0.2] }").contains("the same for all members"));
    assert!(told("\"plant.damping_ratio\" = { normal = [0.1, -1.0] }").contains("standard deviation of at least 0"));
    assert!(told("\"plant.damping_ratio\" = { lognormal = [0.0, 1.0] }").contains("a median above 0"));
    assert!(told("\"plant.damping_ratio\" = { uniform = [0.2, 0.1] }").contains("the larger one"));
    assert!(told("\"plant.damping_ratio\" = { gamma = [0.2, 0.1] }").contains("gamma"));
}

#[test]
fn a_draw_goes_with_its_filter() {
    let mut scenario = population("\"filters.UKF.fading\" = { uniform = [1.0, 1.01] }").unwrap();
    scenario.number_filters();
    scenario.filters[1].name = "other".to_owned();
    scenario.keep_draws();
    assert_eq!(scenario.drawn(1).len(), 1);
    scenario.filters.pop();
    scenario.keep_draws();
    assert!(scenario.draw.is_empty());
}

#[test]
fn offered_laws_are_possible() {
    for value in [-3.0, 0.0, 1e-5, 6.0] {
        assert!(Law::about(value, 0.2).iter().all(|law| law.problem().is_none()), "{value}");
    }
}

fn numbered(ids: &[u32]) -> Vec<u32> {
    let filters = ids.iter().map(|&id| FilterSettings { id, ..FilterSettings::default() }).collect();
    let mut scenario = Scenario { filters, ..Scenario::default() };
    scenario.number_filters();
    scenario.filters.iter().map(|filter| filter.id).collect()
}

#[test]
fn every_filter_has_an_id_of_its_own() {
    assert_eq!(numbered(&[0, 0, 0]), [1, 2, 3]);
    assert_eq!(numbered(&[7, 2, 5]), [7, 2, 5]);
    assert_eq!(numbered(&[2, 0, 2, 0]), [2, 1, 3, 4]);
    assert!(numbered(&[]).is_empty());
    assert_eq!(Scenario::default().free_filter_id(), 3);
}

fn named(filters: &[&str]) -> (Vec<String>, Vec<String>) {
    let mut text = String::new();
    for filter in filters {
        let (kind, name) = filter.split_once('=').unwrap_or((filter, ""));
        text.push_str(&format!("[[filters]]\nkind = \"{kind}\"\nname = \"{name}\"\n"));
    }
    let (scenario, remarks) = Scenario::from_toml_with_remarks(&text).unwrap();
    scenario.validate().unwrap();
    assert_eq!(Scenario::from_toml(&scenario.to_toml().unwrap()).unwrap(), scenario);
    (scenario.filters.into_iter().map(|filter| filter.name).collect(), remarks)
}

#[test]
fn every_filter_has_a_name_of_its_own() {
    for (filters, expected, remarks) in [
        (&["ekf", "ekf", "ukf", "ekf"][..], &["EKF", "EKF 2", "UKF", "EKF 3"][..], 0),
        (&["ekf", "ukf=EKF"], &["EKF 2", "EKF"], 0),
        (&["ekf=a", "ukf=a", "pf=a 2"], &["a", "a 3", "a 2"], 1),
        (&["ekf=*", "ekf=EKF, smoothed", "ekf"], &["* 2", "EKF, smoothed", "EKF 2"], 1),
        (&["ekf=a", "ekf=a, smoothed"], &["a", "a, smoothed 2"], 1),
    ] {
        let (names, sentences) = named(filters);
        assert_eq!(names, expected, "{filters:?}");
        assert_eq!(sentences.len(), remarks, "{sentences:?}");
    }
    let (_, sentences) = named(&["ekf=a", "ukf=a"]);
    assert_eq!(sentences, ["filter 2 is called `a 2` in place of `a`: an earlier filter has this name"]);
}

#[test]
fn names_that_steer_a_terminal_are_refused_with_their_place() {
    for (letter, code) in [("\\u001B", "U+001B"), ("\\u202E", "U+202E"), ("\\n", "U+000A"), ("\\u2066", "U+2066")] {
        let error = Scenario::from_toml(&format!("[[filters]]\nname = \"a{letter}b\"")).unwrap_err().to_string();
        assert!(error.contains("filters[0].name") && error.contains(code), "{error}");
    }
    let scenario = Scenario::from_toml("[[filters]]\nname = \"ωₙ – \u{5d0}, größer\"").unwrap();
    assert_eq!(scenario.filters[0].name, "ωₙ – \u{5d0}, größer");
}

#[test]
fn shown_text_keeps_its_lines() {
    assert_eq!(shown("a\u{1b}]0;b\n\u{202e}c\td"), "a ]0;b\n c d");
}
