//! Accessors: numbers out of buffers (glTF 2.0, §3.6.2).

use super::buffers::{Buffers, View};
use super::item::Item;

/// Elements of an accessor without a view, which cost the file nothing.
const MAX_ZEROS: usize = 1 << 22;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(item: Item) -> Option<Self> {
        let code = item.whole("componentType");
        let component = match code {
            Some(5120) => Self::I8,
            Some(5121) => Self::U8,
            Some(5122) => Self::I16,
            Some(5123) => Self::U16,
            Some(5125) => Self::U32,
            Some(5126) => Self::F32,
            _ => {
                item.error("its \"componentType\" must be 5120, 5121, 5122, 5123, 5125 or 5126");
                return None;
            }
        };
        Some(component)
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number at the start of `bytes`, which are enough. Whole numbers that are `normalized` become parts of one
    /// (§3.11).
    fn read(self, bytes: &[u8], normalized: bool) -> f32 {
        let whole = |value: f32, most: f32| if normalized { (value / most).max(-1.0) } else { value };
        match self {
            Self::I8 => whole(f32::from(bytes[0] as i8), 127.0),
            Self::U8 => whole(f32::from(bytes[0]), 255.0),
            Self::I16 => whole(f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32_767.0),
            Self::U16 => whole(f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65_535.0),
            Self::U32 => {
                let value = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                if normalized { (f64::from(value) / f64::from(u32::MAX)) as f32 } else { value as f32 }
            }
            Self::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }

    /// The same of an index.
    fn read_whole(self, bytes: &[u8]) -> Option<u32> {
        match self {
            Self::U8 => Some(u32::from(bytes[0])),
            Self::U16 => Some(u32::from(u16::from_le_bytes([bytes[0], bytes[1]]))),
            Self::U32 => Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            Self::I8 | Self::I16 | Self::F32 => None,
        }
    }
}

/// Elements in a view, checked to lie in it.
struct Elements {
    view: View,
    start: usize,
    stride: usize,
    count: usize,
}

impl Elements {
    /// `None` if the log of `item` says why.
    fn new(item: Item, view: View, count: usize, size: usize, stride: Option<usize>) -> Option<Self> {
        let start = item.whole("byteOffset").unwrap_or(0);
        let stride = stride.unwrap_or(size);
        let end = (count.max(1) - 1)
            .checked_mul(stride)
            .and_then(|bytes| bytes.checked_add(start)?.checked_add(if count > 0 { size } else { 0 }));
        if end.is_none_or(|end| end > view.bytes().len()) {
            item.error(format!(
                "{count} elements of {size} bytes from byte {start} reach beyond the view of {} bytes",
                view.bytes().len()
            ));
            return None;
        }
        if stride < size {
            item.error(format!("elements of {size} bytes cannot follow one another after {stride}"));
            return None;
        }
        Some(Self { view, start, stride, count })
    }

    fn iter(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.count).map(|i| &self.view.bytes()[self.start + i * self.stride..])
    }
}

/// Numbers in one element of an accessor's type. Matrices are not of vertices.
fn components(kind: &str) -> Option<usize> {
    match kind {
        "SCALAR" => Some(1),
        "VEC2" => Some(2),
        "VEC3" => Some(3),
        "VEC4" => Some(4),
        _ => None,
    }
}

