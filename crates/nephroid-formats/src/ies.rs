//! Light distributions of luminaires: IES LM-63 files, of 1986 to 2019.

use nephroid::color::Rgb;
use nephroid::texture::Image;
use thiserror::Error;

/// Angles along each axis that a file may have: one for each hundredth of a degree.
const MOST_ANGLES: usize = 36_001;

/// The intensities of a luminaire.
#[derive(Clone, Debug, PartialEq)]
pub struct IesProfile {
    /// The intensity in each direction over the largest, in the equirectangular layout of
    /// [`EnvironmentMapping`](nephroid::light::EnvironmentMapping): the last row is straight below, local −y, the file's
    /// vertical angle of 0. Its horizontal angle of 0 is local +x, and that of 90° local −z.
    ///
    /// A `Goniometric` light with it has the intensity that the scene names where it is brightest, as `pbrt` has it for the
    /// images of its goniometric lights.
    pub table: Image,
    /// The largest intensity in cd, with all of the file's factors. Over 683 lm/W it is one in W/sr for which a radiance of 1
    /// in every channel stands for 683 cd/m².
    pub peak_candela: f32,
}

/// Why a file is no light distribution.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum IesError {
    /// There is no line that begins the numbers.
    #[error("no IES file: it has no line \"TILT=\"")]
    NoTilt,
    /// It ends too early.
    #[error("the file ends before its {0}")]
    Ends(&'static str),
    /// Something that should be a number.
    #[error("\"{text}\" among its {part} is not a number")]
    Number {
        /// What stands there.
        text: String,
        /// Where.
        part: &'static str,
    },
    /// Numbers of angles that cannot be.
    #[error("{0} vertical and {1} horizontal angles; there are at least one of each and at most 36001")]
    Counts(f64, f64),
    /// Photometry about another axis.
    #[error("photometry of type {0}; type C, which is 1, can be read")]
    Type(f64),
    /// Angles in no order or beyond the sphere.
    #[error("its {0} angles do not rise within the range that the format has for them")]
    Angles(&'static str),
    /// An intensity or a factor that is no light.
    #[error("{0} as an intensity or factor: each must be finite and not negative")]
    Value(f64),
    /// All intensities are zero.
    #[error("all of its intensities are zero")]
    Dark,
}

/// Reads the text of an IES file with photometry of type C. What it says of tilted lamps is left out: the luminaire hangs as it
/// was measured.
///
/// # Errors
///
/// What it has instead.
pub fn read_ies(text: &str) -> Result<IesProfile, IesError> {
    let mut numbers = Numbers::after_tilt(text)?;
    let [_lamps, _lumens, multiplier, vertical, horizontal, kind] = numbers.some("header")?;
    let [_unit, _width, _length, _height, ballast, ballast_lamp, _watts] = numbers.some("header")?;
    if kind != 1.0 {
        return Err(IesError::Type(kind));
    }
    let count = |n: f64| (n.fract() == 0.0 && n >= 1.0 && n <= MOST_ANGLES as f64).then_some(n as usize);
    let (Some(rows), Some(columns)) = (count(vertical), count(horizontal)) else {
        return Err(IesError::Counts(vertical, horizontal));
    };
    let vertical = numbers.list(rows, "vertical angles")?;
    let horizontal = numbers.list(columns, "horizontal angles")?;
    let planes = (0..columns).map(|_| numbers.list(rows, "intensities")).collect::<Result<Vec<_>, _>>()?;
    for value in planes.iter().flatten().chain([&multiplier, &ballast, &ballast_lamp]) {
        if !(*value >= 0.0 && value.is_finite()) {
            return Err(IesError::Value(*value));
        }
    }
    if !rises(&vertical) || vertical[0] < 0.0 || vertical[rows - 1] > 180.0 {
        return Err(IesError::Angles("vertical"));
    }
    let symmetry = Symmetry::of(&horizontal).ok_or(IesError::Angles("horizontal"))?;
    let peak = planes.iter().flatten().fold(0.0, |peak: f64, value| peak.max(*value));
    let peak_candela = (peak * multiplier * ballast * ballast_lamp) as f32;
    if !(peak_candela > 0.0 && peak_candela.is_finite()) {
        return Err(IesError::Dark);
    }
    let measured = Measured { vertical, horizontal, planes, symmetry };
    Ok(IesProfile { table: measured.table(peak), peak_candela })
}

/// What is left of a file's numbers.
struct Numbers<'t>(std::vec::IntoIter<&'t str>);

