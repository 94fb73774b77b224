//! Estimates where the answer is known.
