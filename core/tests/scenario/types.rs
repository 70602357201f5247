//! Unknown keys, and values of the wrong type.

use kalmanscope_core::{FilterKind, Scenario};

use super::assert_refused;

#[test]
fn an_unknown_key_is_refused_with_line_path_and_the_keys_that_exist() {
    assert_refused(&[
        (
            "\nsed = 1",
            "line 2: `sed`: unknown field `sed`, expected one of `seed`, `dt`, `duration`, `plant`, `force`, `input`, `hold`, \
             `sensors`, `filters`, `record`, `draw`",
        ),
        (
            "[plant]\nmass = 1",
            "line 2: `plant.mass`: unknown field `mass`, expected `kind`, `equation`, `parameters`, `initial`, `disturbance_std`, `input_delay` \
             or one of `natural_frequency`, `damping_ratio`, `cubic_stiffness`, `post_yield_ratio`, `hysteresis_beta`, \
             `hysteresis_gamma`, `yield_beta`, `yield_gamma`, `stiffness_1`, `storey_damping`, `input_gain`, `input_offset`, `unknown_force`, \
             `white_force`, `bias_displacement`, `bias_velocity`, `bias_acceleration`, `bias_total_acceleration`, `bias_drift`, …",
        ),
        (
            "[plant]\ninitial = { x = 1 }",
            "line 2: `plant.initial.x`: unknown field `x`, expected `displacement` or `velocity`",
        ),
        (
            "[plant]\nnatural_frequency = { jump = 1 }",
            "line 2: `plant.natural_frequency.jump`: unknown field `jump`, expected one of `step`, `ramp`, `sine`",
        ),
        (
            "[plant.damping_ratio.step]\nfrom = 1\nto = 2\nat = 3\nend = 4",
            "line 5: `plant.damping_ratio.step.end`: unknown field `end`, expected one of `from`, `to`, `at`",
        ),
        (
            "[force]\nnoise = 1",
            "line 1: `force`: unknown variant `noise`, expected one of `none`, `white_noise`, `sine`, `chirp`, \
             `impulse_train`, `step`",
        ),
        (
            "[force]\nwhite_noise = { std = 1, mean = 2 }",
            "line 2: `force.white_noise.mean`: unknown field `mean`, expected `std`",
        ),
        (
            "[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 1\nbias = 2",
            "line 4: `sensors[0].bias`: unknown field `bias`, expected one of `measures`, `noise_std`, `faults`",
        ),
        (
            "[[filters]]\ninitial_std = { mass = 1 }",
            "line 2: `filters[0].initial_std.mass`: unknown field `mass`, expected one of `displacement`, `velocity`, …",
        ),
    ]);
    // `docs.rs` holds all keys to their table.
    let error = Scenario::from_toml("[[filters]]\n[[filters]]\nlambda = 1").unwrap_err().to_string();
    assert!(
        error.starts_with("line 3: `filters[1].lambda`: unknown field `lambda`, expected one of `id`, "),
        "{error}"
    );
}

