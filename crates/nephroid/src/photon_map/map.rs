use std::f32::consts::PI;

use rayon::prelude::*;

use super::grid_tree::{BlockVisitor, GridTree};
use super::index::PhotonIndex;
use super::payload::{Payload, PayloadBlock};
use super::photon::{Photon, Photons};
use crate::bvh::{LANES, Lanes, Simd, Work};
use crate::color::Rgb;
use crate::math::Vec3;

/// The default of the largest radius, in radii that hold the photons wanted at the map's mean
/// density: a place with a quarter of it still finds them all. Larger ones blur the dark places and
/// let a search run over the whole map; smaller ones turn k nearest into a fixed radius there.
const DEFAULT_MAX_RADIUS: f32 = 2.0;

/// Photons on surfaces and an index over them. Never changes.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonMap<I = GridTree> {
    index: I,
    payloads: Vec<PayloadBlock>,
    emitted: u64,
}

impl<I: PhotonIndex> PhotonMap<I> {
    /// Arranges photons and divides their power by the number of paths emitted.
    ///
    /// Positions must be finite. Panics with 2³² photons or more.
    pub fn build(photons: Photons) -> Self {
        let (index, payloads) = I::build_with(photons.stored(), arranged(&photons));
        Self { index, payloads: blocks(&payloads, |p| *p), emitted: photons.emitted() }
    }

    /// As [`Self::build`]; also returns, for each place, the number in the pass of the photon there.
    pub fn build_ordered(photons: Photons) -> (Self, Vec<u32>) {
        let arranged = arranged(&photons);
        let with_number = |i| {
            let (position, payload) = arranged(i);
            (position, (payload, i as u32))
        };
        let (index, items) = I::build_with(photons.stored(), with_number);
        let payloads = blocks(&items, |(payload, _)| *payload);
        (Self { index, payloads, emitted: photons.emitted() }, items.iter().map(|(_, i)| *i).collect())
    }

    /// Where the photons are.
    pub fn index(&self) -> &I {
        &self.index
    }

    /// How many photons it holds. Nothing is ever divided by this.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// Paths emitted to make it, including those that stored nothing.
    pub fn emitted(&self) -> u64 {
        self.emitted
    }

    /// The photon at a place of the index, with its share of the light's power. Its position is exact;
    /// directions are off by up to 6.5·10⁻⁵, lights from 65 535 on have that number, and the mantissas of
    /// power have eight bits, rounded up or down by chance so that means are exact.
    #[inline(always)]
    pub fn photon(&self, place: u32) -> Photon {
        self.payload(place).decode(self.index.position(place))
    }

    #[inline(always)]
    pub(super) fn payload(&self, place: u32) -> Payload {
        self.payloads[place as usize / LANES].get(place as usize % LANES)
    }

    /// Bytes of heap memory.
    pub fn memory_bytes(&self) -> usize {
        self.index.memory_bytes() + size_of_val(self.payloads.as_slice())
    }
}

fn blocks<T: Sync>(items: &[T], payload: impl Fn(&T) -> Payload + Sync) -> Vec<PayloadBlock> {
    items.par_chunks(LANES).map(|items| PayloadBlock::new(items.iter().map(&payload))).collect()
}

/// What becomes of each photon of a pass: its place and all else about it.
fn arranged(photons: &Photons) -> impl Fn(usize) -> (Vec3, Payload) + Sync {
    let share = (1.0 / photons.emitted().max(1) as f64) as f32;
    move |i| {
        let photon = &photons.as_slice()[i];
        (photon.position, Payload::new(&Photon { power: photon.power * share, ..*photon }, i as u32))
    }
}

impl PhotonMap<GridTree> {
    /// The power of all photons within a radius, whatever the surface they lie on: eight are added at a
    /// time, in an order that the map and the query alone decide.
    pub fn power_within(&self, center: Vec3, radius: f32) -> Rgb {
        self.power_within_by(Simd::detect(), center, radius)
    }

    fn power_within_by(&self, simd: Simd, center: Vec3, radius: f32) -> Rgb {
        let sums = simd.run(PowerWithin { map: self, center, radius_sq: radius * radius });
        let [r, g, b] = sums.map(|lanes| lanes.iter().sum());
        Rgb { r, g, b }
    }

