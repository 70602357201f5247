//! Links and addresses, made on this machine and opened in the browser.

use std::time::Duration;

use kalmanscope::App;
use kalmanscope::layout::ViewLayout;
use kalmanscope::request::ViewKind;
use kalmanscope::session::Mode;
use kalmanscope_core::Scenario;

use crate::page::Page;
use crate::{START, reports_no_problems, starts};

/// A sentence on the page that is read aloud.
const NEWS: &str = "document.getElementById('news').textContent";

/// A picture that differs from a new one in every part, its link and its checksum.
pub(crate) fn picture() -> (String, String) {
    let mut scenario = Scenario::default();
    (scenario.seed, scenario.duration, scenario.filters[1].fading) = (77, 20.0, 1.02);
    let mut app = App::with_scenario(scenario).expect("it can be run");
    *app.layout_mut() = ViewLayout::column(&[ViewKind::States, ViewKind::Phase]);
    let session = app.session_mut();
    session.set_mode(Mode::Live);
    session.pause();
    session.seek(13.37);
    let checksum = format!("{:016x}", app.session().run().checksum());
    (app.link().expect("it is short"), checksum)
}

pub(crate) async fn shows(page: &Page, checksum: &str) {
    let same = format!("JSON.parse(window.wasmBindings.kalmanscope_summary()).checksum === '{checksum}'");
    page.wait_until(&same, START).await.expect("the page shows the same numbers as this machine");
}

/// A link gives the same bits here and there, at the start and in a page that is open; a damaged one is a sentence.
pub(crate) async fn links(page: &Page, address: &str) {
    let (link, checksum) = picture();
    println!("a link of {} characters", link.len());
    starts(page, &format!("{address}{link}")).await;
    shows(page, &checksum).await;
    let summary = page.summary().await;
    assert_eq!((summary["mode"].as_str(), summary["playing"].as_bool()), (Some("live"), Some(false)));
    let views = "(names => names.includes('States') && !names.includes('Parameters'))
        ([...document.querySelectorAll('main h2')].map(it => it.textContent))";
    page.wait_until(views, START).await.expect("the tables are those of the link's views");

    page.value(&format!("location.hash = '{}'", &link[..link.len() - 9])).await;
    page.wait_until(&format!("{NEWS}.includes('it is damaged')"), Duration::from_secs(10)).await.expect("it is said");
    shows(page, &checksum).await;
    page.value("location.hash = '#link=2.x'").await;
    page.wait_until(&format!("{NEWS}.includes('version 2')"), Duration::from_secs(10)).await.expect("it is said");
    shows(page, &checksum).await;

    starts(page, &format!("{address}?scenario=duffing")).await;
    page.value(&format!("location.hash = '{link}'")).await;
    shows(page, &checksum).await;
    reports_no_problems(page, address).await;
}
