use crate::color::Rgb;

/// Where the power of one light went, in W per channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// What the light gave off.
    pub emitted: [f64; 3],
    /// What surfaces took, booked before roulette.
    pub absorbed: [f64; 3],
    /// What media took, ambient fog's attenuation included.
    pub absorbed_by_media: [f64; 3],
    /// What left the scene.
    pub escaped: [f64; 3],
    /// What an option such as a depth limit cut off.
    pub ended: [f64; 3],
    /// What roulette took less what it gave to survivors, and the same of distances in media that were
    /// sampled for all channels at once: zero in the mean.
    pub roulette: [f64; 3],
    /// Sum of squares of the roulette entries of single paths, for the mean of the channels.
    roulette_sq: f64,
}

/// The energy of a photon pass: emitted = absorbed by surfaces and by media + escaped + ended + roulette, for each light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    /// One for each light, in the order of the world's lights.
    pub lights: Vec<Balance>,
    /// Paths that the sums are over.
    pub paths: u64,
}

impl Ledger {
    /// Empty books for a number of lights.
    pub fn new(lights: usize) -> Self {
        Self { lights: vec![Balance::default(); lights], paths: 0 }
    }

    /// Adds the books of further paths.
    pub fn append(&mut self, more: &Self) {
        self.paths += more.paths;
        for (mine, theirs) in self.lights.iter_mut().zip(&more.lights) {
            for (to, from) in [
                (&mut mine.emitted, theirs.emitted),
                (&mut mine.absorbed, theirs.absorbed),
                (&mut mine.absorbed_by_media, theirs.absorbed_by_media),
                (&mut mine.escaped, theirs.escaped),
                (&mut mine.ended, theirs.ended),
                (&mut mine.roulette, theirs.roulette),
            ] {
                add(to, from);
            }
            mine.roulette_sq += theirs.roulette_sq;
        }
    }

    /// The books in W: divided by the number of paths emitted.
    #[must_use]
    pub fn per_path(&self) -> Self {
        let k = 1.0 / self.paths.max(1) as f64;
        let scale = |v: [f64; 3]| v.map(|x| x * k);
        let lights = self
            .lights
            .iter()
            .map(|b| Balance {
                emitted: scale(b.emitted),
                absorbed: scale(b.absorbed),
                absorbed_by_media: scale(b.absorbed_by_media),
                escaped: scale(b.escaped),
                ended: scale(b.ended),
                roulette: scale(b.roulette),
                roulette_sq: b.roulette_sq * k * k,
            })
            .collect();
        Self { lights, paths: self.paths }
    }
}

impl Balance {
    /// Mean of the channels of emitted − absorbed (by surfaces and media) − escaped − ended − roulette, relative to what was
    /// emitted: rounding, and nothing else.
    pub fn imbalance(&self) -> f64 {
        let residue: f64 = (0..3)
            .map(|c| {
                let absorbed = self.absorbed[c] + self.absorbed_by_media[c];
                self.emitted[c] - absorbed - self.escaped[c] - self.ended[c] - self.roulette[c]
            })
            .sum();
        let emitted: f64 = self.emitted.iter().sum();
        if emitted > 0.0 { residue / emitted } else { residue }
    }

    /// The roulette line's mean channel over its standard error; within ±4 but once in 16 000 renders.
    /// Where roulette decides nothing, because surfaces take nothing, only rounding is left to sum,
    /// always to the same side: one unit in the last place of the emitted power counts as error too.
    pub fn roulette_z(&self) -> f64 {
        let mean = |v: [f64; 3]| v.iter().sum::<f64>() / 3.0;
        let rounding = f64::from(f32::EPSILON) * mean(self.emitted);
        let error = (self.roulette_sq + rounding * rounding).sqrt();
        if error > 0.0 { mean(self.roulette) / error } else { 0.0 }
    }

    pub(super) fn emit(&mut self, power: Rgb) {
        book(&mut self.emitted, power);
    }

    pub(super) fn absorb(&mut self, power: Rgb) {
        book(&mut self.absorbed, power);
    }

    pub(super) fn absorb_in_medium(&mut self, power: Rgb) {
        book(&mut self.absorbed_by_media, power);
    }

    pub(super) fn escape(&mut self, power: Rgb) {
        book(&mut self.escaped, power);
    }

    pub(super) fn end(&mut self, power: Rgb) {
        book(&mut self.ended, power);
    }

    /// Books the sum of a path's roulette entries.
    pub(super) fn roulette(&mut self, taken: [f64; 3]) {
        add(&mut self.roulette, taken);
        let mean = taken.iter().sum::<f64>() / 3.0;
        self.roulette_sq += mean * mean;
    }
}

fn add(to: &mut [f64; 3], from: [f64; 3]) {
    for (t, f) in to.iter_mut().zip(from) {
        *t += f;
    }
}

fn book(to: &mut [f64; 3], power: Rgb) {
    add(to, power.to_array().map(f64::from));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roulette_that_only_rounds_is_no_deviation() {
        let mut white = Balance::default();
        let mut grey = Balance::default();
        for _ in 0..10_000 {
            white.emit(Rgb::WHITE);
            white.roulette([-1e-8; 3]);
            grey.emit(Rgb::WHITE);
            grey.roulette([1e-3; 3]);
        }
        assert!(white.roulette_z().abs() < 4.0, "{}", white.roulette_z());
        assert!(grey.roulette_z() > 50.0, "{}", grey.roulette_z());
        assert_eq!(Balance::default().roulette_z(), 0.0);
    }
}
