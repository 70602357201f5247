//! What survives a restart.

use egui::{Context, ThemePreference};
use serde::{Deserialize, Serialize};

use crate::layout::Layout;
use crate::session::{Mode, Session};

/// Where it is kept.
pub(crate) const KEY: &str = "kalmanscope";

/// What survives a restart, as JSON. What cannot be read any more is the default, each part on its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Saved {
    /// A scenario file, which is checked when it is read.
    pub(crate) scenario: String,
    pub(crate) mode: Mode,
    pub(crate) speed: f64,
    pub(crate) presenting: bool,
    /// Whether it is dark; by the system's theme if neither was chosen.
    dark: Option<bool>,
    /// The layout, as JSON of its own.
    layout: String,
    /// Whether nothing had been kept.
    #[serde(skip)]
    pub(crate) new_here: bool,
}

impl Default for Saved {
    fn default() -> Self {
        let (scenario, layout) = (String::new(), String::new());
        Self {
            scenario,
            mode: Mode::default(),
            speed: Session::DEFAULT_SPEED,
            presenting: false,
            dark: None,
            layout,
            new_here: false,
        }
    }
}

impl Saved {
    pub(crate) fn load(storage: Option<&dyn eframe::Storage>) -> Self {
        match storage.and_then(|storage| storage.get_string(KEY)) {
            Some(text) => serde_json::from_str(&text).unwrap_or_default(),
            None => Self { new_here: true, ..Self::default() },
        }
    }

    pub(crate) fn save(&self, storage: &mut dyn eframe::Storage) {
        if let Ok(text) = serde_json::to_string(self) {
            storage.set_string(KEY, text);
        }
    }

    pub(crate) fn new(session: &Session, layout: &Layout, presenting: bool, theme: ThemePreference) -> Self {
        Self {
            scenario: session.scenario().to_toml().unwrap_or_default(),
            mode: session.mode(),
            speed: session.speed(),
            presenting,
            dark: match theme {
                ThemePreference::Dark => Some(true),
                ThemePreference::Light => Some(false),
                ThemePreference::System => None,
            },
            layout: serde_json::to_string(layout).unwrap_or_default(),
            new_here: false,
        }
    }

    pub(crate) fn layout(&self) -> Layout {
        serde_json::from_str(&self.layout).unwrap_or_default()
    }

    /// Chooses the theme again.
    pub(crate) fn apply_theme(&self, ctx: &Context) {
        if let Some(dark) = self.dark {
            ctx.set_theme(if dark { ThemePreference::Dark } else { ThemePreference::Light });
        }
    }
}
