//! How rough a material is.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::{Distribution, Roughness};
use nephroid::texture::Texture;

use super::parameters::Parameters;
use super::reader::Reader;
use crate::diagnostic::Location;
use crate::spectra::Role;

/// What is not rougher is smooth: a lobe so sharp is a mirror for every purpose.
const SMOOTH: f32 = 1e-3;

impl Reader<'_> {
    /// The roughness that is given along u, along v or for both; `None` if it is smooth.
    pub(super) fn roughness(
        &mut self,
        parameters: &Parameters,
        [along_u, along_v, both]: [&'static str; 3],
        default: f32,
    ) -> Option<Roughness> {
        let remap = parameters.boolean("remaproughness", true);
        let at = parameters.at.clone();
        let mut alpha = |name: &'static str| {
            let name = if parameters.has(name) { name } else { both };
            let texture = self.texture_or_color(parameters, name, Rgb::splat(default), Role::Index)?;
            Some(self.alpha(texture, remap, &at))
        };
        let (u, v) = (alpha(along_u), alpha(along_v));
        // Where one is given for each, the other counts for nothing.
        parameters.ignore(&[both]);
        let (alpha_u, alpha_v) = (u?, v?);
        let smooth = |texture| self.constant(texture).is_some_and(|value| value.max_channel() <= SMOOTH);
        if smooth(alpha_u) && smooth(alpha_v) {
            return None;
        }
        let alpha_v = if self.constant(alpha_u).is_some() && self.constant(alpha_u) == self.constant(alpha_v)
        {
            alpha_u
        } else {
            alpha_v
        };
        Some(Roughness { distribution: Distribution::Ggx, alpha_u, alpha_v })
    }

    /// The width of the distribution of slopes: the root of a roughness between 0 and 1, or what is given.
    fn alpha(&mut self, texture: Handle<Texture>, remap: bool, at: &Location) -> Handle<Texture> {
        let texture = if remap { self.root(texture, at) } else { texture };
        match self.constant(texture) {
            Some(value) if value.max_channel() > 1.0 => {
                self.log.warn(at, "a roughness above 1 is taken for 1");
                self.store_texture(at, Texture::Constant(Rgb::WHITE))
            }
            _ => texture,
        }
    }
}
