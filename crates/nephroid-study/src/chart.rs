//! Curves, as SVG that takes its colours from the page.

use plotters::prelude::*;
use serde::{Deserialize, Serialize};

use crate::format;
use crate::section::Stop;

/// Pixels of a chart, which are wide on a phone and narrow on a desk: letters stay readable.
const SIZE: (u32, u32) = (480, 330);

/// Curves that can be told apart by colour and dashes.
const MOST_CURVES: usize = 8;

/// The lengths of dashes and gaps of each curve in turn.
const DASHES: [&str; MOST_CURVES] = ["none", "7 3", "2 3", "9 3 2 3", "none", "7 3", "2 3", "9 3 2 3"];

/// Colours that stand for those of the page: of letters, of the grid, and of each curve.
const INK: RGBColor = RGBColor(0, 0, 1);
const GRID: RGBColor = RGBColor(0, 0, 2);
const fn of_curve(index: usize) -> RGBColor {
    RGBColor(1, index as u8, 0)
}

/// A chart on the page.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Plot {
    /// The drawing.
    pub svg: String,
    /// What is in it, for who does not see it.
    pub alt: String,
    /// What it shows.
    pub caption: String,
    /// The names of the curves, in the order of their colours.
    pub names: Vec<String>,
}

impl Plot {
    /// Each curve's number, dashes and name.
    pub fn legend(&self) -> impl Iterator<Item = (usize, &'static str, &str)> {
        self.names.iter().enumerate().map(|(i, name)| (i, DASHES[i % MOST_CURVES], name.as_str()))
    }
}

/// Curves over one pair of axes.
#[derive(Clone, Debug)]
pub struct Chart {
    x: Axis,
    y: Axis,
    curves: Vec<Curve>,
}

#[derive(Clone, Debug)]
struct Axis {
    label: String,
    logarithmic: bool,
    from: Option<f64>,
}

#[derive(Clone, Debug)]
struct Curve {
    name: String,
    points: Vec<(f64, f64)>,
    dots: bool,
}

impl Chart {
    /// Two axes, with their units.
    pub fn new(x: &str, y: &str) -> Self {
        let axis = |label: &str| Axis { label: label.to_owned(), logarithmic: false, from: None };
        Self { x: axis(x), y: axis(y), curves: Vec::new() }
    }

    /// Both axes by powers of ten.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        self.logarithmic_x().logarithmic_y()
    }

    /// The axis across by powers of ten.
    #[must_use]
    pub fn logarithmic_x(mut self) -> Self {
        self.x.logarithmic = true;
        self
    }

    /// The axis upwards by powers of ten.
    #[must_use]
    pub fn logarithmic_y(mut self) -> Self {
        self.y.logarithmic = true;
        self
    }

    /// The axis upwards begins at or below this.
    #[must_use]
    pub fn from(mut self, y: f64) -> Self {
        self.y.from = Some(y);
        self
    }

    /// Measured points, joined by lines.
    #[must_use]
    pub fn points(self, name: &str, points: Vec<(f64, f64)>) -> Self {
        self.with(name, points, true)
    }

    /// A curve that is known everywhere.
    #[must_use]
    pub fn line(self, name: &str, points: Vec<(f64, f64)>) -> Self {
        self.with(name, points, false)
    }

    fn with(mut self, name: &str, points: Vec<(f64, f64)>, dots: bool) -> Self {
        self.curves.push(Curve { name: name.to_owned(), points, dots });
        self
    }

    /// Draws it. What is not finite, or has no logarithm, is left out.
    pub fn draw(&self, alt: &str, caption: &str) -> Result<Plot, Stop> {
        if self.curves.len() > MOST_CURVES {
            return Err(Stop::because(format!("a chart has at most {MOST_CURVES} curves")));
        }
        let curves: Vec<Vec<(f64, f64)>> = self.curves.iter().map(|curve| self.placed(curve)).collect();
        let xs = curves.iter().flatten().map(|p| p.0);
        let ys = curves.iter().flatten().map(|p| p.1);
        let ((x0, x1), (y0, y1)) = (self.x.range(xs, 0.0), self.y.range(ys, 0.05));
        let mut svg = String::new();
        let drawn = {
            let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
            self.draw_on(&area, &curves, (x0, x1), (y0, y1)).and_then(|()| area.present())
        };
        drawn.map_err(Stop::because)?;
        let names = self.curves.iter().map(|curve| curve.name.clone()).collect();
        Ok(Plot { svg: themed(&svg), alt: alt.to_owned(), caption: caption.to_owned(), names })
    }

    fn placed(&self, curve: &Curve) -> Vec<(f64, f64)> {
        let placed = curve.points.iter().map(|&(x, y)| (self.x.place(x), self.y.place(y)));
        placed.filter(|(x, y)| x.is_finite() && y.is_finite()).collect()
    }

    fn draw_on<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, plotters::coord::Shift>,
        curves: &[Vec<(f64, f64)>],
        (x0, x1): (f64, f64),
        (y0, y1): (f64, f64),
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let font = |size: u32| ("sans-serif", size).into_font().color(&INK);
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .margin_right(18)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(x0..x1, y0..y1)?;
        chart
            .configure_mesh()
            .x_labels(6)
            .y_labels(6)
            .x_label_formatter(&|x| self.x.label_at(*x, x1 - x0))
            .y_label_formatter(&|y| self.y.label_at(*y, y1 - y0))
            .x_desc(self.x.label.as_str())
            .y_desc(self.y.label.as_str())
            .axis_desc_style(font(15))
            .label_style(font(14))
            .axis_style(INK)
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (i, (curve, points)) in self.curves.iter().zip(curves).enumerate() {
            let color = of_curve(i);
            chart.draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)))?;
            if curve.dots {
                chart.draw_series(points.iter().map(|&p| Circle::new(p, 3, color.filled())))?;
            }
        }
        Ok(())
    }
}

