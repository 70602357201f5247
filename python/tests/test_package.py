"""The package against the command line, an EKF in NumPy, and its users' mistakes."""

import inspect
import json
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import kalmanscope as ks
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
CLI = Path(os.environ.get("KALMANSCOPE_CLI", ROOT / "target/debug/kalmanscope-cli"))


@pytest.mark.parametrize("name", ["forgetting", "duffing", "earthquake"])
def test_numbers_have_the_bits_of_the_command_line(name, tmp_path):
    scenario = ROOT / f"assets/scenarios/{name}.toml"
    out = tmp_path / "results.json"
    subprocess.run([CLI, "run", scenario, "--record-out", tmp_path / "record.csv", "--out", out, "--quiet"], check=False)
    expected = json.loads(out.read_text())
    record = None
    if expected["scenario"].get("record"):
        record = ks.Record(tmp_path / "record.csv", hold=expected["record"]["hold"])
    results = ks.run(ks.Scenario(scenario), record)
    for one in expected["filters"]:
        if one["smoothed"]:
            continue
        estimates, series = results[one["name"]], one["series"]
        assert estimates.verdict == (one["verdict"] and one["verdict"]["kind"].replace("_", " "))
        for place, channel in enumerate(estimates.channels):
            np.testing.assert_array_equal(estimates[channel], np.array(series["mean"][channel], float))
            np.testing.assert_array_equal(estimates.std[:, place], np.array(series["std"][channel], float))
        np.testing.assert_array_equal(estimates.nis, np.array(series["nis"], float))
        assert estimates.diagnosis["causes"] == one["causes"]


@pytest.mark.parametrize("kind", ["ekf", "ukf", "enkf"])
def test_samples_that_come_one_by_one_have_the_bits_of_a_run(kind):
    scenario = ks.Scenario(duration=3.0, filters=[{"kind": kind, "ensemble_size": 50}])
    results = ks.run(scenario)
    record, (whole,) = results.record, results.values()
    online = ks.Online(scenario)
    for k in range(len(record)):
        mean = online.step(record.input[k], velocity=record["velocity"][k], displacement=record["displacement"][k])
        np.testing.assert_array_equal(mean, whole.mean[k])
    np.testing.assert_array_equal(online.covariance, whole.covariance[-1])
    assert online["velocity"] == mean[1] and online.nis == whole.nis[-1]


def test_forces_on_single_masses_go_in_and_out():
    forces = {"force_on_2": {"white_noise": {"std": 9.0}}}
    scenario = ks.Scenario(duration=5.0, plant={"kind": "shear_2"}, force="none", forces=forces)
    record = scenario.simulate()
    again = ks.Record(record.dt, **{key: record[key] for key in ["displacement", "velocity", "force_on_2"]})
    one, other = ks.run(scenario)["UKF"], ks.run(scenario, again)["UKF"]
    np.testing.assert_array_equal(one.mean, other.mean)
    assert np.std(record["force_on_2"]) > 5.0


def test_columns_of_any_kind_are_the_same_record():
    pd, pl = pytest.importorskip("pandas"), pytest.importorskip("polars")
    force, x = [0.0, 1.0, 0.5, 0.0], [0.1, None, 0.3, 0.2]
    plain = ks.Record(0.01, force, displacement=x)
    masked = np.ma.masked_invalid([0.1, np.nan, 0.3, 0.2])
    for column in [pd.Series(x), pd.Series(x, dtype="Float64"), pl.Series(x), np.array(x, float), masked]:
        record = ks.Record(np.arange(4) * 0.01 + 5, np.array(force), displacement=column)
        np.testing.assert_array_equal(record["displacement"], plain["displacement"])
        assert record.dt == pytest.approx(0.01) and record.time[0] == 5
    assert "1 readings missing" in repr(plain)
    columns = {"time (s)": [0.0, 0.01, 0.02, 0.03], "force": force, "deflection (mm)": [100, 200, 300, 200]}
    for frame in [pd.DataFrame(columns), pl.DataFrame(columns)]:
        record = ks.Record(frame)
        np.testing.assert_allclose(record["displacement"], [0.1, 0.2, 0.3, 0.2])
        assert "displacement in `deflection`" in record.remarks[1]
    with pytest.raises(ValueError):
        plain["displacement"][0] = 1.0