    /// The radius of a disc with `k` photons at the mean density over [`GridTree::covered_area`]; 0 if
    /// there are no photons or all lie on a line along an axis.
    pub fn typical_radius(&self, k: u32) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        (k as f32 * self.index.covered_area() / (PI * self.len() as f32)).sqrt()
    }

    /// A largest radius for searches of the `k` nearest photons that fits maps of any scale: twice
    /// [`Self::typical_radius`], but not more than the radius of the sphere around all photons, which
    /// also takes its place if it is 0.
    pub fn default_max_radius(&self, k: u32) -> f32 {
        let (_, whole) = self.index.bounds().bounding_sphere();
        let radius = DEFAULT_MAX_RADIUS * self.typical_radius(k);
        if radius > 0.0 { radius.min(whole) } else { whole }
    }
}

/// See [`PhotonMap::power_within`].
struct PowerWithin<'a> {
    map: &'a PhotonMap,
    center: Vec3,
    radius_sq: f32,
}

impl Work for PowerWithin<'_> {
    type Output = [[f32; LANES]; 3];

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let zero = L::splat(0.0);
        let mut sum = Sum { payloads: &self.map.payloads, sums: [zero; 3] };
        self.map.index.visit_blocks::<L, _>(self.center, self.radius_sq, &mut sum);
        let [r, g, b] = sum.sums;
        [r.store(), g.store(), b.store()]
    }
}

/// Adds up powers.
struct Sum<'a, L> {
    payloads: &'a [PayloadBlock],
    sums: [L; 3],
}

