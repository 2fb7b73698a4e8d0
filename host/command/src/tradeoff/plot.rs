//! Time against error, as an SVG.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::scale::Scale;
use super::{Record, Report, Wish};
use crate::error::{Error, Result};
use eyerays::math;
use eyerays::method::TriangleTest;
use eyerays::render::Precision;

/// In pixels.
const SIZE: (u32, u32) = (1000, 680);
const GREY: RGBColor = RGBColor(110, 110, 110);
/// Blue, orange and green of Okabe and Ito's palette, which colour-blind people tell apart.
const COLOURS: [RGBColor; 3] = [RGBColor(0, 114, 178), RGBColor(230, 159, 0), RGBColor(0, 158, 115)];

/// Time of a rendering (logarithmic) against the RMSE (logarithmic; 0 lies at the bottom), with the Pareto front
/// and its numbers, the bound of the wish and the recommended setting.
///
/// # Errors
/// There is nothing to draw, or the drawing fails.
pub fn plot(report: &Report, wish: Option<Wish>) -> Result<String> {
    let scales = Scales::of(&report.records).ok_or_else(|| Error::new("no picture has a finite error to plot"))?;
    let mut svg = String::new();
    drawn(report, wish, &scales, &mut svg).map_err(|e| Error::new(format!("the plot can't be drawn: {e}")))?;
    Ok(svg)
}

type Drawn = std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Of time and error.
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Scale, Scale>>;

/// What the axes span.
struct Scales {
    time: Scale,
    error: Scale,
    /// Where an error of 0 is drawn.
    floor: Option<f64>,
}

impl Scales {
    fn of(records: &[Record]) -> Option<Scales> {
        let finite = || records.iter().filter(|record| record.rmse.is_finite());
        let time = Scale::of(finite().map(|record| record.time_ms))?;
        let errors = finite().map(|record| record.rmse).filter(|&error| error > 0.0);
        let error = Scale::of(errors).or_else(|| Scale::of([1e-9, 1e-6].into_iter()))?;
        let floor = finite().any(|record| record.rmse == 0.0).then_some(error.start() / 3.0);
        Some(Scales { time, error: floor.map_or(error.clone(), |floor| error.down_to(floor / 1.5)), floor })
    }

    /// Where a record lies.
    fn place(&self, record: &Record) -> (f64, f64) {
        let error = if record.rmse > 0.0 { record.rmse } else { self.floor.unwrap_or(self.error.start()) };
        (record.time_ms, error)
    }
}

fn drawn(report: &Report, wish: Option<Wish>, scales: &Scales, svg: &mut String) -> Drawn {
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title(report), ("sans-serif", 20))
        .margin(16)
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d(scales.time.clone(), scales.error.clone())?;
    let zero = if scales.floor.is_some() { "; 0 at the bottom" } else { "" };
    chart
        .configure_mesh()
        .bold_line_style(BLACK.mix(0.12))
        .light_line_style(TRANSPARENT)
        .x_desc("time of a rendering in ms (logarithmic)")
        .y_desc(format!("RMSE against the reference, linear light (logarithmic{zero})"))
        .x_label_formatter(&|time| plain(*time))
        .y_label_formatter(&|error| format!("{:e}", rounded(*error)))
        .label_style(("sans-serif", 15))
        .axis_desc_style(("sans-serif", 17))
        .draw()?;
    let members = report.front();
    line(&mut chart, scales, &members)?;
    bound(&mut chart, scales, wish)?;
    points(&mut chart, scales, &report.records)?;
    numbers(&mut chart, scales, &members)?;
    if let Some(best) = report.recommended() {
        let ring = move |(x, y)| Circle::new((x, y), 10, RED.stroke_width(2));
        let place = scales.place(best);
        let drawn = chart.draw_series(std::iter::once(ring(place)))?;
        drawn.label("recommended").legend(move |(x, y)| Circle::new((x + 10, y), 7, RED.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(free_corner(scales, &report.records))
        .background_style(WHITE.mix(0.85))
        .border_style(GREY)
        .label_font(("sans-serif", 15))
        .draw()?;
    drop(chart);
    area.present()
}

/// The least error that is to be had in a time: steps along the front.
fn line(chart: &mut Chart<'_, '_>, scales: &Scales, members: &[&Record]) -> Drawn {
    let places: Vec<(f64, f64)> = members.iter().map(|record| scales.place(record)).collect();
    let corners = places.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    let steps: Vec<_> = corners.chain(places.last().copied()).collect();
    let drawn = chart.draw_series(LineSeries::new(steps, BLACK.stroke_width(1)))?;
    drawn
        .label("Pareto front, numbered as in the table")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], BLACK.stroke_width(1)));
    Ok(())
}

