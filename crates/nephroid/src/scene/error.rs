use std::fmt;

/// The part of a scene that a problem is about; the numbers count the scene's own lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The camera.
    Camera,
    /// The film.
    Film,
    /// A texture.
    Texture(usize),
    /// An image.
    Image(usize),
    /// A material.
    Material(usize),
    /// A mesh.
    Mesh(usize),
    /// A shape: first come those of the scene, then those of its groups.
    Shape(usize),
    /// A group of shapes.
    Group(usize),
    /// An instance of a group.
    Instance(usize),
    /// A light without a surface.
    Light(usize),
    /// A medium.
    Medium(usize),
    /// A grid of a medium's values.
    Grid(usize),
}

/// Something a scene cannot be rendered with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// What it is about.
    pub subject: Subject,
    /// What is wrong and what to write instead.
    pub message: String,
}

/// Something that may not be meant so; the scene is rendered as it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// What it is about.
    pub subject: Subject,
    /// What is odd and what to write instead.
    pub message: String,
}

/// Every problem of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneErrors(pub Vec<SceneError>);

impl fmt::Display for SceneErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, error) in self.0.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{error}")?;
        }
        Ok(())
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.subject {
            Subject::Camera => write!(f, "camera: "),
            Subject::Film => write!(f, "film: "),
            Subject::Texture(i) => write!(f, "texture {i}: "),
            Subject::Image(i) => write!(f, "image {i}: "),
            Subject::Material(i) => write!(f, "material {i}: "),
            Subject::Mesh(i) => write!(f, "mesh {i}: "),
            Subject::Shape(i) => write!(f, "shape {i}: "),
            Subject::Group(i) => write!(f, "group {i}: "),
            Subject::Instance(i) => write!(f, "instance {i}: "),
            Subject::Light(i) => write!(f, "light {i}: "),
            Subject::Medium(i) => write!(f, "medium {i}: "),
            Subject::Grid(i) => write!(f, "grid {i}: "),
        }?;
        f.write_str(&self.message)
    }
}

impl std::error::Error for SceneErrors {}
