//! The laboratory beside the session.

use std::rc::Rc;

use egui::Context;
use kalmanscope_core::Estimates;

use super::App;
use super::window::NARROW;
use crate::elsewhere::Elsewhere;
use crate::laboratory::{Engine, Laboratory};
use crate::request::ViewKind;
use crate::views::view;

impl App {
    /// The explorer with an engine for its laboratory, in place of slices of the frames.
    #[must_use]
    pub fn computing_with(self, engine: Box<dyn Engine>) -> Self {
        let mut laboratory = Laboratory::new(engine);
        laboratory.restore(self.laboratory.choices());
        Self { laboratory, ..self }
    }

    /// The explorer with a computer for long filters and imports, in place of slices of the frames.
    #[must_use]
    pub fn working_with(mut self, computer: Rc<dyn Elsewhere>) -> Self {
        self.session.compute_elsewhere(computer);
        self
    }

    /// The maps.
    pub fn laboratory(&self) -> &Laboratory {
        &self.laboratory
    }

    /// The maps, for tests to set up.
    pub fn laboratory_mut(&mut self) -> &mut Laboratory {
        &mut self.laboratory
    }

    /// Maps follow the session while they are on screen.
    pub(super) fn follow_laboratory(&mut self, ctx: &Context) {
        let is_in_sight = self.layout.in_sight().iter().any(|kind| view(*kind).is_of_laboratory());
        self.laboratory.follow(&self.session, is_in_sight, self.width < NARROW, ctx);
        let filters = self.session.run().estimates().iter().map(Estimates::id);
        let filters: Vec<u32> = filters.filter(|id| self.visible.filter(*id)).collect();
        let is_in_sight = self.layout.in_sight().contains(&ViewKind::MonteCarlo);
        self.laboratory.follow_seeds(&self.session, &filters, is_in_sight, ctx);
        let is_in_sight = self.layout.in_sight().contains(&ViewKind::Tune);
        self.laboratory.follow_tuning(&self.session, is_in_sight, ctx);
    }
}
