//! Runs, and what their filters have estimated.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

use kalmanscope_cli::{Results as Report, svg};
use kalmanscope_core::{Diagnostics, Estimates as History, Run, Source, smoothed};
use kalmanscope_diagnosis::{Analysis, Diagnosis, Wanted as Parts};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;

use crate::arrays::{array, from_json};
use crate::record::Record;
use crate::scenario::Scenario;
use crate::{PATIENCE, Wanted, error, interruptible, no_key};

/// Runs the filters of a scenario over its own simulated record, or over a given one; returns their estimates by name. An `Error` says
/// which sensor a record lacks, or what else does not fit.
///
/// Parameters
/// ----------
/// scenario : Scenario, or what makes one
/// record : Record, optional
#[pyfunction]
#[pyo3(signature = (scenario, record=None))]
pub(crate) fn run<'py>(
    py: Python<'py>,
    scenario: &Bound<'_, PyAny>,
    record: Option<&Bound<'_, Record>>,
) -> PyResult<Bound<'py, PyAny>> {
    let settings = Scenario::of(scenario)?;
    let source = record.map_or(Source::Simulated, |record| Source::Measured(record.get().record.clone()));
    let mut run = Run::from_source(settings, source).map_err(error)?;
    // The run stays in this thread: a new one would get its memory from the system, which takes 2 ms.
    let (mut portion, mut begun) = (1, Instant::now());
    while py.detach(|| run.advance_to(run.done() + portion)) > 0 {
        py.check_signals()?;
        portion = if begun.elapsed() < PATIENCE { 2 * portion } else { portion.div_ceil(2) };
        begun = Instant::now();
    }
    let record = Record::of(run.record().clone(), Vec::new());
    let stop = run.truth_stop().map(|stop| format!("the record ends before sample {}: {}", stop.sample, stop.reason));
    let run = Whole(Arc::new(Finished { run: Mutex::new(run), report: OnceLock::new() }));
    py.import("kalmanscope._results")?.call_method1("Results", (run, record, Vec::from_iter(stop)))
}

/// A run to its end.
struct Finished {
    run: Mutex<Run>,
    /// Its diagnosis as JSON, once somebody has asked.
    report: OnceLock<String>,
}

