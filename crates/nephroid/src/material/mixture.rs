//! What materials of several lobes have in common: which of them is drawn, and how they add up.

use super::bsdf::Transport;
use super::kind::Classes;
use super::part::Part;
use super::split::Split;
use crate::color::Rgb;
use crate::math::{Vec2, Vec3};

/// Lobes that one material may have.
pub(super) const MOST: usize = 5;

/// Materials that a blend may be made of.
pub(super) const MOST_PARTS: usize = 4;

/// How one material scatters, in directions of the shading frame: the normal is z, and `wo` and `wi` both leave the
/// surface, on either side. Each of its lobes has a number.
pub(super) trait Scatter {
    /// The class of each lobe; none where there is no such lobe.
    fn classes(&self) -> [Classes; MOST];

    /// What each lobe scatters of light from `wo`, roughly: what its chance is in proportion to. Above zero wherever
    /// the lobe is.
    fn shares(&self, wo: Vec3) -> [f32; MOST];

    /// f of the lobes of some classes, in 1/sr and without a cosine; with power carried from `wo` to `wi`, that of
    /// radiance carried from `wi` to `wo`.
    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb;

    /// Density per solid angle with which [`sample`](Self::sample) draws `wi` from a lobe.
    fn pdf(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32;

    /// Draws a direction from a lobe.
    fn sample(&self, lobe: usize, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<Vec3>;

    /// What radiance is multiplied by where a lobe refracts `wo` to `wi`.
    fn radiance_scale(&self, _lobe: usize, _wo: Vec3, _wi: Vec3) -> f32 {
        1.0
    }

    /// Whether lobes with a density lead to the other side.
    fn transmits(&self) -> bool {
        false
    }

    /// The Dirac lobes.
    fn split(&self, _wo: Vec3) -> Option<Split> {
        None
    }
}

/// The first lobes' values, and zeros for the others.
pub(super) fn lobes<T: Default + Copy, const N: usize>(first: [T; N]) -> [T; MOST] {
    let mut all = [T::default(); MOST];
    all[..N].copy_from_slice(&first);
    all
}

/// A material of a blend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weighed {
    pub weight: f32,
    /// Whether it is the back of a two-sided material, turned over.
    pub flipped: bool,
    pub part: Part,
}

impl Weighed {
    pub fn whole(part: Part) -> Self {
        Self { weight: 1.0, flipped: false, part }
    }

    /// A direction in its own frame, or back.
    fn turn(&self, w: Vec3) -> Vec3 {
        if self.flipped { Vec3::new(w.x, -w.y, -w.z) } else { w }
    }
}

/// Up to [`MOST_PARTS`] materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blend {
    count: usize,
    parts: [Weighed; MOST_PARTS],
}

impl Blend {
    /// `None` without any. Those beyond the most are left out.
    pub fn new(parts: &[Weighed]) -> Option<Self> {
        let count = parts.len().min(MOST_PARTS);
        let mut all = [*parts.first()?; MOST_PARTS];
        all[..count].copy_from_slice(&parts[..count]);
        Some(Self { count, parts: all })
    }

    pub fn parts(&self) -> &[Weighed] {
        &self.parts[..self.count]
    }
}

/// The classes of all lobes.
pub(super) fn classes(parts: &[Weighed]) -> Classes {
    parts.iter().flat_map(|w| w.part.classes()).fold(Classes::NONE, Classes::or)
}

