//! Bad models: each mistake is told, and nothing is allocated on the word of a number.

use nephroid_formats::vfs::MemoryFiles;
use serde_json::json;

use crate::model::{Model, read_bytes};

#[test]
fn one_file_may_be_cut_anywhere() {
    let whole = Model::square().binary();
    for length in 0..whole.len() {
        assert!(read_bytes(whole[..length].to_vec(), MemoryFiles::default(), false).is_err(), "{length}");
    }
    assert!(read_bytes(whole, MemoryFiles::default(), false).is_ok());
}

#[test]
fn what_is_no_document_is_told_with_its_place() {
    let fails = |text: &str| {
        read_bytes(text.into(), MemoryFiles::default(), false).map(|_| ()).expect_err("it is bad")
    };
    assert_eq!(
        fails("{\n \"asset\": }"),
        "m/model.gltf:2:11: error: this is not JSON: a value is missing before \"}\""
    );
    assert!(fails("{}").contains("has no \"asset\""));
    assert!(fails("{\"asset\": {\"version\": \"1.0\"}}").contains("only 2.0 is read"));
    assert!(fails("[]").contains("no \"asset\""));
    assert!(fails("{\"asset\": {\"version\": \"2.0\"}}").contains("shows no triangles"));
}

#[test]
fn files_that_are_missing_or_short_are_told() {
    let mut model = Model::square();
    model.document["buffers"] = json!([{ "byteLength": 4, "uri": "gone.bin" }]);
    model.fails_with("cannot read \"gone.bin\": no such file");
    model.document["buffers"] = json!([{ "byteLength": 4000, "uri": "the%20data.bin" }]);
    model.fails_with("should have 4000");
    model.document["buffers"] = json!([{ "byteLength": 4 }]);
    model.fails_with("has no \"uri\"");
    model.document["buffers"] = json!([{ "byteLength": 4, "uri": "data:;base64,***" }]);
    model.fails_with("is not in base64");
    model.document["buffers"] = json!([{ "byteLength": 4, "uri": "http://host/a.bin" }]);
    model.fails_with("address in a network");
}

#[test]
fn accessors_stay_in_their_views() {
    let change = |list: &str, name: &str, value: serde_json::Value| {
        let mut model = Model::square();
        model.document[list][0][name] = value;
        model
    };
    change("accessors", "count", json!(5)).fails_with("reach beyond the view of 48 bytes");
    change("accessors", "byteOffset", json!(1)).fails_with("reach beyond the view");
    change("accessors", "count", json!(9_007_199_254_740_992u64)).fails_with("reach beyond the view");
    change("accessors", "count", json!(-1)).fails_with("must be a whole number");
    change("accessors", "count", json!(1e300)).fails_with("must be a whole number");
    change("accessors", "type", json!("MAT4")).fails_with("of type \"MAT4\"");
    change("accessors", "componentType", json!(5124)).fails_with("\"componentType\" must be");
    change("accessors", "bufferView", json!(17)).fails_with("there are 2 bufferViews");
    change("bufferViews", "byteLength", json!(4_000_000_000u64)).fails_with("reaches beyond its buffer");
    change("bufferViews", "byteOffset", json!(u64::MAX)).fails_with("must be a whole number");
    change("bufferViews", "byteStride", json!(4)).fails_with("cannot follow one another after 4");
    change("bufferViews", "buffer", json!(1)).fails_with("there are 1 buffers");
    let mut zeros = Model::square();
    zeros.document["accessors"][0] =
        json!({ "componentType": 5126, "count": 4_000_000_000u64, "type": "VEC3" });
    zeros.fails_with("elements without a \"bufferView\"");
}

#[test]
fn numbers_of_vertices_are_sound() {
    let mut model = Model::square();
    let positions = model.floats(&[[0.0, f32::NAN, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0; 3]]);
    model.primitive()["attributes"]["POSITION"] = json!(positions);
    model.fails_with("element 0 of the accessor is infinite or not a number");
    let mut model = Model::square();
    let indices = model.whole(&[0, 1, 4]);
    model.primitive()["indices"] = json!(indices);
    model.fails_with("vertex 4 is used, and there are 4");
    let mut model = Model::square();
    let normals = model.floats(&[[0.0f32, 0.0, 1.0]]);
    model.primitive()["attributes"]["NORMAL"] = json!(normals);
    model.fails_with("4 vertices have 1 of \"NORMAL\"");
    let mut model = Model::square();
    model.primitive()["indices"] = json!(0);
    model.fails_with("indices must be of the type \"SCALAR\"");
    let mut model = Model::square();
    model.primitive()["mode"] = json!(7);
    model.fails_with("no \"mode\" 7");
    let mut model = Model::square();
    model.primitive()["attributes"]["POSITION"] = json!(9);
    model.fails_with("there are 2 accessors");
    let mut model = Model::square();
    model.primitive()["material"] = json!(0);
    model.fails_with("there are 0 materials");
}

