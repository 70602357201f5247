//! The window in which the equation of the plant is edited.

use std::collections::BTreeMap;

use egui::{Align2, Context, DragValue, FontId, Key, Popup, RichText, ScrollArea, TextEdit, Ui, Window, vec2};
use kalmanscope_core::equation::{Equation, EquationSettings, Numbers, ParameterSettings, Symbol};
use kalmanscope_core::setting::Change;
use kalmanscope_core::{PlantKind, Scenario, Signal};

use super::similar::{no_function, similar_name};
use super::{job, typed};
use crate::request::Request;
use crate::text::{parse, significant};
use crate::theme::Palette;
use crate::widgets::{named, primary};

const LENGTH: usize = 1000;

const WIDTH: f32 = 640.0;

const MARGIN: f32 = 24.0;

const LARGE: f32 = 19.0;

/// Truth and guess of a new parameter: apart, so that there is something to find.
const NEW: [f64; 2] = [1.0, 1.3];

pub(crate) struct Editor {
    taken: Option<EquationSettings>,
    draft: EquationSettings,
    symbols: Vec<Symbol>,
    truths: BTreeMap<String, f64>,
    printed: String,
    fault: Option<String>,
    is_new: bool,
}

impl Editor {
    pub(crate) fn new(scenario: &Scenario) -> Self {
        let kind = &scenario.plant.kind;
        Self {
            taken: kind.own_equation().map(|own| own.settings().clone()),
            draft: typed(kind),
            symbols: Vec::new(),
            truths: BTreeMap::new(),
            printed: String::new(),
            fault: None,
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
        let window = Window::new("The plant's equation").collapsible(false).resizable(false).open(&mut open);
        window.pivot(Align2::CENTER_CENTER).default_pos(ctx.content_rect().center()).show(ctx, |ui| {
            ui.set_width(width);
            self.contents_ui(ui, scenario, palette, (0.5 * room.y, requests));
        });
        open
    }

    fn follow(&mut self, scenario: &Scenario) {
        // Undo or a link may have brought another equation, of which the draft knows nothing.
        let now = scenario.plant.kind.own_equation().map(Equation::settings);
        if now != self.taken.as_ref() {
            *self = Self { is_new: self.is_new, ..Self::new(scenario) };
        }
    }

    fn contents_ui(
        &mut self,
        ui: &mut Ui,
        scenario: &Scenario,
        palette: &Palette,
        (height, requests): (f32, &mut Vec<Request>),
    ) {
        let symbols = self.draft.symbols();
        let problem = symbols.as_ref().err().map(ToString::to_string).or_else(|| no_function(&self.draft.equation));
        if let Ok(symbols) = symbols {
            self.printed.clone_from(&self.draft.equation);
            self.symbols = symbols;
            self.begin_new(scenario);
        }
        let color = if problem.is_some() { palette.weak } else { palette.text };
        let mut printed = job(&self.printed, &FontId::proportional(LARGE), color);
        printed.wrap.max_width = ui.available_width();
        ui.label(printed);
        let is_entered = self.text_ui(ui);
        let hint = similar_name(&self.draft.equation).unwrap_or_else(|| HINT.to_owned());
        ui.label(RichText::new(hint).small().color(palette.weak));
        let is_in_use = self.taken.as_ref().is_some_and(|taken| taken.equation == self.draft.equation.trim());
        let scroll = ScrollArea::vertical().max_height(height);
        let changed = scroll.show(ui, |ui| self.rows_ui(ui, scenario, is_in_use, requests)).inner;
        ui.weak("Filters begin with the guesses; ± is how sure they are of them.");
        self.fault = self.fault.take().filter(|_| !changed);
        let reason = problem.or_else(|| self.fault.clone());
        let is_usable = reason.is_none() && !is_in_use;
        let is_clicked = ui.horizontal_wrapped(|ui| {
            let button = ui.add_enabled(is_usable, primary("Use it", palette));
            match reason {
                Some(reason) => _ = ui.colored_label(palette.warning, reason),
                None if is_in_use => _ = ui.weak("It is in use."),
                None => {}
            }
            button.clicked()
        });
        let is_pressed = is_entered && is_usable || is_clicked.inner;
        if is_pressed || changed && is_in_use {
            self.take(scenario, requests);
        }
    }

    fn begin_new(&mut self, scenario: &Scenario) {
        let before = self.taken.as_ref().and_then(|taken| taken.symbols().ok()).unwrap_or_default();
        let is_new = |symbol: &&Symbol| symbol.is_parameter && symbol.known.is_none() && !before.contains(symbol);
        for symbol in self.symbols.iter().filter(is_new) {
            self.truths.entry(symbol.key.clone()).or_insert(NEW[0]);
            // Nobody knows the truth of a measured record.
            let guess = NEW[usize::from(scenario.record.is_none())];
            self.draft.parameter_mut(&symbol.key).guess.get_or_insert(guess);
        }
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
        let is_free = ui.memory(|memory| memory.focused().is_none()) && !Popup::is_any_open(ui.ctx());
        (field.has_focus() || is_free) && ui.input(|input| input.key_pressed(Key::Enter))
    }

    fn rows_ui(&mut self, ui: &mut Ui, scenario: &Scenario, is_in_use: bool, requests: &mut Vec<Request>) -> bool {
        let mut changed = false;
        for symbol in &self.symbols {
            let mut truth = self.truth(scenario, symbol);
            let before = truth;
            changed |= row_ui(ui, symbol, &mut self.draft, &mut truth);
            let Some(now) = truth.filter(|_| truth != before) else { continue };
            self.truths.insert(symbol.key.clone(), now);
            if is_in_use {
                let mut change = Change::default();
                change.put(format!("plant.{}", symbol.key), &now);
                requests.push(Request::Edit(change));
            }
        }
        changed
    }

    fn truth(&self, scenario: &Scenario, symbol: &Symbol) -> Option<f64> {
        if scenario.record.is_some() || !symbol.is_parameter {
            return None;
        }
        match scenario.plant.parameters().find(|channel| channel.key() == symbol.key) {
            None => self.truths.get(&symbol.key).copied(),
            Some(channel) => match scenario.plant.parameter(channel)? {
                Signal::Constant(value) => Some(value),
                _ => None,
            },
        }
    }

    fn take(&mut self, scenario: &Scenario, requests: &mut Vec<Request>) {
        let draft = EquationSettings { equation: self.draft.equation.trim().to_owned(), ..self.draft.clone() };
        // Drops the numbers of parameters that the equation no longer has.
        let Ok(kept) = draft.checked() else { return };
        match PlantKind::of_equation(&kept) {
            Ok(kind) => {
                let mut change = Change::default();
                change.set_plant(kind);
                let is_there = |key: &str| scenario.plant.parameters().any(|channel| channel.key() == key);
                let news = self.symbols.iter().filter(|symbol| symbol.known.is_none() && !is_there(&symbol.key));
                for (symbol, truth) in news.filter_map(|symbol| Some((symbol, self.truths.get(&symbol.key)?))) {
                    change.put(format!("plant.{}", symbol.key), truth);
                }
                self.draft.equation.clone_from(&kept.equation);
                (self.taken, self.fault) = (Some(kept), None);
                requests.push(Request::Edit(change));
            }
            Err(error) => self.fault = Some(error.to_string()),
        }
    }
}

const HINT: &str = "x'' or ẍ; z' = … is an internal state; f is the force over mass; sin cos tan exp log sqrt abs sign tanh; \
                    ; parts equations.";

const WIDTHS: [f32; 4] = [40.0, 160.0, 64.0, 70.0];

fn row_ui(ui: &mut Ui, symbol: &Symbol, settings: &mut EquationSettings, truth: &mut Option<f64>) -> bool {
    let mut changed = false;
    ui.horizontal_wrapped(|ui| {
        let height = ui.spacing().interact_size.y;
        let text = RichText::new(&symbol.shown).size(15.0).strong();
        ui.add_sized(vec2(WIDTHS[0], height), egui::Label::new(text)).on_hover_text(&symbol.key);
        if let Some(channel) = symbol.known {
            let unit = Some(channel.unit()).filter(|unit| !unit.is_empty()).map(|unit| format!(" in {unit}"));
            ui.weak(format!("{}{}, as in all plants", channel.name(), unit.unwrap_or_default()));
            return;
        }
        let usual = ParameterSettings::default();
        let before = settings.parameter(&symbol.key).unwrap_or(&usual);
        let mut now = before.clone();
        changed = words_ui(ui, symbol, &mut now);
        if let Some(truth) = truth {
            ui.weak("truth");
            number_ui(ui, truth, format!("Truth of {}", symbol.shown));
        }
        changed |= numbers_ui(ui, symbol, &mut now);
        if now != *before {
            *settings.parameter_mut(&symbol.key) = now;
        }
    });
    changed
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
    let Numbers { mut mean, mut std, .. } = one.numbers(*is_parameter);
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
    done
}

fn word_ui(ui: &mut Ui, word: &mut String, hint: &str, width: f32, name: String) -> bool {
    let field = named(ui.add(TextEdit::singleline(word).hint_text(hint).desired_width(width).char_limit(40)), name);
    field.lost_focus()
}

fn number_ui(ui: &mut Ui, value: &mut f64, name: String) -> bool {
    let speed = 0.01 * value.abs().max(0.1);
    let field = DragValue::new(value)
        .speed(speed)
        .custom_formatter(|x, _| significant(x, 5))
        .custom_parser(parse)
        .update_while_editing(false);
    let response = named(ui.add_sized(vec2(WIDTHS[3], ui.spacing().interact_size.y), field), name);
    // Each change makes the plant again, so a number counts when the hand or the keyboard leaves it.
    let is_at_once = response.changed() && !response.dragged() && !response.has_focus();
    response.drag_stopped() || response.lost_focus() || is_at_once
}
