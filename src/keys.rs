//! The keyboard: a table of all keys and their requests, which is also the list on screen.

use egui::{Grid, Key, Modifiers, RichText, Ui};

use crate::comparison;
use crate::request::{LegendEntry, Request};
use crate::ruler::End;
use crate::session::{Mode, Session};
use crate::theme;

/// A key and its request.
struct Shortcut {
    /// The label on the keyboard.
    name: &'static str,
    what: &'static str,
    keys: &'static [Key],
    modifiers: Modifiers,
    request: fn(&Session) -> Request,
}

/// A key that is pressed alone, or with the modifiers that its character needs.
const fn plain(
    name: &'static str,
    what: &'static str,
    keys: &'static [Key],
    request: fn(&Session) -> Request,
) -> Shortcut {
    Shortcut { name, what, keys, modifiers: Modifiers::NONE, request }
}

const SHORTCUTS: &[Shortcut] = &[
    plain("Space", "play or pause", &[Key::Space], |_| Request::TogglePlay),
    plain("→", "one sample forward", &[Key::ArrowRight], |_| Request::Step),
    plain("←", "one sample back", &[Key::ArrowLeft], |_| Request::StepBack),
    plain("R", "back to the start", &[Key::R, Key::Home], |_| Request::Restart),
    plain("L", "live, or the whole record", &[Key::L], |session| {
        Request::SetMode(if session.mode() == Mode::Live { Mode::Whole } else { Mode::Live })
    }),
    plain("+", "faster", &[Key::Plus, Key::Equals], |session| Request::SetSpeed(session.next_speed(true))),
    plain("−", "slower", &[Key::Minus], |session| Request::SetSpeed(session.next_speed(false))),
    plain("A", "mark the time that is shown as A, or take A away", &[Key::A], |_| Request::ToggleMark(End::A)),
    plain("B", "the same for B", &[Key::B], |_| Request::ToggleMark(End::B)),
    plain("X", "the other of two settings, A and B", &[Key::X], |_| Request::SwapSettings),
    plain("H", "the input held, or linear between samples", &[Key::H], |session| {
        Request::Edit(Box::new(comparison::with_other_hold(session.scenario())))
    }),
    plain("G", "the gain of the input estimated, or known", &[Key::G], |session| {
        Request::Edit(Box::new(comparison::with_other_gain(session.scenario())))
    }),
    plain("C", "copy a link to this picture", &[Key::C], |_| Request::CopyLink),
    Shortcut {
        name: "Ctrl+O",
        what: "open a file: a record, a scenario, a lesson or a session",
        keys: &[Key::O],
        modifiers: Modifiers::COMMAND,
        request: |_| Request::ChooseFile,
    },
    plain("S", "show or hide the settings", &[Key::S], |_| Request::ToggleControls),
    plain("P", "presenter mode: large type", &[Key::P], |_| Request::TogglePresenter),
    plain("Page down", "the next view alone, then all", &[Key::PageDown], |_| Request::TurnView(true)),
    plain("Page up", "the view before", &[Key::PageUp], |_| Request::TurnView(false)),
    plain("E", "export: figures and files", &[Key::E], |_| Request::ToggleExports),
    plain("?", "this list", &[Key::Questionmark], |_| Request::ToggleKeys),
    plain("Esc", "leave this list, stop computing, or leave an enlarged view", &[Key::Escape], |_| Request::Leave),
    Shortcut {
        name: "Ctrl+Shift+Z",
        what: "make the change again",
        keys: &[Key::Z],
        modifiers: Modifiers::COMMAND.plus(Modifiers::SHIFT),
        request: |_| Request::Redo,
    },
    Shortcut {
        name: "Ctrl+Z",
        what: "take back the last change of a setting",
        keys: &[Key::Z],
        modifiers: Modifiers::COMMAND,
        request: |_| Request::Undo,
    },
];

/// The keys that show and hide the filters, in their order.
const DIGITS: [Key; 6] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];

/// Gestures, which the plots handle themselves.
const GESTURES: &[(&str, &str)] = &[
    ("1 to 6", "show or hide a filter"),
    ("Click in a plot", "go to that time"),
    ("Shift and click in a plot", "mark A, then B: values and what lies between"),
    ("Drag in a plot", "zoom in"),
    ("Right drag in a plot", "move it"),
    ("Double click in a plot", "all of it again"),
    ("Click on a plot's symbol", "that plot alone, or all again"),
    ("Double click on a number", "back to what it was"),
    ("Alt and wheel on a number", "turn it"),
];

/// Pushes the requests of the pressed keys, except while the user types text.
pub(crate) fn keys(ctx: &egui::Context, session: &Session, requests: &mut Vec<Request>) {
    if ctx.text_edit_focused() {
        return;
    }
    // Space presses the button that has the focus, and arrows move a slider.
    let has_focus = ctx.memory(|memory| memory.focused().is_some());
    let is_taken = |keys: &[Key]| {
        has_focus && keys.iter().any(|key| matches!(key, Key::Space | Key::ArrowLeft | Key::ArrowRight | Key::Escape))
    };
    ctx.input_mut(|input| {
        for Shortcut { keys, modifiers, request, .. } in SHORTCUTS.iter().filter(|shortcut| !is_taken(shortcut.keys)) {
            let alone = !input.modifiers.command && !input.modifiers.alt;
            let pressed = keys.iter().any(|&key| {
                if modifiers.is_none() { alone && input.key_pressed(key) } else { input.consume_key(*modifiers, key) }
            });
            if pressed {
                requests.push(request(session));
            }
        }
        for (&key, filter) in DIGITS.iter().zip(&session.scenario().filters) {
            if input.modifiers.is_none() && input.key_pressed(key) {
                requests.push(Request::ToggleEntry(LegendEntry::Filter(filter.id)));
            }
        }
    });
}

/// The list of all keys.
pub(crate) fn list_ui(ui: &mut Ui) {
    Grid::new("keys").num_columns(2).spacing([18.0, 5.0]).show(ui, |ui| {
        let keys = SHORTCUTS.iter().map(|shortcut| (shortcut.name, shortcut.what));
        for (name, what) in keys.chain(GESTURES.iter().copied()) {
            ui.label(RichText::new(name).family(theme::strong()));
            ui.label(what);
            ui.end_row();
        }
    });
}
