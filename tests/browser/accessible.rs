//! The page for those who cannot see it: names, landmarks, tables, announcements, contrast.

use std::time::{Duration, Instant};

use serde_json::Value;

use crate::page::{Page, estimate};

/// The least contrast of text (WCAG 2, level AA).
const CONTRAST: f64 = 4.5;

/// `contrasts(selector)` gives the contrasts of all texts there.
const MEASURE: &str = "
    window.contrasts = selector => {
        const numbers = color => color.match(/[\\d.]+/g).map(Number);
        const linear = x => (x /= 255) <= 0.03928 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
        const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
        const ground = element => {
            const color = numbers(getComputedStyle(element).backgroundColor);
            return color[3] === 0 ? ground(element.parentElement) : color;
        };
        const contrast = element => {
            const both = [numbers(getComputedStyle(element).color), ground(element)].map(luminance);
            return (Math.max(...both) + 0.05) / (Math.min(...both) + 0.05);
        };
        return [...document.querySelectorAll(selector)].filter(element => element.textContent.trim()).map(contrast);
    };
    new MutationObserver(() => {
        window.coverContrasts ||= document.getElementById('loading-bytes')?.textContent.trim() && contrasts('#loading p');
    }).observe(document, { subtree: true, childList: true, characterData: true });";

const RULES: [(&str, &str); 9] = [
    ("the document has a language", "document.documentElement.lang === 'en'"),
    ("the document has a title", "document.title === 'Kalmanscope'"),
    ("there is one main landmark", "document.querySelectorAll('main').length === 1"),
    (
        "there is one first heading",
        "[...document.querySelectorAll('h1')].filter(it => !it.closest('[hidden], noscript')).length === 1",
    ),
    ("the canvas has a name and is in the landmark", "document.querySelector('main > canvas').ariaLabel.length > 20"),
    (
        "the canvas is described",
        "document.getElementById(document.querySelector('canvas').getAttribute('aria-describedby')).textContent !== ''",
    ),
    (
        "every field has a name",
        "[...document.querySelectorAll('input, progress')].every(field => field.ariaLabel?.length > 5)",
    ),
    (
        "ids are unique",
        "(ids => new Set(ids).size === ids.length)([...document.querySelectorAll('[id]')].map(element => element.id))",
    ),
    (
        "news are read aloud when there is time",
        "document.querySelectorAll('[aria-live=polite]').length === 1 && document.getElementById('news') !== null",
    ),
];

const TABLE_RULES: [(&str, &str); 4] = [
    ("there are tables: of two parameters, and of the verdicts", "tables.length >= 3"),
    ("a table has a title", "tables.every(table => table.caption.textContent !== '')"),
    (
        "columns have names",
        "tables.every(table => [...table.tHead.rows[0].cells].every(it => it.matches('th[scope=col]') && it.textContent))",
    ),
    (
        "rows have names, and as many cells as there are columns",
        "tables.every(table => [...table.tBodies[0].rows].every(row => row.cells[0].matches('th[scope=row]')
            && row.cells.length === table.tHead.rows[0].cells.length))",
    ),
];

pub(crate) async fn prepare(page: &Page) {
    page.prepare(MEASURE).await;
}

pub(crate) async fn cover_can_be_read(page: &Page) {
    check_contrasts(&page.value("window.coverContrasts").await);
}

pub(crate) async fn failure_can_be_read(page: &Page) {
    for theme in ["dark", "light"] {
        page.theme(theme).await;
        check_contrasts(&page.value("contrasts('#failure h1, #failure p, #failure pre, #failure button')").await);
    }
}

fn check_contrasts(contrasts: &Value) {
    let contrasts: Vec<f64> = contrasts.as_array().expect("a list").iter().filter_map(Value::as_f64).collect();
    assert!(contrasts.len() >= 3, "few texts: {contrasts:?}");
    assert!(contrasts.iter().all(|contrast| *contrast >= CONTRAST), "a text has little contrast: {contrasts:?}");
}

/// The page keeps the rules, and its tables agree with the state of the app, which does not play.
pub(crate) async fn tables_tell_what_the_canvas_shows(page: &Page) {
    for (name, rule) in RULES {
        assert_eq!(page.value(rule).await, true, "{name}");
    }
    for (name, rule) in TABLE_RULES {
        let rule = format!("(tables => {rule})([...document.querySelectorAll('main table')])");
        assert_eq!(page.value(&rule).await, true, "{name}");
    }
    let summary = page.summary().await;
    let filters = summary["filters"].as_array().expect("a list");
    for (place, filter) in filters.iter().enumerate() {
        let [mean, std] = ["mean", "std"].map(|key| estimate(filter, "natural_frequency", key));
        // After the time and the truth.
        let cell = format!(
            "[...document.querySelectorAll('table')].find(table => table.caption.textContent.startsWith('natural frequency'))
                .tBodies[0].rows[0].cells[{}].textContent.startsWith('{:.3} ±{:.3} (')",
            place + 2,
            mean.abs(),
            2.0 * std
        );
        page.wait_until(&cell, Duration::from_secs(10)).await.expect("the table follows the app");
        let verdict = format!(
            "[...document.querySelectorAll('table')].find(table => table.caption.textContent === 'Verdicts on the filters')
                .tBodies[0].rows[{place}].cells[0].textContent === {}",
            filter["name"]
        );
        assert_eq!(page.value(&verdict).await, true, "every filter has a verdict");
    }
    // Movements that have begun come to rest first.
    rests(page).await;
    let news = page.value("document.getElementById('news').textContent").await;
    let news = news.as_str().expect("text");
    println!("announced: {news}");
    assert!(news.contains(" is "), "verdicts are announced: {news:?}");
}

/// Waits until the app draws no frames: one at most in a second.
async fn rests(page: &Page) {
    let (begun, mut before) = (Instant::now(), None);
    loop {
        let frames = page.summary().await["frames"].as_u64();
        if before.zip(frames).is_some_and(|(before, frames)| frames <= before + 1) {
            return;
        }
        assert!(
            begun.elapsed() < Duration::from_secs(30),
            "a page at rest draws no frames: {before:?}, then {frames:?}"
        );
        before = frames;
        tokio::time::sleep(Duration::from_secs(1)).await;
    }
}
