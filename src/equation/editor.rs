//! The window in which the equation of the plant is edited.

use egui::{Context, FontId, Key, Pos2, RichText, ScrollArea, TextEdit, Ui, Window, vec2};
use kalmanscope_core::Scenario;
use kalmanscope_core::equation::{Equation, EquationSettings, Symbol};

use super::print::job;
use super::rows::{Done, row_ui};
use super::typed;
use crate::request::Request;
use crate::theme::Palette;

const LENGTH: usize = 1000;

/// The width of the window, if there is room \[points\].
const WIDTH: f32 = 760.0;

/// The distance of the window from the sides of the screen \[points\].
const MARGIN: f32 = 24.0;

/// The size of the typeset equation \[points\].
const LARGE: f32 = 19.0;

/// An equation that is being edited. The plant has it once it is complete: with Enter, or when a field is left.
pub(crate) struct Editor {
    /// The plant's equation. `None` while the plant is built in.
    taken: Option<EquationSettings>,
    draft: EquationSettings,
    symbols: Vec<Symbol>,
    printed: String,
    accepted: Vec<String>,
    fault: Option<String>,
    at: Option<Pos2>,
    is_new: bool,
}

impl Editor {
    pub(crate) fn new(scenario: &Scenario, at: Option<Pos2>) -> Self {
        let kind = scenario.plant.kind;
        Self {
            taken: kind.own_equation().map(|own| own.settings().clone()),
            draft: typed(kind),
            symbols: Vec::new(),
            printed: String::new(),
            accepted: Vec::new(),
            fault: None,
            at,
            is_new: true,
        }
    }

    pub(crate) fn ui(
        &mut self,
        ctx: &Context,
        scenario: &Scenario,
        palette: &Palette,
        requests: &mut Vec<Request>,
    ) -> bool {
        self.follow(scenario);
        let mut open = true;
        let room = ctx.content_rect().size();
        let width = (room.x - 2.0 * MARGIN).clamp(1.0, WIDTH);
        let mut window = Window::new("The plant's equation").collapsible(false).resizable(false).open(&mut open);
        if let Some(at) = self.at {
            window = window.default_pos(at + vec2(0.0, 12.0));
        }
        window.show(ctx, |ui| {
            ui.set_width(width);
            if self.contents_ui(ui, scenario, palette, 0.5 * room.y) {
                self.take(scenario, requests);
            }
        });
        open
    }

    fn follow(&mut self, scenario: &Scenario) {
        let now = scenario.plant.kind.own_equation().map(Equation::settings);
        if now != self.taken.as_ref() {
            let (at, is_new) = (self.at, self.is_new);
            *self = Self { is_new, ..Self::new(scenario, at) };
        }
    }

    fn contents_ui(&mut self, ui: &mut Ui, scenario: &Scenario, palette: &Palette, height: f32) -> bool {
        let symbols = self.draft.symbols();
        let problem = symbols.as_ref().err().map(ToString::to_string);
        if let Ok(symbols) = symbols {
            self.printed.clone_from(&self.draft.equation);
            self.symbols = symbols;
        }
        let color = if problem.is_some() { palette.weak } else { palette.text };
        let mut printed = job(&self.printed, &FontId::proportional(LARGE), color);
        printed.wrap.max_width = ui.available_width();
        ui.label(printed);
        let mut done = self.text_ui(ui);
        let news = self.news();
        let (said, color) = match (problem.or_else(|| self.fault.clone()), asked(&news)) {
            (Some(problem), _) => (problem, palette.warning),
            (None, Some(question)) => (question, palette.text),
            (None, None) => (HINT.to_owned(), palette.weak),
        };
        ui.label(RichText::new(said).small().color(color));
        ScrollArea::vertical().max_height(height).show(ui, |ui| done |= self.rows_ui(ui));
        let note = if scenario.record.is_some() {
            "Filters begin with the guesses. “Columns…” makes start values of them from the record."
        } else {
            "Filters begin with the guesses; ± is how sure they are of them."
        };
        ui.label(RichText::new(note).small().weak());
        done
    }

    fn text_ui(&mut self, ui: &mut Ui) -> bool {
        let text = &mut self.draft.equation;
        let field = TextEdit::multiline(text).desired_width(f32::INFINITY).desired_rows(2).char_limit(LENGTH);
        let field = ui.add(field.return_key(None));
        field.ctx.accesskit_node_builder(field.id, |node| node.set_label("Equation of motion"));
        if std::mem::take(&mut self.is_new) {
            field.request_focus();
        }
        if field.changed() {
            self.fault = None;
        }
        field.lost_focus() || field.has_focus() && ui.input(|input| input.key_pressed(Key::Enter))
    }

    fn rows_ui(&mut self, ui: &mut Ui) -> bool {
        let news = self.news();
        let mut done = false;
        for symbol in &self.symbols {
            let is_new = news.contains(&symbol.shown);
            let Done { changed, accepted } = row_ui(ui, symbol, &mut self.draft, is_new);
            if accepted {
                self.accepted.push(symbol.key.clone());
            }
            done |= changed || accepted;
        }
        done
    }

    fn news(&self) -> Vec<String> {
        let before = self.taken.as_ref().and_then(|taken| taken.symbols().ok()).unwrap_or_default();
        let is_new = |symbol: &&Symbol| {
            symbol.is_parameter
                && symbol.known.is_none()
                && !self.accepted.contains(&symbol.key)
                && !before.iter().any(|one| one.key == symbol.key)
        };
        self.symbols.iter().filter(is_new).map(|symbol| symbol.shown.clone()).collect()
    }

    /// Makes the draft the plant's equation, if it is one without new symbols.
    fn take(&mut self, scenario: &Scenario, requests: &mut Vec<Request>) {
        let draft = EquationSettings { equation: self.draft.equation.trim().to_owned(), ..self.draft.clone() };
        // Drops the numbers of parameters that the equation no longer has.
        let Ok(kept) = draft.checked() else { return };
        if self.taken.as_ref() == Some(&kept) || !self.news().is_empty() {
            return;
        }
        let mut changed = scenario.clone();
        match changed.set_equation(&kept) {
            Ok(()) => {
                (self.taken, self.fault) = (Some(kept), None);
                requests.extend(Request::edit(scenario, &changed));
            }
            Err(error) => self.fault = Some(error.to_string()),
        }
    }
}

const HINT: &str = "x'' or ẍ; z' = … is an internal state; f is the force over mass; sin cos tan exp log sqrt abs sign tanh; \
                    ; parts equations. Enter takes it.";

fn asked(news: &[String]) -> Option<String> {
    match news {
        [] => None,
        [one] => Some(format!("{one} is new: make it a parameter below, or mend the equation")),
        [others @ .., last] => {
            let others = others.join(", ");
            Some(format!("{others} and {last} are new: make each a parameter below, or mend the equation"))
        }
    }
}
