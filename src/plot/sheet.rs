//! The numbers of one plot over time, as text: for the heading of its chart, and for tables.

use egui::Color32;

use super::heading::Readout;
use crate::text::fixed;

pub struct Sheet<'a> {
    pub title: String,
    pub unit: &'static str,
    pub columns: Vec<SheetColumn<'a>>,
}

pub struct SheetColumn<'a> {
    pub owner: String,
    color: Color32,
    text: Box<dyn Fn(usize) -> Option<String> + 'a>,
    aside: Option<Box<dyn Fn(usize) -> Option<String> + 'a>>,
}

impl<'a> SheetColumn<'a> {
    pub(crate) fn new(owner: &str, color: Color32, text: impl Fn(usize) -> Option<String> + 'a) -> Self {
        Self { owner: owner.to_owned(), color, text: Box::new(text), aside: None }
    }

    pub(crate) fn with_aside(self, aside: impl Fn(usize) -> Option<String> + 'a) -> Self {
        Self { aside: Some(Box::new(aside)), ..self }
    }

    pub fn text(&self, k: usize) -> Option<String> {
        (self.text)(k)
    }

    pub fn aside(&self, k: usize) -> Option<String> {
        self.aside.as_ref()?(k)
    }
}

pub(crate) fn plus_minus(mean: f64, std: f64, decimals: usize) -> String {
    format!("{} ±{}", fixed(mean, decimals), fixed(2.0 * std, decimals))
}

pub(crate) fn readouts(columns: &[SheetColumn<'_>], k: usize) -> Vec<Readout> {
    let readout = |column: &SheetColumn<'_>| {
        let readout = Readout::new(column.text(k)?, column.color, column.owner.clone());
        Some(Readout { aside: column.aside(k), ..readout })
    };
    columns.iter().filter_map(readout).collect()
}
