//! Tuning and sweeps.

use std::sync::Arc;

use kalmanscope_core::document::{self, Document, json};
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Scenario as Settings, Source, simulate};
use kalmanscope_diagnosis::{Measure, UnknownMeasure};
use kalmanscope_lab::tune::Tuner;
use kalmanscope_lab::{Ensemble, EnsembleError, Plan, Priority, Runner, Threads, channels, processors};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, from_json, helpers};
use crate::record::Record;
use crate::scenario::Scenario;
use crate::{error, interruptible};

/// The place of the filter with a name, or of the first one.
pub(crate) fn place_of(settings: &Settings, name: Option<&str>) -> PyResult<usize> {
    let Some(name) = name else {
        return (!settings.filters.is_empty()).then_some(0).ok_or_else(|| error("the scenario has no filter"));
    };
    let place = settings.filters.iter().position(|filter| filter.name == name);
    place.ok_or_else(|| error(format_args!("the scenario has no filter `{name}`{}", settings.filters_in_words())))
}

/// The values of an address: an array, a tuple, or a text.
fn axis(key: &str, values: &Bound<'_, PyAny>) -> PyResult<Axis> {
    let range: String = helpers(values.py())?.call_method1("axis", (key, values))?.extract()?;
    Axis::parse(&format!("{key}={range}")).map_err(error)
}

/// Finds the values of some settings with which a filter does best.
///
/// Parameters
/// ----------
/// scenario : Scenario, or what makes one
/// settings : list of str, or dict of str to (from, to) or (from, to, "log")
///     Addresses such as ``"filters.EKF.process_std"``, and where to look for the best value.
/// record : Record, a measured one; the scenario's simulated one if left out
/// filter : str, the name of one; the first one if left out
/// goal : {"log_likelihood", "nis", "free_run.SENSOR"}
///
/// Returns
/// -------
/// dict
///     ``scenario``, the tuned one; ``before`` and ``after``, values by address; ``bands``, ±2σ by the curvature of the likelihood, or
///     None; ``score``, before and after; ``verdict``; ``remarks``; ``runs``.
#[pyfunction]
#[pyo3(signature = (scenario, settings, record=None, *, filter=None, goal="log_likelihood"))]
pub(crate) fn tune<'py>(
    py: Python<'py>,
    scenario: &Bound<'_, PyAny>,
    settings: &Bound<'_, PyAny>,
    record: Option<&Bound<'_, Record>>,
    filter: Option<&str>,
    goal: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let before = Scenario::of(scenario)?;
    let place = place_of(&before, filter)?;
    let keys: Vec<String> = match settings.extract::<String>() {
        Ok(key) => vec![key],
        Err(_) => settings.try_iter()?.map(|key| key?.extract()).collect::<PyResult<_>>()?,
    };
    let axes = keys.iter().map(|key| {
        let address = Address::parse(&before, key).map_err(error)?;
        match settings.cast::<PyDict>() {
            Ok(ranges) => axis(key, &ranges.as_any().get_item(key)?),
            Err(_) => Ok(Axis { key: key.clone(), ..Axis::usual(&address, &before, 2) }),
        }
    });
    let axes = axes.collect::<PyResult<Vec<_>>>()?;
    let record = record.map(|record| record.get().record.clone());
    let goal = before.knowing(|| document::read(&json!(goal))).map_err(error)?;
    let tuned = interruptible(py, move |wanted| {
        let record = record.unwrap_or_else(|| Arc::new(simulate(&before)));
        let tuner = Tuner::new((*before).clone(), place, record, axes, goal, None)?;
        Ok::<_, EnsembleError>(wanted.finish(tuner))
    })?;
    let tuned = tuned.map_err(error)?.ok_or_else(|| error("interrupted"))?;
    let values = |values: &[f64]| Document::from_iter(keys.iter().cloned().zip(values.iter().copied()));
    let (first, last) = (&tuned.path[0], &tuned.path[tuned.path.len() - 1]);
    let result = json!({
        "before": values(&first.values),
        "after": values(&last.values),
        "score": [first.score, last.score],
        "bands": tuned.bands.map(|bands| Document::from_iter(keys.iter().cloned().zip(bands.into_iter().map(|ends| json!(ends))))),
        "verdict": tuned.verdict.map(|verdict| verdict.name()),
        "remarks": tuned.remarks.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "runs": tuned.runs,
    });
    let result = from_json(py, &result.to_string())?;
    result.set_item("scenario", Scenario { settings: Arc::new(tuned.scenario), remarks: Vec::new() })?;
    Ok(result)
}

