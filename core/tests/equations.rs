//! Equations that a user types are plants like any other.

use kalmanscope_core::equation::EquationSettings;
use kalmanscope_core::{Channel, PlantKind, Scenario, document};

use crate::numbers::Random;
use crate::run::finished;

fn plant(text: &str) -> PlantKind {
    PlantKind::of_equation(&EquationSettings::new(text)).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    let found = PlantKind::of_equation(&EquationSettings::new(text));
    found.expect_err("it is refused").to_string()
}

/// Parameters are in the order of the built-in state.
const TYPED: [(PlantKind, &str, &[&str]); 5] = [
    (PlantKind::SDOF, "ẍ + 2ζωₙẋ + ωₙ²x = f", &["natural_frequency", "damping_ratio"]),
    (PlantKind::DUFFING, "x'' + 2 zeta wn x' + wn^2 x + μ x³ = f", &["natural_frequency", "damping_ratio", "mu"]),
    (
        PlantKind::BOUC_WEN,
        "x'' + 2 ζ ωₙ x' + α ωₙ² x + (1 - α) ωₙ² z = f; z' = x' - β abs(x') abs(z) z - γ x' z²",
        &["z", "natural_frequency", "damping_ratio", "alpha", "beta", "gamma"],
    ),
    (
        PlantKind::BOUC_WEN_1,
        "x'' + 2 ζ ωₙ x' + α ωₙ² x + (1 - α) ωₙ² z = f; z' = x' - β abs(x') z - γ x' abs(z)",
        &["z", "natural_frequency", "damping_ratio", "alpha", "beta", "gamma"],
    ),
    (
        PlantKind::SHEAR_2,
        "x1'' + κ₁ x1 + c x1' - κ₂ (x2 - x1) - c (x2' - x1') = f; x2'' + κ₂ (x2 - x1) + c (x2' - x1') = f",
        &["kappa1", "kappa2", "c"],
    ),
];

#[test]
fn rates_and_derivatives_of_built_in_plants_are_the_same_when_typed() {
    for (built_in, text, names) in TYPED {
        let typed = plant(text);
        assert_eq!((typed.motion(), typed.masses()), (built_in.motion(), built_in.masses()), "{text}");
        assert_eq!(typed.info().is_linear, built_in.info().is_linear, "{text}");
        let (n, motion) = (built_in.channels().len(), built_in.motion());
        // The places of the built-in components in the typed state.
        let masses = 2 * built_in.masses();
        let places: Vec<usize> = (0..masses)
            .chain(names.iter().map(|name| typed.channels().iter().position(|channel| channel.key() == *name).unwrap()))
            .collect();
        let mut numbers = Random::new(7);
        let mut random = || 4.0 * numbers.uniform() - 2.0;
        for _ in 0..200 {
            let state: Vec<f64> = (0..n).map(|_| random()).collect();
            let mut own = vec![0.0; n];
            places.iter().enumerate().for_each(|(i, &place)| own[place] = state[i]);
            let force = random();
            let (mut expected, mut rate) = (vec![0.0; motion], vec![0.0; motion]);
            built_in.motion_rate(&state, force, &mut expected);
            typed.motion_rate(&own, force, &mut rate);
            let (mut a, mut b) = (vec![0.0; motion * n], vec![0.0; motion * n]);
            built_in.motion_jacobian(&state, &mut a);
            typed.motion_jacobian(&own, &mut b);
            for i in 0..motion {
                let close = |x: f64, y: f64| (x - y).abs() <= 1e-12 * (1.0 + x.abs());
                assert!(close(expected[i], rate[places[i]]), "{text}: rate {i}: {expected:?} {rate:?}");
                for j in 0..n {
                    let typed = b[places[i] * n + places[j]];
                    assert!(close(a[i * n + j], typed), "{text}: ∂{i}/∂{j}: {} {typed}", a[i * n + j]);
                }
            }
        }
    }
}

#[test]
fn a_scenario_with_an_equation_can_be_written_and_read() {
    let text = "filters = [{ kind = \"ekf\", initial_mean = { c = 0.3 }, plant = { equation = \"x'' + c x' + k x = f\" } }]\n\
                [plant]\nc = 0.2\nk = 30.0\nfriction = 0.1\nparameters = { friction = { unit = \"m/s²\", guess = 0.05, sign = \
                \"not_negative\", range = [0.0, 1.0] } }\nequation = \"x'' + c x' + k x + friction tanh(x'/0.01) = f\"\n";
    let scenario = Scenario::from_toml(text).unwrap();
    let friction = scenario.plant.kind.channels()[4];
    assert_eq!((friction.key(), friction.unit(), friction.usual().mean), ("friction", "m/s²", 0.05));
    assert!(friction.is_positive());
    // Its key means it in this scenario, and nothing elsewhere.
    assert_eq!((scenario.channel("friction"), Channel::from_key("friction")), (Some(friction), None));
    assert_eq!(Scenario::from_toml(&scenario.to_toml().unwrap()).unwrap(), scenario);
    let json = document::to_json(&scenario).unwrap();
    assert_eq!(document::read_json::<Scenario>(&json).unwrap(), scenario);
    let alone = Scenario::from_toml("[plant]\nparameters = { c = { guess = 2.0 } }").unwrap_err().to_string();
    assert!(alone.contains("`parameters` belong to an `equation`, which is missing"), "{alone}");
    // The one whose parameter has other numbers is another plant.
    let other = Scenario::from_toml(&text.replace("0.05", "0.06")).unwrap();
    assert_ne!(other.plant.kind, scenario.plant.kind);
}

