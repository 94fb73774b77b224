use super::cloud::Cloud;
use super::distance::lit_length;
use super::field::Field;
use super::profile::Profile;
use super::{Grid, Medium, Phase, uniform};
use crate::color::Rgb;
use crate::handle::Arena;
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;

/// The optical depth behind which 2·10⁻⁹ is left.
const OPAQUE: f32 = 20.0;

/// A medium as light meets it.
#[derive(Clone, Debug)]
pub(crate) struct Matter {
    phase: Phase,
    extinction: Extinction,
    albedo: Field,
    emission: Field,
    emits: bool,
    ambient: Rgb,
}

#[derive(Clone, Debug)]
enum Extinction {
    Uniform(Rgb),
    Cloud(Box<Cloud>),
}

/// What becomes of light on its way through a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Passage {
    /// It collides after so long a way. `weight` is transmittance times extinction over the density
    /// of such a collision: 1 in the mean over all that can happen. The albedo is not in it.
    Collision { t: f32, weight: Rgb },
    /// It comes through, with transmittance over the probability of that.
    Through { weight: Rgb },
}

impl Matter {
    /// Of a medium that passed the check.
    pub fn new(medium: &Medium, grids: &Arena<Grid>) -> Self {
        let extinction = match Field::new(&medium.sigma_t, grids) {
            Field::Constant(sigma_t) => Extinction::Uniform(sigma_t),
            Field::Placed(placed) => Extinction::Cloud(Box::new(Cloud::new(placed))),
        };
        let emission = Field::new(&medium.emission, grids);
        Self {
            phase: medium.phase,
            extinction,
            albedo: Field::new(&medium.albedo, grids),
            emits: !emission.is_black(),
            emission,
            ambient: medium.ambient,
        }
    }

    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The radiance scattered by ambient fog, in W/(m²·sr).
    pub fn ambient(&self) -> Rgb {
        self.ambient
    }

    /// The transmittance of a way in a medium that is the same everywhere, and 1 elsewhere.
    #[inline]
    pub fn attenuation(&self, length: f32) -> Rgb {
        match &self.extinction {
            Extinction::Uniform(sigma_t) => uniform::attenuation(*sigma_t, length),
            Extinction::Cloud(_) => Rgb::WHITE,
        }
    }

    /// Where along a ray the last of the extinction lies, or less than 2·10⁻⁹ is left of every channel that has any:
    /// nothing is scattered beyond. Finite but for extinctions that are nearly zero.
    pub fn reach(&self, ray: &Ray) -> f32 {
        match &self.extinction {
            Extinction::Uniform(sigma_t) => {
                sigma_t.to_array().into_iter().filter(|s| *s > 0.0).map(|s| OPAQUE / s).fold(0.0, f32::max)
            }
            Extinction::Cloud(cloud) => cloud.exit(ray),
        }
    }

    /// How far along a ray what the medium gives off is seen. Extinctions end with their grid, behind which emission
    /// goes on, to the end of the medium if that has one.
    fn shining(&self, ray: &Ray, t_max: f32) -> f32 {
        match &self.extinction {
            Extinction::Uniform(sigma_t) => t_max.min(OPAQUE / sigma_t.min_channel()),
            Extinction::Cloud(_) if t_max.is_finite() => t_max,
            Extinction::Cloud(cloud) => cloud.exit(ray),
        }
    }

    /// The radiance that the medium itself gives off towards the origin of a ray with a direction of unit length,
    /// from its way to `t_max`, in W/(m²·sr); right in the mean.
    pub fn emitted(&self, ray: &Ray, t_max: f32, sampler: &mut Sampler) -> Rgb {
        match (&self.extinction, &self.emission) {
            _ if !self.emits => Rgb::BLACK,
            (Extinction::Uniform(sigma_t), Field::Constant(emission)) => {
                sigma_t.zip(*emission, |sigma_t, emission| emission * lit_length(sigma_t, t_max))
            }
            _ => {
                let end = self.shining(ray, t_max);
                let t = end * sampler.next_1d();
                self.emission(ray.at(t)) * self.transmittance(ray, t, sampler) * end
            }
        }
    }

