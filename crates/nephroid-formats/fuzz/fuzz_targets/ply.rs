//! Any bytes as an PLY file: an error, or a mesh that holds together.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephroid_formats::mesh::{MeshOptions, read_ply};

#[path = "../mesh.rs"]
mod mesh;

fuzz_target!(|bytes: &[u8]| {
    for face_normals in [false, true] {
        mesh::check(read_ply(bytes, MeshOptions { face_normals, flip_tex_coords: true }));
    }
});
