use crate::bvh::{Boxes, Kind, Lanes, Tree, Visitor};
use crate::math::{Bounds, Ray};
use crate::observer::Work;
use crate::shape::{
    FlatBlock, Hits, Intersection, Mesh, Primitive, ShearedLanes, ShearedRay, TriangleLeaf, Triangles,
};

/// A tree and what is in its leaves: the scene without its groups, or a group.
#[derive(Clone, Debug)]
pub(super) struct Level {
    tree: Tree,
    triangles: Triangles,
    flats: Vec<FlatBlock>,
    others: Vec<Other>,
    /// Primitives without bounds, beside the tree.
    infinite: Vec<u32>,
    pub bounds: Bounds,
}

/// What a leaf of one item holds.
#[derive(Clone, Copy, Debug)]
pub(super) enum Other {
    /// A primitive, by its number.
    Primitive(u32),
    /// An instance, by its number.
    Instance(u32),
}

/// What a tree is built over.
#[derive(Clone, Copy, Debug)]
pub(super) enum Item {
    /// A triangle of the mesh of a shape.
    Triangle { shape: u32, index: u32 },
    /// Any other.
    Other(Other),
}

/// An [`Item`] in eight bytes, of which there are many while a tree is built: the shape and the number, or in place of the
/// shape what else it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct PackedItem([u32; 2]);

impl PackedItem {
    const PRIMITIVE: u32 = u32::MAX;
    const INSTANCE: u32 = u32::MAX - 1;

    #[inline]
    fn unpacked(self) -> Item {
        match self.0 {
            [Self::PRIMITIVE, number] => Item::Other(Other::Primitive(number)),
            [Self::INSTANCE, number] => Item::Other(Other::Instance(number)),
            [shape, index] => Item::Triangle { shape, index },
        }
    }
}

impl From<Item> for PackedItem {
    fn from(item: Item) -> Self {
        Self(match item {
            Item::Triangle { shape, index } => [shape, index],
            Item::Other(Other::Primitive(number)) => [Self::PRIMITIVE, number],
            Item::Other(Other::Instance(number)) => [Self::INSTANCE, number],
        })
    }
}

/// The candidate for a hit that a level offers: of which shape or primitive, and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub t: f32,
    pub u: f32,
    pub v: f32,
    pub piece: Item,
}

/// Items, whose boxes are reckoned when they are asked for: to keep them would take more than a mesh does.
pub(super) struct Items<'a> {
    pub list: &'a [PackedItem],
    pub meshes: &'a [Mesh],
    pub mesh_of: &'a [Option<u32>],
    pub primitives: &'a [Primitive],
    /// Bounds of the instances.
    pub instances: &'a [Bounds],
}

impl<'a> Items<'a> {
    /// The mesh of a shape that has one: only such shapes have triangles.
    #[inline]
    fn mesh(&self, shape: u32) -> &'a Mesh {
        &self.meshes[self.mesh_of[shape as usize].unwrap_or(0) as usize]
    }
}

impl Boxes for Items<'_> {
    fn count(&self) -> u32 {
        self.list.len() as u32
    }

    #[inline]
    fn get(&self, number: u32) -> Bounds {
        match self.list[number as usize].unpacked() {
            Item::Triangle { shape, index } => {
                let mesh = self.mesh(shape);
                Bounds::of(mesh.triangles[index as usize].map(|i| mesh.positions[i as usize]))
            }
            Item::Other(Other::Primitive(p)) => self.primitives[p as usize].bounds(),
            Item::Other(Other::Instance(i)) => self.instances[i as usize],
        }
    }
}

impl Level {
    /// Over items with bounds, and primitives without any.
    pub fn new(work: &Work<'_>, items: &Items<'_>, infinite: Vec<u32>) -> Self {
        let (mut flats, mut others) = (Vec::new(), Vec::new());
        let count = items.list.iter().filter(|item| matches!(item.unpacked(), Item::Triangle { .. })).count();
        let mut triangles = Triangles::default();
        let kind = |i: u32| match items.list[i as usize].unpacked() {
            Item::Triangle { .. } => Kind::Triangles,
            Item::Other(Other::Primitive(p))
                if matches!(items.primitives[p as usize], Primitive::Flat(_)) =>
            {
                Kind::Flats
            }
            Item::Other(_) => Kind::Other,
        };
        let tree = Tree::build(work, items, kind, |kind, list| {
            let members = list.iter().map(|&i| items.list[i as usize].unpacked());
            let number = match kind {
                Kind::Triangles => {
                    // Not before: to part and cluster boxes takes memory that is free by now.
                    if triangles.is_empty() {
                        triangles = Triangles::with_capacity(count);
                    }
                    let leaf = triangles.add(members.filter_map(|item| match item {
                        Item::Triangle { shape, index } => Some((shape, items.mesh(shape), index)),
                        Item::Other(_) => None,
                    }));
                    return leaf.into();
                }
                Kind::Flats => {
                    flats.push(FlatBlock::new(members.filter_map(|item| match item {
                        Item::Other(Other::Primitive(p)) => match &items.primitives[p as usize] {
                            Primitive::Flat(flat) => Some((p, flat)),
                            _ => None,
                        },
                        _ => None,
                    })));
                    flats.len()
                }
                Kind::Other => {
                    others.extend(members.filter_map(|item| match item {
                        Item::Other(other) => Some(other),
                        Item::Triangle { .. } => None,
                    }));
                    others.len()
                }
            };
            number as u32 - 1
        });
        triangles.finish();
        let bounds = (0..items.count()).fold(Bounds::EMPTY, |all, i| all.union(items.get(i)));
        Self { tree, triangles, flats, others, infinite, bounds }
    }