    /// The extinction if it is the same everywhere.
    pub fn uniform_extinction(&self) -> Option<Rgb> {
        match &self.extinction {
            Extinction::Uniform(sigma_t) => Some(*sigma_t),
            Extinction::Cloud(_) => None,
        }
    }

    /// Whether it scatters any light.
    pub fn scatters(&self) -> bool {
        let stops = match &self.extinction {
            Extinction::Uniform(sigma_t) => !sigma_t.is_black(),
            Extinction::Cloud(_) => true,
        };
        stops && !self.albedo.is_black()
    }

    /// Whether it gives off light.
    pub fn emits(&self) -> bool {
        self.emits
    }

    /// 1/m.
    #[inline]
    pub fn sigma_t(&self, p: Vec3) -> Rgb {
        match &self.extinction {
            Extinction::Uniform(sigma_t) => *sigma_t,
            Extinction::Cloud(cloud) => cloud.at(p),
        }
    }

    #[inline]
    pub fn albedo(&self, p: Vec3) -> Rgb {
        self.albedo.at(p)
    }

    /// W/(m³·sr).
    #[inline]
    pub fn emission(&self, p: Vec3) -> Rgb {
        self.emission.at(p)
    }

    /// Transmittance along a ray with a direction of unit length from its origin to `t_max`, which may be
    /// infinite; right in the mean.
    #[inline]
    pub fn transmittance(&self, ray: &Ray, t_max: f32, sampler: &mut Sampler) -> Rgb {
        match &self.extinction {
            Extinction::Uniform(sigma_t) => uniform::attenuation(*sigma_t, t_max),
            Extinction::Cloud(cloud) => cloud.transmittance(ray, t_max, sampler),
        }
    }

    /// Goes along a ray with a direction of unit length, at most to `t_max`, which may be infinite, with light
    /// that carries `carried`, to which the chances are fitted. Right in the mean for every channel that
    /// carries something; and the sum of what is carried times its weight is the same before and after.
    #[inline]
    pub fn travel(&self, ray: &Ray, t_max: f32, carried: Rgb, sampler: &mut Sampler) -> Passage {
        match &self.extinction {
            Extinction::Uniform(sigma_t) => uniform::travel(*sigma_t, t_max, carried, sampler),
            Extinction::Cloud(cloud) => cloud.travel(ray, t_max, carried, sampler, |_, _, _| {}),
        }
    }

    /// The same, and tells `passed` of stretches of the way and of their weights. Right in the mean is at each point of
    /// the ray the weight of a stretch that contains it; where there is a closed form for that, none is told.
    #[inline]
    pub fn travel_and_tell(
        &self,
        ray: &Ray,
        t_max: f32,
        carried: Rgb,
        sampler: &mut Sampler,
        passed: impl FnMut(f32, f32, Rgb),
    ) -> Passage {
        match &self.extinction {
            Extinction::Uniform(_) => self.travel(ray, t_max, carried, sampler),
            Extinction::Cloud(cloud) => cloud.travel(ray, t_max, carried, sampler, passed),
        }
    }

    /// The transmittance along a ray with a direction of unit length, up to `t_max`, without noise.
    pub fn profile_into(&self, ray: &Ray, t_max: f32, profile: &mut Profile) {
        match &self.extinction {
            Extinction::Uniform(sigma_t) => profile.reset(*sigma_t),
            Extinction::Cloud(cloud) => {
                profile.reset(Rgb::BLACK);
                cloud.profile(ray, t_max, profile);
            }
        }
    }
    /// The same, in memory of its own.
    #[cfg(test)]
    pub fn profile(&self, ray: &Ray, t_max: f32) -> Profile {
        let mut profile = Profile::default();
        self.profile_into(ray, t_max, &mut profile);
        profile
    }
}
