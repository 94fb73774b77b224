#![allow(missing_docs)]
use super::{Bandwidth, Gathered, Kernel, NearestList};
use crate::color::Rgb;
use crate::math::{Ray, Vec3};
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumePhoton {
    pub position: Vec3,
    pub power: Rgb,
    pub wi: Vec3,
    pub depth: u16,
    pub light: u32,
    pub medium: u16,
}
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VolumePhotons {
    photons: Vec<VolumePhoton>,
    emitted: u64,
}
impl VolumePhotons {
    pub fn new(emitted: u64, photons: Vec<VolumePhoton>) -> Self {
        Self { photons, emitted }
    }
}
pub struct VolumeMap(VolumePhotons);
impl VolumeMap {
    pub fn build(photons: VolumePhotons, _k: u32) -> Self {
        Self(photons)
    }
    pub fn len(&self) -> usize {
        self.0.photons.len()
    }
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    pub fn emitted(&self) -> u64 {
        self.0.emitted
    }
    pub fn memory_bytes(&self) -> usize {
        0
    }
    pub fn default_max_radius(&self, _k: u32) -> f32 {
        0.1
    }
    pub fn along(
        &self,
        ray: &Ray,
        t_max: f32,
        medium: u16,
        kernel: Kernel,
        mut visit: impl FnMut(f32, &VolumePhoton, f32),
    ) {
        for p in &self.0.photons {
            let t = (p.position - ray.origin).dot(ray.direction);
            if t > 0.0 && t < t_max && medium == p.medium {
                let d = (p.position - ray.at(t)).length_squared();
                let w = kernel.weight_2d(d, 0.0025);
                if w > 0.0 {
                    visit(t, &VolumePhoton { power: p.power / self.0.emitted as f32, ..*p }, w)
                }
            }
        }
    }
    #[allow(clippy::too_many_arguments)]
    pub fn at(
        &self,
        _position: Vec3,
        _medium: u16,
        _depth: Option<u16>,
        _bandwidth: Bandwidth,
        _kernel: Kernel,
        _neighbors: &mut NearestList,
        _visit: impl FnMut(&VolumePhoton, f32),
    ) -> Gathered {
        Gathered { radius: 0.1, count: 0 }
    }
}