#[test]
fn a_value_of_the_wrong_type_is_refused_with_line_path_and_the_expected_type() {
    let signal = "expected a number, or a table with exactly one of `step`, `ramp`, `sine`";
    let refused = |text: &str, message: String| assert_refused(&[(text, &message)]);
    for (value, found) in [
        ("\"low\"", "invalid type: string \"low\""),
        ("{}", "invalid value: map"),
        (
            "{ sine = { mean = 6, amplitude = 1, period = 9 }, step = { from = 6, to = 5, at = 3 } }",
            "invalid value: map",
        ),
    ] {
        refused(
            &format!("[plant]\ndamping_ratio = {value}"),
            format!("line 2: `plant.damping_ratio`: {found}, {signal}"),
        );
    }
    let quantities = "`displacement`, `velocity`, `acceleration`, `total_acceleration`, `drift`, and of other masses as in \
                      `displacement_2`";
    refused(
        "[[sensors]]\nmeasures = \"jerk\"\nnoise_std = 1",
        format!("line 2: `sensors[0].measures`: unknown variant `jerk`, expected one of {quantities}"),
    );
    let kinds = FilterKind::ALL.map(|kind| format!("`{}`", kind.key())).join(", ");
    refused(
        "[[filters]]\nkind = \"lqr\"",
        format!("line 2: `filters[0].kind`: unknown variant `lqr`, expected one of {kinds}"),
    );
    assert_refused(&[
        ("seed = 1.5", "line 1: `seed`: invalid type: floating point `1.5`, expected u64"),
        ("seed = -1", "line 1: `seed`: invalid value: integer `-1`, expected u64"),
        ("seed = 1\n\ndt = \"fast\"", "line 3: `dt`: invalid type: string \"fast\", expected f64"),
        ("plant = 3", "line 1: `plant`: invalid type: integer `3`, expected a table"),
        (
            "[plant]\nkind = \"mdof\"",
            "line 2: `plant.kind`: unknown variant `mdof`, expected one of `sdof`, `duffing`, `bouc_wen`, `bouc_wen_1`, `shear_2`, \
             `shear_3`, `shear_4`, `shear_5`, `shear_6`, `shear_7`, `shear_8`, `shear_9`, `shear_10`",
        ),
        (
            "[plant]\nkind = 3",
            "line 2: `plant.kind`: invalid type: integer `3`, expected the key of a plant, or a table with an equation",
        ),
        (
            "[plant]\ninitial = { velocity = true }",
            "line 2: `plant.initial.velocity`: invalid type: boolean `true`, expected f64",
        ),
        (
            "[plant]\nnatural_frequency = { step = { from = 1, to = [], at = 2 } }",
            "line 2: `plant.natural_frequency.step.to`: invalid type: sequence, expected f64",
        ),
        (
            "[plant]\nnatural_frequency = { step = 1 }",
            "line 2: `plant.natural_frequency.step`: invalid type: integer `1`, expected a table",
        ),
        (
            "[plant]\nnatural_frequency = { step = { from = 1, to = 2 } }",
            "line 2: `plant.natural_frequency.step`: missing field `at`",
        ),
        ("force = 3", "line 1: `force`: invalid type: integer `3`, expected a word, or a table with exactly one key"),
        ("force = {}", "line 1: `force`: invalid value: map, expected a table with exactly one key"),
        ("[force]\nsine = { amplitude = 1.0 }", "line 2: `force.sine`: missing field `frequency`"),
        (
            "[force]\nsine = { amplitude = \"a\", frequency = 1 }",
            "line 2: `force.sine.amplitude`: invalid type: string \"a\", expected f64",
        ),
        (
            "force = \"noise\"",
            "line 1: `force`: unknown variant `noise`, expected one of `none`, `white_noise`, `sine`, `chirp`, \
             `impulse_train`, `step`",
        ),
        ("sensors = 3", "line 1: `sensors`: invalid type: integer `3`, expected a sequence"),
        ("[[sensors]]\nmeasures = \"velocity\"", "line 1: `sensors[0]`: missing field `noise_std`"),
        ("[[filters]]\nname = 3", "line 2: `filters[0].name`: invalid type: integer `3`, expected a string"),
        (
            "[[filters]]\nsensor_std = 1",
            "line 2: `filters[0].sensor_std`: invalid type: integer `1`, expected a sequence",
        ),
        (
            "[[filters]]\n[[filters]]\nsensor_std = [\n1,\n\"a\"]",
            "line 5: `filters[1].sensor_std[1]`: invalid type: string \"a\", expected f64",
        ),
        (
            "[[filters]]\nprocess_std = { velocity = \"a\" }",
            "line 2: `filters[0].process_std.velocity`: invalid type: string \"a\", expected f64",
        ),
        (
            "[[filters]]\nprocess_std = 3",
            "line 2: `filters[0].process_std`: invalid type: integer `3`, expected a table",
        ),
    ]);
}
