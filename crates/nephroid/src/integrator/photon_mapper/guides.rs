//! Guides for gather rays, made once for a map and shared by the surfaces near them.

use rayon::prelude::*;

use super::guide::{Facing, Guide};
use super::{Maps, Turn};
use crate::integrator::{Method, progressive};
use crate::math::Vec3;
use crate::observer::Observer;
use crate::photon_map::{Bandwidth, GridTree, Kernel, NearestList, PhotonIndex, PhotonMap, Query, gather};
use crate::world::World;

/// One guide is made for so many photons of the map, at one of them …
const PHOTONS_PER_GUIDE: usize = 64;

/// … but not more than so many in all: neighbours can share them.
const MAX_GUIDES: usize = 8192;

/// Photons that a guide is made of: many, as noise comes from the bright places that none of them knew.
const GUIDE_PHOTONS: u32 = 512;

/// A surface takes guides only from others whose normal has at least this cosine with its own: 18°.
const MIN_NORMAL_COSINE: f32 = 0.95;

/// Densities over the hemisphere at some of the photons of a map. Any may be used anywhere without
/// bias; near its photon, on a surface of about the same normal, it also follows the light.
#[derive(Debug)]
pub(crate) struct Guides {
    index: GridTree,
    /// By place in the index, like the normals.
    guides: Vec<Guide>,
    normals: Vec<Vec3>,
    max_radius_sq: f32,
}

impl Guides {
    /// No guides.
    pub fn none() -> Self {
        Self::new(&PhotonMap::build(crate::photon_map::Photons::default()))
    }

    /// Those of an iteration: of its own photons, or in a series of iterations those that the first was given. `None`
    /// if the observer cancelled.
    pub fn of_turn(
        given: Option<Self>,
        world: &World,
        method: &Method,
        maps: &Maps,
        turn: &Turn,
        observer: &dyn Observer,
    ) -> Option<Self> {
        Some(match (method, given) {
            _ if !turn.gathers => Self::none(),
            (Method::Ppm(_), Some(guides)) => guides,
            (Method::Ppm(config), None) => progressive::guides(world, config, turn.seed, observer)?,
            _ => Self::new(&maps.global),
        })
    }

    /// Makes the guides of a map.
    pub fn new(map: &PhotonMap) -> Self {
        let step = PHOTONS_PER_GUIDE.max(map.len().div_ceil(MAX_GUIDES));
        let photons: Vec<_> = (0..map.len()).step_by(step).map(|place| map.photon(place as u32)).collect();
        let (index, order) = GridTree::build(photons.len(), |i| photons[i].position);
        let normals: Vec<Vec3> = order.iter().map(|&i| photons[i as usize].normal).collect();
        let max_radius = map.default_max_radius(GUIDE_PHOTONS);
        let guides = (0..photons.len() as u32)
            .into_par_iter()
            .map_init(NearestList::new, |scratch, place| {
                guide(map, index.position(place), normals[place as usize], max_radius, scratch)
            })
            .collect();
        Self { index, guides, normals, max_radius_sq: max_radius * max_radius }
    }

    /// The nearest guide for a point of a surface; `None` where no photon is near.
    pub(super) fn at(&self, position: Vec3, normal: Vec3, scratch: &mut NearestList) -> Option<Facing<'_>> {
        let alike = |place: u32, dist_sq| {
            (self.normals[place as usize].dot(normal) >= MIN_NORMAL_COSINE).then_some(dist_sq)
        };
        self.index.nearest(position, self.max_radius_sq, 1, alike, scratch);
        scratch.get(0).map(|nearest| self.guides[nearest.place as usize].facing(normal))
    }
}

/// The guide of the photons about a point.
fn guide(map: &PhotonMap, position: Vec3, normal: Vec3, max_radius: f32, scratch: &mut NearestList) -> Guide {
    let mut guide = Guide::new(normal);
    let query = Query { position, normal, max_photon_depth: None };
    let bandwidth = Bandwidth::Nearest { k: GUIDE_PHOTONS, max_radius };
    gather(map, &query, Kernel::Box, bandwidth, scratch, |photon, weight| {
        // Light that comes straight from a light is sampled there.
        if photon.depth > 1 {
            guide.add(photon.wi, photon.power, photon.power * weight);
        }
    });
    guide.finish();
    guide
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::photon_map::{Photon, Photons};

    /// Two walls back to back, a millimetre apart, lit from opposite corners of their hemispheres.
    #[test]
    fn a_surface_takes_the_guide_of_its_own_side() {
        let photons = (0..4000).map(|i| {
            let normal = if i % 2 == 0 { Vec3::Z } else { -Vec3::Z };
            let (x, y) = ((i % 61) as f32 / 61.0, (i % 67) as f32 / 67.0);
            Photon {
                position: Vec3::new(x, y, normal.z * 0.0005),
                power: Rgb::WHITE,
                wi: (normal + Vec3::X * normal.z).normalize(),
                normal,
                depth: 2,
                light: 0,
            }
        });
        let guides = Guides::new(&PhotonMap::build(Photons::new(1, photons.collect())));
        let mut scratch = NearestList::new();
        for normal in [Vec3::Z, -Vec3::Z] {
            let guide = guides.at(Vec3::new(0.5, 0.5, 0.0), normal, &mut scratch).unwrap();
            let (lit, dark) = (normal + Vec3::X * normal.z, normal - Vec3::X * normal.z);
            assert!(guide.pdf(lit.normalize()) > 10.0 * guide.pdf(dark.normalize()));
        }
        assert!(guides.at(Vec3::new(0.5, 0.5, 0.0), Vec3::Y, &mut scratch).is_none());
        assert!(guides.at(Vec3::splat(50.0), Vec3::Z, &mut scratch).is_none());
        assert!(Guides::none().at(Vec3::ZERO, Vec3::Z, &mut scratch).is_none());
    }
}
