//! What a view or the transport bar may ask for.

use crate::library::Entry;
use crate::session::Mode;
use crate::views::{Arrangement, ViewKind};

/// A request, carried out after the frame in which it was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Play if paused, pause if playing; from the start if at the end.
    TogglePlay,
    /// One sample forward, paused.
    Step,
    /// One sample back, paused.
    StepBack,
    /// Back to the start, playing on if playing.
    Restart,
    /// Go to a time after the start \[s\].
    Seek(f64),
    /// Show the record as it grows, or all of it.
    SetMode(Mode),
    /// Simulated seconds per second.
    SetSpeed(f64),
    /// Play a built-in scenario from its start.
    Open(Entry),
    /// Take back the last change of the scenario.
    Undo,
    /// Make it again.
    Redo,
    /// Begin the lesson at a place in the menu.
    StartLesson(usize),
    /// Go to a step of the lesson.
    GoToStep(usize),
    /// Make the change of the lesson's step.
    ChangeLesson,
    /// Leave the lesson, and everything as it is.
    LeaveLesson,
    /// Show the filter at a place, or hide it.
    ToggleFilter(usize),
    /// Show the settings or hide them.
    ToggleControls,
    /// Large type, or back to normal.
    TogglePresenter,
    /// Show the list of keys or hide it.
    ToggleKeys,
    /// Leave the list of keys, or the enlarged view.
    Leave,
    /// Show a view or hide it.
    ToggleView(ViewKind),
    /// Show the views of a ready-made arrangement.
    Arrange(Arrangement),
    /// Let the time axis follow the playback again.
    Follow,
    /// Leave the time axis where the user has put it.
    Unfollow,
    /// Show the values at this time \[s\], or where playback stands.
    PointAt(Option<f64>),
}
