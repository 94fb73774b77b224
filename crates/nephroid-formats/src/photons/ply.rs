use std::path::Path;

use nephroid::laboratory::MapPhoton;
use nephroid::math::Vec3;
use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Ply, PropertyAccess, PropertyDef, PropertyType, ScalarType,
};
use ply_rs_bw::writer::Writer;

use crate::image::{ImageError, ImageProblem, write_atomically};

/// The properties of a photon. `map` is 0 for global, 1 for caustic, 2 for afterglow, 3 for haze, 4 for
/// volume, 5 for volume-caustic; `bounce` counts bounces
/// before the photon landed; `path` numbers the paths emitted for the map, which may be more than 2³².
const PROPERTIES: [(&str, ScalarType); 13] = [
    ("x", ScalarType::Float),
    ("y", ScalarType::Float),
    ("z", ScalarType::Float),
    ("dx", ScalarType::Float),
    ("dy", ScalarType::Float),
    ("dz", ScalarType::Float),
    ("power_r", ScalarType::Float),
    ("power_g", ScalarType::Float),
    ("power_b", ScalarType::Float),
    ("map", ScalarType::UChar),
    ("bounce", ScalarType::UInt),
    ("light", ScalarType::UInt),
    ("path", ScalarType::Double),
];

/// Writes photons as the vertices of a binary PLY file, little-endian. The file appears whole or not at
/// all.
pub fn write_ply(path: &Path, photons: &[MapPhoton]) -> Result<(), ImageError> {
    write_atomically(path, || encode_ply(photons))
}

/// The bytes that [`write_ply`] writes: always the same for the same photons.
pub fn encode_ply(photons: &[MapPhoton]) -> Result<Vec<u8>, ImageProblem> {
    let mut ply = Ply::<Row>::new();
    ply.header.encoding = Encoding::BinaryLittleEndian;
    ply.header.comments.push("photons: dx dy dz along the flight, power in W".to_owned());
    let mut vertex = ElementDef::new("vertex".to_owned());
    for (name, kind) in PROPERTIES {
        vertex.properties.add(PropertyDef::new(name.to_owned(), PropertyType::Scalar(kind)));
    }
    ply.header.elements.add(vertex);
    ply.payload.insert("vertex".to_owned(), photons.iter().map(Row::of).collect());
    let mut bytes = Vec::new();
    Writer::new().write_ply(&mut bytes, &mut ply).map_err(ImageProblem::Write)?;
    Ok(bytes)
}

/// A photon as the writer asks for it.
struct Row {
    floats: [f32; 9],
    map: u8,
    bounce: u32,
    light: u32,
    path: f64,
}

impl Row {
    fn of(MapPhoton { photon, map, path, bounces }: &MapPhoton) -> Self {
        let (p, d, w) = (photon.position, Vec3::ZERO - photon.wi, photon.power);
        Self {
            floats: [p.x, p.y, p.z, d.x, d.y, d.z, w.r, w.g, w.b],
            map: *map as u8,
            bounce: bounces.count(),
            light: photon.light,
            path: *path as f64,
        }
    }
}

impl PropertyAccess for Row {
    fn new() -> Self {
        Self { floats: [0.0; 9], map: 0, bounce: 0, light: 0, path: 0.0 }
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        let place = PROPERTIES.iter().position(|(property, _)| *property == name)?;
        self.floats.get(place).copied()
    }

    fn get_uchar(&self, _name: &str) -> Option<u8> {
        Some(self.map)
    }

    fn get_uint(&self, name: &str) -> Option<u32> {
        Some(if name == "light" { self.light } else { self.bounce })
    }

    fn get_double(&self, _name: &str) -> Option<f64> {
        Some(self.path)
    }
}