/// Runs a scenario with every combination of some settings, on all processors.
///
/// Parameters
/// ----------
/// scenario : Scenario, or what makes one
/// vary : dict of str to array_like, tuple or str
///     Values by address: evenly spaced in differences or in ratios, ``(from, to, count)``, ``(from, to, count, "log")``, or
///     ``"FROM:TO:COUNT:log"``.
/// seeds : int, each combination with the seeds 1 to this
/// measures : list of str, optional
///     ``"nis"``, ``"rmse.natural_frequency"``, ...; all that need no history if left out.
/// filters : list of str, names of some; all if left out
/// threads : int, optional
/// part : (int, int), the k-th of n parts of the rows, from 1 on, for a cluster
///
/// Returns
/// -------
/// dict of str to ndarray, shape (rows,)
///     A column for each setting and each measure of each filter; the last setting changes fastest. NaN where settings are impossible or
///     a filter stops.
#[pyfunction]
#[pyo3(signature = (scenario, vary, record=None, *, seeds=None, measures=None, filters=None, threads=None, part=(1, 1)))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    scenario: &Bound<'_, PyAny>,
    vary: &Bound<'_, PyDict>,
    record: Option<&Bound<'_, Record>>,
    seeds: Option<i64>,
    measures: Option<Vec<String>>,
    filters: Option<Vec<String>>,
    threads: Option<usize>,
    part: (usize, usize),
) -> PyResult<Bound<'py, PyDict>> {
    let settings = Scenario::of(scenario)?;
    let axes = vary.iter().map(|(key, values)| axis(&key.extract::<String>()?, &values));
    let mut axes = axes.collect::<PyResult<Vec<_>>>()?;
    let seeds = seeds.map(|count| Axis::parse(&format!("seed=1:{count}:{count}")));
    axes.extend(seeds.transpose().map_err(error)?);
    let filters = match filters {
        Some(names) => names.iter().map(|name| place_of(&settings, Some(name))).collect::<PyResult<_>>()?,
        None => (0..settings.filters.len()).collect::<Vec<_>>(),
    };
    let source = record.map_or(Source::Simulated, |record| Source::Measured(record.get().record.clone()));
    let is_known = |measure: &Measure| !measure.info().needs_truth || matches!(source, Source::Simulated);
    let measures = match measures {
        Some(names) => {
            let read = || names.iter().map(|name| name.parse()).collect::<Result<_, UnknownMeasure>>();
            settings.knowing(read).map_err(error)?
        }
        None => Measure::of_sums(&channels(&settings, &filters)).into_iter().filter(is_known).collect(),
    };
    let plan = Plan { filters, measures, axes, ..Plan::default() };
    let ensemble = Ensemble::new((*settings).clone(), plan).map_err(error)?;
    let runner = Arc::new(Runner::new(ensemble, source).map_err(error)?);
    let (number, of) = part;
    if number == 0 || number > of {
        return Err(error(format_args!("there is no part {number} of {of}")));
    }
    let all = runner.ensemble().cells();
    let cells = all * (number - 1) / of..all * number / of;
    let width = runner.ensemble().width();
    let count = threads.unwrap_or_else(processors).clamp(1, cells.len().max(1));
    let (shared, range) = (Arc::clone(&runner), cells.clone());
    let rows = interruptible(py, move |wanted| {
        let team = Threads::new(count, 0).map_err(|error| error.to_string())?;
        let work = team.rows(Priority::Map, &shared, range.clone().collect(), |_| {});
        let (mut rows, mut done) = (vec![f64::NAN; range.len() * width], 0);
        while done < range.len() && wanted.is_so() {
            let slice = work.wait().ok_or("a thread ended before its work was done")?;
            for (cell, row) in slice.cells.iter().zip(slice.rows.chunks_exact(width)) {
                rows[(cell - range.start) * width..][..width].copy_from_slice(row);
            }
            done += slice.cells.len();
        }
        Ok::<_, String>(rows)
    })?;
    let rows = rows.map_err(error)?;
    let ensemble = runner.ensemble();
    let settings_of = |cell: usize| [ensemble.values(cell), ensemble.member(cell)].concat();
    let drawn = ensemble.drawn().iter().map(|address| ensemble.scenario().address_by_name(&address.to_string()));
    let axes = ensemble.plan().axes.iter().map(|axis| axis.key.clone());
    let table = PyDict::new(py);
    for (place, name) in axes.chain(drawn).enumerate() {
        table.set_item(name, array(py, &[cells.len()], cells.clone().map(|cell| settings_of(cell)[place]))?)?;
    }
    for (place, name) in ensemble.columns().into_iter().enumerate() {
        table.set_item(name, array(py, &[cells.len()], rows.iter().skip(place).step_by(width.max(1)).copied())?)?;
    }
    Ok(table)
}
