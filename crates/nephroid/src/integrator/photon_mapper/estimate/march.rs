//! Ray marching: photons near points of a ray.

use super::in_scatter::Segment;
use super::{PhotonMapper, Tools};
use crate::color::Rgb;
use crate::integrator::{FromVolume, Probe};
use crate::math::{Vec3, real};
use crate::medium::Profile;
use crate::photon_map::{Bandwidth, Gathered, VolumeMap, VolumeQuery};
use crate::sampling::Sampler;

/// Of how many parts of the scene a step of the report's march is one.
const REPORT_STEPS: f32 = 128.0;

/// The most steps of the other, however small what it finds.
const MOST_STEPS: f32 = 4096.0;

impl PhotonMapper<'_> {
    /// In steps as long as the radius of the last estimate, over which what it finds can change. In each a
    /// point is sampled by transmittance, so that the steps' lengths make no error.
    pub(super) fn march<P: Probe>(
        &self,
        map: &VolumeMap,
        segment: &Segment<'_>,
        profile: &Profile,
        sampler: &mut Sampler,
        tools: &mut Tools<'_, P>,
    ) -> FromVolume {
        let end = segment.end.min(segment.matter.reach(segment.ray));
        let (mut count, mut sum) = (0, Rgb::BLACK);
        let (mut from, mut radius) =
            (0.0, map.default_max_radius_in(segment.medium(), self.config.volume_neighbours()));
        // The medium may have no photons.
        if radius <= 0.0 || !end.is_finite() {
            return FromVolume::default();
        }
        while from < end {
            let step = radius.max(end / MOST_STEPS);
            // The last step takes what would be left of another.
            let to = if from + 1.5 * step < end { from + step } else { end };
            let t = profile.sample(sampler.next_1d(), from, to);
            let pdf = profile.pdf(t, from, to);
            let (source, found) = self.source(map, segment, segment.ray.at(t), tools);
            if pdf > 0.0 {
                sum += profile.transmittance(t) * source / pdf;
            }
            count += found.count;
            (from, radius) = (to, found.radius);
        }
        FromVolume { count, radiance: sum }
    }

    /// L(x_k) = σ_s L_i Δx + e^(−σ_t Δx) L(x_(k−1)), from the far end (the report's §3.1).
    pub(super) fn march_report<P: Probe>(
        &self,
        map: &VolumeMap,
        segment: &Segment<'_>,
        tools: &mut Tools<'_, P>,
    ) -> FromVolume {
        let end = segment.end.min(segment.matter.reach(segment.ray));
        if map.default_max_radius_in(segment.medium(), 2) <= 0.0 || !end.is_finite() {
            return FromVolume::default();
        }
        let step = self.config.march_step.unwrap_or(2.0 * self.world.radius() / REPORT_STEPS);
        let step = step.max(end / MOST_STEPS);
        let steps = (end / step).ceil().max(1.0);
        (0..steps as u32).rev().fold(FromVolume::default(), |behind, k| {
            let near = k as f32 * step;
            let length = step.min(end - near);
            let position = segment.ray.at(near);
            let extinction = segment.matter.sigma_t(position);
            let left = extinction.map(|sigma| real::exp(-sigma * length));
            let (source, found) = self.source(map, segment, position, tools);
            let radiance = source * length + left * behind.radiance;
            FromVolume { count: behind.count + found.count, radiance }
        })
    }

    /// The radiance scattered per length at a point towards the origin of the ray, in W/(m³·sr), and the photons that
    /// were found.
    fn source<P: Probe>(
        &self,
        map: &VolumeMap,
        segment: &Segment<'_>,
        position: Vec3,
        tools: &mut Tools<'_, P>,
    ) -> (Rgb, Gathered) {
        let (wo, phase) = (-segment.ray.direction, segment.matter.phase());
        let (k, medium) = (self.config.volume_neighbours(), segment.medium());
        let nearest = Bandwidth::Nearest { k, max_radius: map.default_max_radius_in(medium, k) };
        let bandwidth = self.maps.blur.narrow(nearest, 3);
        let max_photon_depth =
            self.config.max_depth.map(|max| max.saturating_sub(segment.depth).min(65_535) as u16);
        let query = VolumeQuery { position, medium, max_photon_depth };
        let mut sum = Rgb::BLACK;
        let gathered = map.at(&query, self.config.kernel, bandwidth, tools.neighbors, |photon, weight| {
            sum += photon.power * (phase.eval(wo, photon.wi) * weight);
        });
        (sum, gathered)
    }
}
