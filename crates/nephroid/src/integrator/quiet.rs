use crate::observer::Observer;

/// Stops, but tells nothing: what is tried is no part of the render.
pub(crate) struct Quiet<'a>(pub &'a dyn Observer);

impl Observer for Quiet<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