#[test]
fn sparse_places_are_checked() {
    let mut model = Model::square();
    let places = model.view(&[9, 0]);
    let values = model.view(&[0; 12]);
    model.document["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": places, "componentType": 5123 },
        "values": { "bufferView": values },
    });
    model.fails_with("element 9 is replaced, and the accessor has 4");
    model.document["accessors"][0]["sparse"]["count"] = json!(2);
    model.fails_with("reach beyond the view of 2 bytes");
    model.document["accessors"][0]["sparse"] = json!({ "count": 1 });
    model.fails_with("a sparse accessor needs");
}

#[test]
fn nodes_form_a_tree() {
    let mut model = Model::square();
    model.document["nodes"][0]["children"] = json!([0]);
    model.fails_with("node 0 hangs on two nodes, or on itself");
    let mut model = Model::square();
    let child = model.node(json!({ "children": [0] }));
    model.document["nodes"][0]["children"] = json!([child]);
    model.fails_with("hangs on two nodes");
    let mut model = Model::square();
    model.document["nodes"][0]["children"] = json!([7]);
    model.fails_with("there is no such node; there are 1");
    let mut model = Model::square();
    model.document["nodes"][0]["matrix"] = json!([1, 2, 3]);
    model.fails_with("\"matrix\" must be 16 numbers");
    let mut model = Model::square();
    model.document["nodes"][0]["matrix"] = json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    model.fails_with("last row");
    let mut model = Model::square();
    model.document["nodes"][0]["rotation"] = json!([0, 0, 0, 0]);
    model.fails_with("\"rotation\" must not be zero");
}

#[test]
fn a_chain_of_a_hundred_thousand_nodes_is_read() {
    let mut model = Model::square();
    let count = 100_000;
    let chain =
        (0..count).map(|i| if i + 1 < count { json!({ "children": [i + 1] }) } else { json!({ "mesh": 0 }) });
    model.document["nodes"] = chain.collect();
    assert_eq!(model.good().0.scene.shapes.len(), 1);
}

#[test]
fn a_view_of_nothing_and_lights_of_nothing_are_told() {
    let mut model = Model::square();
    model.document["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 4.0 } }]);
    model.node(json!({ "camera": 0 }));
    model.fails_with("\"yfov\" between 0 and π");
    model.document["cameras"] =
        json!([{ "type": "orthographic", "orthographic": { "xmag": 0.0, "ymag": 1.0 } }]);
    model.fails_with("not zero");
    model.document["cameras"] = json!([{ "type": "fisheye" }]);
    model.fails_with("\"type\" of a camera");
    let lit = |light: serde_json::Value| {
        let mut model = Model::square();
        model.document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
        model.node(json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
        model
    };
    lit(json!({ "type": "point", "intensity": -1.0 })).fails_with("negative");
    lit(json!({ "type": "area" })).fails_with("\"type\" of a light");
    let cone = json!({ "innerConeAngle": 0.5, "outerConeAngle": 0.5 });
    lit(json!({ "type": "spot", "spot": cone })).fails_with("inner cone");
}

#[test]
fn extensions_that_hide_the_model_are_refused_by_name() {
    for (name, advice) in [
        ("KHR_draco_mesh_compression", "without mesh compression"),
        ("EXT_meshopt_compression", "without mesh compression"),
        ("KHR_texture_basisu", "PNG or JPEG"),
        ("VENDOR_unheard_of", "--lenient"),
    ] {
        let mut model = Model::square();
        model.document["extensionsRequired"] = json!([name]);
        model.document["extensionsUsed"] = json!([name]);
        model.fails_with(&format!("requires the extension {name}"));
        model.fails_with(advice);
    }
    let mut model = Model::square();
    model.document["extensionsRequired"] = json!(["VENDOR_unheard_of"]);
    assert!(model.read_with(true).is_ok());
    model.document["extensionsRequired"] = json!(["KHR_mesh_quantization", "KHR_texture_transform"]);
    assert_eq!(model.good().1, "");
}

#[test]
fn copies_are_checked() {
    let with = |attributes: serde_json::Value, model: &Model| {
        let mut model = model.clone();
        model.document["nodes"][0]["extensions"] =
            json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
        model
    };
    let mut model = Model::square();
    let two = model.floats(&[[0.0f32; 3]; 2]);
    let one = model.floats(&[[0.0f32; 4]; 1]);
    with(json!({}), &model).fails_with("neither \"TRANSLATION\"");
    with(json!({ "TRANSLATION": two, "ROTATION": one }), &model).fails_with("not equally many");
    with(json!({ "ROTATION": one }), &model).fails_with("is zero");
    with(json!({ "TRANSLATION": one }), &model).fails_with("of type \"VEC4\"");
}
