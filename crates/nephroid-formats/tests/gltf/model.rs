//! Small models, made in memory.

use std::path::Path;

use nephroid::math::Vec3;
use nephroid::shape::{Geometry, Mesh, Shape};
use nephroid_formats::diagnostic::Severity;
use nephroid_formats::gltf::read_scene;
use nephroid_formats::vfs::MemoryFiles;
use nephroid_formats::{Options, SceneFile};
use serde_json::{Value, json};

/// A model that is put together: a document and one buffer.
#[derive(Clone)]
pub struct Model {
    pub document: Value,
    pub buffer: Vec<u8>,
    pub files: MemoryFiles,
}

/// The corners of a square in z = 0.
pub const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

impl Model {
    /// One with nothing in it.
    pub fn empty() -> Self {
        let document = json!({
            "asset": { "version": "2.0" },
            "buffers": [], "bufferViews": [], "accessors": [], "meshes": [], "nodes": [], "materials": [],
            "scene": 0, "scenes": [{ "nodes": [] }],
        });
        Self { document, buffer: Vec::new(), files: MemoryFiles::default() }
    }

    /// A square of two triangles at a node of its own, of material 0 if there is one.
    pub fn square() -> Self {
        let mut model = Self::empty();
        let positions = model.floats(&SQUARE);
        let indices = model.whole(&[0u16, 1, 2, 0, 2, 3]);
        model.document["meshes"] =
            json!([{ "primitives": [{ "attributes": { "POSITION": positions }, "indices": indices }] }]);
        model.node(json!({ "mesh": 0 }));
        model
    }

    /// The same with texture coordinates and a material.
    pub fn painted(material: Value) -> Self {
        let mut model = Self::square();
        let uvs = model.floats(&[[0.0f32, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        model.primitive()["attributes"]["TEXCOORD_0"] = json!(uvs);
        model.primitive()["material"] = json!(0);
        model.document["materials"] = json!([material]);
        model.document["images"] = json!([{ "uri": "image.png" }]);
        model.document["textures"] = json!([{ "source": 0 }]);
        model
    }

    /// The first primitive.
    pub fn primitive(&mut self) -> &mut Value {
        &mut self.document["meshes"][0]["primitives"][0]
    }

    /// Adds a node to the scene, and gives its number.
    pub fn node(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        let list = self.document["scenes"][0]["nodes"].as_array_mut().expect("a list of nodes");
        list.push(json!(index));
        index
    }

    /// Adds something to a list of the document, and gives its number.
    pub fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.document[list].as_array_mut().expect("a list");
        list.push(item);
        list.len() - 1
    }

    /// Adds bytes to the buffer, as a view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let offset = self.buffer.len();
        self.buffer.extend(bytes);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// Adds vectors as an accessor.
    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        self.accessor(view, 5126, values.len(), kind)
    }

    /// Adds indices as an accessor.
    pub fn whole(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessor(view, 5123, values.len(), "SCALAR")
    }

    /// Adds an accessor of a view.
    pub fn accessor(&mut self, view: usize, component: u32, count: usize, kind: &str) -> usize {
        let accessor =
            json!({ "bufferView": view, "componentType": component, "count": count, "type": kind });
        self.push("accessors", accessor)
    }

    /// The document with its buffer in a file beside it.
    pub fn text(&self) -> (String, MemoryFiles) {
        let mut document = self.document.clone();
        if document["buffers"] == json!([]) {
            document["buffers"] = json!([{ "byteLength": self.buffer.len(), "uri": "the%20data.bin" }]);
        }
        let files = self.files.clone().with("m/the data.bin", self.buffer.clone());
        (document.to_string(), files)
    }

    /// Reads it.
    pub fn read(&self) -> Result<SceneFile, String> {
        self.read_with(false)
    }

    pub fn read_with(&self, lenient: bool) -> Result<SceneFile, String> {
        let (text, files) = self.text();
        read_bytes(text.into_bytes(), files, lenient)
    }

    /// Reads it as one file.
    pub fn read_binary(&self) -> Result<SceneFile, String> {
        read_bytes(self.binary(), self.files.clone(), false)
    }

    /// It as one file.
    pub fn binary(&self) -> Vec<u8> {
        let mut document = self.document.clone();
        document["buffers"] = json!([{ "byteLength": self.buffer.len() }]);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend((28 + text.len() as u32 + self.buffer.len() as u32).to_le_bytes());
        out.extend((text.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(text);
        out.extend((self.buffer.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(&self.buffer);
        out
    }

    /// Reads it, which must do, and gives its warnings in one text.
    #[track_caller]
    pub fn good(&self) -> (SceneFile, String) {
        let file = self.read().unwrap_or_else(|errors| panic!("{errors}"));
        assert!(file.warnings.iter().all(|w| w.severity == Severity::Warning));
        let warnings = file.warnings.iter().map(|w| format!("{w}\n")).collect();
        (file, warnings)
    }

    /// Reads it, which must not do, and looks for a text in the errors.
    #[track_caller]
    pub fn fails_with(&self, text: &str) {
        let errors = self.read().map(|_| ()).expect_err("it is bad");
        assert!(errors.contains(text), "{text:?} is not in {errors}");
        assert!(errors.contains("m/model.gltf"), "{errors}");
    }
}

/// Reads bytes as a file in the folder `m`.
pub fn read_bytes(bytes: Vec<u8>, files: MemoryFiles, lenient: bool) -> Result<SceneFile, String> {
    let files = files.with("m/model.gltf", bytes);
    let options = Options { defines: Vec::new(), lenient };
    read_scene(Path::new("m/model.gltf"), &files, &options).map_err(|errors| errors.to_string())
}

/// The mesh of a shape.
pub fn mesh<'s>(file: &'s SceneFile, shape: &Shape) -> &'s Mesh {
    match shape.geometry {
        Geometry::Mesh(mesh) => &file.scene.meshes[mesh],
        ref other => panic!("{other:?} is no mesh"),
    }
}

/// The corners of the triangles of a shape, at its place.
pub fn triangles(file: &SceneFile, shape: &Shape) -> Vec<[Vec3; 3]> {
    let mesh = mesh(file, shape);
    mesh.triangles.iter().map(|t| t.map(|i| shape.to_world.point(mesh.positions[i as usize]))).collect()
}
