//! What directives change and attributes bring back.

use std::rc::Rc;

use nephroid::handle::Handle;
use nephroid::material::Material;
use nephroid::math::Transform;
use nephroid::medium::Medium;

use super::area_light::AreaLight;
use super::color_space::ColorSpace;
use super::parameter::Parameter;
use crate::diagnostic::Location;

/// What a shape is made of.
#[derive(Clone, Debug, Default)]
pub(super) enum Current {
    /// Nothing was said yet: grey and diffuse.
    #[default]
    Default,
    /// A material.
    Is(Handle<Material>),
    /// What is wrong with it has been told.
    Failed,
}

/// The graphics state.
#[derive(Clone, Default)]
pub(super) struct State {
    /// From what is described next to the world; before `WorldBegin`, from the world to the camera.
    pub(super) ctm: Transform,
    /// Whether a scale of zero hides what is described next; `ctm` is without it.
    pub(super) is_hidden: bool,
    pub(super) reverse_orientation: bool,
    pub(super) material: Current,
    pub(super) area_light: Option<Rc<AreaLight>>,
    pub(super) inside: Option<Handle<Medium>>,
    pub(super) outside: Option<Handle<Medium>>,
    pub(super) color_space: ColorSpace,
    pub(super) defaults: Defaults,
}

/// What `Attribute` says of all that follows, by what it says it of.
#[derive(Clone, Default)]
pub(super) struct Defaults {
    pub(super) shape: Vec<Rc<Parameter>>,
    pub(super) light: Vec<Rc<Parameter>>,
    pub(super) material: Vec<Rc<Parameter>>,
    pub(super) medium: Vec<Rc<Parameter>>,
    pub(super) texture: Vec<Rc<Parameter>>,
}

/// What a state was saved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// `AttributeBegin`, or `TransformBegin`, which means the same.
    Attribute,
    /// `ObjectBegin`
    Object,
}

impl Scope {
    pub(super) fn begin(self) -> &'static str {
        match self {
            Self::Attribute => "AttributeBegin",
            Self::Object => "ObjectBegin",
        }
    }

    pub(super) fn end(self) -> &'static str {
        match self {
            Self::Attribute => "AttributeEnd",
            Self::Object => "ObjectEnd",
        }
    }
}

/// A state to come back to.
pub(super) struct Saved {
    pub(super) scope: Scope,
    pub(super) at: Location,
    pub(super) state: State,
}
