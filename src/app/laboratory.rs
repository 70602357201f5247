//! The laboratory beside the session.

use std::rc::Rc;

use egui::Context;
use kalmanscope_core::Estimates;

use super::App;
use super::window::NARROW;
use crate::laboratory::Laboratory;
use crate::request::ViewKind;
use crate::team::Team;
use crate::views::view;

impl App {
    #[must_use]
    pub fn working_with(mut self, team: Rc<dyn Team>) -> Self {
        self.laboratory.work_with(Rc::clone(&team));
        self.session.work_with(team);
        self
    }

    pub fn laboratory(&self) -> &Laboratory {
        &self.laboratory
    }

    pub fn laboratory_mut(&mut self) -> &mut Laboratory {
        &mut self.laboratory
    }

    pub(super) fn follow_laboratory(&mut self, ctx: &Context) {
        let is_in_sight = self.layout.in_sight().iter().any(|kind| view(*kind).is_of_laboratory);
        self.laboratory.follow(&self.session, is_in_sight, self.width < NARROW, ctx);
        let filters = self.session.run().estimates().iter().map(Estimates::id);
        let filters: Vec<u32> = filters.filter(|id| self.visible.filter(*id)).collect();
        let is_in_sight = self.layout.in_sight().contains(&ViewKind::MonteCarlo);
        self.laboratory.follow_seeds(&self.session, &filters, is_in_sight, ctx);
        let is_in_sight = self.layout.in_sight().contains(&ViewKind::Tune);
        self.laboratory.follow_tuning(&self.session, is_in_sight, ctx);
        let is_in_sight = self.layout.in_sight().contains(&ViewKind::ParameterPlane);
        self.laboratory.follow_posterior(&self.session, is_in_sight, ctx);
    }
}
