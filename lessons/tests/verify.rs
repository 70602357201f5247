use kalmanscope_diagnosis::Value;
use kalmanscope_lessons::{Claim, Lesson, verify, verify_all};

fn lesson(checks: &str) -> Lesson {
    let text = "title = \"T\"\ncourse = \"Practice\"\nsummary = \"s\"\nscenario = { duration = 2.0 }\n\
                [[steps]]\nlook = \"l\"\nhappens = \"h\"\nwhy = \"w\"\n\
                change = { label = \"x\", set = { \"filters.*.fading\" = 1.0 } }\n";
    Lesson::from_toml(&format!("{text}checks = [{checks}]")).unwrap()
}

#[test]
fn a_failed_claim_reports_measure_values_and_seeds() {
    let lesson = lesson("{ filter = \"EKF\", measure = \"evaluations\", above = 5.5, share = 0.9 }");
    let claim = verify(&lesson, 3..=4).unwrap().remove(0);
    assert!(!claim.holds());
    let expected = "FAILS   0.0 % (90 %)  T, step 1: evaluations of EKF, above 5.5: 5.000 | 5.000 | 5.000 | 5.000 | \
                    5.000 | 5.000 | 5.000; fails with seed 3: 5.000; fails with seed 4: 5.000";
    assert_eq!(claim.to_string(), expected);
}

#[test]
fn a_claim_is_judged_by_the_share_that_it_states() {
    let check = |share: f64| format!("{{ filter = \"EKF\", measure = \"nis\", above = 0.0, share = {share} }}");
    let holds = |share: f64, failures: u64, tries: u64| {
        let mut claim = verify(&lesson(&check(share)), []).unwrap().remove(0);
        claim.values = (0..tries).map(|n| (n, Value::Number(if n < failures { -1.0 } else { 1.0 }))).collect();
        claim.holds()
    };
    assert!(holds(0.98, 7, 200) && !holds(0.98, 8, 200));
    assert!(holds(0.98, 1, 10) && !holds(0.98, 2, 10));
    assert!(holds(0.5, 114, 200) && !holds(0.5, 115, 200));
    assert!(holds(1.0, 0, 200) && !holds(1.0, 1, 200));
    assert!(holds(0.98, 0, 0), "not tried");
}

#[test]
fn a_check_may_be_about_one_seed() {
    let claims =
        verify(&lesson("{ filter = \"EKF\", measure = \"evaluations\", above = 1.0, seed = 2 }"), 1..=3).unwrap();
    assert_eq!(claims[0].values, [(2, Value::Number(5.0))]);
}

#[test]
fn a_check_over_cells_is_about_their_share() {
    let grid = "x = \"filters.EKF.initial_std.natural_frequency=1:4:4\", y = \"filters.*.fading=1.0:1.1:2\"";
    let check = |limits: &str, share: &str| {
        format!(
            "{{ filter = \"EKF\", measure = \"std\", channel = \"natural_frequency\", at = 0.0, \
             cells = {{ {grid}, {limits} }}, {share} }}"
        )
    };
    let lesson =
        lesson(&[check("below = 2.5", "above = 0.49, below = 0.51"), check("above = 0.5", "above = 0.99")].join(","));
    let claims = verify(&lesson, 1..=2).unwrap();
    let shares: Vec<&Vec<(u64, Value)>> = claims.iter().map(|claim| &claim.values).collect();
    let of = |share: f64| vec![(1, Value::Number(share)), (2, Value::Number(share))];
    assert_eq!(shares, [&of(0.5), &of(1.0)]);
    assert!(claims.iter().all(Claim::holds));
    let words = claims[0].to_string();
    assert!(words.contains("below 2.5; share of the cells of filters.EKF") && words.contains("above 0.49"), "{words}");
}

#[test]
fn threads_do_not_change_the_claims() {
    let lessons = [lesson("{ filter = \"EKF\", measure = \"nis\", above = 0.0 }")];
    assert_eq!(verify_all(&lessons, &[5, 2, 9]).unwrap(), verify(&lessons[0], [2, 5, 9]).unwrap());
}