#[test]
fn equations_that_give_one_name_other_numbers_do_not_disturb_each_other() {
    let text = |guess: f64| {
        format!(
            "duration = 2.0\n[plant]\nequation = \"x'' + c x' + k x = f\"\nparameters = {{ k = {{ guess = {guess:?}, unit = \"1/s²\" }} }}\n\
             [[filters]]\nkind = \"ekf\"\ncorrelation_time = {{ input_offset = 1.0 }}\naugment = [\"input_offset\"]\n"
        )
    };
    let outcome = |scenario: &Scenario| {
        let (k, run) = (scenario.channel("k").unwrap(), finished(scenario));
        (k.usual().mean, scenario.filters[0].initial_mean[k], run.checksum(), scenario.to_toml().unwrap())
    };
    let read = |guess: f64| Scenario::from_toml(&text(guess)).unwrap();
    let (one, fifty) = (read(1.0), read(50.0));
    let expected = [outcome(&one), outcome(&fifty)];
    assert_eq!([(expected[0].0, expected[0].1), (expected[1].0, expected[1].1)], [(1.0, 1.0), (50.0, 50.0)]);
    assert_ne!(expected[0].2, expected[1].2);
    let (fifty, one) = (read(50.0), read(1.0));
    assert_eq!([outcome(&one), outcome(&fifty)], expected);
    for (text, scenario) in [(&expected[0].3, &one), (&expected[1].3, &fifty)] {
        assert_eq!(Scenario::from_toml(text).unwrap(), *scenario);
    }
    assert_eq!(Channel::from_key("k"), None);
}

#[test]
fn numbers_of_an_earlier_equation_are_not_written() {
    let mut scenario = Scenario::from_toml("[plant]\nk = 30.0\nequation = \"x'' + k x = f\"\n").unwrap();
    let k = scenario.channel("k").unwrap();
    scenario.filters[0].initial_mean[k] = 7.0;
    scenario.set_plant(PlantKind::SDOF);
    let (text, json) = (scenario.to_toml().unwrap(), document::to_json(&scenario).unwrap());
    assert!(scenario.channel("k").is_none() && !text.contains("\nk =") && !json.contains("\"k\""), "{text}\n{json}");
    let again = [Scenario::from_toml(&text).unwrap(), document::read_json(&json).unwrap()];
    assert!(again.iter().all(|again| again.plant.kind == PlantKind::SDOF));
}

#[test]
fn products_with_a_mass_are_solved_for_the_acceleration() {
    let kind = plant("m x'' + c x' + k x = m f");
    let keys: Vec<&str> = kind.channels().iter().map(|channel| channel.key()).collect();
    assert_eq!(keys, ["displacement", "velocity", "m", "c", "k"]);
    let mut rate = [0.0; 2];
    kind.motion_rate(&[0.5, -1.0, 2.0, 3.0, 8.0], 0.25, &mut rate);
    assert_eq!(rate, [-1.0, 0.25 - (-3.0 + 8.0 * 0.5) / 2.0]);
}

#[test]
fn derivatives_of_all_functions_are_their_differences() {
    let text = "x'' + c sin(x) + cos(2 x') tan(x/3) + exp(-x²) + log(4 + x) + sqrt(4 + x') + abs(x) + sign(x') + tanh(x/0.3) + (4 + \
                x)^1.5 + (4 + x)^-2 + x^3 / (1 + x'²) = f";
    let kind = plant(text);
    let rate = |state: &[f64]| {
        let mut rate = [0.0; 2];
        kind.motion_rate(state, 0.0, &mut rate);
        rate[1]
    };
    for state in [[0.4, -0.7, 1.3], [-1.1, 0.2, 0.5], [2.3, 1.9, -0.8]] {
        let mut jacobian = [0.0; 6];
        kind.motion_jacobian(&state, &mut jacobian);
        for j in 0..3 {
            let at = |by: f64| {
                let mut moved = state;
                moved[j] += by;
                rate(&moved)
            };
            let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
            let found = jacobian[3 + j];
            assert!((found - difference).abs() < 1e-7 * (1.0 + difference.abs()), "{j}: {found} {difference}");
        }
    }
    assert_eq!(&plant("x'' + x = f").own_equation().unwrap().operations(), &[1, 2]);
}