    /// Bytes of the tree and its leaves.
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
            + self.triangles.bytes()
            + size_of_val(&self.flats[..])
            + size_of_val(&self.others[..])
    }

    /// Offers the hits of a ray before `t_max`, near ones about first. What is taken shortens the ray,
    /// and ends the search where `ANY` hit will do; whether it did is returned.
    #[inline(always)]
    pub fn search<L: Lanes, const ANY: bool>(
        &self,
        primitives: &[Primitive],
        ray: &Ray,
        t_max: &mut f32,
        searcher: &mut impl Searcher,
    ) -> bool {
        let no_triangles = self.triangles.is_empty();
        let sheared = if no_triangles { ShearedRay::UNUSED } else { ShearedRay::new(ray.direction) };
        let lanes = ShearedLanes::<L>::new(ray, &sheared);
        for &p in &self.infinite {
            if single::<ANY>(primitives, p, ray, &sheared, t_max, searcher) {
                return true;
            }
        }
        let mut leaves = Leaves::<L, _, ANY> { level: self, primitives, ray, sheared, lanes, searcher };
        self.tree.traverse::<L, ANY>(ray, t_max, &mut leaves)
    }
}

/// The leaves of a level, as a ray comes to them.
struct Leaves<'a, L, S, const ANY: bool> {
    level: &'a Level,
    primitives: &'a [Primitive],
    ray: &'a Ray,
    sheared: ShearedRay,
    lanes: ShearedLanes<L>,
    searcher: &'a mut S,
}

impl<L: Lanes, S: Searcher, const ANY: bool> Visitor for Leaves<'_, L, S, ANY> {
    #[inline(always)]
    fn visit(&mut self, kind: Kind, number: usize, t_max: &mut f32) -> bool {
        match kind {
            Kind::Triangles => {
                let (triangles, leaf) = (&self.level.triangles, TriangleLeaf::from(number));
                let hits = triangles.intersect::<L>(leaf, self.ray, &self.sheared, &self.lanes, *t_max);
                take::<ANY>(hits, t_max, self.searcher, |lane| {
                    let [shape, index] = triangles.name(leaf, lane);
                    Item::Triangle { shape, index }
                })
            }
            Kind::Flats => {
                let block = &self.level.flats[number];
                let hits = block.intersect::<L>(self.ray, *t_max);
                take::<ANY>(hits, t_max, self.searcher, |i| Item::Other(Other::Primitive(block.index[i])))
            }
            Kind::Other => match self.level.others[number] {
                Other::Primitive(p) => {
                    single::<ANY>(self.primitives, p, self.ray, &self.sheared, t_max, self.searcher)
                }
                Other::Instance(i) => self.searcher.instance::<L, ANY>(i, t_max),
            },
        }
    }

    #[inline(always)]
    fn prefetch(&self, kind: Kind, number: usize) {
        if kind == Kind::Triangles {
            self.level.triangles.prefetch::<L>(TriangleLeaf::from(number));
        }
    }
}

/// Who asks a [`Level`].
pub(super) trait Searcher {
    /// Whether a candidate counts.
    fn offer(&mut self, candidate: Candidate) -> bool;

    /// Searches an instance, as [`Level::search`] does a level.
    fn instance<L: Lanes, const ANY: bool>(&mut self, number: u32, t_max: &mut f32) -> bool;
}

/// Offers the hits of a block.
#[inline(always)]
fn take<const ANY: bool>(
    mut hits: Hits,
    t_max: &mut f32,
    searcher: &mut impl Searcher,
    piece: impl Fn(usize) -> Item,
) -> bool {
    while let Some((i, Intersection { t, u, v })) = hits.next() {
        // The first that counts is the last.
        if (ANY || t < *t_max) && searcher.offer(Candidate { t, u, v, piece: piece(i) }) {
            *t_max = t;
            if ANY {
                return true;
            }
        }
    }
    false
}

/// Offers the hit of one primitive.
#[inline(always)]
fn single<const ANY: bool>(
    primitives: &[Primitive],
    number: u32,
    ray: &Ray,
    sheared: &ShearedRay,
    t_max: &mut f32,
    searcher: &mut impl Searcher,
) -> bool {
    let ray = Ray { t_max: *t_max, ..*ray };
    let Some(Intersection { t, u, v }) = primitives[number as usize].intersect(&ray, sheared) else {
        return false;
    };
    let piece = Item::Other(Other::Primitive(number));
    if searcher.offer(Candidate { t, u, v, piece }) {
        *t_max = t;
        return ANY;
    }
    // A curved surface that is not there on the near side may be on the far one.
    let near = Intersection { t, u, v };
    let far = primitives[number as usize].beyond(&ray, &near, sheared);
    if let Some(Intersection { t, u, v }) = far
        && searcher.offer(Candidate { t, u, v, piece })
    {
        *t_max = t;
        return ANY;
    }
    false
}
