//! The page.

use askama::Template;

use crate::body::Part;
use crate::keep::Finished;
use crate::section::Section;
use crate::sections::SECTIONS;
use crate::study::Settings;

#[derive(Template)]
#[template(path = "page.html")]
struct Page<'a> {
    finished: &'a [(&'static Section, Finished)],
    missing: Vec<&'static Section>,
    numbers: usize,
    broken: usize,
    command: String,
    quick: bool,
    seed: u64,
    version: &'static str,
}

/// The page of all sections that there are.
pub fn render(
    finished: &[(&'static Section, Finished)],
    settings: &Settings,
) -> Result<String, askama::Error> {
    let is_missing = |section: &&Section| finished.iter().all(|(own, _)| own.id != section.id);
    let numbers = || finished.iter().flat_map(|(_, finished)| finished.body.all_numbers());
    let page = Page {
        finished,
        missing: SECTIONS.iter().filter(is_missing).collect(),
        numbers: numbers().filter(|number| number.band.is_some()).count(),
        broken: numbers().filter(|number| !number.holds()).count(),
        command: command(settings),
        quick: settings.quick,
        seed: settings.seed,
        version: env!("CARGO_PKG_VERSION"),
    };
    page.render()
}

/// What makes the whole page again.
fn command(settings: &Settings) -> String {
    let quick = if settings.quick { " --quick" } else { "" };
    let seed = if settings.seed == 0 { String::new() } else { format!(" --seed {}", settings.seed) };
    format!("nephroid study{quick}{seed}")
}

#[cfg(test)]
mod tests {
    /// The value of each colour of a block of the style sheet, linear, by name.
    fn colours(block: &str) -> Vec<(&str, f64)> {
        let pairs =
            block.split([';', '{', '}']).filter_map(|pair| pair.trim().strip_prefix("--")?.split_once(": #"));
        pairs.map(|(name, hex)| (name, luminance(hex))).collect()
    }

    /// Relative luminance of a colour in sRGB, as WCAG 2.2 has it.
    fn luminance(hex: &str) -> f64 {
        let channel = |i: usize| {
            let value = f64::from(u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()) / 255.0;
            if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
        };
        0.2126 * channel(0) + 0.7152 * channel(1) + 0.0722 * channel(2)
    }

    fn contrast(a: f64, b: f64) -> f64 {
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn letters_and_curves_stand_out_from_both_papers() {
        assert!((contrast(luminance("ffffff"), luminance("000000")) - 21.0).abs() < 1e-9);
        let css = include_str!("../templates/page.css");
        let blocks: Vec<_> = css.split(":root").skip(1).take(2).map(colours).collect();
        assert_eq!(blocks.len(), 2);
        for block in blocks {
            let of = |name: &str| block.iter().find(|(own, _)| *own == name).unwrap().1;
            // WCAG's least: 4.5 for letters, 3 for lines that say something.
            for paper in ["paper", "panel"] {
                for ink in ["ink", "soft", "link", "good", "bad"] {
                    assert!(contrast(of(ink), of(paper)) >= 4.5, "{ink} on {paper}");
                }
                for curve in 0..8 {
                    let name = format!("curve-{curve}");
                    assert!(contrast(of(&name), of(paper)) >= 3.0, "{name} on {paper}");
                }
            }
        }
    }
}
