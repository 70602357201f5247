//! Filters that follow samples as they come.

use std::sync::{Mutex, MutexGuard, PoisonError};

use kalmanscope_core::{LastSample, OnlineFilter};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::PyDict;

use crate::arrays::array;
use crate::lab::place_of;
use crate::scenario::Scenario;
use crate::{error, no_key};

/// A filter of a scenario before its first sample, for samples that come one by one. The same bits as those of `run`.
///
/// Online(scenario, filter=None)
///
/// Parameters
/// ----------
/// scenario : Scenario, or what makes one; ``dt`` is the time between samples
/// filter : str, the name of one; the first one if left out
///
/// Examples
/// --------
/// >>> import kalmanscope as ks
/// >>> online = ks.Online({"dt": 0.01, "filters": [{"kind": "ekf"}]})
/// >>> mean = online.step(0.0, displacement=0.1, velocity=0.0)
/// >>> online.channels[2]
/// 'natural_frequency'
#[pyclass(module = "kalmanscope", frozen)]
pub(crate) struct Online {
    filter: Mutex<(OnlineFilter, LastSample)>,
    /// The keys of the channels, in the order of `mean`.
    #[pyo3(get)]
    channels: Vec<&'static str>,
    /// The sensors, in the order of the readings.
    #[pyo3(get)]
    sensors: Vec<&'static str>,
}

impl Online {
    fn filter(&self, py: Python<'_>) -> MutexGuard<'_, (OnlineFilter, LastSample)> {
        self.filter.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Online {
    #[new]
    #[pyo3(signature = (scenario, filter=None))]
    fn new(scenario: &Bound<'_, PyAny>, filter: Option<&str>) -> PyResult<Self> {
        let settings = Scenario::of(scenario)?;
        let place = place_of(&settings, filter)?;
        let online = OnlineFilter::new(&settings, place).map_err(error)?;
        let model = settings.filters[place].model(&settings.plant.kind, settings.input);
        let mut last = LastSample::default();
        last.want_prior(false);
        let channels = model.channels().iter().map(|channel| channel.key()).collect();
        let sensors = settings.measured().iter().map(|sensor| sensor.key()).collect();
        Ok(Self { filter: Mutex::new((online, last)), channels, sensors })
    }

    /// Takes in the next sample: its input [m/s²], and readings in the order of `sensors` or by name; one that is left out is missing.
    /// Returns the means after it, shape (n,). The first sample begins with the initial belief, and its readings are not used.
    /// With a negative `input_delay` the means are those of an earlier sample, and empty until there is one.
    #[pyo3(signature = (u=0.0, z=None, **readings))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        u: f64,
        z: Option<Vec<f64>>,
        readings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut measured = z.unwrap_or_else(|| vec![f64::NAN; self.sensors.len()]);
        if measured.len() != self.sensors.len() {
            let (found, wanted) = (measured.len(), self.sensors.join(", "));
            return Err(error(format_args!("{found} readings, but the sensors are {wanted}")));
        }
        for (key, value) in readings.into_iter().flat_map(|readings| readings.iter()) {
            let key: String = key.extract()?;
            let place = self.sensors.iter().position(|sensor| *sensor == key);
            let place = place
                .ok_or_else(|| error(format_args!("there is no sensor `{key}`, but {}", self.sensors.join(", "))))?;
            measured[place] = value.extract::<Option<f64>>()?.unwrap_or(f64::NAN);
        }
        if !u.is_finite() || measured.iter().any(|reading| reading.is_infinite()) {
            return Err(error("an input is finite, and a reading is finite or missing"));
        }
        let mut filter = self.filter(py);
        let (online, last) = &mut *filter;
        online.step(u, &measured, last);
        if let Some(stop) = online.pass.stop {
            return Err(error(format_args!("stopped at sample {}: {}", stop.sample, stop.reason)));
        }
        let mean = last.sample().mean;
        array(py, &[mean.len()], mean.iter().copied())
    }

    /// The mean of one channel after the last sample.
    fn __getitem__(&self, py: Python<'_>, key: &str) -> PyResult<f64> {
        let place = self.channels.iter().position(|channel| *channel == key);
        let filter = self.filter(py);
        let mean = place.and_then(|place| filter.1.sample().mean.get(place).copied());
        mean.ok_or_else(|| if place.is_some() { error("no sample has come yet") } else { no_key(key, &self.channels) })
    }

    /// The covariance after the last sample, shape (n, n).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let filter = self.filter(py);
        let cov = filter.1.sample().cov;
        let n = cov.len().isqrt();
        array(py, &[n, n], cov.iter().copied())
    }

    /// The NIS of the last sample.
    #[getter]
    fn nis(&self, py: Python<'_>) -> f64 {
        self.filter(py).1.sample().nis
    }
}
