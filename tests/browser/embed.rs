//! The page under its policy, in the frame of another page, and the messages between both.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::page::Page;
use crate::server::Server;
use crate::{START, share, starts};

/// Collects what the policy has forbidden.
pub(crate) const WATCH: &str = "
    window.forbidden = [];
    document.addEventListener('securitypolicyviolation', event => {
        window.forbidden.push(`${event.effectiveDirective}: ${event.blockedURI} ${event.sourceFile}:${event.lineNumber}`);
    });";

/// A page that embeds the explorer, with what the frame has said in `answers`, and another frame that asks it too.
const HOST: &str = r#"<!doctype html><title>Lecture notes</title><link rel=icon href="data:,">
<iframe width=900 height=600></iframe>
<iframe hidden srcdoc="<script>
    onmessage = ({ data }) => {
        if (data === 'ask') parent.frames[0].postMessage({ kalmanscope: 1, get: 'state' }, '*');
        else parent.answers.push('to another frame');
    };
</script>"></iframe>
<script>
    window.answers = [];
    addEventListener('message', event => {
        answers.push({ ...event.data, from: event.origin, ofFrame: event.source === frames[0] });
    });
    window.say = message => {
        frames[0].postMessage(message, document.querySelector('iframe').src);
        return true;
    };
</script>"#;

/// The page starts under its policy, which allows no other script: neither from an attribute, nor from a text.
pub(crate) async fn policy_is_strict(page: &Page, address: &str) {
    starts(page, address).await;
    assert_eq!(page.value("window.forbidden").await, json!([]), "the page keeps its own policy");
    let add = "(script => { script.textContent = 'window.intruder = 1'; document.body.append(script); return 1; })
        (document.createElement('script'))";
    page.value(add).await;
    page.value(
        "(button => { button.setAttribute('onclick', 'window.intruder = 2'); button.click(); return 1; })
        (document.createElement('button'))",
    )
    .await;
    page.value(
        "(style => { document.body.append(style); style.textContent = 'canvas { display: none }'; return 1; })
        (document.createElement('style'))",
    )
    .await;
    let forbidden = page.value("window.forbidden.map(text => text.split(':')[0])").await;
    for directive in ["script-src-elem", "script-src-attr", "style-src-elem"] {
        assert!(forbidden.to_string().contains(directive), "{directive} is not among {forbidden}");
    }
    assert_eq!(page.value("window.intruder === undefined").await, true, "no other script runs");
    let fetched = "fetch('https://example.org/').then(() => 'sent', error => error.name)";
    assert_eq!(page.value(fetched).await, "TypeError", "nothing is sent elsewhere");
    // The console has all of this.
    page.console().await;
}

/// A page of another origin sets and reads the picture; messages that it should not send change nothing.
pub(crate) async fn messages(page: &Page, address: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("notes");
    fs::create_dir_all(&folder).expect("a folder can be made");
    fs::write(folder.join("index.html"), HOST).expect("a file can be written");
    let notes = Server::start(folder).expect("a port is free");
    page.go(&notes.page()).await;
    page.value(&format!("document.querySelector('iframe').src = '{address}?embed&scenario=duffing'")).await;
    let ready = answer(page, "answers.find(answer => answer.ready)").await;
    let origin = address.split('/').take(3).collect::<Vec<_>>().join("/");
    assert_eq!((ready["from"].as_str(), ready["ofFrame"].as_bool()), (Some(origin.as_str()), Some(true)));

    let (link, checksum) = share::picture();
    let fragment = &link[link.find('#').expect("a link has one")..];
    say(page, &json!({ "id": 1, "set": { "link": fragment } })).await;
    assert_eq!(answer_to(page, 1).await["set"], true);
    for id in 2.. {
        say(page, &json!({ "id": id, "get": "state" })).await;
        let state = answer_to(page, id).await["state"].clone();
        if state["computing"] == false {
            assert_eq!(state["checksum"].as_str(), Some(checksum.as_str()), "the same bits in a frame");
            let time = state["time"].as_f64().expect("it is a number");
            assert!(state["playing"] == false && (time - 13.37).abs() < 1e-9, "{state}");
            break;
        }
        assert!(id < 200, "it is not computed: {state}");
    }
    say(page, &json!({ "id": "link", "get": "link" })).await;
    let answered = answer(page, "answers.find(answer => answer.id === 'link')").await;
    assert_eq!(answered["link"], format!("{address}{fragment}"), "the frame tells the link that it was set to");

    say(page, &json!({ "id": 900, "set": { "scenario": "none" } })).await;
    let error = answer_to(page, 900).await["error"].to_string();
    assert!(error.contains("There is no scenario “none”"), "{error}");
    let before = page.value("answers.length").await;
    for hostile in ["42", "null", "{ a: 1 }", "'x'.repeat(70000)", "{ kalmanscope: 1, x: 'x'.repeat(70000) }", "10n"] {
        page.value(&format!("say({hostile})")).await;
    }
    page.value("frames[1].postMessage('ask')").await;
    page.settle().await;
    say(page, &json!({ "id": 901, "get": "state" })).await;
    assert_eq!(answer_to(page, 901).await["state"]["checksum"].as_str(), Some(checksum.as_str()));
    let after = page.value("answers.length").await;
    assert_eq!(after.as_u64(), before.as_u64().map(|count| count + 1), "what is not ours gets no answer");
    let console = page.console().await;
    let ignored = console.iter().filter(|(_, message)| message.contains("A message is ignored")).count();
    assert_eq!(ignored, 8, "each has a sentence: {console:?}");
    assert!(console.iter().all(|(level, _)| level != "SEVERE"), "{console:?}");
}

async fn say(page: &Page, message: &Value) {
    page.value(&format!("say({{ kalmanscope: 1, ...{message} }})")).await;
}

async fn answer_to(page: &Page, id: u32) -> Value {
    answer(page, &format!("answers.find(answer => answer.id === {id})")).await
}

/// The value of an expression once it has one.
async fn answer(page: &Page, expression: &str) -> Value {
    page.wait_until(&format!("({expression}) !== undefined"), START).await.expect("the frame answers");
    page.value(expression).await
}
