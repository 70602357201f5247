//! The Kalman gain over time.

use egui::Ui;
use kalmanscope_core::{Channel, Estimates, Quantity};

use crate::plot::chart::{Chart, Curve, charts_ui};
use crate::plot::layers::Layer;
use crate::plot::series::PlotSeries;
use crate::plot::sheet::Sheet;
use crate::request::Request;
use crate::text::significant;
use crate::view::{View, ViewContext};

pub(super) static VIEW: View = View {
    name: "Kalman gain",
    help: [
        "What an innovation of one sensor changes: of the channel that it measures, the share of the innovation that is taken; of any other, K times √S, the change by an innovation of one standard deviation.",
        "Large at first, when the filter knows little; then constant, when measurements balance process noise and fading.",
        "With a gain near zero, measurements no longer change the estimate.",
    ],
    sheets: Some(sheets),
    ui: Some(view_ui),
    ..View::NONE
};

fn sheets<'a>(context: &ViewContext<'a>) -> Vec<Sheet<'a>> {
    let sensors = 0..context.session.sensors().len();
    sensors.flat_map(|sensor| charts(sensor, context)).map(Chart::into_sheet).collect()
}

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
    if context.session.run().scenario().sensors.is_empty() {
        ui.weak("Nothing is measured.");
        return None;
    }
    let sensors = context.session.sensors();
    let sensor = context.visible.sensor.min(sensors.len() - 1);
    sensor_ui(ui, &sensors, sensor, requests);
    charts_ui(ui, charts(sensor, context), &context.plot_input(), requests)
}

pub(super) fn sensor_ui(ui: &mut Ui, sensors: &[Quantity], chosen: usize, requests: &mut Vec<Request>) {
    if sensors.len() > 1 {
        ui.horizontal(|ui| {
            for (sensor, quantity) in sensors.iter().enumerate() {
                let hint = format!("What the {} sensor moves", quantity.key());
                let button = ui.selectable_label(sensor == chosen, format!("from e({})", quantity.symbol()));
                if button.on_hover_text(hint).clicked() {
                    requests.push(Request::ChooseSensor(sensor));
                }
            }
        });
    }
}

fn charts<'a>(sensor: usize, context: &ViewContext<'a>) -> Vec<Chart<'a>> {
    let channels = context.session.run().channels().into_iter().filter(|c| context.in_doubt(*c));
    let (parameters, states): (Vec<Channel>, Vec<Channel>) = channels.partition(|c| c.is_parameter());
    let channels = context.visible.channels([parameters, states].concat());
    channels.into_iter().map(|channel| chart(channel, sensor, context)).collect()
}

fn change(estimates: &Estimates, (sensor, at): (usize, usize), is_measured: bool, k: usize) -> f64 {
    let (n, m) = (estimates.channels().len(), estimates.sensors().len());
    // Between two quantities K has a unit that tells nothing; times √S it is the change by a usual innovation.
    let size = if is_measured { 1.0 } else { estimates.innovation_cov(k)[sensor * (m + 1)].sqrt() };
    estimates.gain(k)[sensor * n + at] * size
}

fn chart<'a>(channel: Channel, sensor: usize, context: &ViewContext<'a>) -> Chart<'a> {
    let sensor_of = context.session.sensors().get(sensor).copied();
    let is_measured = sensor_of.and_then(Quantity::channel) == Some(channel);
    let by = sensor_of.map_or_else(String::new, |quantity| format!(" by the {} sensor", quantity.key()));
    let mut chart = Chart {
        key: format!("gain of {} from {sensor}", channel.key()),
        title: format!("gain of the {}{by}", channel.name()),
        symbol: if is_measured { "K".to_owned() } else { format!("K√S → {}", channel.symbol()) },
        name: if is_measured { "share of the innovation taken".to_owned() } else { channel.name().to_owned() },
        unit: if is_measured { "" } else { context.unit(channel.unit()) },
        layers: vec![Layer::zero(context.palette.weak)],
        ..Chart::default()
    };
    for (_, of, at) in context.estimating(channel) {
        let value = move |k: usize| change(of, (sensor, at), is_measured, k);
        let curve = Curve { line: PlotSeries::each(of.len(), value), band: None, width: 1.2 };
        context.add(&mut chart, of, curve, move |k| Some(significant(value(k), 3)));
    }
    chart
}
