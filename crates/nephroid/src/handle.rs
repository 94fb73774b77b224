//! Arenas and the typed indices into them: scene data refers by number and owns in one place.

use std::fmt;
use std::marker::PhantomData;
use std::ops::Index;
use std::sync::Arc;

/// The place of a `T` in an [`Arena`]. A texture's handle cannot index materials.
pub struct Handle<T> {
    index: u32,
    kind: PhantomData<fn() -> T>,
}

impl<T> Handle<T> {
    /// The index as a number.
    #[inline]
    pub fn index(self) -> usize {
        self.index as usize
    }
}

impl<T> Clone for Handle<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Handle<T> {}

impl<T> PartialEq for Handle<T> {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

impl<T> Eq for Handle<T> {}

impl<T> fmt::Debug for Handle<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.index)
    }
}

/// A growing list that hands out a [`Handle`] for each item and never takes one back.
/// Copies share their items until one of them gets another.
#[derive(Clone, Debug, PartialEq)]
pub struct Arena<T> {
    items: Arc<Vec<T>>,
}

impl<T> Default for Arena<T> {
    fn default() -> Self {
        Self { items: Arc::default() }
    }
}

impl<T> Arena<T> {
    /// The items in order.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.items.iter()
    }

    /// Handles and items in order.
    pub fn iter_handles(&self) -> impl Iterator<Item = (Handle<T>, &T)> {
        (0u32..).zip(self.items.iter()).map(|(index, item)| (Handle { index, kind: PhantomData }, item))
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// The items as a slice.
    #[inline]
    pub fn as_slice(&self) -> &[T] {
        &self.items
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Whether the handle came from an arena at least this long.
    pub fn contains(&self, handle: Handle<T>) -> bool {
        handle.index() < self.items.len()
    }
}

impl<T: Clone> Arena<T> {
    /// Stores an item.
    pub fn push(&mut self, item: T) -> Handle<T> {
        let index = u32::try_from(self.items.len()).expect("fewer than 2^32 items of one kind");
        Arc::make_mut(&mut self.items).push(item);
        Handle { index, kind: PhantomData }
    }

    /// An item, to be changed.
    pub(crate) fn item_mut(&mut self, handle: Handle<T>) -> &mut T {
        &mut Arc::make_mut(&mut self.items)[handle.index()]
    }

    /// All items, to be changed.
    pub(crate) fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        Arc::make_mut(&mut self.items).iter_mut()
    }
}

impl<T> Index<Handle<T>> for Arena<T> {
    type Output = T;
    #[inline]
    fn index(&self, handle: Handle<T>) -> &T {
        &self.items[handle.index()]
    }
}