def test_readings_may_have_times_of_their_own():
    scenario = ks.Scenario(duration=20.0, filters=[{"kind": "ekf"}])
    truth = scenario.simulate()
    times = np.sort(np.random.default_rng(1).uniform(0, 20, 900))
    readings = np.interp(times, truth.time, truth["true_displacement"])
    day = np.datetime64("2026-01-01T12:00:00")
    dates = [day + (1e9 * seconds).astype("timedelta64[ns]") for seconds in (truth.time, times)]
    for t, own in [(truth.dt, times), (truth.time, times), dates]:
        record = ks.Record(t, truth.input, displacement=(own, readings), velocity=truth["velocity"])
        assert "times of their own" in repr(record) and "each column has its own clock" in record.remarks[0]
        (found,) = ks.run(scenario, record).values()
        assert abs(found["natural_frequency"][-1] - 6.0) < 0.1
    uneven = ks.Record(times, np.interp(times, truth.time, truth.input), displacement=readings, hold="first")
    assert "irregular" in uneven.remarks[0] and "times of their own" in repr(uneven)


MISTAKES = [
    (lambda: ks.Record(0.1, [1.0, 2.0], displacement=[1.0]), "column `displacement` has 1 values, but there are 2 samples"),
    (lambda: ks.Record([0, 1, 2], [1.0, 2.0], velocity=[1, 2, 3]), "column `input` has 2 values, but there are 3 samples"),
    (lambda: ks.Record([0, 2, 1], displacement=[1, 2, 3]), "`time` goes back from 2 s to 1 s"),
    (lambda: ks.Record(0.1, [1.0, np.inf], displacement=[1.0, 1.0]), "`input`: the number is infinite"),
    (lambda: ks.Record(0.1, displacement=np.eye(2)), "`displacement` must have one dimension, not 2"),
    (lambda: ks.Record(0.1, displacement=["a", "b"]), "`displacement` is no column of numbers"),
    (lambda: ks.Record([0, 1], displacement=(np.array(["2026-01-01", "2026-01-02"], "M8[s]"), [0, 1])), "has dates where"),
    (lambda: ks.Record([0, 1], displacement=([1, 0.5], [1, 2]), velocity=[1, 2]), "the times of `displacement` are two or more"),
    (lambda: ks.Record(0.1, [1.0], speed=[1.0]), "`speed` is no quantity: there are displacement, "),
    (lambda: ks.Record(0.1, [1.0, 1.0], displacement=([0.0], [1.0, 2.0])), "`displacement` has 1 times, but 2 readings"),
    (lambda: ks.Record("nothing.csv"), "nothing.csv: No such file"),
    (lambda: ks.Scenario(filters=[{"fading": 0.5}]), "`filters[0].fading` is 0.5, but must be "),
    (lambda: ks.Scenario(filters=[{"sensor_std": {"speed": 1}}]), "`filters[0].sensor_std.speed`: the sensors are "),
    (lambda: ks.Scenario("dt = 'soon'"), "line 1"),
    (lambda: ks.Scenario(equation="x'' + (x = f"), "is expected here, at character 10"),
    (lambda: ks.Scenario(**{"filters.EKF.fadng": 1.0}), "has no number `filters.EKF.fadng`"),
    (lambda: ks.Online({}, "PF"), "the scenario has no filter `PF`"),
    (lambda: ks.Online({}).step(0.0, speed=1.0), "there is no sensor `speed`, but displacement, velocity"),
    (lambda: ks.Online({}).step(np.nan), "an input is finite"),
    (lambda: ks.tune({}, ["filters.EKF.nothing"]), "has no number `filters.EKF.nothing`"),
    (lambda: ks.sweep({}, {"seed": [1, 2, 4, 5]}), "evenly spaced"),
    (lambda: ks.sweep({}, {"seed": (1, 2, 2)}, part=(3, 2)), "there is no part 3 of 2"),
]


@pytest.mark.parametrize("mistake, sentence", MISTAKES)
def test_a_mistake_is_a_sentence(mistake, sentence):
    with pytest.raises(ValueError) as caught:
        mistake()
    assert sentence in str(caught.value)


def test_a_cause_is_found_and_its_edits_take_it_away():
    scenario = ks.Scenario(duration=40.0, plant={"natural_frequency": 6.0}, filters=[{"sensor_std": [0.001, 0.006]}])
    (found,) = ks.run(scenario).values()
    assert found.verdict == "overconfident"
    first = found.diagnosis["causes"][0]
    assert "R of a sensor" in first["sentence"]
    mended = ks.Scenario(scenario, **{edit["key"]: edit["value"] for edit in first["edits"]})
    (after,) = ks.run(mended).values()
    assert after.verdict == first["then"]
    assert np.nansum(after.log_likelihood) - np.nansum(found.log_likelihood) > 0.9 * first["gain"]


