//! Geometry, nodes, cameras and lights of good models.

use nephroid::camera::{FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::light::LightKind;
use nephroid::math::{Vec2, Vec3};
use nephroid::world::World;
use nephroid_formats::fit::Fitted;
use serde_json::json;

use crate::model::{Model, SQUARE, mesh, triangles};

#[test]
fn a_square_is_two_triangles() {
    let model = Model::square();
    let (file, warnings) = model.good();
    assert_eq!(warnings, "");
    assert_eq!(file.scene.shapes.len(), 1);
    let read = mesh(&file, &file.scene.shapes[0]);
    assert_eq!(read.positions, SQUARE.map(Vec3::from));
    assert_eq!(read.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(read.normals.is_empty() && read.uvs.is_empty() && read.colors.is_empty());
    assert_eq!(file.fitted, Fitted { camera: true, sky: true });
    assert_eq!(file.origins.shapes.len(), 1);
    assert_eq!(file.origins.materials.len(), file.scene.materials.len());
    assert_eq!(file.origins.textures.len(), file.scene.textures.list.len());
    assert_eq!(file.origins.images.len(), file.scene.textures.images.len());
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn one_file_and_data_in_the_text_are_the_same() {
    let model = Model::square();
    let scene = model.good().0.scene;
    assert_eq!(model.read_binary().expect("it can be read").scene, scene);
    // Twelve zero bytes beside the one vertex that is not at the origin would do; here all of it.
    let mut inside = model.clone();
    let data: String = model.buffer.iter().map(|byte| format!("%{byte:02x}")).collect();
    inside.document["buffers"] =
        json!([{ "byteLength": model.buffer.len(), "uri": format!("data:application/octet-stream,{data}") }]);
    assert_eq!(inside.good().0.scene, scene);
}

#[test]
fn indices_have_three_widths_or_are_missing() {
    let expected = [[0, 1, 2], [0, 2, 3]];
    let mut bytes = Model::square();
    let view = bytes.view(&[0, 1, 2, 0, 2, 3]);
    let accessor = bytes.accessor(view, 5121, 6, "SCALAR");
    bytes.primitive()["indices"] = json!(accessor);
    let mut words = Model::square();
    let view = words.view(&[0u32, 1, 2, 0, 2, 3].map(u32::to_le_bytes).concat());
    let accessor = words.accessor(view, 5125, 6, "SCALAR");
    words.primitive()["indices"] = json!(accessor);
    for model in [bytes, words] {
        let file = model.good().0;
        assert_eq!(mesh(&file, &file.scene.shapes[0]).triangles, expected);
    }
    let mut none = Model::square();
    none.primitive().as_object_mut().expect("an object").remove("indices");
    let file = none.good().0;
    assert_eq!(mesh(&file, &file.scene.shapes[0]).triangles, [[0, 1, 2]]);
}

#[test]
fn strips_and_fans_are_triangles_and_lines_are_left_out() {
    for (mode, indices, expected) in [
        (5, vec![0u16, 1, 3, 2], vec![[0, 1, 3], [1, 2, 3]]),
        (6, vec![0, 1, 2, 3], vec![[0, 1, 2], [0, 2, 3]]),
        // Joined by triangles without area, of which nothing is said.
        (5, vec![0, 1, 3, 3, 1, 1, 2, 3], vec![[0, 1, 3], [1, 3, 2]]),
    ] {
        let mut model = Model::square();
        let indices = model.whole(&indices);
        model.primitive()["indices"] = json!(indices);
        model.primitive()["mode"] = json!(mode);
        let (file, warnings) = model.good();
        assert_eq!(warnings, "");
        assert_eq!(mesh(&file, &file.scene.shapes[0]).triangles, expected, "mode {mode}");
    }
    let mut model = Model::square();
    let lines = json!({ "attributes": { "POSITION": 0 }, "mode": 1 });
    let list = model.document["meshes"][0]["primitives"].as_array_mut().expect("a list");
    list.extend([lines.clone(), lines]);
    let (file, warnings) = model.good();
    assert_eq!(file.scene.shapes.len(), 1);
    assert_eq!(warnings.matches("points and lines").count(), 1, "{warnings}");
}

#[test]
fn interleaved_and_normalized_numbers_are_read() {
    let mut model = Model::square();
    // Position in 16 bits, a quarter apart in each direction, with the texture coordinate as bytes behind it.
    let mut bytes = Vec::new();
    for [x, y, _] in SQUARE {
        bytes.extend([x, y, 0.0].map(|v| ((v * 32_767.0) as i16).to_le_bytes()).concat());
        bytes.extend([(x * 255.0) as u8, (y * 51.0) as u8]);
    }
    let view = model.view(&bytes);
    model.document["bufferViews"][view]["byteStride"] = json!(8);
    let positions = model.accessor(view, 5122, 4, "VEC3");
    let uvs = model.accessor(view, 5121, 4, "VEC2");
    model.document["accessors"][uvs]["byteOffset"] = json!(6);
    for accessor in [positions, uvs] {
        model.document["accessors"][accessor]["normalized"] = json!(true);
    }
    model.primitive()["attributes"] = json!({ "POSITION": positions, "TEXCOORD_0": uvs });
    let file = model.good().0;
    let read = mesh(&file, &file.scene.shapes[0]);
    assert_eq!(read.positions, SQUARE.map(Vec3::from));
    assert_eq!(read.uvs[2], Vec2::new(1.0, 0.2));
    // Not normalised, numbers are themselves.
    model.document["accessors"][positions]["normalized"] = json!(false);
    let file = model.good().0;
    assert_eq!(mesh(&file, &file.scene.shapes[0]).positions[2], Vec3::new(32_767.0, 32_767.0, 0.0));
}

#[test]
fn sparse_accessors_replace_elements() {
    let mut model = Model::square();
    let places = model.view(&[2, 0, 3, 0]);
    let values = model.view(
        &[[5.0f32, 0.0, 1.0], [0.0, 7.0, 1.0]]
            .concat()
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect::<Vec<_>>(),
    );
    let sparse = json!({
        "count": 2,
        "indices": { "bufferView": places, "componentType": 5123 },
        "values": { "bufferView": values },
    });
    model.document["accessors"][0]["sparse"] = sparse;
    let file = model.good().0;
    let read = &mesh(&file, &file.scene.shapes[0]).positions;
    assert_eq!(read[..], [Vec3::ZERO, Vec3::X, Vec3::new(5.0, 0.0, 1.0), Vec3::new(0.0, 7.0, 1.0)]);
    // Without a view all the others are zero; what then is no triangle is left out.
    model.document["accessors"][0].as_object_mut().expect("an object").remove("bufferView");
    let (file, warnings) = model.good();
    assert_eq!(mesh(&file, &file.scene.shapes[0]).triangles.len(), 1);
    assert!(warnings.contains("left out 1 triangle without area"), "{warnings}");
}

#[test]
fn nodes_move_what_hangs_on_them() {
    let mut model = Model::square();
    // Scaled by 2, turned by a quarter about z, moved by 10; below it a matrix that moves by 1 along x.
    let matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1];
    let child = model.push("nodes", json!({ "mesh": 0, "matrix": matrix, "name": "leaf" }));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    model.document["nodes"][0] = json!({
        "children": [child], "translation": [10, 0, 0], "rotation": [0, 0, half, half], "scale": [2, 2, 2],
    });
    let file = model.good().0;
    let shape = &file.scene.shapes[0];
    assert_eq!(shape.name, "leaf");
    // The corner (1, 0, 0) goes to (2, 0, 0), (4, 0, 0), (0, 4, 0) and (10, 4, 0).
    let corner = triangles(&file, shape)[0][1];
    assert!((corner - Vec3::new(10.0, 4.0, 0.0)).length() < 1e-5, "{corner}");
}

#[test]
fn a_mirrored_node_shows_the_same_side() {
    let mut model = Model::square();
    model.document["nodes"][0]["scale"] = json!([-1, 1, 1]);
    let file = model.good().0;
    assert!(file.scene.shapes[0].to_world.is_mirrored());
    let world = World::new(file.scene).expect("it can be rendered");
    let ray = nephroid::math::Ray::new(Vec3::new(-0.3, 0.6, 5.0), -Vec3::Z);
    let hit = world.intersect(&ray).expect("the square is there");
    assert_eq!(hit.point.ng, Vec3::Z);
}

#[test]
fn copies_of_large_meshes_become_instances() {
    // 64 × 64 squares, shown twice by nodes and three times by one node.
    let mut model = Model::empty();
    let n = 64u16;
    let points: Vec<[f32; 3]> =
        (0..=n).flat_map(|y| (0..=n).map(move |x| [f32::from(x), f32::from(y), 0.0])).collect();
    let corner = |x: u16, y: u16| y * (n + 1) + x;
    let indices: Vec<u16> = (0..n)
        .flat_map(|y| (0..n).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [a, b, c, a, c, d]
        })
        .collect();
    let (positions, indices) = (model.floats(&points), model.whole(&indices));
    model.document["meshes"] = json!([{ "name": "grid", "primitives": [{ "attributes": { "POSITION": positions }, "indices": indices }] }]);
    model.node(json!({ "mesh": 0 }));
    model.node(json!({ "mesh": 0, "translation": [0, 0, 1] }));
    let moves = model.floats(&[[0.0f32, 0.0, 2.0], [0.0, 0.0, 3.0], [0.0, 0.0, 4.0]]);
    let view = model.view(&[0, 0, 0, 127, 0, 0, 127, 0, 0, 0, 0, 129]);
    let turns = model.accessor(view, 5120, 3, "VEC4");
    model.document["accessors"][turns]["normalized"] = json!(true);
    let extension = json!({ "attributes": { "TRANSLATION": moves, "ROTATION": turns } });
    model.node(
        json!({ "mesh": 0, "scale": [2, 2, 2], "extensions": { "EXT_mesh_gpu_instancing": extension } }),
    );
    let (file, warnings) = model.good();
    assert_eq!(warnings, "");
    assert_eq!((file.scene.groups.len(), file.scene.instances.len(), file.scene.shapes.len()), (1, 5, 0));
    assert_eq!(file.origins.shapes.len(), 1);
    let point = |i: usize| file.scene.instances[i].to_world.point(Vec3::new(1.0, 2.0, 0.0));
    assert_eq!(point(1), Vec3::new(1.0, 2.0, 1.0));
    assert_eq!(point(2), Vec3::new(2.0, 4.0, 4.0));
    // Half a turn about z.
    assert!((point(3) - Vec3::new(-2.0, -4.0, 6.0)).length() < 1e-5);
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn few_triangles_are_copied() {
    let mut model = Model::square();
    model.node(json!({ "mesh": 0, "translation": [0, 0, 1] }));
    let file = model.good().0;
    assert_eq!((file.scene.groups.len(), file.scene.shapes.len(), file.scene.meshes.len()), (0, 2, 1));
    assert_eq!(file.scene.shapes[0].geometry, file.scene.shapes[1].geometry);
}

#[test]
fn vertices_that_others_use_are_left_out() {
    let mut model = Model::square();
    let indices = model.whole(&[3, 0, 2]);
    let second = json!({ "attributes": { "POSITION": 0 }, "indices": indices });
    model.document["meshes"][0]["primitives"].as_array_mut().expect("a list").push(second);
    let file = model.good().0;
    let read = mesh(&file, &file.scene.shapes[1]);
    assert_eq!(read.positions, [3, 0, 2].map(|i: usize| Vec3::from(SQUARE[i])));
    assert_eq!(read.triangles, [[0, 1, 2]]);
}

#[test]
fn perspective_cameras_are_read() {
    let mut model = Model::square();
    model.document["cameras"] =
        json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "aspectRatio": 2.0, "znear": 0.1 } }]);
    model.node(json!({ "camera": 0, "translation": [0, 0, 5], "scale": [3, 3, 3] }));
    let (file, warnings) = model.good();
    assert_eq!(warnings, "");
    // There is a view, and nothing to light it.
    assert_eq!(file.fitted, Fitted { camera: false, sky: true });
    let camera = &file.scene.camera;
    assert_eq!((file.scene.film.width, file.scene.film.height), (768, 384));
    let Projection::Perspective { fov_deg, fov_axis, .. } = camera.projection else { panic!("{camera:?}") };
    assert!((fov_deg - 28.647_89).abs() < 1e-4 && fov_axis == FovAxis::Y, "{fov_deg}");
    assert_eq!(camera.to_world.point(Vec3::ZERO), Vec3::Z * 5.0);
    assert_eq!(camera.to_world.vector(Vec3::Z), -Vec3::Z);
    assert_eq!(camera.to_world.vector(Vec3::X), -Vec3::X);
}

