//! Runs, and what their filters have estimated.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use kalmanscope_cli::{Results as Report, svg};
use kalmanscope_core::{Channel, Diagnostics, Estimates as History, Run, Source, smoothed};
use kalmanscope_diagnosis::{Analysis, Diagnosis, Wanted as Parts};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

use crate::arrays::{array, from_json};
use crate::record::Record;
use crate::scenario::Scenario;
use crate::{Wanted, error, interruptible};

/// Runs the filters of a scenario over its own simulated record, or over a given one.
///
/// Parameters
/// ----------
/// scenario : Scenario, or what makes one
/// record : Record, optional
///
/// Returns
/// -------
/// Results
///     The estimates of each filter by its name.
#[pyfunction]
#[pyo3(signature = (scenario, record=None))]
pub(crate) fn run(
    py: Python<'_>,
    scenario: &Bound<'_, PyAny>,
    record: Option<&Bound<'_, Record>>,
) -> PyResult<Results> {
    let settings = Scenario::of(scenario)?;
    let source = record.map_or(Source::Simulated, |record| Source::Measured(record.get().record.clone()));
    let mut run = Run::from_source(settings, source).map_err(error)?;
    let run = interruptible(py, move |wanted| {
        // A step takes from a tenth of a microsecond to milliseconds: Ctrl-C is looked for between chunks of a few.
        const LONG: Duration = Duration::from_millis(5);
        let mut chunk = 1;
        loop {
            let begin = Instant::now();
            if !wanted.is_so() || run.advance_to(run.done() + chunk) == 0 {
                return run;
            }
            chunk *= if begin.elapsed() < LONG { 2 } else { 1 };
        }
    })?;
    Ok(Results(Arc::new(Finished { run: Mutex::new(run), report: OnceLock::new() })))
}

/// A run to its end.
struct Finished {
    run: Mutex<Run>,
    /// Its diagnosis as JSON, once somebody has asked.
    report: OnceLock<String>,
}

impl Finished {
    fn run(&self) -> MutexGuard<'_, Run> {
        self.run.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn report(&self, py: Python<'_>) -> PyResult<&str> {
        if let Some(report) = self.report.get() {
            return Ok(report);
        }
        let report = interruptible(py, |wanted| report(&self.run(), wanted))?.map_err(error)?;
        Ok(self.report.get_or_init(|| report))
    }
}

/// Verdicts, evidence, causes, last estimates and free runs, as `kalmanscope-cli run --json` prints them.
fn report(run: &Run, wanted: &Wanted) -> Result<String, String> {
    let analysis = Analysis::new(run, Parts { bounds: true, ..Parts::default() });
    let causes = analysis.diagnostics().iter().enumerate().map(|(place, diagnostics)| {
        let diagnosis = analysis.diagnosis(place).filter(|diagnosis| diagnosis.verdict.is_some());
        let estimates = &run.estimates()[place];
        let search =
            diagnosis.and_then(|it| it.search(run.scenario(), place, diagnostics, estimates, run.record()).ok());
        search.and_then(|search| wanted.finish(search)).unwrap_or_default()
    });
    let causes = causes.collect();
    let results = Report::of_run(run, &analysis, causes).with_free_runs(run, &[("its own record", run.record())]);
    results.json(&[]).map_err(|error| error.to_string())
}

/// The estimates of each filter of a run by its name.
#[pyclass(module = "kalmanscope", frozen, mapping)]
pub(crate) struct Results(Arc<Finished>);

impl Results {
    fn one(&self, place: usize) -> Estimates {
        Estimates { of: self.0.clone(), place, smoothed: None }
    }
}

#[pymethods]
impl Results {
    /// The names of the filters.
    fn keys(&self) -> Vec<String> {
        self.0.run().estimates().iter().map(|one| one.name().to_owned()).collect()
    }

    fn __len__(&self) -> usize {
        self.0.run().estimates().len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.keys().into_pyobject(py)?.call_method0("__iter__")
    }

    fn __getitem__(&self, name: &str) -> PyResult<Estimates> {
        let place = self.keys().iter().position(|one| one == name);
        let place = place.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        Ok(self.one(place))
    }

    /// The estimates of all filters.
    fn values(&self) -> Vec<Estimates> {
        (0..self.__len__()).map(|place| self.one(place)).collect()
    }

    /// The record, simulated or given.
    #[getter]
    fn record(&self) -> Record {
        Record::of(self.0.run().record().clone(), Vec::new())
    }

    /// How well each identified model follows each sensor of a record, from its input alone: a list of dicts with ``filter``,
    /// ``sensor``, ``rms`` and ``percent``.
    fn free_run<'py>(&self, py: Python<'py>, record: &Bound<'_, Record>) -> PyResult<Bound<'py, PyAny>> {
        let record = &*record.get().record;
        let json = interruptible(py, |_| {
            let run = self.0.run();
            let results = Report::of_run(&run, &Analysis::new(&run, Parts::NOTHING), Vec::new());
            results.with_free_runs(&run, &[("a record", record)]).json(&[])
        })?;
        from_json(py, &json.map_err(error)?)?.get_item("free_runs")
    }

    fn __repr__(&self) -> String {
        let lines = self.values().into_iter().map(|one| one.__repr__());
        lines.collect::<Vec<_>>().join("\n")
    }

    fn _repr_html_(&self) -> String {
        svg(&self.0.run())
    }
}

/// What one filter has estimated, sample by sample: N samples, n channels, m sensors. Arrays are read-only.
#[pyclass(module = "kalmanscope", frozen)]
#[derive(Clone)]
pub(crate) struct Estimates {
    of: Arc<Finished>,
    place: usize,
    smoothed: Option<Arc<History>>,
}