impl<'d> Buffers<'d> {
    /// The elements of an accessor whose type has `N` numbers, or between them and `N`: then `fill` are the others. All
    /// are finite. `None` if the log says why.
    pub(super) fn floats<const N: usize>(
        &mut self,
        accessor: Item<'d>,
        least: usize,
        fill: [f32; N],
    ) -> Option<Vec<[f32; N]>> {
        let kind = accessor.text("type").unwrap_or_default();
        let Some(width) = components(kind).filter(|width| (least..=N).contains(width)) else {
            accessor.error(format!(
                "the accessor is of type \"{kind}\" where elements of {least} numbers are needed"
            ));
            return None;
        };
        let component = Component::of(accessor)?;
        let normalized = accessor.boolean("normalized");
        let count = self.count(accessor)?;
        let size = width * component.size();
        let element = |bytes: &[u8]| {
            let mut out = fill;
            for (i, value) in out.iter_mut().take(width).enumerate() {
                *value = component.read(&bytes[i * component.size()..], normalized);
            }
            out
        };
        let mut zero = fill;
        zero[..width].fill(0.0);
        let mut values = match self.view_of(accessor)? {
            Some(view) => {
                let stride = view.stride;
                Elements::new(accessor, view, count, size, stride)?.iter().map(element).collect()
            }
            None => vec![zero; count],
        };
        if let Some(sparse) = accessor.object("sparse") {
            let places = self.sparse_places(sparse, count)?;
            let part = sparse.object("values")?;
            let view = self.view(part, "bufferView")?;
            let elements = Elements::new(part, view, places.len(), size, None)?;
            for (place, bytes) in places.into_iter().zip(elements.iter()) {
                values[place] = element(bytes);
            }
        }
        if let Some(bad) = values.iter().position(|value| value.iter().any(|v| !v.is_finite())) {
            accessor.error(format!("element {bad} of the accessor is infinite or not a number"));
            return None;
        }
        Some(values)
    }

    /// The whole numbers of an accessor. `None` if the log says why.
    pub(super) fn indices(&mut self, accessor: Item<'d>) -> Option<Vec<u32>> {
        if accessor.text("type") != Some("SCALAR") {
            accessor.error("indices must be of the type \"SCALAR\"");
            return None;
        }
        let component = Component::of(accessor)?;
        let count = self.count(accessor)?;
        let mut values: Vec<u32> = match self.view_of(accessor)? {
            Some(view) => {
                let stride = view.stride;
                let elements = Elements::new(accessor, view, count, component.size(), stride)?;
                whole_numbers(accessor, component, &elements)?
            }
            None => vec![0; count],
        };
        if let Some(sparse) = accessor.object("sparse") {
            let places = self.sparse_places(sparse, count)?;
            let part = sparse.object("values")?;
            let view = self.view(part, "bufferView")?;
            let elements = Elements::new(part, view, places.len(), component.size(), None)?;
            let replaced = whole_numbers(part, component, &elements)?;
            for (place, value) in places.into_iter().zip(replaced) {
                values[place] = value;
            }
        }
        Some(values)
    }

    fn count(&self, accessor: Item<'d>) -> Option<usize> {
        let Some(count) = accessor.whole("count") else {
            if !accessor.has("count") {
                accessor.error("the accessor has no \"count\"");
            }
            return None;
        };
        if !accessor.has("bufferView") && count > MAX_ZEROS {
            accessor
                .error(format!("{count} elements without a \"bufferView\", which is more than {MAX_ZEROS}"));
            return None;
        }
        Some(count)
    }

    /// The view of an accessor; without one all of it is zero.
    fn view_of(&mut self, accessor: Item<'d>) -> Option<Option<View>> {
        if accessor.has("bufferView") { self.view(accessor, "bufferView").map(Some) } else { Some(None) }
    }

    /// The elements that a sparse accessor replaces.
    fn sparse_places(&mut self, sparse: Item<'d>, count: usize) -> Option<Vec<usize>> {
        let Some((part, replaced)) = sparse.object("indices").zip(sparse.whole("count")) else {
            sparse.error("a sparse accessor needs \"count\", \"indices\" and \"values\"");
            return None;
        };
        if !sparse.has("values") {
            sparse.error("a sparse accessor needs \"values\"");
            return None;
        }
        let component = Component::of(part)?;
        let view = self.view(part, "bufferView")?;
        let elements = Elements::new(part, view, replaced, component.size(), None)?;
        let places = whole_numbers(part, component, &elements)?;
        if let Some(beyond) = places.iter().find(|place| **place as usize >= count) {
            part.error(format!("element {beyond} is replaced, and the accessor has {count}"));
            return None;
        }
        Some(places.into_iter().map(|place| place as usize).collect())
    }
}

fn whole_numbers(item: Item, component: Component, elements: &Elements) -> Option<Vec<u32>> {
    let values: Option<Vec<u32>> = elements.iter().map(|bytes| component.read_whole(bytes)).collect();
    if values.is_none() && elements.count > 0 {
        item.error("indices must be whole numbers without a sign (componentType 5121, 5123 or 5125)");
    }
    values
}