#[test]
fn orthographic_cameras_are_read() {
    let mut model = Model::square();
    let camera = json!({ "type": "orthographic", "orthographic": { "xmag": 2.0, "ymag": 4.0, "znear": 0, "zfar": 9 } });
    model.document["cameras"] = json!([camera]);
    model.node(json!({ "camera": 0, "translation": [0, 0, 5] }));
    let file = model.good().0;
    let camera = &file.scene.camera;
    assert_eq!(camera.projection, Projection::Orthographic);
    // The width, from −1 to 1 in its space, is 4 units wide.
    assert_eq!(camera.to_world.vector(Vec3::X), -Vec3::X * 2.0);
    assert_eq!((file.scene.film.width, file.scene.film.height), (384, 768));
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn lights_are_watts_by_683_lumens() {
    let mut model = Model::square();
    model.document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "intensity": 683.0, "color": [1.0, 0.5, 0.0], "range": 3 },
        { "type": "directional", "intensity": 1366.0 },
        { "type": "spot", "intensity": 68.3, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.2 }, "name": "lamp" },
        { "type": "spot" },
    ]}});
    for light in 0..4 {
        let extension = json!({ "KHR_lights_punctual": { "light": light } });
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // Turned by a quarter about x: what looks along −z looks along +y then.
        model.node(
            json!({ "translation": [1, 2, 3], "rotation": [half, 0, 0, half], "extensions": extension }),
        );
    }
    let (file, warnings) = model.good();
    assert_eq!(warnings, "", "one is bright enough");
    assert_eq!(file.fitted, Fitted { camera: true, sky: false });
    let kinds: Vec<&LightKind> = file.scene.lights.iter().map(|light| &light.kind).collect();
    let position = Vec3::new(1.0, 2.0, 3.0);
    assert_eq!(*kinds[0], LightKind::Point { position, intensity: Rgb::new(1.0, 0.5, 0.0) });
    let LightKind::Directional { direction, irradiance } = *kinds[1] else { panic!("{kinds:?}") };
    assert!((direction - Vec3::Y).length() < 1e-6 && irradiance == Rgb::splat(2.0));
    let LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, .. } = kinds[2] else {
        panic!("{kinds:?}")
    };
    assert!((to_world.vector(Vec3::Z) - Vec3::Y).length() < 1e-6);
    assert!((cutoff_deg - 11.459_156).abs() < 1e-4 && (beam_width_deg - 5.729_578).abs() < 1e-4);
    assert!((intensity.g - 0.1).abs() < 1e-6);
    let LightKind::Spot { cutoff_deg, beam_width_deg, .. } = kinds[3] else { panic!("{kinds:?}") };
    assert!((cutoff_deg - 45.0).abs() < 1e-4 && *beam_width_deg == 0.0);
    World::new(file.scene).expect("it can be rendered");
}

