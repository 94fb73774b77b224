//! Statistical tests and numerical checks. Knows no type of the renderer: everything takes closures and slices.
