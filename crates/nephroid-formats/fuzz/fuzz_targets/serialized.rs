//! Any bytes as a file of serialized meshes: an error, or a mesh that holds together.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephroid_formats::mesh::{MeshOptions, read_serialized};

#[path = "../mesh.rs"]
mod mesh;

fuzz_target!(|bytes: &[u8]| {
    for shape_index in [0, 1] {
        mesh::check(read_serialized(bytes, shape_index, MeshOptions { face_normals: false, flip_tex_coords: true }));
    }
});
