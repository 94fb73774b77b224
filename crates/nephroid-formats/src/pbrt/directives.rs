//! Directives: what a file says, one after the other.

use std::rc::Rc;
use std::sync::Arc;

use super::names::DIRECTIVES;
use super::parameter::{Parameter, read_parameters};
use super::parameters::Parameters;
use super::reader::Reader;
use super::state::Scope;
use super::token::{Token, TokenKind, Tokens, unescaped};
use crate::diagnostic::{Diagnostic, Location, Source};
use crate::log::shortened;
use crate::number::float;

impl<'t> Reader<'t> {
    /// Obeys the directives of a file.
    pub(super) fn obey(&mut self, source: Arc<Source>) {
        let mut tokens = Tokens::new(source);
        while let Some(token) = tokens.next(self.log) {
            let at = tokens.location(&token);
            let directive = DIRECTIVES.iter().find(|known| **known == tokens.text(&token));
            match directive.filter(|_| token.kind == TokenKind::Word) {
                Some(directive) => self.directive(directive, &at, &mut tokens),
                None => self.no_directive(&token, &mut tokens),
            }
        }
    }

    /// Complains of what is no directive, and goes on with the next that is one.
    fn no_directive(&mut self, token: &Token, tokens: &mut Tokens) {
        let (text, at) = (tokens.text(token), tokens.location(token));
        let message = match token.kind {
            TokenKind::Word => Diagnostic::error(&at, format!("unknown directive \"{}\"", shortened(text)))
                .did_you_mean(text, DIRECTIVES.iter().copied()),
            _ => Diagnostic::error(&at, format!("expected a directive, found \"{}\"", shortened(text))),
        };
        self.log.push(message);
        while let Some(next) = tokens.peek(self.log) {
            if next.kind == TokenKind::Word && DIRECTIVES.contains(&tokens.text(&next)) {
                return;
            }
            tokens.next(self.log);
        }
    }

    fn directive(&mut self, directive: &'static str, at: &Location, tokens: &mut Tokens) {
        match directive {
            "Identity" | "Translate" | "Scale" | "Rotate" | "LookAt" | "Transform" | "ConcatTransform" => {
                self.transform(directive, at, tokens);
            }
            "CoordinateSystem" | "CoordSysTransform" => {
                if let Some((name, name_at)) = self.string(directive, at, tokens) {
                    self.coordinate_system(directive, &name, &name_at);
                }
            }
            "ActiveTransform" | "TransformTimes" => {
                self.pass_words(tokens);
                let message = format!("{directive}: motion blur cannot be had yet; nothing moves");
                self.log.warn(at, message);
            }
            "Film" | "Camera" | "Sampler" | "Integrator" | "PixelFilter" | "Accelerator" | "Renderer"
            | "SurfaceIntegrator" | "VolumeIntegrator" => {
                if let Some((kind, kind_at)) = self.string(directive, at, tokens) {
                    let list = self.parameters(tokens);
                    self.option_block(directive, kind, kind_at, list);
                }
            }
            "ColorSpace" => {
                if let Some((name, name_at)) = self.string(directive, at, tokens) {
                    self.set_color_space(&name, &name_at);
                }
            }
            "Option" => {
                self.string(directive, at, tokens);
                tokens.next(self.log);
                self.log.warn(at, "options of pbrt mean nothing here");
            }
            "WorldBegin" => self.world_begin(at),
            "WorldEnd" => self.log.warn(at, "\"WorldEnd\" is of older files, and not needed"),
            "Include" | "Import" => {
                if let Some((name, name_at)) = self.string(directive, at, tokens) {
                    self.include_or_import(directive, &name, &name_at);
                }
            }
            "ReverseOrientation" => {
                self.state.reverse_orientation = !self.state.reverse_orientation;
                self.must_be_in_world(directive, at);
            }
            "AttributeBegin" | "TransformBegin" => self.begin(Scope::Attribute, at),
            "AttributeEnd" | "TransformEnd" => {
                self.end(Scope::Attribute, at);
            }
            "Attribute" => {
                if let Some((target, target_at)) = self.string(directive, at, tokens) {
                    let list = self.parameters(tokens);
                    self.attribute(&target, &target_at, list);
                }
            }
            "ObjectBegin" | "ObjectInstance" => {
                if let Some((name, name_at)) = self.string(directive, at, tokens)
                    && self.must_be_in_world(directive, at)
                {
                    if directive == "ObjectBegin" {
                        self.object_begin(name, &name_at);
                    } else {
                        self.object_instance(&name, &name_at);
                    }
                }
            }
            "ObjectEnd" => self.object_end(at),
            "MediumInterface" => self.medium_interface(directive, at, tokens),
            _ => self.description(directive, at, tokens),
        }
    }

