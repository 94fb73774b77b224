//! The simple materials as parts of a blend.

use super::bsdf::Transport;
use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::kind::Classes;
use super::lambertian::Lambertian;
use super::mixture::{MOST, Scatter, lobes};
use super::phong::Phong;
use super::split::Split;
use crate::color::Rgb;
use crate::math::{Frame, Vec2, Vec3};

/// The shading frame in its own coordinates.
const LOCAL: Frame = Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z };

impl Scatter for Lambertian {
    fn classes(&self) -> [Classes; MOST] {
        lobes([Classes::DIFFUSE])
    }

    fn shares(&self, wo: Vec3) -> [f32; MOST] {
        lobes([if wo.z > 0.0 { self.albedo.mean() } else { 0.0 }])
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, _: Transport) -> Rgb {
        let seen = among.meets(Classes::DIFFUSE) && wo.z > 0.0 && wi.z > 0.0;
        if seen { Self::eval(self) } else { Rgb::BLACK }
    }

    fn pdf(&self, _: usize, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z > 0.0 { Self::pdf(Vec3::Z, wi) } else { 0.0 }
    }

    fn sample(&self, _: usize, _: Vec3, u: Vec2, _: f32) -> Option<Vec3> {
        Some(Self::sample(&LOCAL, u))
    }
}

impl Scatter for Phong {
    fn classes(&self) -> [Classes; MOST] {
        let of = |albedo: Rgb, class| if albedo.is_black() { Classes::NONE } else { class };
        lobes([of(self.diffuse, Classes::DIFFUSE), of(self.specular, Classes::GLOSSY)])
    }

    fn shares(&self, wo: Vec3) -> [f32; MOST] {
        if wo.z > 0.0 { lobes([self.diffuse.mean(), self.specular.mean()]) } else { [0.0; MOST] }
    }

    fn eval(&self, among: Classes, wo: Vec3, wi: Vec3, _: Transport) -> Rgb {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return Rgb::BLACK;
        }
        let of = |albedo, class| if among.meets(class) { albedo } else { Rgb::BLACK };
        let (diffuse, specular) = (of(self.diffuse, Classes::DIFFUSE), of(self.specular, Classes::GLOSSY));
        Self { diffuse, specular, ..*self }.eval(Vec3::Z, wo, wi)
    }

    fn pdf(&self, lobe: usize, wo: Vec3, wi: Vec3) -> f32 {
        let seen = wo.z > 0.0 && wi.z > 0.0;
        if seen { self.lobe(lobe).pdf(Vec3::Z, wo, wi) } else { 0.0 }
    }

    fn sample(&self, lobe: usize, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<Vec3> {
        Some(self.lobe(lobe).sample(&LOCAL, wo, u, u_lobe))
    }
}

impl Phong {
    /// One of the lobes alone.
    fn lobe(&self, lobe: usize) -> Self {
        if lobe == 0 { Self { specular: Rgb::BLACK, ..*self } } else { Self { diffuse: Rgb::BLACK, ..*self } }
    }
}

/// The smooth boundary of two dielectrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clear(pub Dielectric);

/// A thin slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thin(pub Dielectric);

/// Nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass;

/// Materials of Dirac lobes alone.
macro_rules! dirac {
    ($kind:ty, |$own:ident, $wo:ident| $split:expr) => {
        impl Scatter for $kind {
            fn classes(&self) -> [Classes; MOST] {
                lobes([Classes::DIRAC])
            }

            fn shares(&self, _: Vec3) -> [f32; MOST] {
                lobes([1.0])
            }

            fn eval(&self, _: Classes, _: Vec3, _: Vec3, _: Transport) -> Rgb {
                Rgb::BLACK
            }

            fn pdf(&self, _: usize, _: Vec3, _: Vec3) -> f32 {
                0.0
            }

            fn sample(&self, _: usize, _: Vec3, _: Vec2, _: f32) -> Option<Vec3> {
                None
            }

            fn split(&self, wo: Vec3) -> Option<Split> {
                let ($own, $wo) = (self, wo);
                $split
            }
        }
    };
}

dirac!(Conductor, |own, wo| (wo.z > 0.0).then(|| own.split(wo.z)));
dirac!(Clear, |own, wo| {
    let outside = wo.z > 0.0;
    Some(own.0.split(wo, if outside { Vec3::Z } else { -Vec3::Z }, outside))
});
dirac!(Thin, |own, wo| Some(own.0.split_thin(wo, wo.z)));
dirac!(Pass, |_own, wo| Some(Split::pass(wo, Rgb::WHITE)));