/// What is wished, where the plot shows it.
fn bound(chart: &mut Chart<'_, '_>, scales: &Scales, wish: Option<Wish>) -> Drawn {
    let (time, error) = (&scales.time, &scales.error);
    let (wish, ends) = match wish {
        Some(wish @ Wish::MaxError(most)) if error.holds(most) => (wish, [(time.start(), most), (time.end(), most)]),
        Some(wish @ Wish::Budget(most)) if time.holds(most) => (wish, [(most, error.start()), (most, error.end())]),
        _ => return Ok(()),
    };
    let style = RED.mix(0.6).stroke_width(1);
    let drawn = chart.draw_series(DashedLineSeries::new(ends, 6, 5, style))?;
    drawn.label(wish.to_string()).legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style));
    Ok(())
}

/// Every record, by precision and triangle test.
fn points(chart: &mut Chart<'_, '_>, scales: &Scales, records: &[Record]) -> Drawn {
    let kinds = [
        ("exact", (Precision::Exact, TriangleTest::Watertight)),
        ("fast", (Precision::Fast, TriangleTest::Watertight)),
        ("fast, moller", (Precision::Fast, TriangleTest::Moller)),
    ];
    for (colour, (label, kind)) in COLOURS.into_iter().zip(kinds) {
        let of = records.iter().filter(|r| r.rmse.is_finite() && (r.setting.precision, r.setting.triangle) == kind);
        let places: Vec<_> = of.map(|record| scales.place(record)).collect();
        if !places.is_empty() {
            let style = colour.filled();
            let drawn = chart.draw_series(places.into_iter().map(|place| Circle::new(place, 4, style)))?;
            drawn.label(label).legend(move |(x, y)| Circle::new((x + 10, y), 4, style));
        }
    }
    Ok(())
}

/// Where a legend hides the fewest records.
fn free_corner(scales: &Scales, records: &[Record]) -> SeriesLabelPosition {
    let places = || {
        let finite = records.iter().filter(|record| record.rmse.is_finite());
        finite
            .map(|record| scales.place(record))
            .map(|(time, error)| (scales.time.along(time), scales.error.along(error)))
    };
    let corners = [
        (SeriesLabelPosition::UpperRight, (1.0, 1.0)),
        (SeriesLabelPosition::LowerLeft, (0.0, 0.0)),
        (SeriesLabelPosition::LowerRight, (1.0, 0.0)),
        (SeriesLabelPosition::UpperLeft, (0.0, 1.0)),
    ];
    let hidden = |(x, y): (f64, f64)| places().filter(|p| (p.0 - x).abs() < 0.42 && (p.1 - y).abs() < 0.3).count();
    let best = corners.into_iter().min_by_key(|(_, corner)| hidden(*corner));
    best.map_or(SeriesLabelPosition::UpperRight, |(position, _)| position)
}

/// The members' numbers beside them.
fn numbers(chart: &mut Chart<'_, '_>, scales: &Scales, members: &[&Record]) -> Drawn {
    let style = ("sans-serif", 14).into_font().color(&BLACK).pos(Pos::new(HPos::Right, VPos::Top));
    let number = |(i, record): (usize, &&Record)| {
        EmptyElement::at(scales.place(record)) + Text::new((i + 1).to_string(), (-8, 6), style.clone())
    };
    chart.draw_series(members.iter().enumerate().map(number))?;
    Ok(())
}

fn title(report: &Report) -> String {
    let of = |key: &str| report.setup.iter().find(|(name, _)| name == key).map_or("", |(_, value)| value.as_str());
    format!("{}: {} on {}", report.scene, of("size"), of("device"))
}

/// Two digits, as marks have.
fn rounded(x: f64) -> f64 {
    let step = math::pow(10.0, math::log10(x).floor() - 1.0);
    (x / step).round() * step
}

/// Without an exponent.
fn plain(x: f64) -> String {
    let decimals = (1.0 - math::log10(x).floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