impl<'t> Numbers<'t> {
    /// Those behind the header and the factors for tilted lamps.
    fn after_tilt(text: &'t str) -> Result<Self, IesError> {
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            start += line.len();
            if let Some(tilt) = line.trim_start().strip_prefix("TILT=") {
                let words = text[start..].split(|c: char| c.is_whitespace() || c == ',');
                let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
                let mut numbers = Self(words.into_iter());
                if tilt.trim() == "INCLUDE" {
                    let [_geometry, angles] = numbers.some("tilt")?;
                    for _ in 0..angles.max(0.0) as usize {
                        let [_angle, _factor] = [numbers.next("tilt")?, numbers.next("tilt")?];
                    }
                }
                return Ok(numbers);
            }
        }
        Err(IesError::NoTilt)
    }

    fn next(&mut self, part: &'static str) -> Result<f64, IesError> {
        let word = self.0.next().ok_or(IesError::Ends(part))?;
        word.parse().map_err(|_| IesError::Number { text: word.chars().take(40).collect(), part })
    }

    fn some<const N: usize>(&mut self, part: &'static str) -> Result<[f64; N], IesError> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.next(part)?;
        }
        Ok(values)
    }

    fn list(&mut self, count: usize, part: &'static str) -> Result<Vec<f64>, IesError> {
        if self.0.len() < count {
            return Err(IesError::Ends(part));
        }
        (0..count).map(|_| self.next(part)).collect()
    }
}

fn rises(angles: &[f64]) -> bool {
    angles.windows(2).all(|pair| pair[0] < pair[1]) && angles.iter().all(|angle| angle.is_finite())
}

/// Which of the horizontal angles a file leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Symmetry {
    /// The same all around.
    Around,
    /// The four quarters mirror one another.
    Quarters,
    /// Two halves do, on either side of the plane from 0° to 180°.
    Halves,
    /// The same with the plane from 90° to 270°.
    HalvesAcross,
    /// None.
    Whole,
}

impl Symmetry {
    /// By the first and the last angle. `None` where they are none of the format's.
    fn of(angles: &[f64]) -> Option<Self> {
        if !rises(angles) {
            return None;
        }
        match (angles[0], angles[angles.len() - 1]) {
            (first, last) if first == last => Some(Self::Around),
            (0.0, 90.0) => Some(Self::Quarters),
            (0.0, 180.0) => Some(Self::Halves),
            (90.0, 270.0) => Some(Self::HalvesAcross),
            // Some leave out 360°, which is 0° again.
            (0.0, last) if last > 180.0 && last <= 360.0 => Some(Self::Whole),
            _ => None,
        }
    }

    /// The angle that the file has for one in [0, 360).
    fn folded(self, angle: f64) -> f64 {
        match self {
            Self::Around => 0.0,
            Self::Quarters => {
                let half = angle % 180.0;
                half.min(180.0 - half)
            }
            Self::Halves => angle.min(360.0 - angle),
            Self::HalvesAcross => 90.0 + Self::Halves.folded((angle + 270.0) % 360.0),
            Self::Whole => angle,
        }
    }
}

/// Intensities by angles in degrees: of each horizontal one a plane.
struct Measured {
    vertical: Vec<f64>,
    horizontal: Vec<f64>,
    planes: Vec<Vec<f64>>,
    symmetry: Symmetry,
}

impl Measured {
    /// A pixel for each degree, or for each half where angles are finer.
    fn table(&self, peak: f64) -> Image {
        let whole = |angles: &[f64]| angles.iter().all(|angle| angle.fract() == 0.0);
        let height: u32 = if whole(&self.vertical) { 181 } else { 361 };
        let width: u32 = match self.symmetry {
            Symmetry::Around => 1,
            _ if whole(&self.horizontal) => 360,
            _ => 720,
        };
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            let below = 180.0 * (1.0 - f64::from(y) / f64::from(height - 1));
            for x in 0..width {
                // Columns go from −z by +x, and angles from +x by −z.
                let turn = 360.0 * (f64::from(x) + 0.5) / f64::from(width);
                let around = (450.0 - turn) % 360.0;
                pixels.push(Rgb::splat((self.at(below, around) / peak) as f32));
            }
        }
        Image { width, height, pixels }
    }

    fn at(&self, below: f64, around: f64) -> f64 {
        // What was not measured is dark.
        let rows = &self.vertical;
        if below < rows[0] || below > rows[rows.len() - 1] {
            return 0.0;
        }
        let (row, t) = place(rows, below);
        let in_plane =
            |plane: usize| mix(self.planes[plane][row], self.planes[plane][(row + 1).min(rows.len() - 1)], t);
        let folded = self.symmetry.folded(around);
        let last = self.horizontal[self.horizontal.len() - 1];
        if self.symmetry == Symmetry::Whole && folded > last {
            return mix(in_plane(self.planes.len() - 1), in_plane(0), (folded - last) / (360.0 - last));
        }
        let (plane, t) = place(&self.horizontal, folded);
        mix(in_plane(plane), in_plane((plane + 1).min(self.planes.len() - 1)), t)
    }
}

