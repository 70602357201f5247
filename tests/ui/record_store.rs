//! The file of a measured record outlasts the program.

use std::cell::RefCell;
use std::rc::Rc;

use egui::Context;
use kalmanscope::inbox::{Arrival, Done, Inbox};
use kalmanscope::record_store::RecordStore;

use super::records::{check_result, dialects, drop_record};
use super::*;

type Kept = (String, Vec<u8>);

/// A place for one file in memory. Actions end when a test says so, as those of a browser do later.
#[derive(Clone, Default)]
struct Drawer(Rc<RefCell<Option<Kept>>>, Rc<RefCell<Vec<Done>>>);

impl Drawer {
    fn end(&self, screen: &mut Screen, end: Result<String, String>) -> String {
        self.1.borrow_mut().pop().expect("an action has begun")(end);
        screen.run_steps(2);
        screen.state().notice().unwrap_or_default().to_owned()
    }
}

impl RecordStore for Drawer {
    fn keep(&self, name: &str, bytes: Rc<[u8]>, done: Done) {
        *self.0.borrow_mut() = Some((name.to_owned(), bytes.to_vec()));
        self.1.borrow_mut().push(done);
    }

    fn fetch(&self, ctx: &Context, inbox: &Inbox) {
        if let Some((name, bytes)) = self.0.borrow().clone() {
            inbox.put(Arrival::Kept(name, bytes), ctx);
        }
    }

    fn forget(&self, done: Done) {
        self.0.borrow_mut().take();
        self.1.borrow_mut().push(done);
    }
}

fn with_drawer(saved: &Memory, drawer: &Drawer) -> Screen {
    reloaded(saved, |app, ctx| app.keeping_records(Box::new(drawer.clone()), ctx))
}

fn with_record() -> (Screen, Drawer, &'static str) {
    let drawer = Drawer::default();
    let mut screen = with_drawer(&Memory::default(), &drawer);
    let (name, bytes) = dialects()[0].clone();
    drop_record(&mut screen, name, &bytes);
    (screen, drawer, name)
}

#[test]
fn a_record_is_there_again_after_a_restart_until_it_is_forgotten() {
    let (mut screen, drawer, name) = with_record();
    check_result(&screen, name);
    assert_eq!(screen.state().notice(), None, "it is not yet written");
    let said = drawer.end(&mut screen, Ok("a drawer".to_owned()));
    assert_eq!(said, format!("“{name}” will be here next time."));
    assert!(screen.query_by_label("Forget it").is_some());

    let mut again = with_drawer(&saved(&mut screen), &drawer);
    again.run_steps(30);
    check_result(&again, "after a restart");
    assert!(again.query_by_label("Open the record").is_none(), "nothing is asked");

    click(&mut again, "More");
    click(&mut again, "Forget the record");
    assert_eq!(again.state().notice(), None, "it is not yet forgotten");
    let said = drawer.end(&mut again, Ok("a drawer".to_owned()));
    assert_eq!(said, "This record will not be here next time.");
    let mut empty = with_drawer(&saved(&mut again), &drawer);
    empty.run_steps(10);
    assert!(!empty.state().session().is_measured());
    assert!(empty.state().session().problem().is_some_and(|problem| problem.contains("drop the file")));
}

#[test]
fn a_record_that_cannot_be_kept_or_forgotten_is_said() {
    let (mut screen, drawer, name) = with_record();
    let said = drawer.end(&mut screen, Err("the disk is full".to_owned()));
    assert_eq!(said, format!("“{name}” will not be here next time: the disk is full."));
    click(&mut screen, "More");
    click(&mut screen, "Forget the record");
    let said = drawer.end(&mut screen, Err("the disk is gone".to_owned()));
    assert_eq!(said, "The record could not be forgotten: the disk is gone.");
}
