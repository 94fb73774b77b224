use std::mem::MaybeUninit;

/// How many children a [`Stack`] holds. Trees that need more are built otherwise: in halves, where fewer than
/// 2³² items make 32 binary levels at most, at each of which up to 7 children wait.
pub(super) const DEPTH: usize = 7 * 32;

/// Children that a ray has still to enter. Not filled in advance, which took a tenth of a ray's time.
pub(super) struct Stack {
    /// The first `held` are written.
    entries: [MaybeUninit<u64>; DEPTH],
    held: usize,
}

impl Stack {
    #[inline(always)]
    pub fn new() -> Self {
        Self { entries: [const { MaybeUninit::uninit() }; DEPTH], held: 0 }
    }

    #[inline(always)]
    pub fn held(&self) -> usize {
        self.held
    }

    #[inline(always)]
    pub fn push(&mut self, entry: u64) {
        self.entries[self.held].write(entry);
        self.held += 1;
    }

    /// Puts an entry below the smaller ones of those that were pushed since `bottom` were held.
    #[inline(always)]
    pub fn insert(&mut self, bottom: usize, entry: u64) {
        let mut place = self.held;
        while place > bottom {
            // SAFETY: it lies below `held`, so it is written.
            let above = unsafe { self.entries[place - 1].assume_init() };
            if above >= entry {
                break;
            }
            self.entries[place] = self.entries[place - 1];
            place -= 1;
        }
        self.entries[place].write(entry);
        self.held += 1;
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<u64> {
        if self.held == 0 {
            return None;
        }
        self.held -= 1;
        // SAFETY: it was below `held`, so it is written.
        Some(unsafe { self.entries[self.held].assume_init() })
    }
}