/// f of the lobes of some classes.
pub(super) fn eval(parts: &[Weighed], among: Classes, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb {
    parts.iter().map(|w| w.part.eval(among, w.turn(wo), w.turn(wi), transport) * w.weight).sum()
}

/// What the lobes of some classes scatter of light from `wo`, roughly.
pub(super) fn share(parts: &[Weighed], among: Classes, wo: Vec3) -> f32 {
    let of = |w: &Weighed| -> f32 {
        let lobes = w.part.classes().into_iter().zip(w.part.shares(w.turn(wo)));
        lobes.filter(|(class, _)| class.meets(among)).map(|(_, share)| share * w.weight).sum()
    };
    parts.iter().map(of).sum()
}

/// The chances of the lobes of some classes.
pub(super) struct Chances {
    of: [[f32; MOST]; MOST_PARTS],
    classes: [[Classes; MOST]; MOST_PARTS],
}

impl Chances {
    /// `None` where there are no such lobes.
    pub fn new(parts: &[Weighed], among: Classes, wo: Vec3) -> Option<Self> {
        let mut of = [[0.0; MOST]; MOST_PARTS];
        let mut classes = [[Classes::NONE; MOST]; MOST_PARTS];
        let mut sum = 0.0;
        for (i, w) in parts.iter().enumerate() {
            classes[i] = w.part.classes();
            let shares = w.part.shares(w.turn(wo));
            for lobe in 0..MOST {
                if classes[i][lobe].meets(among) && shares[lobe] > 0.0 {
                    of[i][lobe] = w.weight * shares[lobe];
                    sum += of[i][lobe];
                }
            }
        }
        if sum <= 0.0 {
            return None;
        }
        of.iter_mut().flatten().for_each(|chance| *chance /= sum);
        Some(Self { of, classes })
    }

    /// The chance that the lobe drawn is of some classes.
    pub fn of_classes(&self, among: Classes) -> f32 {
        let all = self.of.iter().flatten().zip(self.classes.iter().flatten());
        all.filter(|(_, class)| class.meets(among)).map(|(chance, _)| chance).sum()
    }

    /// Density per solid angle with which `wi` is drawn from lobes of some classes, their chance included.
    pub fn pdf(&self, parts: &[Weighed], among: Classes, wo: Vec3, wi: Vec3) -> f32 {
        let among = among.and(Classes::DENSE);
        let mut sum = 0.0;
        for (i, w) in parts.iter().enumerate() {
            for lobe in 0..MOST {
                if self.of[i][lobe] > 0.0 && self.classes[i][lobe].meets(among) {
                    sum += self.of[i][lobe] * w.part.pdf(lobe, w.turn(wo), w.turn(wi));
                }
            }
        }
        sum
    }

    /// Draws a lobe.
    pub fn draw(&self, u_lobe: f32) -> Drawn {
        let (mut from, mut last) = (0.0, Drawn { part: 0, lobe: 0, class: Classes::NONE, u_lobe: 0.0 });
        for (part, chances) in self.of.iter().enumerate() {
            for (lobe, &chance) in chances.iter().enumerate() {
                if chance > 0.0 {
                    // Rounding may leave a last number beyond all.
                    let within = ((u_lobe - from) / chance).clamp(0.0, 1.0 - f32::EPSILON / 2.0);
                    last = Drawn { part, lobe, class: self.classes[part][lobe], u_lobe: within };
                    from += chance;
                    if u_lobe < from {
                        return last;
                    }
                }
            }
        }
        last
    }
}

/// A lobe that was drawn.
#[derive(Clone, Copy)]
pub(super) struct Drawn {
    part: usize,
    lobe: usize,
    pub class: Classes,
    /// What is left of the number that chose it.
    pub u_lobe: f32,
}

impl Drawn {
    /// A direction from the lobe; none on a side where the lobe is not, though others may be.
    pub fn sample(&self, parts: &[Weighed], wo: Vec3, u: Vec2) -> Option<Vec3> {
        let w = &parts[self.part];
        let wo = w.turn(wo);
        let wi = w.part.sample(self.lobe, wo, u, self.u_lobe)?;
        (w.part.pdf(self.lobe, wo, wi) > 0.0).then(|| w.turn(wi))
    }

    /// See [`Scatter::radiance_scale`].
    pub fn radiance_scale(&self, parts: &[Weighed], wo: Vec3, wi: Vec3) -> f32 {
        let w = &parts[self.part];
        w.part.radiance_scale(self.lobe, w.turn(wo), w.turn(wi))
    }
}

/// The Dirac lobes of all, in the frame of the whole. Only one of them refracts.
pub(super) fn split(parts: &[Weighed], wo: Vec3) -> Option<Split> {
    let mut sum: Option<Split> = None;
    for w in parts {
        let Some(mut own) = w.part.split(w.turn(wo)) else { continue };
        own.reflectance *= w.weight;
        if let Some(refraction) = &mut own.refraction {
            refraction.transmittance *= w.weight;
            refraction.wi = w.turn(refraction.wi);
        }
        if let Some(before) = sum {
            own.reflectance += before.reflectance;
            own.refraction = before.refraction.or(own.refraction);
            let passed = own.refraction.map_or(0.0, |refraction| refraction.transmittance.mean());
            let reflected = own.reflectance.mean();
            own.reflect_probability = if reflected > 0.0 { reflected / (reflected + passed) } else { 0.0 };
        }
        sum = Some(own);
    }
    sum
}
