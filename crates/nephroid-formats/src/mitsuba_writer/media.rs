//! Participating media.

use nephroid::color::Rgb;
use nephroid::medium::{Coefficient, Phase};

use super::{Writer, vol};
use crate::image::ImageError;

impl Writer<'_, '_> {
    pub(super) fn media(&mut self) -> Result<(), ImageError> {
        let scene = self.scene;
        for medium in scene.media.list.iter() {
            let id = self.id(&medium.name);
            // The factor of an extinction has a property of its own.
            let (sigma_t, scale) = match &medium.sigma_t {
                Coefficient::Grid { grid, to_world, scale } => {
                    (Coefficient::Grid { grid: *grid, to_world: *to_world, scale: 1.0 }, *scale)
                }
                constant => (constant.clone(), 1.0),
            };
            let is_uniform = matches!(sigma_t, Coefficient::Constant(_));
            let volumes = [("sigma_t", &sigma_t), ("albedo", &medium.albedo), ("emission", &medium.emission)];
            let mut files = Vec::new();
            for (name, coefficient) in volumes {
                files.push(self.grid_file(&format!("{id}-{name}"), coefficient)?);
            }
            self.xml.plugin("medium", if is_uniform { "homogeneous" } else { "heterogeneous" }, &id);
            if scale != 1.0 {
                self.xml.float("scale", scale);
            }
            for ((name, coefficient), file) in volumes.into_iter().zip(files) {
                if name != "emission" || *coefficient != Coefficient::ZERO {
                    self.coefficient(name, coefficient, file);
                }
            }
            if medium.ambient != Rgb::BLACK {
                self.warn(format!("{id}: Mitsuba knows no ambient light of media"));
            }
            match medium.phase {
                Phase::Isotropic => self.xml.bare_plugin("phase", "isotropic"),
                Phase::Rayleigh => self.xml.bare_plugin("phase", "rayleigh"),
                Phase::HenyeyGreenstein { g } => {
                    self.xml.plugin("phase", "hg", "");
                    self.xml.float("g", g);
                    self.xml.close();
                }
            }
            self.xml.close();
            self.media.push(id);
        }
        Ok(())
    }

    fn grid_file(&mut self, name: &str, coefficient: &Coefficient) -> Result<Option<String>, ImageError> {
        match coefficient {
            Coefficient::Constant(_) => Ok(None),
            Coefficient::Grid { grid, scale, .. } => {
                let bytes = vol::encode(&self.scene.media.grids[*grid], *scale);
                self.store(&format!("{name}.vol"), bytes).map(Some)
            }
        }
    }

    fn coefficient(&mut self, name: &str, coefficient: &Coefficient, file: Option<String>) {
        match (coefficient, file) {
            (Coefficient::Constant(value), _) => self.xml.rgb(name, *value),
            (Coefficient::Grid { to_world, .. }, file) => {
                self.xml.open("volume", &[("type", "gridvolume"), ("name", name)]);
                self.xml.string("filename", &file.unwrap_or_default());
                self.xml.transform("to_world", to_world);
                self.xml.close();
            }
        }
    }
}