    /// What describes a part of the world.
    fn description(&mut self, directive: &'static str, at: &Location, tokens: &mut Tokens) {
        let Some((name, name_at)) = self.string(directive, at, tokens) else { return };
        if directive == "NamedMaterial" {
            self.named_material(&name, &name_at);
            return;
        }
        if directive == "Texture" {
            let Some((values, values_at)) = self.string(directive, at, tokens) else { return };
            let Some((kind, kind_at)) = self.string(directive, at, tokens) else { return };
            let list = self.parameters(tokens);
            let list = self.with_defaults("texture", kind, kind_at, list);
            self.texture((name, &name_at), (&values, &values_at), &list);
            return;
        }
        let list = self.parameters(tokens);
        // Media around the camera stand before the world.
        if directive != "MakeNamedMedium" && !self.must_be_in_world(directive, at) {
            return;
        }
        match directive {
            "Shape" => {
                let list = self.with_defaults("shape", name, name_at, list);
                self.shape(&list);
            }
            "Material" => {
                let list = self.with_defaults("material", name, name_at, list);
                self.state.material = self.set_material(&list);
            }
            "MakeNamedMaterial" => {
                let list = self.with_defaults("material", String::new(), name_at, list);
                self.make_named_material(name, list);
            }
            "MakeNamedMedium" => {
                let list = self.with_defaults("medium", String::new(), name_at, list);
                self.make_named_medium(name, list);
            }
            "LightSource" => {
                let list = self.with_defaults("light", name, name_at, list);
                self.light(&list);
            }
            "AreaLightSource" => {
                let list = self.with_defaults("light", name, name_at, list);
                self.set_area_light(&list);
            }
            _ => {}
        }
    }

    fn include_or_import(&mut self, directive: &'static str, name: &str, at: &Location) {
        if directive == "Include" {
            self.include(name, at);
            return;
        }
        if !self.must_be_in_world(directive, at) {
            return;
        }
        // What is imported changes nothing for what follows.
        self.begin(Scope::Attribute, at);
        let depth = self.saved.len();
        self.include(name, at);
        while self.saved.len() > depth {
            self.never_ended();
        }
        if self.saved.len() == depth {
            self.end(Scope::Attribute, at);
        }
    }

    fn parameters(&self, tokens: &mut Tokens) -> Vec<Parameter> {
        read_parameters(tokens, self.color_space(), self.log)
    }

    fn with_defaults(
        &self,
        noun: &'static str,
        kind: String,
        at: Location,
        list: Vec<Parameter>,
    ) -> Parameters<'t> {
        let defaults: &[Rc<Parameter>] = match noun {
            "shape" => &self.state.defaults.shape,
            "light" => &self.state.defaults.light,
            "material" => &self.state.defaults.material,
            "medium" => &self.state.defaults.medium,
            _ => &self.state.defaults.texture,
        };
        Parameters::new(noun, kind, at, list, defaults, self.log)
    }

    /// The string that must follow.
    pub(super) fn string(
        &self,
        directive: &str,
        at: &Location,
        tokens: &mut Tokens,
    ) -> Option<(String, Location)> {
        match tokens.peek(self.log) {
            Some(token) if token.kind == TokenKind::Quoted => {
                tokens.next(self.log);
                Some((unescaped(tokens.text(&token)), tokens.location(&token)))
            }
            _ => {
                self.log.error(at, format!("{directive} must be followed by a string in quotes"));
                // Its parameters belong to nothing.
                read_parameters(tokens, self.color_space(), self.log);
                None
            }
        }
    }

    /// So many numbers that must follow, between brackets or not.
    pub(super) fn follow<const N: usize>(
        &self,
        directive: &str,
        at: &Location,
        tokens: &mut Tokens,
    ) -> Option<[f64; N]> {
        let mut numbers = Vec::with_capacity(N);
        let mut sound = true;
        let mut bracketed = false;
        while let Some(token) = tokens.peek(self.log) {
            match token.kind {
                TokenKind::Open if numbers.is_empty() && !bracketed => bracketed = true,
                TokenKind::Close if bracketed => {
                    tokens.next(self.log);
                    break;
                }
                TokenKind::Word if !DIRECTIVES.contains(&tokens.text(&token)) => {
                    match float(tokens.text(&token)) {
                        Ok(value) => numbers.push(value),
                        Err(message) => {
                            self.log.error(&tokens.location(&token), message);
                            numbers.push(0.0);
                            sound = false;
                        }
                    }
                }
                _ => break,
            }
            tokens.next(self.log);
        }
        match numbers.as_slice().try_into() {
            Ok(array) => Some(array).filter(|_| sound),
            Err(_) => {
                self.log.error(at, format!("{directive} takes {N} numbers, not {}", numbers.len()));
                None
            }
        }
    }

    fn pass_words(&self, tokens: &mut Tokens) {
        while let Some(token) = tokens.peek(self.log) {
            if token.kind != TokenKind::Word || DIRECTIVES.contains(&tokens.text(&token)) {
                return;
            }
            tokens.next(self.log);
        }
    }
}