impl<L: Lanes> BlockVisitor<L> for Sum<'_, L> {
    #[inline(always)]
    fn visit(&mut self, number: usize, _: L, mask: L) {
        let [r, g, b] = self.payloads[number].powers(mask);
        self.sums = [self.sums[0].plus(r), self.sums[1].plus(g), self.sums[2].plus(b)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photon_map::BruteForce;
    use crate::photon_map::testing::{Rng, photon_at};

    fn map(photons: Vec<Photon>) -> PhotonMap {
        PhotonMap::build(Photons::new(1, photons))
    }

    fn square(n: usize, size: f32, tilted: bool) -> PhotonMap {
        let mut rng = Rng::new(1);
        let (s, t) = if tilted {
            (Vec3::new(1.0, -1.0, 0.0).normalize(), Vec3::new(1.0, 1.0, -2.0).normalize())
        } else {
            (Vec3::X, Vec3::Y)
        };
        map((0..n).map(|_| photon_at((s * rng.next() + t * rng.next()) * size, Vec3::Z)).collect())
    }

    #[test]
    fn power_is_divided_by_the_paths_emitted_and_not_by_the_photons_stored() {
        let mut photons = Photons::new(6, vec![photon_at(Vec3::X, Vec3::Z); 3]);
        photons.append(Photons::new(2, vec![photon_at(Vec3::Y, Vec3::Z)]));
        assert_eq!((photons.emitted(), photons.stored()), (8, 4));
        let tree: PhotonMap = PhotonMap::build(photons.clone());
        let oracle: PhotonMap<BruteForce> = PhotonMap::build(photons);
        let power = |map: &PhotonMap| (0..4).map(|i| map.photon(i).power).sum::<Rgb>();
        assert_eq!(power(&tree), Rgb::splat(0.5));
        assert_eq!(oracle.photon(3), Photon { power: Rgb::splat(0.125), ..photon_at(Vec3::Y, Vec3::Z) });
        assert_eq!(tree.emitted(), 8);
        let nothing: PhotonMap = PhotonMap::build(Photons::default());
        assert!(nothing.is_empty() && nothing.default_max_radius(50) == 0.0);
    }

    #[test]
    fn photons_keep_their_payload_when_arranged() {
        let mut rng = Rng::new(2);
        let photons: Vec<_> = (0..1000u32)
            .map(|i| Photon {
                light: i,
                depth: i as u16,
                power: Rgb::splat(i as f32),
                ..photon_at(Vec3::new(rng.next(), rng.next(), rng.next()), Vec3::Y)
            })
            .collect();
        let map = map(photons.clone());
        let mut seen: Vec<_> = (0..1000).map(|place| map.photon(place)).collect();
        seen.sort_by_key(|p| p.light);
        for (kept, given) in seen.iter().zip(&photons) {
            assert_eq!(Photon { power: given.power, ..*kept }, *given);
            assert!((kept.power.r - given.power.r).abs() <= given.power.r / 127.0);
        }
    }

    #[test]
    fn the_order_says_which_photon_of_the_pass_is_where() {
        let mut rng = Rng::new(3);
        let photons: Vec<_> = (0..1000).map(|_| photon_at(rng.point(), Vec3::Y)).collect();
        let (map, order): (PhotonMap, _) = PhotonMap::build_ordered(Photons::new(1, photons.clone()));
        assert!((0..1000).all(|place| map.photon(place) == photons[order[place as usize] as usize]));
    }

    #[test]
    fn memory_is_some_thirty_bytes_a_photon() {
        let per_photon = square(100_000, 1.0, false).memory_bytes() as f32 / 1e5;
        assert!((28.0..33.0).contains(&per_photon), "{per_photon}");
    }

    #[test]
    fn memory_has_a_bound_for_any_cloud() {
        let mut rng = Rng::new(4);
        let mut cloud = |place: &dyn Fn(usize, Vec3) -> Vec3| -> Vec<Photon> {
            (0..20_000).map(|i| photon_at(place(i, rng.point()), Vec3::Z)).collect()
        };
        let clouds = [
            ("a volume", cloud(&|_, p| p)),
            (
                "a plain a thousand times the room",
                cloud(&|i, p| if i % 2 == 0 { p } else { p.with_z(0.0) * 1e3 }),
            ),
            ("one far outlier", cloud(&|i, p| if i == 0 { Vec3::splat(1e6) } else { p.with_z(0.0) })),
            ("one place", cloud(&|_, _| Vec3::ONE)),
            ("a line", cloud(&|_, p| Vec3::splat(p.x))),
            ("clusters in clusters", cloud(&|_, p| p * crate::math::real::exp(-40.0 * p.x))),
            ("pairs", cloud(&|i, p| (Vec3::splat((i / 2) as f32 * 0.618) % 1.0) + p * 1e-6)),
        ];
        for (what, photons) in clouds {
            let per_photon = map(photons).memory_bytes() as f32 / 2e4;
            assert!(per_photon <= 40.0, "{what}: {per_photon}");
        }
    }

    /// Powers are small whole numbers, so that sums are exact in any order.
    #[test]
    fn power_within_a_radius_is_that_of_the_photons_found_there() {
        let mut rng = Rng::new(5);
        let mut cloud = |n: usize, place: &dyn Fn(Vec3) -> Vec3| -> PhotonMap {
            let power = |i: usize| Rgb { r: (i % 256) as f32, g: (i % 7) as f32, b: 128.0 };
            map((0..n)
                .map(|i| Photon { power: power(i), ..photon_at(place(rng.point()), Vec3::Z) })
                .collect())
        };
        let maps = [
            cloud(0, &|p| p),
            cloud(3, &|p| p),
            cloud(3000, &|p| p),
            cloud(3001, &|p| p.with_y(0.5)),
            cloud(1000, &|_| Vec3::splat(0.5)),
            cloud(2000, &|p| if p.x < 0.5 { p * 1e-3 } else { Vec3::ONE - p * 1e-4 }),
        ];
        let mut rng = Rng::new(6);
        for map in &maps {
            let places = (0..map.len() as u32).step_by(97).map(|place| map.photon(place).position);
            let centers: Vec<_> = (0..50).map(|_| rng.point() * 1.5 - 0.25).chain(places).collect();
            for center in centers {
                for radius in [0.0, 1e-4, 0.03, 0.2, 1.0, f32::INFINITY, f32::NAN] {
                    let mut expected = Rgb::BLACK;
                    let add = |place, _| expected += map.photon(place).power;
                    map.index().for_each_within(center, radius * radius, add);
                    for simd in [Simd::detect(), Simd::Portable] {
                        assert_eq!(map.power_within_by(simd, center, radius), expected, "{center} {radius}");
                    }
                }
            }
        }
    }

    #[test]
    fn covered_area_follows_the_surface_and_the_scale() {
        for (tilted, least, most) in [(false, 0.97, 1.03), (true, 0.97, 1.7)] {
            let area = square(20_000, 1.0, tilted).index().covered_area();
            assert!((least..most).contains(&area), "{area}");
            for size in [1.0 / 1024.0, 1048576.0] {
                assert_eq!(square(20_000, size, tilted).index().covered_area(), area * size * size);
            }
        }
        let map = square(20_000, 1.0, false);
        assert!((map.typical_radius(50) / (50.0 / (PI * 20_000.0)).sqrt() - 1.0).abs() < 0.03);
        assert_eq!(map.default_max_radius(50), 2.0 * map.typical_radius(50));
    }

    #[test]
    fn the_largest_radius_survives_degenerate_maps() {
        assert_eq!(map(vec![photon_at(Vec3::ONE, Vec3::Z); 100]).default_max_radius(50), 0.0);
        let line = map((0..100).map(|i| photon_at(Vec3::X * i as f32, Vec3::Z)).collect());
        assert_eq!(line.default_max_radius(50), 49.5);
        let few = square(3, 1.0, false);
        assert!(few.default_max_radius(50) <= 0.75 && few.default_max_radius(50) > 0.0);
    }
}
