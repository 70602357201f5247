//! Requests of the views, the controls and the keys, as data.

use std::fmt;

use egui_tiles::Tree;
use kalmanscope_core::Scenario;
use kalmanscope_core::setting::{Address, Change};
use kalmanscope_lessons::{BuiltIn, Lesson};

use crate::laboratory::{MapChoice, SeedChoice, SensorChoice, TuneChoice};
use crate::ruler::RulerEnd;
use crate::session::Mode;
use crate::share::SavedPicture;

pub use crate::kinds::{Answer, Arrangement, LegendEntry, Proportions, Tabs, VIEWS, ViewKind};

#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    TogglePlay,
    Step,
    StepBack,
    Restart,
    Seek(f64),
    SetMode(Mode),
    SetSpeed(f64),
    Open(BuiltIn),
    OpenScenario(Box<Scenario>),
    ChooseFile,
    ImportFile(Box<RawFile>),
    ChangeColumns,
    Measure,
    EditEquation,
    ForgetRecord,
    HoldOut,
    CancelImport,
    OpenAddress(String),
    CopyLink,
    OpenOutside,
    Edit(Change),
    Undo,
    Redo,
    SwapSnapshot,
    ForgetBefore,
    StartLesson(usize),
    StudyLesson(Box<Lesson>),
    GoToStep(usize),
    Answer(Answer),
    ChangeLesson,
    FinishLesson,
    LeaveLesson,
    TurnLesson(bool),
    ToggleEntry(LegendEntry),
    ShowAllChannels,
    ToggleControls,
    ShowAllSettings(bool),
    TogglePresenter,
    Find,
    ToggleKeys,
    Report(String),
    DismissNotice,
    Leave,
    Diagnose(u32),
    CloseDiagnosis,
    ToggleView(ViewKind),
    ShowView(ViewKind),
    /// Show the second tab in place of the first.
    ChooseTab(ViewKind, ViewKind),
    Arrange(Arrangement),
    Rearrange(Box<Tree<ViewKind>>),
    TurnView(bool),
    ToggleEnlarged(ViewKind),
    Follow,
    Unfollow,
    /// Show the values at this time \[s\], or at playback.
    PointAt(Option<f64>),
    /// Mark a time \[s\]: A, then B, then the nearer of both moves.
    MarkTime(f64),
    PlaceMark(RulerEnd, f64),
    ToggleMark(RulerEnd),
    ClearMarks,
    Export(Export),
    ShowFigure,
    ToggleExports,
    ChooseMap(Box<MapChoice>),
    ComputeMap(bool),
    ChooseSeeds(SeedChoice),
    RunSeeds(bool),
    ChooseTuning(Box<TuneChoice>),
    Tune(bool),
    ChooseSensors(Box<SensorChoice>),
    CompareSensors(bool),
    OpenSession(Box<SavedPicture>),
}

impl Request {
    pub(crate) fn edit(change: Change) -> Option<Self> {
        (change != Change::default()).then_some(Self::Edit(change))
    }

    pub(crate) fn set(address: Address, value: f64) -> Self {
        let mut change = Change::default();
        change.set_at(address, value);
        Self::Edit(change)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Export {
    Figure(FigureFormat),
    Map,
    MonteCarlo,
    Report,
    Estimates,
    Record,
    Scenario,
    All,
    Session,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureFormat {
    Column,
    Page,
    Slide,
}

#[derive(Clone, PartialEq)]
pub struct RawFile {
    pub name: String,
    pub bytes: Vec<u8>,
    pub is_measured: bool,
}

impl fmt::Debug for RawFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} bytes)", self.name, self.bytes.len())
    }
}
