//! Links: opening an address, and the address of the picture on screen.

use egui::{Context, Event, OpenUrl};

use super::App;
use kalmanscope_lessons::records;

use crate::controls::number;
use crate::laboratory::Choices;
use crate::notice::Notice;
use crate::plot::time_axis::TimeAxis;
use crate::request::{Request, ViewKind};
use crate::share::address::{self, LinkTarget};
use crate::share::{LinkError, SavedPicture};
use crate::theme::Palette;
use crate::views::view;
use crate::visibility::Visibility;

/// The page at which links of the desktop program begin; without it a link is the fragment alone, which any page opens.
pub(super) const PAGE: Option<&str> = option_env!("KALMANSCOPE_PAGE");

impl App {
    #[must_use]
    pub fn at_page(self, page: &str) -> Self {
        Self { page: page.to_owned(), ..self }
    }

    /// Opens what an address names, or says why it cannot be opened. An address that names nothing changes nothing.
    pub fn open_address(&mut self, address: &str) {
        self.requests.push(Request::OpenAddress(address.to_owned()));
    }

    pub(super) fn go_to_address(&mut self, address: &str, ctx: &Context) {
        match address::target(address) {
            Ok(None) => {}
            Ok(Some(LinkTarget::Picture(picture))) => self.show_picture(*picture, ctx),
            Ok(Some(LinkTarget::Scenario(built_in))) => self.open_built_in(built_in, ctx),
            Ok(Some(LinkTarget::Lesson(place, step))) => {
                self.start_lesson(place, ctx);
                self.go_to_step(step);
            }
            Err(error) => self.notice = Some(error.to_string().into()),
        }
    }

    pub fn picture(&self) -> SavedPicture {
        let palette = Palette::of(egui::Theme::Light);
        let picture = self.figure_context(&palette).picture(&self.layout);
        let shown = self.layout.shown();
        let shows_map = shown.iter().any(|kind| view(*kind).is_of_laboratory);
        let of_each = [ViewKind::MonteCarlo, ViewKind::Tune, ViewKind::Sensors];
        let [shows_seeds, shows_tuning, shows_sensors] = of_each.map(|kind| shown.contains(&kind));
        let Choices { map, seeds, tuning, sensors } = picture.laboratory;
        let laboratory = Choices {
            map: map.filter(|_| shows_map),
            seeds: seeds.filter(|_| shows_seeds),
            tuning: tuning.filter(|_| shows_tuning),
            sensors: sensors.filter(|_| shows_sensors),
        };
        SavedPicture { laboratory, ..picture }
    }

    pub fn link(&self) -> Result<String, LinkError> {
        Ok(format!("{}{}", self.page, self.picture().fragment()?))
    }

    pub(super) fn copy_link(&mut self, ctx: &Context) {
        self.notice = Some(match self.link() {
            Ok(link) => {
                ctx.copy_text(link);
                let more = |file: &str| format!(" The record “{file}” is not in it: send that file too.");
                let more = self.missing_record().map(more).unwrap_or_default();
                Notice::done(&format!("A link to this picture is in the clipboard.{more}"))
            }
            Err(error) => format!("There is no link to this picture: {error}.").into(),
        });
    }

    /// The name of the record's file, where a link cannot bring it: it is not built in.
    pub(super) fn missing_record(&self) -> Option<&str> {
        let mapping = self.session.scenario().record.as_ref()?;
        records::record(mapping).is_none().then_some(mapping.file.as_str())
    }

    pub(super) fn open_outside(&mut self, ctx: &Context) {
        match self.link() {
            Ok(link) => ctx.open_url(OpenUrl::new_tab(link)),
            Err(error) => self.notice = Some(format!("There is no link to this picture: {error}.").into()),
        }
    }

    pub(super) fn show_picture(&mut self, picture: SavedPicture, ctx: &Context) {
        let layout = picture.layout();
        let SavedPicture { scenario, laboratory, mode, time, speed, ruler, hidden, views: _, enlarged: _, habits } =
            picture;
        self.history.add_undo(&self.session.version());
        self.session.set_scenario(scenario);
        self.session.begin_anew();
        self.session.set_mode(mode);
        self.session.set_speed(speed);
        self.session.pause();
        self.session.seek(time);
        self.tutor = None;
        self.inviting = false;
        self.layout = layout;
        let choices = laboratory.or(self.laboratory.choices());
        self.laboratory.restore(choices);
        self.axis = TimeAxis::default();
        self.ruler = ruler;
        self.visible = Visibility::without(&hidden);
        number::begin_anew(ctx);
        if let Some(habits) = habits {
            self.take_up(habits, ctx);
        }
    }
}

pub(super) fn pasted(ctx: &Context, requests: &mut Vec<Request>) {
    // Text that is pasted into a field belongs to the field.
    if ctx.text_edit_focused() {
        return;
    }
    let pasted = |event: &Event| if let Event::Paste(text) = event { Some(text.clone()) } else { None };
    if let Some(text) = ctx.input(|input| input.events.iter().find_map(pasted)) {
        requests.push(Request::OpenAddress(text.trim().to_owned()));
    }
}
