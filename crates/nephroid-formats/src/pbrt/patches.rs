//! Shapes of patches and of subdivided triangles.

use nephroid::handle::Handle;
use nephroid::shape::Mesh;

use super::parameters::Parameters;
use super::reader::Reader;
use crate::mesh::{Patches, loop_subdivision};

/// Triangles of a subdivided surface, and patches of a shape that may become 512 triangles each.
const MAX_TRIANGLES: usize = 1 << 22;

impl Reader<'_> {
    pub(super) fn bilinear_mesh(&mut self, parameters: &Parameters) -> Option<Handle<Mesh>> {
        let indices = self.indices(parameters, 4);
        let corners = self.vertices(parameters)?;
        let indices = match indices? {
            Some(indices) => indices,
            None if corners.positions.len() == 4 => vec![0, 1, 2, 3],
            None => {
                self.log.error(&parameters.at, "\"bilinearmesh\" lacks \"integer indices\"");
                return None;
            }
        };
        if let Some(image) = parameters.any("emissionfilename") {
            self.log.warn(&image.location, "\"emissionfilename\" of a shape cannot be had yet");
        }
        parameters.ignore(&["faceIndices"]);
        self.indices_fit(parameters, &indices, corners.positions.len())?;
        if indices.len() / 4 > MAX_TRIANGLES / 512 {
            let message = format!("more than {} patches", MAX_TRIANGLES / 512);
            self.log.error(&parameters.at, message);
            return None;
        }
        let patches = indices.as_chunks::<4>().0.to_vec();
        let Mesh { positions, normals, uvs, .. } = corners;
        match (Patches { positions, normals, uvs, patches }).to_mesh() {
            Ok(mesh) => self.store_mesh(parameters, mesh),
            Err(error) => {
                self.log.error(&parameters.at, error.message);
                None
            }
        }
    }

    pub(super) fn loop_subdivision(&mut self, parameters: &Parameters) -> Option<Handle<Mesh>> {
        let levels =
            parameters.integer(if parameters.has("nlevels") { "nlevels" } else { "levels" }, 3, 0..=12);
        parameters.ignore(&["scheme"]);
        let indices = self.indices(parameters, 3);
        let mut cage = self.vertices(parameters)?;
        let Some(indices) = indices? else {
            self.log.error(&parameters.at, "\"loopsubdiv\" lacks \"integer indices\"");
            return None;
        };
        self.indices_fit(parameters, &indices, cage.positions.len())?;
        if (indices.len() / 3) << (2 * levels) > MAX_TRIANGLES {
            let message = format!("{levels} levels make more than {MAX_TRIANGLES} triangles");
            self.log.error(&parameters.at, message);
            return None;
        }
        cage.triangles = indices.as_chunks::<3>().0.to_vec();
        match loop_subdivision(&cage, levels) {
            Ok(mesh) => self.store_mesh(parameters, mesh),
            Err(error) => {
                self.log.error(&parameters.at, error.message);
                None
            }
        }
    }
}
