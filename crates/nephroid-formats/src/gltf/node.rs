//! The tree of nodes, and where it puts things.

use nephroid::math::{DAffine3, DMat3, DVec3, Transform};

use super::buffers::Buffers;
use super::item::Item;

/// Copies that one node may ask for.
const MAX_COPIES: usize = 1 << 22;

/// A node at its place.
pub(super) struct Placed<'d> {
    pub(super) node: Item<'d>,
    pub(super) index: usize,
    pub(super) to_world: DAffine3,
}

/// The nodes of the scene that is shown, each after what it hangs on.
pub(super) fn placed<'d>(root: Item<'d>) -> Vec<Placed<'d>> {
    let nodes = root.list("nodes");
    let mut met = vec![false; nodes.len()];
    let mut open: Vec<(usize, Item<'d>, DAffine3)> = Vec::new();
    let enter = |list: Vec<Item<'d>>, to_world: DAffine3, open: &mut Vec<(usize, Item<'d>, DAffine3)>| {
        // The last that is put on the pile is the first to be taken.
        for item in list.into_iter().rev() {
            match item.as_whole().filter(|index| *index < nodes.len()) {
                Some(index) => open.push((index, item, to_world)),
                None => item.error(format!("there is no such node; there are {}", nodes.len())),
            }
        }
    };
    match shown(root) {
        Some(scene) => enter(scene.list("nodes"), DAffine3::IDENTITY, &mut open),
        None => {
            let top = tops(&nodes);
            open.extend(top.into_iter().rev().map(|index| (index, nodes[index], DAffine3::IDENTITY)));
        }
    }
    let mut out = Vec::new();
    while let Some((index, named, above)) = open.pop() {
        if std::mem::replace(&mut met[index], true) {
            named.error(format!("node {index} hangs on two nodes, or on itself"));
            continue;
        }
        let node = nodes[index];
        let to_world = above * local(node);
        enter(node.list("children"), to_world, &mut open);
        out.push(Placed { node, index, to_world });
    }
    out
}

/// The scene that the document shows: the one it names, or its first.
fn shown(root: Item) -> Option<Item> {
    let count = root.list("scenes").len();
    if count == 0 {
        return None;
    }
    if root.has("scene") {
        return root.refers("scene", "scenes").map(|(_, scene)| scene);
    }
    if count > 1 {
        root.warn(format!("the document names none of its {count} scenes, and the first is shown"));
    }
    root.nth("scenes", 0)
}

/// Of a document without scenes: the nodes that hang on no other.
fn tops(nodes: &[Item]) -> Vec<usize> {
    let mut hangs = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| node.list("children")) {
        if let Some(hangs) = child.as_whole().and_then(|index| hangs.get_mut(index)) {
            *hangs = true;
        }
    }
    (0..nodes.len()).filter(|index| !hangs[*index]).collect()
}

/// The transform of a node itself (glTF 2.0, §3.5.2).
fn local(node: Item) -> DAffine3 {
    if let Some(m) = node.vector::<16>("matrix") {
        let column = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            node.error("the last row of \"matrix\" must be 0, 0, 0, 1");
        }
        let linear = DMat3::from_cols(column(0), column(1), column(2));
        return DAffine3::from_mat3_translation(linear, column(3));
    }
    let translation = node.vector::<3>("translation").unwrap_or_default();
    let rotation = node.vector::<4>("rotation").unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = node.vector::<3>("scale").unwrap_or([1.0; 3]);
    composed(translation, rotation, scale).unwrap_or_else(|| {
        node.error("\"rotation\" must not be zero");
        DAffine3::IDENTITY
    })
}

/// First scaled, then turned by a quaternion (x, y, z, w), then moved. `None` if the quaternion has no length.
fn composed(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> Option<DAffine3> {
    let length_sq: f64 = rotation.iter().map(|v| v * v).sum();
    if !(length_sq > 0.0 && length_sq.is_finite()) {
        return None;
    }
    let [x, y, z, w] = rotation;
    let s = 2.0 / length_sq;
    let turn = DMat3::from_cols(
        DVec3::new(1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
        DVec3::new(s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)),
        DVec3::new(s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)),
    );
    let linear = turn * DMat3::from_diagonal(DVec3::from(scale));
    Some(DAffine3::from_mat3_translation(linear, DVec3::from(translation)))
}

