//! The source of an imported record: a table that is shared with the window, and the choices in it.

use std::borrow::Borrow;
use std::sync::Arc;

use kalmanscope_core::import::{Mapping, Table};
use kalmanscope_core::{Hold, InputKind};

use crate::session::RecordFile;

pub(super) type Choices = (Mapping, InputKind, Hold);

#[derive(Clone, Debug)]
pub(super) struct Shared(pub(super) Arc<RecordFile>);

impl Borrow<Table> for Shared {
    fn borrow(&self) -> &Table {
        &self.0.table
    }
}