impl Finished {
    /// Without the GIL: a thread that waits for the run with it would keep it from the one that has the run.
    fn run(&self) -> MutexGuard<'_, Run> {
        self.run.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives the GIL to others while it waits.
    fn run_attached(&self, py: Python<'_>) -> MutexGuard<'_, Run> {
        self.run.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    fn report(self: &Arc<Self>, py: Python<'_>) -> PyResult<&str> {
        if let Some(report) = self.report.get() {
            return Ok(report);
        }
        let own = Arc::clone(self);
        let report = interruptible(py, move |wanted| report(&own.run(), wanted))?.map_err(error)?;
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

/// The part of a run that `Results` needs.
#[pyclass(module = "kalmanscope", name = "_Run", frozen)]
pub(crate) struct Whole(Arc<Finished>);

#[pymethods]
impl Whole {
    fn estimates(&self, py: Python<'_>) -> Vec<Estimates> {
        let run = self.0.run_attached(py);
        (0..run.estimates().len()).map(|place| Estimates::of(&self.0, place, &run.estimates()[place], None)).collect()
    }

    fn free_run<'py>(&self, py: Python<'py>, record: &Bound<'_, Record>) -> PyResult<Bound<'py, PyAny>> {
        let (own, record) = (self.0.clone(), record.get().record.clone());
        let json = interruptible(py, move |_| {
            let run = own.run();
            let results = Report::of_run(&run, &Analysis::new(&run, Parts::NOTHING), Vec::new());
            results.with_free_runs(&run, &[("a record", &record)]).json(&[]).map_err(|error| error.to_string())
        })?;
        from_json(py, &json.map_err(error)?)?.get_item("free_runs")
    }

    fn svg(&self, py: Python<'_>) -> String {
        svg(&self.0.run_attached(py))
    }
}

/// The estimates of one filter, sample by sample: N samples, n channels, m sensors. Each access makes a new array, read-only.
#[pyclass(module = "kalmanscope", frozen)]
pub(crate) struct Estimates {
    of: Arc<Finished>,
    place: usize,
    smoothed: Option<Arc<History>>,
    /// The filter's name.
    #[pyo3(get)]
    name: String,
    /// The keys of the channels, in the order of `mean`.
    #[pyo3(get)]
    channels: Vec<&'static str>,
    /// The sensors, in the order of `innovation`.
    #[pyo3(get)]
    sensors: Vec<&'static str>,
    /// The sample at which the filter stopped and why, or None.
    #[pyo3(get)]
    stop: Option<(usize, String)>,
}

impl Estimates {
    fn of(run: &Arc<Finished>, place: usize, estimates: &History, smoothed: Option<Arc<History>>) -> Self {
        Self {
            of: Arc::clone(run),
            place,
            smoothed,
            name: estimates.name().to_owned(),
            channels: estimates.channels().iter().map(|channel| channel.key()).collect(),
            sensors: estimates.sensors().iter().map(|sensor| sensor.key()).collect(),
            stop: estimates.stop().map(|stop| (stop.sample, stop.reason.to_string())),
        }
    }

    fn with<T>(&self, py: Python<'_>, read: impl FnOnce(&History) -> T) -> T {
        match &self.smoothed {
            Some(smoothed) => read(smoothed),
            None => read(&self.of.run_attached(py).estimates()[self.place]),
        }
    }
}

#[pymethods]
impl Estimates {
    fn __len__(&self, py: Python<'_>) -> usize {
        self.with(py, History::len)
    }

    /// The times of the samples [s], shape (N,).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let samples = self.__len__(py);
        let run = self.of.run_attached(py);
        array(py, &[samples], (0..samples).map(|k| run.record().time(k)))
    }

    /// Means of the channels, a natural frequency not negative; shape (N, n).
    #[getter]
    fn mean<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let n = self.channels.len();
        self.with(py, |of| {
            array(py, &[of.len(), n], (0..of.len()).flat_map(|k| (0..n).map(move |i| of.canonical_mean(k, i))))
        })
    }

    /// Standard deviations of the channels, shape (N, n).
    #[getter]
    fn std<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let n = self.channels.len();
        self.with(py, |of| array(py, &[of.len(), n], (0..of.len()).flat_map(|k| (0..n).map(move |i| of.std(k, i)))))
    }

    /// Covariances of the channels, shape (N, n, n).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(py, |of| {
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
        let m = self.sensors.len();
        self.with(py, |of| array(py, &[of.len(), m], (0..of.len()).flat_map(|k| of.innovation(k)).copied()))
    }

    /// S, the covariances of the innovations; shape (N, m, m).
    #[getter]
    fn innovation_covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let m = self.sensors.len();
        self.with(py, |of| array(py, &[of.len(), m, m], (0..of.len()).flat_map(|k| of.innovation_cov(k)).copied()))
    }

    /// Normalised innovations squared over their number, one on average where the filter is consistent; shape (N,).
    #[getter]
    fn nis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(py, |of| array(py, &[of.len()], of.nis().iter().copied()))
    }

    /// Log likelihoods of the readings, shape (N,).
    #[getter]
    fn log_likelihood<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.with(py, |of| array(py, &[of.len()], of.log_likelihoods()))
    }

    /// The means of one channel, shape (N,).
    fn __getitem__<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let place = self.channels.iter().position(|one| *one == key).ok_or_else(|| no_key(key, &self.channels))?;
        self.with(py, |of| array(py, &[of.len()], of.canonical_means(place).iter().copied()))
    }

    /// Whether the filter is to be believed, in a word such as "consistent" or "overconfident"; None of a smoother, and where
    /// too little was measured.
    #[getter]
    fn verdict(&self, py: Python<'_>) -> Option<&'static str> {
        let run = self.smoothed.is_none().then(|| self.of.run_attached(py))?;
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
        let (of, place) = (self.of.clone(), self.place);
        let smoothed = interruptible(py, move |_| {
            let run = of.run();
            smoothed(run.scenario(), place, run.record())
        })?;
        let smoothed = Arc::new(smoothed.map_err(error)?);
        Ok(Self::of(&self.of, place, &smoothed, Some(smoothed.clone())))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let verdict = self.verdict(py).unwrap_or("no verdict");
        self.with(py, |of| {
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
