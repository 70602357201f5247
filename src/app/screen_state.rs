//! The state of the screen as data, for tests that drive the app from outside.

use egui::{Context, Rect};
use kalmanscope_core::document::{Document, json};
use kalmanscope_core::{Channel, Estimates};

use super::App;
use crate::laboratory::Survey;
use crate::probe;
use crate::session::Mode;

impl App {
    pub fn screen_state(&self, ctx: &Context) -> Document {
        let Self { session, tutor, laboratory, .. } = self;
        let control = |(name, rect): (String, Rect)| {
            let (x, y, width, height) = (rect.left(), rect.top(), rect.width(), rect.height());
            json!({ "name": name, "x": x, "y": y, "width": width, "height": height })
        };
        let run = session.run();
        json!({
            "mode": if session.mode() == Mode::Live { "live" } else { "whole" },
            "playing": session.playing(),
            "lesson": tutor.as_ref().map(|tutor| json!([tutor.title(), tutor.step + 1])),
            "samples": run.len(),
            "filters": Document::from_iter(run.estimates().iter().map(filter)),
            "checksum": format!("{:016x}", run.checksum()),
            "map": laboratory.shown().map(map),
            "frames": ctx.cumulative_frame_nr(),
            "controls": Document::from_iter(probe::all(ctx).into_iter().map(control)),
        })
    }
}

fn filter(estimates: &Estimates) -> Document {
    let one = |(at, channel): (usize, &Channel)| {
        let last = estimates.len().checked_sub(1)?;
        let (mean, std) = (estimates.mean(last)[at], estimates.std(last, at));
        Some(json!({ "channel": channel.key(), "mean": mean, "std": std }))
    };
    let channels = estimates.channels().iter().enumerate();
    json!({ "name": estimates.name(), "estimates": Document::from_iter(channels.filter_map(one)) })
}

fn map(survey: &Survey) -> Document {
    let sheet = &survey.sheet;
    json!({
        "cells": sheet.len(),
        "done": sheet.done(),
        "checksum": format!("{:016x}", sheet.checksum()),
        "computers": Document::from_iter(survey.computers.iter().map(ToString::to_string)),
        "ensemble": survey.ensemble.to_json(),
    })
}