#[test]
fn no_text_is_too_much() {
    let pieces = "x|x''|x'|x1''|z'|z|ζ|ωₙ|f|(|)|+|-|*|/|^|²|=|;|2|0|1e308|.5|sin|abs(|log(| |\
                  ẍ|𝛼|'|\"|_|π|e|x2''|c1|¹⁰⁰⁰|\u{308}";
    let pieces: Vec<&str> = pieces.split('|').collect();
    let mut numbers = Random::new(99);
    let mut random = |below: usize| (numbers.uniform() * below as f64) as usize;
    let mut plants = 0;
    for _ in 0..20_000 {
        let mut text: String = (0..random(14)).map(|_| pieces[random(pieces.len())]).collect();
        if random(2) == 0 {
            text = format!("x'' + {text} = f");
        }
        match PlantKind::of_equation(&EquationSettings::new(text.clone())) {
            Ok(kind) => {
                plants += 1;
                let (n, motion) = (kind.channels().len(), kind.motion());
                kind.motion_rate(&vec![0.3; n], 1.0, &mut vec![0.0; motion]);
                kind.motion_jacobian(&vec![0.3; n], &mut vec![0.0; motion * n]);
            }
            Err(error) => assert!(!error.what.is_empty() && error.to_string().chars().count() < 400, "{text}: {error}"),
        }
    }
    assert!(plants > 100, "{plants}");
    // Powers of powers, and sums of many parts.
    let tower = format!("x'' + {}x{} = f", "(".repeat(38), "+c)^7".repeat(38));
    assert!(refused(&tower).contains("too long") || plant(&tower).channels().len() == 3);
    let wide = format!("x'' {} = f", "+ sin(x c)".repeat(90));
    assert_eq!(plant(&wide).channels().len(), 3);
    let many = format!("x'' {} = f", (0..60).map(|i| format!("+ c{i} x")).collect::<String>());
    assert!(refused(&many).contains("at most 32 components"));
}

#[test]
fn a_file_that_does_not_name_its_parameters_is_told_what_they_are_taken_for() {
    let remarks = |text: &str| Scenario::from_toml_with_remarks(text).unwrap().1;
    let alone =
        "filters = [{ kind = \"ekf\", initial_mean = { k = 30.0 } }]\n[plant]\nequation = \"x'' + c x' + k x = f\"\n";
    let said = "of the equation, c (guess 1) and k (guess 30) are taken for parameters: `parameters` can say name, unit, guess and range";
    assert_eq!(remarks(alone), [said]);
    let one = format!("{alone}c = 0.2\n");
    assert!(remarks(&one)[0].starts_with("of the equation, k (guess 30) is taken for a parameter:"));
    assert!(remarks(&format!("{one}parameters = {{ k = {{}} }}\n")).is_empty());
    let usual = remarks("[plant]\nequation = \"x'' + 2 ζ ωₙ x' + ωₙ² x = f\"\n");
    assert!(usual.is_empty(), "they are those of all plants");
    // The written text names all of them.
    let again = Scenario::from_toml(alone).unwrap().to_toml().unwrap();
    assert!(remarks(&again).is_empty(), "{again}");
}

#[test]
fn filters_begin_with_the_guess_that_an_equation_gets() {
    let mut scenario = Scenario::from_toml("[plant]\nequation = \"x'' + c x' + k x = f\"\n").unwrap();
    let mut settings = scenario.plant.kind.own_equation().unwrap().settings().clone();
    let of = |scenario: &Scenario, key: &str| {
        let channel = scenario.plant.kind.channels().iter().copied().find(|channel| channel.key() == key).unwrap();
        let filter = &scenario.filters[0];
        (filter.initial_mean[channel], filter.initial_std[channel])
    };
    let c = scenario.plant.kind.parameters().next().unwrap();
    scenario.filters[0].initial_mean[c] = 0.7;
    (settings.parameter_mut("k").guess, settings.parameter_mut("k").std) = (Some(36.0), Some(4.0));
    scenario.set_plant(PlantKind::of_equation(&settings).unwrap());
    assert_eq!((of(&scenario, "k"), of(&scenario, "c")), ((36.0, 4.0), (0.7, 0.5)));
    settings.parameter_mut("k").range = Some([2.0, 1.0]);
    let error = PlantKind::of_equation(&settings).unwrap_err().to_string();
    assert!(error.starts_with("the numbers of `k` are impossible"), "{error}");
}

#[test]
fn symbols_are_internal_states_parameters_and_those_of_all_plants() {
    let settings = EquationSettings::new("x'' + 2 ζ ωₙ x' + μ z = f; z' = x' - z");
    let symbols = settings.symbols().unwrap();
    let told: Vec<_> = symbols.iter().map(|one| (one.key.as_str(), one.is_parameter, one.known.is_some())).collect();
    assert_eq!(told, [("z", false, false), ("omega_n", true, true), ("zeta", true, true), ("mu", true, false)]);
    assert_eq!(symbols[3].shown, "μ");
}
