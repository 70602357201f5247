//! The window in which the equation of the plant is edited.

use egui::{Button, ComboBox, Context, DragValue, FontId, Key, Pos2, RichText, ScrollArea, TextEdit, Ui, Window, vec2};
use kalmanscope_core::channel::Sign;
use kalmanscope_core::equation::{Equation, EquationSettings, Numbers, ParameterSettings, Symbol};
use kalmanscope_core::setting::Change;
use kalmanscope_core::{PlantKind, Scenario};

use super::{job, typed};
use crate::request::Request;
use crate::text::{parse, significant};
use crate::theme::Palette;
use crate::widgets::named;

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
        let kind = &scenario.plant.kind;
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
                self.take(requests);
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
        let field = named(ui.add(field.return_key(None)), "Equation of motion");
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
    fn take(&mut self, requests: &mut Vec<Request>) {
        let draft = EquationSettings { equation: self.draft.equation.trim().to_owned(), ..self.draft.clone() };
        // Drops the numbers of parameters that the equation no longer has.
        let Ok(kept) = draft.checked() else { return };
        if self.taken.as_ref() == Some(&kept) || !self.news().is_empty() {
            return;
        }
        match PlantKind::of_equation(&kept) {
            Ok(kind) => {
                (self.taken, self.fault) = (Some(kept), None);
                let mut change = Change::default();
                change.set_plant(kind);
                requests.push(Request::Edit(change));
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

/// The widths of symbols, names, units, numbers and signs \[points\].
const WIDTHS: [f32; 5] = [40.0, 130.0, 56.0, 58.0, 110.0];

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Done {
    pub(super) changed: bool,
    pub(super) accepted: bool,
}

pub(super) fn row_ui(ui: &mut Ui, symbol: &Symbol, settings: &mut EquationSettings, is_new: bool) -> Done {
    let shown = &symbol.shown;
    let mut done = Done::default();
    ui.horizontal_wrapped(|ui| {
        let height = ui.spacing().interact_size.y;
        let text = RichText::new(shown).size(15.0).strong();
        ui.add_sized(vec2(WIDTHS[0], height), egui::Label::new(text)).on_hover_text(&symbol.key);
        if let Some(channel) = symbol.known {
            let unit = Some(channel.unit()).filter(|unit| !unit.is_empty()).map(|unit| format!(" in {unit}"));
            ui.weak(format!("{}{}, as in all plants", channel.name(), unit.unwrap_or_default()));
            return;
        }
        let usual = ParameterSettings::default();
        let before = settings.parameter(&symbol.key).unwrap_or(&usual);
        let mut now = before.clone();
        if is_new {
            done.accepted = offer_ui(ui, shown, height);
        } else {
            done.changed = words_ui(ui, symbol, &mut now);
        }
        done.changed |= numbers_ui(ui, symbol, &mut now);
        let is_touched = now != *before;
        if is_touched || done.accepted {
            let one = settings.parameter_mut(&symbol.key);
            *one = now;
            if done.accepted {
                // A file then names it.
                one.guess.get_or_insert(1.0);
            }
        }
    });
    done
}

/// The button that makes a new symbol a parameter, in the place of name and unit. Returns whether it was clicked.
fn offer_ui(ui: &mut Ui, shown: &str, height: f32) -> bool {
    let width = WIDTHS[1] + WIDTHS[2] + ui.spacing().item_spacing.x;
    let button = ui.add_sized(vec2(width, height), Button::new("Make it a parameter"));
    let button = named(button, format!("Make {shown} a parameter"));
    button.clicked()
}

fn words_ui(ui: &mut Ui, symbol: &Symbol, one: &mut ParameterSettings) -> bool {
    let Symbol { shown, is_parameter, .. } = symbol;
    let mut name = one.name.clone().unwrap_or_default();
    let usual = if *is_parameter { "name" } else { "internal state" };
    let done = word_ui(ui, &mut name, usual, WIDTHS[1], format!("Name of {shown}"));
    one.name = Some(name).filter(|name| !name.is_empty());
    done | word_ui(ui, &mut one.unit, "unit", WIDTHS[2], format!("Unit of {shown}"))
}

fn numbers_ui(ui: &mut Ui, symbol: &Symbol, one: &mut ParameterSettings) -> bool {
    let Symbol { shown, is_parameter, .. } = symbol;
    let Numbers { mut mean, mut std, range: [mut low, mut high] } = one.numbers(*is_parameter);
    let mut done = false;
    let mut number = |ui: &mut Ui, word: &str, name: String, value: &mut f64| {
        ui.weak(word);
        let before = *value;
        done |= number_ui(ui, value, name);
        *value != before
    };
    if number(ui, "guess", format!("Guess of {shown}"), &mut mean) {
        one.guess = Some(mean);
    }
    if number(ui, "±", format!("σ of the guess of {shown}"), &mut std) {
        one.std = Some(std.max(0.0));
    }
    if *is_parameter {
        let from = number(ui, "from", format!("Least {shown}"), &mut low);
        if number(ui, "to", format!("Largest {shown}"), &mut high) | from {
            one.range = Some([low, high]);
        }
        done |= sign_ui(ui, &mut one.sign, shown);
    }
    done
}

fn word_ui(ui: &mut Ui, word: &mut String, hint: &str, width: f32, name: String) -> bool {
    let field = named(ui.add(TextEdit::singleline(word).hint_text(hint).desired_width(width).char_limit(40)), name);
    field.lost_focus()
}

/// A number. Returns whether its change is complete: not while it is dragged.
fn number_ui(ui: &mut Ui, value: &mut f64, name: String) -> bool {
    let speed = 0.01 * value.abs().max(0.1);
    let field = DragValue::new(value)
        .speed(speed)
        .custom_formatter(|x, _| significant(x, 5))
        .custom_parser(parse)
        .update_while_editing(false);
    let response = named(ui.add_sized(vec2(WIDTHS[3], ui.spacing().interact_size.y), field), name);
    let is_at_once = response.changed() && !response.dragged() && !response.has_focus();
    response.drag_stopped() || response.lost_focus() || is_at_once
}

fn sign_ui(ui: &mut Ui, sign: &mut Sign, shown: &str) -> bool {
    let before = *sign;
    let words = [(Sign::Any, "any sign"), (Sign::NotNegative, "not negative"), (Sign::Positive, "positive")];
    let text = words.iter().find(|(one, _)| one == sign).map_or("", |(_, word)| word);
    let combo = ComboBox::from_id_salt(("sign", shown)).selected_text(text).width(WIDTHS[4]).show_ui(ui, |ui| {
        for (one, word) in words {
            ui.selectable_value(sign, one, word);
        }
    });
    named(combo.response, format!("Sign of {shown}"));
    *sign != before
}
