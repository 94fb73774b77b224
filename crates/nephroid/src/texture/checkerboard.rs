use super::Texture;
use crate::handle::Handle;
use crate::math::{Affine2, Vec2};

/// Squares of half a unit in transformed `uv`: `color0` where both halves agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkerboard {
    /// In the squares at (0, 0) and (½, ½).
    pub color0: Handle<Texture>,
    /// In the others.
    pub color1: Handle<Texture>,
    /// Applied to `uv` first.
    pub to_uv: Affine2,
}

impl Checkerboard {
    /// The texture shown at `uv`.
    pub fn child(&self, uv: Vec2) -> Handle<Texture> {
        let p = self.to_uv.transform_point2(uv);
        let upper = |x: f32| x - x.floor() > 0.5;
        if upper(p.x) == upper(p.y) { self.color0 } else { self.color1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::texture::Textures;

    #[test]
    fn squares_alternate() {
        let mut t = Textures::default();
        let (color0, color1) = (t.constant(Rgb::BLACK), t.constant(Rgb::WHITE));
        let board = Checkerboard { color0, color1, to_uv: Affine2::IDENTITY };
        assert_eq!(board.child(Vec2::new(0.25, 0.25)), color0);
        assert_eq!(board.child(Vec2::new(0.75, 0.25)), color1);
        assert_eq!(board.child(Vec2::new(-0.25, 0.25)), color1);
        let board = t.push(Texture::Checkerboard(board));
        assert_eq!(t.mean(board), Rgb::splat(0.5));
    }
}
