//! Failures of the device that no call returns.

use std::sync::{Arc, Mutex, PoisonError};

use crate::error::GpuError;

/// The first failure that the device has reported, outside of any call.
#[derive(Clone, Default)]
pub(crate) struct Trouble(Arc<Mutex<Option<String>>>);

impl Trouble {
    pub(crate) fn report(&self, text: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
    }

    /// # Errors
    /// [`GpuError::Failed`] where the device has reported a failure.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        match &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(text) => Err(GpuError::Failed(text.clone())),
            None => Ok(()),
        }
    }
}
