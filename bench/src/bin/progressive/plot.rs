//! Curves of errors on logarithmic axes, as SVG.

use std::path::Path;

use plotters::prelude::*;

use super::Curve;

const SIZE: (u32, u32) = (640, 420);

/// Colours that can be told apart without seeing red from green (Okabe and Ito 2008).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

/// Draws the curves, and a dashed line at the pace of the theory for surfaces, t^(−2/3).
pub fn draw(path: &Path, curves: &[Curve]) -> Result<(), String> {
    chart(path, curves).map_err(|e| format!("{}: {e}", path.display()))
}

fn chart(path: &Path, curves: &[Curve]) -> Result<(), Box<dyn std::error::Error>> {
    // A picture that is as good as its reference has no error to show.
    let points: Vec<(f64, f64)> =
        curves.iter().flat_map(|curve| &curve.points).copied().filter(|p| p.1 > 0.0).collect();
    let ends = |of: fn(&(f64, f64)) -> f64| {
        let values = points.iter().map(of);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max))
    };
    let ((first, last), (least, most)) = (ends(|p| p.0), ends(|p| p.1));
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(58)
        .build_cartesian_2d((0.8 * first..1.2 * last).log_scale(), (0.7 * least..1.5 * most).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("CPU seconds")
        .y_desc("relMSE")
        .max_light_lines(1)
        .light_line_style(RGBColor(238, 238, 238))
        .label_style(("sans-serif", 13))
        .x_labels(40)
        .y_labels(40)
        .x_label_formatter(&|x| {
            if [1, 2, 5].contains(&leading_digit(*x)) { format!("{x}") } else { String::new() }
        })
        .y_label_formatter(&|y| if leading_digit(*y) == 1 { format!("{y:.0e}") } else { String::new() })
        .draw()?;
    for (curve, color) in curves.iter().zip(COLORS.iter().cycle()) {
        let points = || curve.points.iter().copied().filter(|p| p.1 > 0.0);
        chart
            .draw_series(LineSeries::new(points(), color.stroke_width(2)))?
            .label(&curve.name)
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
        chart.draw_series(points().map(|p| Circle::new(p, 3, color.filled())))?;
    }
    let pace = |x: f64| (x, most * (x / first).powf(-2.0 / 3.0));
    let gray = RGBColor(120, 120, 120);
    let steps = (0..=40).map(|i| first * (last / first).powf(f64::from(i) / 40.0));
    chart
        .draw_series(DashedLineSeries::new(
            steps.map(pace).filter(|p| p.1 > 0.7 * least),
            6,
            4,
            gray.stroke_width(1),
        ))?
        .label("pace t^(-2/3)")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], gray.stroke_width(1)));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 13))
        .draw()?;
    root.present()?;
    Ok(())
}

/// The first digit that is not zero, for there is no room for a label at each line.
fn leading_digit(value: f64) -> i64 {
    (value / 10_f64.powf((value.log10() + 1e-9).floor())).round() as i64
}
