use super::{Coefficient, Grid, Medium, Phase};
use crate::color::Rgb;
use crate::handle::Arena;
use crate::math::{Ray, Vec3, real};
use crate::sampling::Sampler;

/// A medium as light meets it.
#[derive(Clone, Debug)]
pub(crate) struct Matter {
    phase: Phase,
    sigma_t: Rgb,
    albedo: Rgb,
    emission: Rgb,
    ambient: Rgb,
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

/// The transmittance along a ray from its origin on.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    sigma_t: Rgb,
}

impl Profile {
    /// Samples a distance between two by the transmittance of the mean channel; the farther may be infinite.
    pub fn sample(&self, u: f32, from: f32, to: f32) -> f32 {
        let sigma = self.sigma_t.mean();
        if sigma == 0.0 {
            return from + u * (to - from);
        }
        let share = -real::exp_m1(-sigma * (to - from));
        (from - real::ln(1.0 - u * share) / sigma).min(to)
    }

    /// The density of [`Self::sample`] per length.
    pub fn pdf(&self, t: f32, from: f32, to: f32) -> f32 {
        let sigma = self.sigma_t.mean();
        if sigma == 0.0 {
            return 1.0 / (to - from);
        }
        sigma * real::exp(-sigma * (t - from)) / -real::exp_m1(-sigma * (to - from))
    }

    /// Transmittance from the origin to `t`.
    #[inline]
    pub fn transmittance(&self, t: f32) -> Rgb {
        attenuation(self.sigma_t, t)
    }
}

impl Matter {
    pub fn new(medium: &Medium, _grids: &Arena<Grid>) -> Self {
        let constant = |c: &Coefficient| match c {
            Coefficient::Constant(value) => *value,
            Coefficient::Grid { .. } => Rgb::BLACK,
        };
        Self {
            phase: medium.phase,
            sigma_t: constant(&medium.sigma_t),
            albedo: constant(&medium.albedo),
            emission: constant(&medium.emission),
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

    /// The extinction if it is the same everywhere.
    pub fn uniform_extinction(&self) -> Option<Rgb> {
        Some(self.sigma_t)
    }

    /// Whether it gives off light.
    pub fn emits(&self) -> bool {
        !self.emission.is_black()
    }

    pub fn sigma_t(&self, _p: Vec3) -> Rgb {
        self.sigma_t
    }

    pub fn albedo(&self, _p: Vec3) -> Rgb {
        self.albedo
    }

    /// W/(m³·sr).
    pub fn emission(&self, _p: Vec3) -> Rgb {
        self.emission
    }

    /// Transmittance along a ray with a direction of unit length from its origin to `t_max`, which may be
    /// infinite; right in the mean.
    pub fn transmittance(&self, _ray: &Ray, t_max: f32, _sampler: &mut Sampler) -> Rgb {
        attenuation(self.sigma_t, t_max)
    }

    /// The transmittance of a way in a medium that is the same everywhere.
    pub fn attenuation(&self, length: f32) -> Rgb {
        attenuation(self.sigma_t, length)
    }

    /// How far light may come through, along any ray, before less than 2·10⁻⁹ of every channel is left.
    pub fn reach(&self, _ray: &Ray) -> f32 {
        20.0 / self.sigma_t.min_channel()
    }

    /// Goes along a ray with a direction of unit length, at most to `t_max`, which may be infinite, with light that carries
    /// `carried`, to which the channel that decides is fitted. Right in the mean for every channel.
    pub fn travel(&self, _ray: &Ray, t_max: f32, carried: Rgb, sampler: &mut Sampler) -> Passage {
        let share = carried / (carried.r + carried.g + carried.b);
        let (u_channel, u) = (sampler.next_1d(), sampler.next_1d());
        let channel = match u_channel {
            u if u < share.r => self.sigma_t.r,
            u if u < share.r + share.g => self.sigma_t.g,
            _ => self.sigma_t.b,
        };
        let t = -real::ln(1.0 - u) / channel;
        if t < t_max {
            let density = self.sigma_t * attenuation(self.sigma_t, t);
            Passage::Collision { t, weight: density / (share * density).sum() }
        } else {
            let through = attenuation(self.sigma_t, t_max);
            Passage::Through { weight: through / (share * through).sum() }
        }
    }

    /// The radiance that the medium itself gives off towards the origin of a ray with a direction of unit length,
    /// from its way to `t_max`, in W/(m²·sr); right in the mean.
    pub fn emitted(&self, _ray: &Ray, t_max: f32, _sampler: &mut Sampler) -> Rgb {
        self.sigma_t.zip(self.emission, |sigma_t, emission| emission * lit_length(sigma_t, t_max))
    }

    /// The transmittance along a ray with a direction of unit length, up to `t_max`, without noise.
    pub fn profile(&self, _ray: &Ray, _t_max: f32) -> Profile {
        Profile { sigma_t: self.sigma_t }
    }
}

/// The integral of the transmittance up to t: (1 − e^(−σt)) / σ, and t where there is nothing.
fn lit_length(sigma_t: f32, t: f32) -> f32 {
    if sigma_t > 0.0 { -real::exp_m1(-sigma_t * t) / sigma_t } else { t }
}

/// e^(−σt), and 1 where there is nothing even on an infinite way.
fn attenuation(sigma_t: Rgb, t: f32) -> Rgb {
    let through = |sigma: f32| if sigma > 0.0 { real::exp(-sigma * t) } else { 1.0 };
    Rgb::new(through(sigma_t.r), through(sigma_t.g), through(sigma_t.b))
}