impl<'d> Buffers<'d> {
    /// The places of copies that a node asks for (`EXT_mesh_gpu_instancing`). `None` if the log says why.
    pub(super) fn copies(&mut self, extension: Item<'d>) -> Option<Vec<DAffine3>> {
        let attributes = extension.object("attributes")?;
        let translations = self.attribute(attributes, "TRANSLATION", [0.0f32; 3])?;
        let rotations = self.attribute(attributes, "ROTATION", [0.0f32; 4])?;
        let scales = self.attribute(attributes, "SCALE", [0.0f32; 3])?;
        let counts = [
            translations.as_ref().map(Vec::len),
            rotations.as_ref().map(Vec::len),
            scales.as_ref().map(Vec::len),
        ];
        let mut known = counts.into_iter().flatten();
        let Some(count) = known.next() else {
            extension.error("the copies have neither \"TRANSLATION\" nor \"ROTATION\" nor \"SCALE\"");
            return None;
        };
        if known.any(|other| other != count) {
            attributes.error("the attributes of the copies are not equally many");
            return None;
        }
        if count > MAX_COPIES {
            attributes.error(format!("{count} copies, which are more than {MAX_COPIES}"));
            return None;
        }
        let at = |values: &Option<Vec<[f32; 3]>>, i: usize, default: f64| {
            values.as_ref().map_or([default; 3], |values| values[i].map(f64::from))
        };
        let places: Option<Vec<DAffine3>> = (0..count)
            .map(|i| {
                let rotation =
                    rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |values| values[i].map(f64::from));
                composed(at(&translations, i, 0.0), rotation, at(&scales, i, 1.0))
            })
            .collect();
        if places.is_none() {
            attributes.error("a \"ROTATION\" is zero");
        }
        places
    }

    /// The values of an attribute, if it is there. The outer `None` if the log says why.
    pub(super) fn attribute<const N: usize>(
        &mut self,
        attributes: Item<'d>,
        name: &str,
        fill: [f32; N],
    ) -> Option<Option<Vec<[f32; N]>>> {
        if !attributes.has(name) {
            return Some(None);
        }
        let (_, accessor) = attributes.refers(name, "accessors")?;
        self.floats(accessor, N, fill).map(Some)
    }
}

/// Turns what looks along −z, as cameras and lights do here, to look along +z as ours do, with +y up: the place of a
/// camera or a light, without the scale of its nodes. `None` if a scale of zero hides its direction.
pub(super) fn looking(to_world: &DAffine3) -> Option<Transform> {
    let m = to_world.matrix3;
    let eye = to_world.translation;
    let forward = -m.z_axis;
    let ahead = eye + forward.try_normalize()?;
    Transform::look_at(eye, ahead, m.y_axis.try_normalize()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::math::Vec3;

    #[test]
    fn a_quaternion_turns() {
        // A quarter turn about z, of any length.
        let turn = composed([1.0, 0.0, 0.0], [0.0, 0.0, 2.0, 2.0], [2.0, 1.0, 1.0]).expect("it has a length");
        let p = turn.transform_point3(DVec3::X);
        assert!((p - DVec3::new(1.0, 2.0, 0.0)).length() < 1e-15, "{p}");
        assert!(composed([0.0; 3], [0.0; 4], [1.0; 3]).is_none());
    }

    #[test]
    fn cameras_look_along_minus_z() {
        let camera = looking(&DAffine3::from_scale(DVec3::new(3.0, 2.0, 5.0))).expect("it has a direction");
        assert_eq!(camera.vector(Vec3::Z), -Vec3::Z);
        assert_eq!(camera.vector(Vec3::X), -Vec3::X);
        assert_eq!(camera.vector(Vec3::Y), Vec3::Y);
    }
}
