use std::path::Path;

use nephroid::laboratory::MapPhoton;
use nephroid::math::Vec3;

use crate::image::{ImageError, ImageProblem, write_atomically};

/// The header row. `bounce` counts bounces before the photon landed, `path` numbers the paths emitted
/// for the map, and `kind` spells the path: L for the light, S for specular bounces, V for collisions in
/// media, D for others.
const COLUMNS: [&str; 14] = [
    "x", "y", "z", "dx", "dy", "dz", "power_r", "power_g", "power_b", "map", "bounce", "light", "path",
    "kind",
];

/// Writes photons as comma-separated values with a header row. The file appears whole or not at all.
pub fn write_csv(path: &Path, photons: &[MapPhoton]) -> Result<(), ImageError> {
    write_atomically(path, || encode_csv(photons))
}

/// The bytes that [`write_csv`] writes: always the same for the same photons. Numbers have as many digits
/// as tell them from their neighbours in single precision.
pub fn encode_csv(photons: &[MapPhoton]) -> Result<Vec<u8>, ImageProblem> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let failed = |e: csv::Error| ImageProblem::Write(e.into());
    writer.write_record(COLUMNS).map_err(failed)?;
    for MapPhoton { photon, map, path, bounces } in photons {
        let (p, d, w) = (photon.position, Vec3::ZERO - photon.wi, photon.power);
        let numbers = [p.x, p.y, p.z, d.x, d.y, d.z, w.r, w.g, w.b].map(|v| v.to_string());
        let rest = [
            map.name().to_owned(),
            bounces.count().to_string(),
            photon.light.to_string(),
            path.to_string(),
            bounces.to_string(),
        ];
        writer.write_record(numbers.iter().chain(&rest)).map_err(failed)?;
    }
    writer.into_inner().map_err(|e| ImageProblem::Write(std::io::Error::other(e.to_string())))
}
