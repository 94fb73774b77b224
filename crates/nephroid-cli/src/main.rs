//! The command `nephroid`.

fn main() {}
