//! The numbers of one plot over time, as text: for the heading of its chart, and for tables.

use egui::Color32;

use crate::plot::heading::Readout;

pub struct Sheet<'a> {
    pub title: String,
    /// The unit of its numbers, or nothing.
    pub unit: &'static str,
    pub columns: Vec<Column<'a>>,
}

/// The numbers of the truth, or of one filter.
pub struct Column<'a> {
    pub owner: String,
    color: Color32,
    text: Box<dyn Fn(usize) -> Option<String> + 'a>,
    aside: Option<Box<dyn Fn(usize) -> Option<String> + 'a>>,
}

impl<'a> Column<'a> {
    /// `text` gives the text of a sample's number, if it has one.
    pub(crate) fn new(owner: &str, color: Color32, text: impl Fn(usize) -> Option<String> + 'a) -> Self {
        Self { owner: owner.to_owned(), color, text: Box::new(text), aside: None }
    }

    /// `aside` gives the text of the same number in another unit, if there is one.
    pub(crate) fn with_aside(self, aside: impl Fn(usize) -> Option<String> + 'a) -> Self {
        Self { aside: Some(Box::new(aside)), ..self }
    }

    /// The text of the number at a sample, if it has one.
    pub fn text(&self, k: usize) -> Option<String> {
        (self.text)(k)
    }

    /// The text of the same number in another unit, if it has one.
    pub fn aside(&self, k: usize) -> Option<String> {
        self.aside.as_ref()?(k)
    }
}

/// The numbers at a sample, for the heading of a chart.
pub(crate) fn readouts(columns: &[Column<'_>], k: usize) -> Vec<Readout> {
    let readout = |column: &Column<'_>| {
        let readout = Readout::new(column.text(k)?, column.color, column.owner.clone());
        Some(Readout { aside: column.aside(k), ..readout })
    };
    columns.iter().filter_map(readout).collect()
}
