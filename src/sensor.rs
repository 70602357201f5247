//! The sensors of this device, if it has some: an accelerometer, a microphone, a source of lines.

use std::rc::Rc;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use egui::Context;
use kalmanscope_core::Scenario;
use kalmanscope_sources::StreamRow;

pub trait SensorDevice<T> {
    fn begin(&self, ctx: &Context, to: &ReadingQueue<T>);

    fn end(&self);

    fn hint(&self) -> String;
}

pub trait SensorReading: Clone {
    const MOST: usize;
}

/// Time \[s\] and three accelerations along the device's axes, with gravity \[m/s²\].
pub type Acceleration = [f64; 4];

impl SensorReading for Acceleration {
    /// Limits the readings to ten minutes at 200 per second.
    const MOST: usize = 120_000;
}

/// A sample of a sound, as a share of the microphone's loudest one.
pub type Sound = f32;

impl SensorReading for Sound {
    /// Limits the samples to one minute at 48,000 per second.
    const MOST: usize = 2_880_000;
}

impl SensorReading for StreamRow {
    /// Limits the readings that wait in the buffer.
    const MOST: usize = 1_000_000;
}

#[derive(Clone, Default)]
pub struct Sensors {
    pub accelerometer: Option<Rc<dyn SensorDevice<Acceleration>>>,
    pub microphone: Option<Rc<dyn SensorDevice<Sound>>>,
    pub stream: Option<(Rc<dyn SensorDevice<StreamRow>>, Rc<Scenario>)>,
}

impl Sensors {
    pub(crate) fn is_empty(&self) -> bool {
        let Self { accelerometer, microphone, stream } = self;
        accelerometer.is_none() && microphone.is_none() && stream.is_none()
    }
}

pub struct ReadingQueue<T>(Arc<Mutex<ReadingBuffer<T>>>);

pub(crate) struct ReadingBuffer<T> {
    pub(crate) readings: Vec<T>,
    // Not the length of `readings`, which a stream takes out.
    count: usize,
    pub(crate) has_ended: bool,
    pub(crate) rate: Option<f64>,
    pub(crate) refusal: Option<String>,
}

impl<T> Default for ReadingQueue<T> {
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

impl<T> Clone for ReadingQueue<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T: SensorReading> ReadingQueue<T> {
    pub fn put(&self, readings: &[T], ctx: &Context) -> bool {
        let mut told = self.readings();
        let room = T::MOST - told.readings.len();
        told.count += readings.len().min(room);
        told.readings.extend_from_slice(&readings[..readings.len().min(room)]);
        drop(told);
        // Thirty frames a second are enough to watch a sensor that sends hundreds of readings.
        ctx.request_repaint_after(std::time::Duration::from_millis(33));
        readings.len() <= room
    }

    pub fn set_rate(&self, rate: f64) {
        self.readings().rate = Some(rate);
    }

    pub fn count(&self) -> usize {
        self.readings().count
    }

    pub fn end(&self, ctx: &Context) {
        self.readings().has_ended = true;
        ctx.request_repaint();
    }

    pub fn refusal(&self) -> Option<String> {
        self.readings().refusal.clone()
    }

    pub fn refuse(&self, reason: String, ctx: &Context) {
        self.readings().refusal = Some(reason);
        ctx.request_repaint();
    }

    pub(crate) fn readings(&self) -> MutexGuard<'_, ReadingBuffer<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
