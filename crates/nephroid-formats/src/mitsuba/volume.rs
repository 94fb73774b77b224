//! `<volume>` elements: quantities in space.

use nephroid::handle::Handle;
use nephroid::math::Transform;
use nephroid::medium::{Coefficient, Grid};

use super::document::Element;
use super::names::{VOLUMES, VOLUMES_LATER};
use super::properties::Plugin;
use super::reader::Reader;
use crate::spectra::Role;
use crate::volume::{VolumeFile, read_vol};

/// A grid that was read, and the map from [0, 1]³ to the box in its file; what is wrong with the box if
/// there is none.
#[derive(Clone)]
pub(super) struct StoredGrid {
    handle: Handle<Grid>,
    to_bounds: Result<Transform, String>,
}

impl<'t> Reader<'t> {
    /// A `<volume>`. `None` if the log says why.
    pub(super) fn volume(&mut self, element: &'t Element, role: Role) -> Option<Coefficient> {
        let plugin = self.plugin(element);
        let coefficient = match plugin.kind {
            "constvolume" => {
                plugin.ignore(&["to_world"]);
                Some(Coefficient::Constant(self.color_property(&plugin, "value", 1.0, role)))
            }
            "gridvolume" => self.grid_volume(&plugin),
            kind if VOLUMES_LATER.contains(&kind) => {
                self.left_out(plugin.location(), &format!("a medium with the volume \"{kind}\""));
                return None;
            }
            _ => {
                self.unknown_kind(&plugin, &[VOLUMES, VOLUMES_LATER]);
                return None;
            }
        };
        plugin.finish();
        coefficient
    }

    fn grid_volume(&mut self, plugin: &Plugin<'t>) -> Option<Coefficient> {
        let mut to_world = plugin.transform("to_world");
        let use_bounds = plugin.boolean("use_grid_bbox", false);
        self.only_choice(plugin, "filter_type", "trilinear", &["nearest"]);
        self.only_choice(plugin, "wrap_mode", "clamp", &["repeat", "mirror"]);
        plugin.ignore(&["raw", "accel", "max_value"]);
        let Some((name, at)) = plugin.text("filename") else {
            if !plugin.has("filename") {
                self.log.error(plugin.location(), "volume \"gridvolume\" lacks a filename");
            }
            return None;
        };
        let (path, bytes) = self.read_file(name, at)?;
        let stored = match self.grid_of.get(&path) {
            Some(stored) => stored.clone(),
            None => match read_vol(&bytes) {
                Ok(file) => {
                    let to_bounds = file.to_bounds().map_err(|error| format!("{}: {error}", path.display()));
                    let VolumeFile { size, values, negative, .. } = file;
                    if negative > 0 {
                        let message = format!("{}: {negative} values below zero become zero", path.display());
                        self.log.warn(at, message);
                    }
                    let handle =
                        self.media.grids.push(Grid { name: path.display().to_string(), size, values });
                    self.origins.grids.push(at.clone());
                    let stored = StoredGrid { handle, to_bounds };
                    self.grid_of.insert(path, stored.clone());
                    stored
                }
                Err(error) => {
                    self.log.error(at, format!("{}: {error}", path.display()));
                    return None;
                }
            },
        };
        if use_bounds {
            match stored.to_bounds {
                Ok(to_bounds) => to_world = to_bounds.then(to_world),
                Err(message) => {
                    self.log.error(at, message);
                    return None;
                }
            }
        }
        Some(Coefficient::Grid { grid: stored.handle, to_world, scale: 1.0 })
    }

    /// A choice between what can be rendered and what `only` stands for.
    fn only_choice(&self, plugin: &Plugin<'t>, name: &'static str, only: &'static str, later: &[&str]) {
        let choices: Vec<_> =
            std::iter::once((only, true)).chain(later.iter().map(|word| (*word, false))).collect();
        if let (false, Some((text, at))) = (plugin.choice(name, true, &choices), plugin.text(name)) {
            self.log.warn(at, format!("{name} \"{text}\" cannot be had yet; \"{only}\" stands for it"));
        }
    }
}
