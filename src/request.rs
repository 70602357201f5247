//! Requests of the views, the controls and the keys, as data.

mod kinds;

use std::fmt;

use egui_tiles::Tree;
use kalmanscope_core::Scenario;
use kalmanscope_core::setting::Change;
use kalmanscope_lessons::{BuiltIn, Lesson};
use serde::{Deserialize, Serialize};

use crate::laboratory::{Choice, SeedChoice, TuneChoice};
use crate::ruler::End;
use crate::session::Mode;
use crate::share::Picture as SavedPicture;

pub use kinds::{Arrangement, LegendEntry, Proportions, ViewKind};

/// A request, applied after the frame in which it was made.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
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
    /// Show the record as it grows, or the whole record.
    SetMode(Mode),
    /// Simulated seconds per second.
    SetSpeed(f64),
    /// Play a built-in scenario from its start.
    Open(BuiltIn),
    /// Play a scenario from its start.
    OpenScenario(Box<Scenario>),
    /// Let the user choose a file to open.
    ChooseFile,
    /// Import a measured record from a file.
    ImportFile(Box<RawFile>),
    /// Choose another meaning of the columns of the record on screen.
    ChangeColumns,
    /// Measure a free decay with a sensor of this device.
    Measure,
    /// Edit the equation of the plant.
    EditEquation,
    /// Forget the record's file that is kept for the next start.
    ForgetRecord,
    /// Test the identified models on the record that is being imported.
    HoldOut,
    /// Give up the import.
    CancelImport,
    /// Open the link, the lesson or the scenario of an address.
    OpenAddress(String),
    /// Copy a link to this picture.
    CopyLink,
    /// Open this picture in the whole explorer, beside the page that embeds this one.
    OpenOutside,
    /// Change these settings of the scenario.
    Edit(Change),
    /// Undo the last change of the scenario.
    Undo,
    /// Redo it.
    Redo,
    /// Go to the other of the two settings, and keep this one.
    SwapSettings,
    /// Forget the picture from before the last change.
    ForgetBefore,
    /// Begin the lesson at a place in the menu.
    StartLesson(usize),
    /// Begin a lesson that is not in the menu.
    StudyLesson(Box<Lesson>),
    /// Go to a step of the lesson.
    GoToStep(usize),
    /// Answer the question of the lesson's step.
    Answer(Answer),
    /// Make the change of the lesson's step.
    ChangeLesson,
    /// Note that the lesson is finished.
    FinishLesson,
    /// Leave the lesson and keep the scenario and the views.
    LeaveLesson,
    /// Show or hide an entry of the legend in all plots.
    ToggleEntry(LegendEntry),
    /// Show charts of all channels again.
    ShowAllChannels,
    /// Show the settings or hide them.
    ToggleControls,
    /// Show all settings, or only those that the story names.
    ShowAllSettings(bool),
    /// Switch presenter mode.
    TogglePresenter,
    /// Open the finder of settings, views, scenarios, lessons and commands.
    Find,
    /// Show or hide the list of keys.
    ToggleKeys,
    /// Show a message about a failure.
    Report(String),
    /// Dismiss the message about a failure.
    DismissNotice,
    /// Leave the list of keys, or the enlarged view.
    Leave,
    /// Show the diagnosis of the filter with an id beside the plots.
    Diagnose(u32),
    /// Close it.
    CloseDiagnosis,
    /// Show or hide a view.
    ToggleView(ViewKind),
    /// Show a view that may be hidden.
    ShowView(ViewKind),
    /// Show the views of a ready-made arrangement.
    Arrange(Arrangement),
    /// Use the tiles as the user has dragged or resized them.
    Rearrange(Box<Tree<ViewKind>>),
    /// Enlarge the next view, or the one before; after the last come all of them.
    TurnView(bool),
    /// Enlarge a view, or show all views again.
    ToggleEnlarged(ViewKind),
    /// Let the time axis follow the playback again.
    Follow,
    /// Leave the time axis where the user has put it.
    Unfollow,
    /// Show the values at this time \[s\], or at playback.
    PointAt(Option<f64>),
    /// Mark a time \[s\]: A, then B, then the nearer of both moves.
    MarkTime(f64),
    /// Move a mark to a time \[s\].
    PlaceMark(End, f64),
    /// Mark the time on screen, or remove the mark if it is already there.
    ToggleMark(End),
    /// Take both marks away.
    ClearMarks,
    /// Write the picture on screen to a file.
    Export(Export),
    /// Open or close the menu of exports.
    ToggleExports,
    /// Show another map in the laboratory.
    ChooseMap(Box<Choice>),
    /// Compute the map, or stop that.
    ComputeMap(bool),
    /// Show the statistics of other seeds, or of another parameter.
    ChooseSeeds(SeedChoice),
    /// Run the seeds, or stop that.
    RunSeeds(bool),
    /// Tune other settings, or for another goal.
    ChooseTuning(Box<TuneChoice>),
    /// Begin to tune, or stop that.
    Tune(bool),
    /// Show the posterior of the parameters of the filter with an id, or of none.
    ChoosePosterior(Option<u32>),
    /// Restore a session from a file.
    OpenSession(Box<SavedPicture>),
}

impl Request {
    /// The request that makes `now` of the scenario on screen; `None` where they are the same.
    pub(crate) fn edit(before: &Scenario, now: &Scenario) -> Option<Self> {
        (before != now).then(|| Self::Edit(Change::between(before, now)))
    }
}

/// A file that leaves the explorer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Export {
    /// The views on screen.
    Figure(FigureFormat),
    /// The map of the laboratory, as CSV.
    Map,
    /// The statistics over many seeds, as CSV.
    MonteCarlo,
    /// Verdicts, evidence, estimates, scores and figures as one page, as HTML.
    Report,
    /// Every estimate of every filter, as CSV.
    Estimates,
    /// The record, as CSV.
    Record,
    /// The scenario, as TOML.
    Scenario,
    /// Scenario, record, estimates and diagnosis, as one JSON.
    All,
    /// Scenario, layout and playback, to be opened again.
    Session,
}

/// The size and style of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureFormat {
    /// One column of a journal.
    Column,
    /// The full width of a journal's page.
    Page,
    /// A slide, 16:9.
    Slide,
}

/// A file's bytes, not yet read.
#[derive(Clone, PartialEq)]
pub struct RawFile {
    /// Its name.
    pub name: String,
    /// Its contents.
    pub bytes: Vec<u8>,
}

impl fmt::Debug for RawFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} bytes)", self.name, self.bytes.len())
    }
}

/// An answer to the question of a lesson's step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// The choice at a place, from 0 on.
    Choice(usize),
    /// The user wants to see the effect without an answer.
    Skipped,
}