impl Axis {
    fn place(&self, value: f64) -> f64 {
        if self.logarithmic { libm::log10(value) } else { value }
    }

    /// Where it begins and ends: never one point, and with some room if that is asked for.
    fn range(&self, values: impl Iterator<Item = f64>, room: f64) -> (f64, f64) {
        let from = self.from.map(|from| self.place(from));
        let (low, high) = values
            .chain(from)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if !(low.is_finite() && high.is_finite()) {
            return (0.0, 1.0);
        }
        if high - low < 1e-9 * high.abs().max(1e-9) {
            return (low - 0.5, high + 0.5);
        }
        let room = room * (high - low);
        (if from == Some(low) { low } else { low - room }, high + room)
    }

    /// Of a logarithmic axis only whole powers are named, where there are enough of them.
    fn label_at(&self, place: f64, length: f64) -> String {
        if !self.logarithmic {
            return format::number(if place.abs() < 1e-9 * length { 0.0 } else { place });
        }
        let whole = libm::round(place);
        match (place - whole).abs() < 1e-6 {
            true if (-2.0..4.0).contains(&whole) => format::number(libm::exp10(whole)),
            true => format!("10{}", format::superscript(&format!("{whole}"))),
            false if length < 1.5 => format::number(two_digits(libm::exp10(place))),
            false => String::new(),
        }
    }
}

fn two_digits(value: f64) -> f64 {
    let unit = libm::exp10(libm::floor(libm::log10(value)) - 1.0);
    libm::round(value / unit) * unit
}

/// Puts the page's colours in place of those that stand for them, and lets the page decide how large it is.
fn themed(svg: &str) -> String {
    let hex = |RGBColor(r, g, b): RGBColor| format!("\"#{r:02X}{g:02X}{b:02X}\"");
    let mut out = svg.replace(&hex(INK), "\"currentColor\"").replace(&hex(GRID), "\"var(--grid)\"");
    for (i, dashes) in DASHES.iter().enumerate() {
        let name = hex(of_curve(i));
        let line = format!("stroke={name}");
        out = out.replace(&line, &format!("stroke=\"var(--curve-{i})\" stroke-dasharray=\"{dashes}\""));
        out = out.replace(&name, &format!("\"var(--curve-{i})\""));
    }
    let (width, height) = SIZE;
    let size = format!("width=\"{width}\" height=\"{height}\" ");
    out.replacen(&size, "aria-hidden=\"true\" ", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_has_the_colours_of_the_page_and_no_others() {
        let chart = Chart::new("photons", "error").logarithmic();
        let chart = chart.points("a", vec![(1.0, 2.0), (1000.0, 0.1), (0.0, 1.0)]);
        let plot = chart.line("b", vec![(1.0, 1.0), (1000.0, f64::NAN)]).draw("alt", "caption").unwrap();
        assert!(plot.svg.contains("var(--curve-0)") && plot.svg.contains("currentColor"), "{}", plot.svg);
        assert!(!plot.svg.contains("\"#") && !plot.svg.contains("width=\"480\""), "{}", plot.svg);
        assert_eq!(plot.svg.matches("<circle").count(), 2);
        assert_eq!(plot.names, ["a", "b"]);
    }

    #[test]
    fn charts_without_points_or_of_one_are_drawn() {
        assert!(Chart::new("x", "y").draw("", "").is_ok());
        let one = Chart::new("x", "y").logarithmic().points("a", vec![(1.0, 1.0)]);
        assert!(one.draw("", "").is_ok());
        let nine = (0..9).fold(Chart::new("x", "y"), |chart, _| chart.line("a", vec![]));
        assert!(nine.draw("", "").is_err());
    }
}