/// Which of rising angles comes before one, and how far it is to the next.
fn place(angles: &[f64], angle: f64) -> (usize, f64) {
    let index = angles.partition_point(|a| *a <= angle).saturating_sub(1);
    match angles.get(index + 1) {
        Some(next) => (index, ((angle - angles[index]) / (next - angles[index])).clamp(0.0, 1.0)),
        None => (index, 0.0),
    }
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a * (1.0 - t) + b * t
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(vertical: &str, horizontal: &str, values: &str) -> String {
        let counts = [vertical, horizontal].map(|list| list.split_whitespace().count());
        format!(
            "IESNA:LM-63-2002\n[TEST] a lamp\n[MANUFAC] none\nTILT=NONE\n1 1000 2.0 {} {} 1 2 0.1 0.1 0\n0.5 1.0 50\n{vertical}\n\
             {horizontal}\n{values}\n",
            counts[0], counts[1]
        )
    }

    /// The value at a vertical and a horizontal angle, at which there is a column's middle.
    fn value(profile: &IesProfile, below: f64, around: f64) -> f32 {
        let Image { width, height, .. } = profile.table;
        let y = ((1.0 - below / 180.0) * f64::from(height - 1)).round() as u32;
        let turn = (450.0 - around) % 360.0;
        let x = (turn / 360.0 * f64::from(width)) as u32;
        profile.table.pixel(x.min(width - 1), y).g
    }

    #[test]
    fn a_lamp_that_is_the_same_all_around_has_one_column() {
        let profile = read_ies(&file("0 45 90", "0", "100 200 0")).expect("a profile");
        assert_eq!((profile.table.width, profile.table.height), (1, 181));
        assert_eq!(profile.peak_candela, 200.0);
        assert_eq!(value(&profile, 0.0, 0.0), 0.5);
        assert_eq!(value(&profile, 45.0, 0.0), 1.0);
        assert!((value(&profile, 18.0, 0.0) - 0.7).abs() < 1e-6);
        assert_eq!((value(&profile, 90.0, 0.0), value(&profile, 120.0, 0.0)), (0.0, 0.0));
    }

    #[test]
    fn what_is_left_out_for_symmetry_is_mirrored() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} instead of {b}");
        // Values rise with the angle: at 45.5° and its mirror images a half and a bit.
        let quarters = read_ies(&file("0 90", "0 90", "0 0\n 9 9")).expect("quarters");
        for around in [45.5, 134.5, 225.5, 314.5] {
            near(value(&quarters, 30.0, around), 45.5 / 90.0);
        }
        let halves = read_ies(&file("0 90", "0 180", "0 0\n 9 9")).expect("halves");
        for around in [45.5, 314.5] {
            near(value(&halves, 30.0, around), 45.5 / 180.0);
        }
        let across = read_ies(&file("0 90", "90 270", "0 0\n 9 9")).expect("halves across");
        for (around, folded) in [(135.5, 45.5), (44.5, 45.5), (269.5, 179.5), (270.5, 179.5)] {
            near(value(&across, 30.0, around), folded / 180.0);
        }
        let whole = read_ies(&file("0 90", "0 90 180 270 360", "0 0 1 1 2 2 4 4 0 0")).expect("a whole");
        near(value(&whole, 30.0, 225.5), (2.0 + 2.0 * 45.5 / 90.0) / 4.0);
        near(value(&whole, 30.0, 315.5), (4.0 - 4.0 * 45.5 / 90.0) / 4.0);
        let open = read_ies(&file("0 90", "0 90 180 270", "0 0 1 1 2 2 4 4")).expect("a whole");
        assert_eq!(open.table, whole.table);
    }

    #[test]
    fn tilted_lamps_are_passed_over() {
        let plain = file("0 90", "0", "3 1");
        let tilted = plain.replace("TILT=NONE", "TILT=INCLUDE\n1\n3\n0 90 180\n1 0.9 0.8");
        assert_eq!(read_ies(&tilted), read_ies(&plain));
        // Without a first line, as in 1986, and with commas.
        let old = plain.replacen("IESNA:LM-63-2002\n", "", 1).replace("0 90", "0, 90");
        assert_eq!(read_ies(&old), read_ies(&plain));
    }

    #[test]
    fn what_is_no_distribution_is_refused() {
        let error = |text: &str| read_ies(text).expect_err("an error");
        let good = file("0 90", "0", "3 1");
        assert_eq!(error("IESNA:LM-63-2002\n"), IesError::NoTilt);
        assert_eq!(error(&file("0 90", "0", "3")), IesError::Ends("intensities"));
        assert_eq!(error(&file("90 0", "0", "3 1")), IesError::Angles("vertical"));
        assert_eq!(error(&file("0 90", "0 45", "3 1 3 1")), IesError::Angles("horizontal"));
        assert_eq!(error(&file("0 90", "0", "0 0")), IesError::Dark);
        assert_eq!(error(&file("0 90", "0", "3 -1")), IesError::Value(-1.0));
        assert_eq!(error(&good.replace("2 1 1 2", "2 1 3 2")), IesError::Type(3.0));
        assert_eq!(error(&good.replace("2 1 1 2", "1e9 1 1 2")), IesError::Counts(1e9, 1.0));
        assert!(matches!(error(&good.replace("1000", "many")), IesError::Number { .. }));
        assert!(matches!(error(&file("0 90", "0", "3 x")), IesError::Number { .. }));
    }

    /// Whatever is left of a file, nothing panics.
    #[test]
    fn any_part_of_a_file_gives_a_profile_or_an_error() {
        let text = file("0 30 90", "0 90", "3 1 2 2 0 1");
        for end in 0..text.len() {
            for start in [0, 30, 60] {
                let _ = read_ies(text.get(start.min(end)..end).unwrap_or_default());
            }
        }
    }
}
