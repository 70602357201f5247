//! The interface of a view, and the context that it may read.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use egui::{Color32, Ui};
use kalmanscope_core::{Channel, Diagnostics, Estimates};

use crate::laboratory::Laboratory;
use crate::layout::ViewLayout;
use crate::plot::chart::{Chart, Curve, charts_ui};
use crate::plot::layers::Layer;
use crate::plot::sheet::{Sheet, SheetColumn};
use crate::plot::time_axis::{PlotInput, TimeAxis};
use crate::request::Request;
use crate::ruler::Ruler;
use crate::session::{Before, Session, Wanted};
use crate::share::SavedPicture;
use crate::text::unit_in;
use crate::theme::Palette;
use crate::visibility::Visibility;

#[derive(Clone, Copy)]
pub struct ViewContext<'a> {
    pub session: &'a Session,
    pub palette: &'a Palette,
    pub visible: &'a Visibility,
    pub axis: &'a TimeAxis,
    pub ruler: &'a Ruler,
    pub laboratory: Option<&'a Laboratory>,
    version: u64,
}

impl<'a> ViewContext<'a> {
    pub fn new(
        session: &'a Session,
        palette: &'a Palette,
        visible: &'a Visibility,
        axis: &'a TimeAxis,
        ruler: &'a Ruler,
    ) -> Self {
        let mut hasher = DefaultHasher::new();
        session.before().map_or(0, Before::len).hash(&mut hasher);
        (session.generation(), session.drawn(), session.run().len(), session.bounds().len(), visible, palette)
            .hash(&mut hasher);
        session.run().estimates().iter().for_each(|estimates| estimates.color().hash(&mut hasher));
        Self { session, palette, visible, axis, ruler, laboratory: None, version: hasher.finish() }
    }

    #[must_use]
    pub fn in_laboratory(self, laboratory: Option<&'a Laboratory>) -> Self {
        Self { laboratory, ..self }
    }

    /// Draws with another palette, without verdicts and the marks that follow the pointer, as figures and films are.
    pub(crate) fn without_marks<R>(&self, palette: &Palette, draw: impl FnOnce(&ViewContext<'_>) -> R) -> R {
        let mut visible = self.visible.clone();
        visible.verdicts = false;
        let axis = TimeAxis { pointed: None, ..*self.axis };
        draw(&ViewContext::new(self.session, palette, &visible, &axis, self.ruler).in_laboratory(self.laboratory))
    }

    pub(crate) fn picture(&self, layout: &ViewLayout) -> SavedPicture {
        let Self { session, visible, ruler, laboratory, .. } = self;
        let time = session.time() - session.run().record().time_of(0);
        SavedPicture {
            laboratory: laboratory.map(Laboratory::choices).unwrap_or_default().possible_with(session.scenario()),
            speed: session.speed(),
            ruler: ruler.in_nanoseconds(),
            hidden: visible.hidden(),
            ..SavedPicture::new(session.scenario().clone(), layout, session.mode(), time)
        }
    }

    pub(crate) fn unit(&self, unit: &'static str) -> &'static str {
        unit_in(self.session.run().scenario(), unit)
    }

    pub(crate) fn plot_input(&self) -> PlotInput<'a> {
        let Self { session, palette, visible, axis, ruler, laboratory: _, version } = *self;
        PlotInput { session, palette, visible, axis, ruler, version }
    }

    pub(crate) fn filters(&self) -> impl Iterator<Item = (usize, &'a Estimates)> + use<'a> {
        let Self { session, visible, .. } = *self;
        session.run().estimates().iter().enumerate().filter(|(_, estimates)| visible.filter(estimates.id()))
    }

    pub(crate) fn estimating(&self, channel: Channel) -> impl Iterator<Item = (usize, &'a Estimates, usize)> + use<'a> {
        self.filters().filter_map(move |(place, of)| Some((place, of, of.place(channel)?)))
    }

    pub(crate) fn color(&self, of: &Estimates) -> Color32 {
        self.palette.shade(of.color())
    }

    /// Adds a filter to a chart, at the samples that it has: its band below everything else.
    pub(crate) fn add(
        &self,
        chart: &mut Chart<'a>,
        of: &'a Estimates,
        Curve { line, band, width }: Curve<'a>,
        words: impl Fn(usize) -> Option<String> + 'a,
    ) {
        let (color, filter) = (self.color(of), Some(of.id()));
        let band = band.filter(|_| self.visible.bands);
        chart.bands.extend(band.map(|series| Layer::Band { series, color, filter }));
        chart.layers.push(Layer::Line { series: line, color, width, dashed: false, bounds: false, filter });
        chart.columns.push(SheetColumn::new(of.name(), color, move |k| (k < of.len()).then(|| words(k))?));
    }

    pub(crate) fn diagnostics(&self) -> impl Iterator<Item = (usize, &'a Estimates, &'a Diagnostics)> + use<'a> {
        let all = self.session.diagnostics();
        self.filters().filter_map(|(place, estimates)| Some((place, estimates, all.get(place)?)))
    }

    pub(crate) fn before(&self) -> impl Iterator<Item = &'a Estimates> + use<'a> {
        let before = self.session.before();
        self.filters().filter_map(move |(_, estimates)| before?.estimates(estimates.id()))
    }

    pub(crate) fn in_doubt(&self, channel: Channel) -> bool {
        self.session.run().estimates().iter().any(|estimates| {
            let std = |k: usize| estimates.place(channel).map_or(0.0, |at| estimates.std(k, at));
            !estimates.is_empty() && (std(0) != 0.0 || std(estimates.len() - 1) != 0.0)
        })
    }
}

type ViewUi = fn(&mut Ui, &ViewContext<'_>, &mut Vec<Request>) -> Option<f64>;

// A table, since a trait would need a type for each view and a function for each constant.
pub struct View {
    pub name: &'static str,
    /// A shorter name, for a narrow row of tabs.
    pub(crate) short: Option<&'static str>,
    pub help: [&'static str; 3],
    pub(crate) wanted: Wanted,
    pub(crate) wants_free_runs: bool,
    pub(crate) is_of_laboratory: bool,
    pub(crate) charts: for<'a> fn(&ViewContext<'a>) -> Vec<Chart<'a>>,
    // A number of its own, so that the heights of tiles do not build every chart once more in each frame.
    pub(crate) plots: fn(&ViewContext<'_>) -> usize,
    pub(crate) without_charts: &'static str,
    pub(crate) sheets: Option<for<'a> fn(&ViewContext<'a>) -> Vec<Sheet<'a>>>,
    pub(crate) ui: Option<ViewUi>,
}

impl View {
    pub(crate) const NONE: Self = Self {
        name: "",
        short: None,
        help: [""; 3],
        wanted: Wanted::NOTHING,
        wants_free_runs: false,
        is_of_laboratory: false,
        charts: |_| Vec::new(),
        plots: |_| 0,
        without_charts: "",
        sheets: None,
        ui: None,
    };

    pub(crate) fn sheets<'a>(&self, context: &ViewContext<'a>) -> Vec<Sheet<'a>> {
        let of_charts = || (self.charts)(context).into_iter().map(Chart::into_sheet).collect();
        self.sheets.map_or_else(of_charts, |sheets| sheets(context))
    }

    pub fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
        if let Some(own) = self.ui {
            return own(ui, context, requests);
        }
        let charts = (self.charts)(context);
        if charts.is_empty() {
            ui.weak(self.without_charts);
        }
        charts_ui(ui, charts, &context.plot_input(), requests)
    }
}
