//! Writes the tables of the screen into the page, beside the canvas, where screen readers find them.

use kalmanscope::App;
use kalmanscope::screen_text::{ScreenPart, ScreenTable, ScreenText};
use wasm_bindgen::JsValue;
use web_sys::{Document, Element};
use web_time::{Duration, Instant};

const EVERY: Duration = Duration::from_secs(1);

pub(super) struct Tables {
    document: Document,
    home: Element,
    news: Element,
    shown: ScreenText,
    elements: Vec<Element>,
    last: Option<Instant>,
}

impl Tables {
    pub(super) fn new(document: &Document) -> Option<Self> {
        Some(Self {
            home: document.get_element_by_id("tables")?,
            news: document.get_element_by_id("news")?,
            document: document.clone(),
            shown: ScreenText::default(),
            elements: Vec::new(),
            last: None,
        })
    }

    pub(super) fn follow(&mut self, app: &App, ctx: &egui::Context) {
        let since = self.last.map_or(EVERY, |last| last.elapsed());
        if since < EVERY {
            // Every frame asks again, because a frame replaces the request of the frame before.
            ctx.request_repaint_after(EVERY - since);
            return;
        }
        self.last = Some(Instant::now());
        if let Err(error) = self.show(app.screen_text()) {
            log::warn!("the tables cannot be written: {error:?}");
        }
    }

    fn show(&mut self, text: ScreenText) -> Result<(), JsValue> {
        let news = text.news(&self.shown);
        if !news.is_empty() {
            self.news.set_text_content(Some(&news.join(" ")));
        }
        if shape(&text) == shape(&self.shown) {
            let texts = texts(&self.shown).zip(texts(&text)).zip(&self.elements);
            for ((_, text), element) in texts.filter(|((before, text), _)| before != text) {
                element.set_text_content(Some(text));
            }
        } else {
            self.elements.clear();
            self.home.set_text_content(None);
            for part in &text.parts {
                self.add_part(part)?;
            }
        }
        self.shown = text;
        Ok(())
    }

    fn add_part(&mut self, part: &ScreenPart) -> Result<(), JsValue> {
        let section = self.add(&self.home.clone(), "section")?;
        self.add_text(&section, "h2", &part.name)?;
        self.add_text(&section, "p", &part.about)?;
        for ScreenTable { caption, columns, rows } in &part.tables {
            let table = self.add(&section, "table")?;
            self.add_text(&table, "caption", caption)?;
            let head = self.add(&self.add(&table, "thead")?, "tr")?;
            for column in columns {
                self.add_text(&head, "th", column)?.set_attribute("scope", "col")?;
            }
            let body = self.add(&table, "tbody")?;
            for row in rows {
                let line = self.add(&body, "tr")?;
                for (place, text) in row.iter().enumerate() {
                    if place == 0 {
                        self.add_text(&line, "th", text)?.set_attribute("scope", "row")?;
                    } else {
                        self.add_text(&line, "td", text)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn add_text(&mut self, parent: &Element, tag: &str, text: &str) -> Result<Element, JsValue> {
        let element = self.add(parent, tag)?;
        element.set_text_content(Some(text));
        self.elements.push(element.clone());
        Ok(element)
    }

    fn add(&self, parent: &Element, tag: &str) -> Result<Element, JsValue> {
        let element = self.document.create_element(tag)?;
        parent.append_child(&element)?;
        Ok(element)
    }
}

fn shape(text: &ScreenText) -> Vec<Vec<(usize, usize)>> {
    let size = |table: &ScreenTable| (table.columns.len(), table.rows.len());
    text.parts.iter().map(|part| part.tables.iter().map(size).collect()).collect()
}

fn texts(text: &ScreenText) -> impl Iterator<Item = &String> {
    text.parts.iter().flat_map(|part| [&part.name, &part.about].into_iter().chain(part.tables.iter().flat_map(cells)))
}

fn cells(table: &ScreenTable) -> impl Iterator<Item = &String> {
    let ScreenTable { caption, columns, rows } = table;
    std::iter::once(caption).chain(columns).chain(rows.iter().flatten())
}