impl Estimates {
    fn with<T>(&self, read: impl FnOnce(&History) -> T) -> T {
        match &self.smoothed {
            Some(smoothed) => read(smoothed),
            None => read(&self.of.run().estimates()[self.place]),
        }
    }
}

#[pymethods]
impl Estimates {
    /// The filter's name.
    #[getter]
    fn name(&self) -> String {
        self.with(|of| of.name().to_owned())
    }

    /// The keys of the channels, in the order of `mean`.
    #[getter]
    fn channels(&self) -> Vec<&'static str> {
        self.with(|of| of.channels().iter().map(|channel| channel.key()).collect())
    }

    /// The sensors, in the order of `innovation`.
    #[getter]
    fn sensors(&self) -> Vec<&'static str> {
        self.with(|of| of.sensors().iter().map(|sensor| sensor.key()).collect())
    }

    /// The sample at which the filter stopped and why, or None.
    #[getter]
    fn stop(&self) -> Option<(usize, String)> {
        self.with(|of| of.stop().map(|stop| (stop.sample, stop.reason.to_string())))
    }

    fn __len__(&self) -> usize {
        self.with(History::len)
    }

    /// The times of the samples [s], shape (N,).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let samples = self.__len__();
        let run = self.of.run();
        array(py, &[samples], (0..samples).map(|k| run.record().time(k)))
    }

    /// Means of the channels, a natural frequency not negative; shape (N, n).
    #[getter]
    fn mean<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(|of| {
            let n = of.channels().len();
            array(py, &[of.len(), n], (0..of.len()).flat_map(|k| (0..n).map(move |i| of.canonical_mean(k, i))))
        })
    }

    /// Standard deviations of the channels, shape (N, n).
    #[getter]
    fn std<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(|of| {
            let n = of.channels().len();
            array(py, &[of.len(), n], (0..of.len()).flat_map(|k| (0..n).map(move |i| of.std(k, i))))
        })
    }

    /// Covariances of the channels, shape (N, n, n).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(|of| {
            let n = of.channels().len();
            let numbers = (0..of.len()).flat_map(|k| {
                let sign = move |i: usize| of.canonical_sign(k, i);
                of.cov(k).iter().enumerate().map(move |(at, value)| sign(at / n) * sign(at % n) * value)
            });
            array(py, &[of.len(), n, n], numbers)
        })
    }

    /// Readings less what was expected of them; NaN where nothing was measured. Shape (N, m).
    #[getter]
    fn innovation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(|of| {
            array(py, &[of.len(), of.sensors().len()], (0..of.len()).flat_map(|k| of.innovation(k)).copied())
        })
    }

    /// S, the covariances of the innovations; shape (N, m, m).
    #[getter]
    fn innovation_covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(|of| {
            let m = of.sensors().len();
            array(py, &[of.len(), m, m], (0..of.len()).flat_map(|k| of.innovation_cov(k)).copied())
        })
    }

    /// Normalised innovations squared over their number, one on average where the filter is consistent; shape (N,).
    #[getter]
    fn nis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(|of| array(py, &[of.len()], of.nis().iter().copied()))
    }

    /// Log likelihoods of the readings, shape (N,).
    #[getter]
    fn log_likelihood<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(|of| array(py, &[of.len()], of.log_likelihoods()))
    }

    /// The means of one channel, shape (N,).
    fn __getitem__<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        self.with(|of| {
            let place = of.channels().iter().position(|channel: &Channel| channel.key() == key);
            let place = place.ok_or_else(|| PyKeyError::new_err(key.to_owned()))?;
            array(py, &[of.len()], of.canonical_means(place).iter().copied())
        })
    }

    /// Whether the filter is to be believed, in a word such as "consistent" or "overconfident"; None of a smoother, and where
    /// too little was measured.
    #[getter]
    fn verdict(&self) -> Option<&'static str> {
        if self.smoothed.is_some() {
            return None;
        }
        let run = self.of.run();
        let (estimates, record) = (&run.estimates()[self.place], run.record());
        let verdict = Diagnosis::new(&Diagnostics::new(estimates, record), estimates, record)?.verdict?;
        Some(verdict.kind.name())
    }

    /// Verdict, evidence, causes with the settings that take them away, and last estimates.
    #[getter]
    fn diagnosis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, self.of.report(py)?)?.get_item("filters")?.get_item(self.place)
    }

    /// The same filter with hindsight: every estimate given all readings.
    fn smooth(&self, py: Python<'_>) -> PyResult<Self> {
        let smoothed = interruptible(py, |_| {
            let run = self.of.run();
            smoothed(run.scenario(), self.place, run.record())
        })?;
        Ok(Self { smoothed: Some(Arc::new(smoothed.map_err(error)?)), ..self.clone() })
    }

    fn __repr__(&self) -> String {
        let verdict = self.verdict().unwrap_or("no verdict");
        self.with(|of| {
            let last = of.len().wrapping_sub(1);
            let parameters = of.channels().iter().enumerate().filter(|(_, it)| it.is_parameter() && last < of.len());
            let ends = parameters.map(|(i, channel)| {
                let (value, std) = kalmanscope_cli::with_spread(of.canonical_mean(last, i), 2.0 * of.std(last, i));
                format!("{} {value} ± {std} {}", channel.key(), channel.unit())
            });
            let ends: Vec<String> = ends.collect();
            format!("<{}: {verdict}; {}>", of.name(), ends.join(", ").trim_end())
        })
    }
}