#[test]
fn the_scene_that_is_named_is_shown_or_all_roots() {
    let mut model = Model::square();
    let other = model.push("nodes", json!({ "mesh": 0, "name": "other" }));
    model.push("scenes", json!({ "nodes": [other] }));
    model.document["scene"] = json!(1);
    assert_eq!(model.good().0.scene.shapes[0].name, "other");
    let document = model.document.as_object_mut().expect("an object");
    document.remove("scene");
    let (file, warnings) = model.good();
    assert_eq!(file.scene.shapes[0].name, "node 0");
    assert!(warnings.contains("the first is shown"), "{warnings}");
    model.document.as_object_mut().expect("an object").remove("scenes");
    assert_eq!(model.good().0.scene.shapes.len(), 2);
}

#[test]
fn what_moves_is_shown_at_rest_and_said_once() {
    let mut model = Model::square();
    model.document["animations"] = json!([{ "channels": [], "samplers": [] }, {}]);
    model.document["skins"] = json!([{ "joints": [0] }]);
    model.document["nodes"][0]["skin"] = json!(0);
    model.primitive()["targets"] = json!([{ "POSITION": 0 }]);
    model.document["meshes"][0]["weights"] = json!([0.5]);
    let warnings = model.good().1;
    assert_eq!(warnings.lines().count(), 3, "{warnings}");
    for word in ["animations", "skins", "morph targets"] {
        assert!(warnings.contains(word), "{warnings}");
    }
}

#[test]
fn a_scale_of_zero_hides() {
    let mut model = Model::square();
    model.node(json!({ "mesh": 0, "scale": [0, 1, 1] }));
    let (file, warnings) = model.good();
    assert_eq!(file.scene.shapes.len(), 1);
    assert!(warnings.contains("a scale of zero"), "{warnings}");
}
