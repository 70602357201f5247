//! Long filters in the page's workers.

use kalmanscope::App;
use kalmanscope::session::Mode;
use kalmanscope_core::{FilterKind, FilterSettings, Scenario};

use crate::page::Page;
use crate::share::shows;
use crate::{START, reports_no_problems, starts};

/// Counts the messages to workers by their first word.
pub(crate) const WATCH: &str = "
    window.told = {};
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (...message) {
        const word = Array.isArray(message[0]) ? message[0][0] : 'program';
        told[word] = (told[word] ?? 0) + 1;
        if (told[word] === window.fatal?.[word]) setTimeout(() => {
            told.failures = 1;
            this.dispatchEvent(new Event('error'));
        });
        return post.apply(this, message);
    };";

pub(crate) const NONE: &str = "window.Worker = class { constructor() { throw new Error('there are none'); } };";

pub(crate) const FAILS: &str = "window.fatal = { more: 5 };";

/// No worker hears that it should go on, for as long as `hold` is true.
pub(crate) const HOLDS: &str = "
    window.hold = true;
    const send = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (...message) {
        if (!window.hold || message[0]?.[0] !== 'more') return send.apply(this, message);
        window.told.held = 1;
    };";

/// A picture of a whole record, with an EKF and a particle filter: the link to it and its checksum.
fn picture(seed: u64, duration: f64, particles: usize) -> (String, String) {
    let mut scenario = Scenario { duration, seed, ..Scenario::default() };
    scenario.filters.truncate(1);
    let sampled = FilterSettings { kind: FilterKind::PF, ensemble_size: particles, ..scenario.filters[0].clone() };
    scenario.filters.push(FilterSettings { id: 0, name: "PF".to_owned(), ..sampled });
    let mut app = App::with_scenario(scenario).unwrap();
    app.session_mut().set_mode(Mode::Whole);
    app.session_mut().pause();
    (app.link().unwrap(), format!("{:016x}", app.session().run().checksum()))
}

pub(crate) async fn told(page: &Page, word: &str) -> u64 {
    page.value(&format!("window.told?.{word} ?? 0")).await.as_u64().unwrap()
}

/// The estimates have the bits of this machine's, and come from a worker; an edit in the middle gives the work up.
pub(crate) async fn a_long_filter_is_computed_in_a_worker(page: &Page, address: &str) {
    let (link, checksum) = picture(3, 35.0, 1000);
    starts(page, &format!("{address}{link}")).await;
    shows(page, &checksum).await;
    assert_eq!((told(page, "filter").await, told(page, "forget").await), (1, 1));
    assert!(told(page, "more").await > 5);
    let (long, _) = picture(4, 300.0, 1000);
    let (link, checksum) = picture(5, 32.0, 1000);
    page.value(&format!("location.hash = '{long}'")).await;
    page.wait_until("told.filter === 2 && told.more > 20", START).await.unwrap();
    page.value(&format!("location.hash = '{link}'")).await;
    shows(page, &checksum).await;
    assert_eq!((told(page, "filter").await, told(page, "forget").await), (3, 3));
    assert_eq!(page.summary().await["samples"], 3201);
    reports_no_problems(page, address).await;
}

/// Where workers are missing or break, the page computes the same bits.
pub(crate) async fn the_page_computes_where_workers_do_not(page: &Page, address: &str, is_begun: bool) {
    let (link, checksum) = picture(6, 32.0, 1000);
    starts(page, &format!("{address}{link}")).await;
    shows(page, &checksum).await;
    assert_eq!(told(page, "filter").await, u64::from(is_begun));
    assert_eq!(told(page, "failures").await, u64::from(is_begun));
    reports_no_problems(page, address).await;
}
