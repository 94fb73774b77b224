use std::borrow::Cow;
use std::io::Read;

use flate2::read::MultiGzDecoder;

use super::MeshError;

/// Meshes are packed less densely than this.
const BEST_RATIO: u64 = 256;

/// The contents of a file that gzip may have packed.
pub(super) fn unpacked(bytes: &[u8]) -> Result<Cow<'_, [u8]>, MeshError> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let most = (bytes.len() as u64).saturating_mul(BEST_RATIO);
    let mut out = Vec::new();
    let read = MultiGzDecoder::new(bytes).take(most + 1).read_to_end(&mut out);
    match read {
        Err(error) => Err(MeshError::new(format!("broken gzip file: {error}"))),
        Ok(_) if out.len() as u64 > most => Err(MeshError::new("the gzip file holds more than a mesh can")),
        Ok(_) => Ok(Cow::Owned(out)),
    }
}
