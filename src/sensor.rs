//! The sensors of this device, if it has some: an accelerometer, a microphone, a source of lines.

use std::rc::Rc;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use egui::Context;
use kalmanscope_core::Scenario;
use kalmanscope_sources::StreamRow;

/// A sensor of a device, with readings of some kind.
pub trait Sensor<T> {
    /// Begins to tell readings. They come later, or the reason why there are none.
    fn begin(&self, ctx: &Context, to: &Readings<T>);

    /// Stops.
    fn end(&self);

    /// A sentence for a user who waits in vain.
    fn hint(&self) -> String;
}

pub trait Reading: Clone {
    const MOST: usize;
}

/// Time \[s\] and three accelerations along the device's axes, with gravity \[m/s²\].
pub type Acceleration = [f64; 4];

impl Reading for Acceleration {
    /// Ten minutes of 200 a second.
    const MOST: usize = 120_000;
}

/// A sample of a sound, as a share of the loudest one that the microphone can tell.
pub type Sound = f32;

impl Reading for Sound {
    /// One minute of 48,000 a second.
    const MOST: usize = 2_880_000;
}

impl Reading for StreamRow {
    /// Those that have not been taken out yet.
    const MOST: usize = 1_000_000;
}

#[derive(Clone, Default)]
pub struct Sensors {
    pub accelerometer: Option<Rc<dyn Sensor<Acceleration>>>,
    pub microphone: Option<Rc<dyn Sensor<Sound>>>,
    /// The sensors of a scenario, with the scenario.
    pub stream: Option<(Rc<dyn Sensor<StreamRow>>, Rc<Scenario>)>,
}

impl Sensors {
    pub(crate) fn is_empty(&self) -> bool {
        let Self { accelerometer, microphone, stream } = self;
        accelerometer.is_none() && microphone.is_none() && stream.is_none()
    }
}

/// Readings that a sensor puts in and a window takes out; copies share them.
pub struct Readings<T>(Arc<Mutex<ReadingBuffer<T>>>);

pub(crate) struct ReadingBuffer<T> {
    pub(crate) readings: Vec<T>,
    /// How many have come, those that were taken out among them.
    count: usize,
    pub(crate) has_ended: bool,
    /// How many readings come in a second, if the sensor says so.
    pub(crate) rate: Option<f64>,
    /// Why there are none, or no more.
    pub(crate) refusal: Option<String>,
}

impl<T> Default for Readings<T> {
    fn default() -> Self {
        Self(Arc::new(Mutex::new(ReadingBuffer {
            readings: Vec::new(),
            count: 0,
            has_ended: false,
            rate: None,
            refusal: None,
        })))
    }
}

impl<T> Clone for Readings<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T: Reading> Readings<T> {
    /// Takes in readings. Returns false if there are enough.
    pub fn put(&self, readings: &[T], ctx: &Context) -> bool {
        let mut told = self.told();
        let room = T::MOST - told.readings.len();
        told.count += readings.len().min(room);
        told.readings.extend_from_slice(&readings[..readings.len().min(room)]);
        drop(told);
        ctx.request_repaint_after(std::time::Duration::from_millis(33));
        readings.len() <= room
    }

    /// Says how many readings come in a second.
    pub fn set_rate(&self, rate: f64) {
        self.told().rate = Some(rate);
    }

    pub fn count(&self) -> usize {
        self.told().count
    }

    pub fn end(&self, ctx: &Context) {
        self.told().has_ended = true;
        ctx.request_repaint();
    }

    /// Why there are none, or no more.
    pub fn refusal(&self) -> Option<String> {
        self.told().refusal.clone()
    }

    pub fn refuse(&self, reason: String, ctx: &Context) {
        self.told().refusal = Some(reason);
        ctx.request_repaint();
    }

    pub(crate) fn told(&self) -> MutexGuard<'_, ReadingBuffer<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
