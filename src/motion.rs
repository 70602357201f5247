//! The accelerometer of this device, if it has one.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use egui::Context;

/// Limits the readings of one measurement: ten minutes of 200 a second.
pub const MOST: usize = 120_000;

/// The accelerometer of a device.
pub trait Accelerometer {
    /// Begins to tell readings. They come later, or the reason why there are none.
    fn begin(&self, ctx: &Context, to: &Readings);

    /// Stops.
    fn end(&self);
}

/// What an accelerometer tells; copies share it.
#[derive(Clone, Default)]
pub struct Readings(Arc<Mutex<Told>>);

/// What was told so far.
#[derive(Default)]
pub(crate) struct Told {
    /// Time \[s\] and three accelerations with gravity \[m/s²\].
    pub(crate) readings: Vec<[f64; 4]>,
    /// Why there are none, or no more.
    pub(crate) refusal: Option<String>,
}

impl Readings {
    /// Takes in a reading: its time \[s\], and the accelerations along the device's axes with gravity \[m/s²\]. Returns false if
    /// there are enough.
    pub fn put(&self, reading: [f64; 4], ctx: &Context) -> bool {
        let mut told = self.told();
        if told.readings.len() >= MOST {
            return false;
        }
        told.readings.push(reading);
        drop(told);
        ctx.request_repaint_after(std::time::Duration::from_millis(33));
        true
    }

    /// Says why there are no readings.
    pub fn refuse(&self, reason: String, ctx: &Context) {
        self.told().refusal = Some(reason);
        ctx.request_repaint();
    }

    pub(crate) fn told(&self) -> MutexGuard<'_, Told> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