def test_scenarios_are_equal_in_every_form():
    scenario = ks.Scenario(duration=5, filters=[{"kind": "ukf"}], **{"filters.UKF.fading": 1.01})
    assert ks.Scenario(scenario.toml) == ks.Scenario(scenario.to_dict()) == ks.Scenario(scenario) == scenario
    assert scenario["filters.UKF.fading"] == 1.01 and ks.Scenario(scenario, seed=7)["seed"] == 7
    own = ks.Scenario(equation="x'' + c x' + k x = f", plant={"c": 0.6}, duration=5)
    assert ks.run(own)["EKF"].channels == ["displacement", "velocity", "c", "k"]
    other = ks.Scenario(scenario, filters=[{"kind": "enkf"}])
    assert other.filters == ["EnKF"] and pickle.loads(pickle.dumps(other)) == other
    assert any("k (guess 1)" in remark for remark in own.remarks), own.remarks


def test_a_sweep_has_the_numbers_of_runs_and_parts_make_the_whole():
    pd = pytest.importorskip("pandas")
    scenario = ks.Scenario(duration=5.0, filters=[{"kind": "ekf"}])
    vary = {"filters.EKF.initial_mean.natural_frequency": np.linspace(4, 8, 3)}
    measures = ["nis", "estimate.natural_frequency"]
    whole = pd.DataFrame(ks.sweep(scenario, vary, seeds=4, measures=measures))
    assert len(whole) == 12 and list(whole.columns[:2]) == [*vary, "seed"]
    for _, row in whole.iterrows():
        one = ks.Scenario(scenario, seed=int(row["seed"]), **{key: row[key] for key in vary})
        last = ks.run(one)["EKF"]["natural_frequency"][-1]
        assert row["EKF.estimate.natural_frequency"] == pytest.approx(last, rel=1e-12)
    parts = [pd.DataFrame(ks.sweep(scenario, vary, seeds=4, measures=measures, part=(k, 5))) for k in range(1, 6)]
    pd.testing.assert_frame_equal(pd.concat(parts, ignore_index=True), whole)


def test_tuning_does_no_worse():
    scenario = ks.Scenario(duration=10.0, filters=[{"kind": "ekf", "sensor_std": [0.03, 0.06]}])
    key = "filters.EKF.sensor_std.displacement"
    tuned = ks.tune(scenario, {key: (0.001, 0.1, "log")})
    assert tuned["after"][key] == pytest.approx(0.01, rel=0.3) and tuned["score"][1] > tuned["score"][0]
    assert tuned["scenario"][key] == pytest.approx(tuned["after"][key], rel=1e-6)


def test_hindsight_and_free_runs():
    record = ks.Scenario(duration=20.0, plant={"natural_frequency": 6.0}).simulate()
    results = ks.run(ks.Scenario(record), record)
    assert results._repr_html_().startswith("<svg") and record._repr_html_().startswith("<svg")
    smoothed = results["EKF"].smooth()
    assert smoothed.std[0, 2] < 0.5 * results["EKF"].std[0, 2] and smoothed.verdict is None
    other = ks.Scenario(duration=20.0, seed=2, plant={"natural_frequency": 6.0}).simulate()
    assert all(fit["percent"] > 80 for fit in results.free_run(other))


CALL = """
import threading, time, kalmanscope as ks
LONG = {"duration": 2000.0, "filters": [{"kind": "pf", "ensemble_size": 2000}]}
ticks = []
threading.Thread(target=lambda: [ticks.append(time.sleep(0.005)) for _ in range(9999)], daemon=True).start()
print("begun", flush=True)
try:
    ks.%s
except KeyboardInterrupt:
    print(len(ticks))
"""


@pytest.mark.parametrize("call", ["run(LONG)", "tune(LONG, 'filters.PF.sensor_std.velocity')", "sweep(LONG, {'seed': (1, 4, 4)})"])
def test_others_run_meanwhile_and_ctrl_c_ends_a_call(call):
    with subprocess.Popen([sys.executable, "-c", CALL % call], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "begun\n"
        time.sleep(0.5)
        child.send_signal(signal.SIGINT)
        assert int(child.communicate(timeout=20)[0]) > 20, "others run meanwhile"


@pytest.mark.parametrize("notebook", sorted((ROOT / "python/notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_notebooks_run(notebook, monkeypatch):
    monkeypatch.chdir(notebook.parent)
    names = {"__name__": "notebook"}
    for cell in json.loads(notebook.read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), notebook.name, "exec"), names)


def test_everything_public_is_described():
    for name in set(ks.__all__) - {"__version__"}:
        thing = getattr(ks, name)
        assert thing.__doc__, name
        for member in vars(thing) if inspect.isclass(thing) else []:
            assert member.startswith("_") or getattr(thing, member).__doc__, f"{name}.{member}"
