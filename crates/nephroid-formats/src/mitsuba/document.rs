//! From XML text to one tree: includes put in, parameters filled in, nothing interpreted yet.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::legacy::upgrade;
use super::parameters::Parameters;
use crate::diagnostic::{Diagnostic, Location, Source};
use crate::log::{Log, shortened};
use crate::open::{MAX_BYTES, decode, find};
use crate::vfs::{Files, normalized};

/// Elements inside elements.
const MAX_DEPTH: usize = 50;
/// Files included by files.
const MAX_INCLUDE_DEPTH: usize = 16;
/// Files of one scene.
const MAX_INCLUDES: usize = 1000;
/// Elements and attributes in one file.
const MAX_NODES: u32 = 20_000_000;

/// An XML element.
#[derive(Debug)]
pub(super) struct Element {
    /// Different for each element of a scene.
    pub(super) number: usize,
    pub(super) tag: String,
    /// Its opening bracket and name.
    pub(super) location: Location,
    pub(super) attributes: Vec<Attribute>,
    pub(super) children: Vec<Element>,
    /// Whether its file is of a version before 2.
    pub(super) is_legacy: bool,
}

/// An attribute of an element.
#[derive(Debug)]
pub(super) struct Attribute {
    pub(super) name: String,
    pub(super) value: String,
    /// Of the value, without quotes.
    pub(super) location: Location,
}

impl Element {
    pub(super) fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }

    pub(super) fn value_of(&self, name: &str) -> Option<&str> {
        self.attribute(name).map(|a| a.value.as_str())
    }

    /// Complains about attributes that are not listed.
    pub(super) fn allow_attributes(&self, known: &[&str], log: &Log) {
        for attribute in &self.attributes {
            if !known.contains(&attribute.name.as_str()) {
                let message = format!("<{}> has no attribute \"{}\"", self.tag, attribute.name);
                log.push(
                    Diagnostic::error(&attribute.location, message)
                        .did_you_mean(&attribute.name, known.iter().copied()),
                );
            }
        }
    }

    /// The value of an attribute that must be there.
    pub(super) fn require(&self, name: &str, log: &Log) -> Option<&Attribute> {
        let found = self.attribute(name);
        if found.is_none() {
            log.error(&self.location, format!("<{}> lacks the attribute \"{name}\"", self.tag));
        }
        found
    }
}

/// A whole scene before its elements are interpreted.
pub(super) struct Document {
    /// The content of `<scene>`, with the content of included files in its place.
    pub(super) elements: Vec<Element>,
    /// The root of the first file.
    pub(super) root: Location,
    /// Where to look for files, in order.
    pub(super) folders: Vec<PathBuf>,
    /// `<alias>`: the existing name, the new name, where.
    pub(super) aliases: Vec<(String, String, Location)>,
}

/// Reads a scene's text and all it includes. `None` if the log says why.
pub(super) fn load(
    path: &Path,
    bytes: Vec<u8>,
    files: &dyn Files,
    defines: &[(String, String)],
    log: &Log,
) -> Option<Document> {
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut loader = Loader {
        files,
        log,
        folders: vec![folder],
        parameters: Parameters::new(defines),
        aliases: Vec::new(),
        pending_paths: Vec::new(),
        open: Vec::new(),
        includes: 0,
        bytes: 0,
        count: 0,
        is_legacy: false,
    };
    let source = decode(&path.display().to_string(), bytes, None, log)?;
    let (mut elements, root) = loader.file(path, &source)?;
    for element in &mut elements {
        substitute(element, &loader.parameters, log);
        upgrade(element, &mut loader.count);
    }
    let Loader { folders, parameters, mut aliases, .. } = loader;
    for (existing, new, at) in &mut aliases {
        *existing = parameters.substitute(existing, at, log);
        *new = parameters.substitute(new, at, log);
    }
    parameters.report_unused(&root, log);
    Some(Document { elements, root, folders, aliases })
}

fn substitute(element: &mut Element, parameters: &Parameters, log: &Log) {
    for attribute in &mut element.attributes {
        if attribute.value.contains('$') {
            attribute.value = parameters.substitute(&attribute.value, &attribute.location, log);
        }
    }
    for child in &mut element.children {
        substitute(child, parameters, log);
    }
}

struct Loader<'a> {
    files: &'a dyn Files,
    log: &'a Log,
    folders: Vec<PathBuf>,
    parameters: Parameters,
    aliases: Vec<(String, String, Location)>,
    /// `<path>`s of the file at hand, which may use parameters that it defines later.
    pending_paths: Vec<(String, Location)>,
    /// The files that include each other, outermost first.
    open: Vec<PathBuf>,
    includes: usize,
    bytes: usize,
    count: usize,
    /// Whether the file at hand is of a version before 2.
    is_legacy: bool,
}

impl Loader<'_> {
    /// The elements of a file and of those it includes.
    fn file(&mut self, path: &Path, source: &Arc<Source>) -> Option<(Vec<Element>, Location)> {
        let whole = Location::new(source, 0..0);
        self.bytes += source.text().len();
        if self.bytes > MAX_BYTES {
            self.log.error(&whole, format!("more than {} MiB of XML", MAX_BYTES >> 20));
            return None;
        }
        let options = roxmltree::ParsingOptions { nodes_limit: MAX_NODES, ..Default::default() };
        let xml = match roxmltree::Document::parse_with_options(source.text(), options) {
            Ok(xml) => xml,
            Err(error) => {
                self.log.push(syntax_error(source, &error));
                return None;
            }
        };
        let root = xml.root_element();
        let location = tag_location(source, &root);
        self.is_legacy = self.check_root(source, &root, &location)? < 2;
        let mut elements = Vec::new();
        for child in root.children() {
            if let Some(element) = self.element(source, child, 1) {
                elements.push(element);
            }
        }
        drop(xml);
        for (value, at) in std::mem::take(&mut self.pending_paths) {
            let text = self.parameters.substitute(&value, &at, self.log);
            let folder = self.folders[0].join(text.replace('\\', "/"));
            self.folders.push(folder);
        }
        self.open.push(normalized(path));
        let mut out = Vec::new();
        for element in elements {
            if element.tag == "include" {
                out.extend(self.include(&element, path).unwrap_or_default());
            } else {
                out.push(element);
            }
        }
        self.open.pop();
        Some((out, location))
    }

    /// The version of the file before the first point.
    fn check_root(&self, source: &Arc<Source>, root: &roxmltree::Node, at: &Location) -> Option<u32> {
        let tag = root.tag_name().name();
        if tag != "scene" {
            self.log.error(at, format!("expected <scene>, found <{tag}>"));
            return None;
        }
        for attribute in root.attributes() {
            if attribute.name() != "version" {
                let at = Location::new(source, attribute.range_value());
                self.log.error(&at, format!("<scene> has no attribute \"{}\"", attribute.name()));
            }
        }
        let Some(version) = root.attribute_node("version") else {
            self.log.push(
                Diagnostic::error(at, "<scene> lacks the attribute \"version\"")
                    .hint("write <scene version=\"3.0.0\">"),
            );
            return None;
        };
        let at = Location::new(source, version.range_value());
        let major = version.value().split('.').next().and_then(|major| major.trim().parse::<u32>().ok());
        let message = match major {
            // Mitsuba takes what is older than 2 for what was before it, and there was no version 1.
            Some(major @ 0..=3) => return Some(major),
            Some(_) => {
                Diagnostic::error(&at, format!("unknown scene version \"{}\"", shortened(version.value())))
                    .hint("versions 0.4 to 0.6, 2 and 3 can be read")
            }
            None => {
                Diagnostic::error(&at, format!("\"{}\" is not a scene version", shortened(version.value())))
                    .hint("write <scene version=\"3.0.0\">")
            }
        };
        self.log.push(message);
        None
    }

    /// An XML node as an element; `None` for comments and for what only concerns the loader.
    fn element(&mut self, source: &Arc<Source>, node: roxmltree::Node, depth: usize) -> Option<Element> {
        if node.is_text() {
            let text = node.text().unwrap_or_default();
            if let Some(start) = text.find(|c: char| !c.is_whitespace()) {
                let word: String = text[start..].chars().take_while(|c| !c.is_whitespace()).collect();
                let at = Location::new(source, node.range().start + start..node.range().end);
                self.log.error(&at, format!("unexpected text \"{}\"", shortened(&word)));
            }
            return None;
        }
        if !node.is_element() {
            return None;
        }
        let location = tag_location(source, &node);
        if depth > MAX_DEPTH {
            self.log.error(&location, format!("elements are nested more than {MAX_DEPTH} deep"));
            return None;
        }
        let attributes = node
            .attributes()
            .map(|a| Attribute {
                name: a.name().to_string(),
                value: a.value().to_string(),
                location: Location::new(source, a.range_value()),
            })
            .collect();
        self.count += 1;
        let mut element = Element {
            number: self.count,
            tag: node.tag_name().name().to_string(),
            location,
            attributes,
            children: Vec::new(),
            is_legacy: self.is_legacy,
        };
        if self.absorb(&element) {
            return None;
        }
        if element.tag == "include" && depth > 1 {
            self.log.error(&element.location, "<include> may only stand directly in <scene>");
            return None;
        }
        for child in node.children() {
            element.children.extend(self.element(source, child, depth + 1));
        }
        Some(element)
    }

    /// Takes in an element that concerns the loader alone.
    fn absorb(&mut self, element: &Element) -> bool {
        match element.tag.as_str() {
            "default" => {
                element.allow_attributes(&["name", "value"], self.log);
                let name = element.require("name", self.log);
                if let (Some(name), Some(value)) = (name, element.require("value", self.log)) {
                    self.parameters.set_default(&name.value, &value.value);
                }
            }
            "path" => {
                element.allow_attributes(&["value"], self.log);
                if let Some(value) = element.require("value", self.log) {
                    self.pending_paths.push((value.value.clone(), value.location.clone()));
                }
            }
            "alias" => {
                element.allow_attributes(&["id", "as"], self.log);
                let id = element.require("id", self.log);
                if let (Some(id), Some(new)) = (id, element.require("as", self.log)) {
                    self.aliases.push((id.value.clone(), new.value.clone(), new.location.clone()));
                }
            }
            _ => return false,
        }
        true
    }

    fn include(&mut self, element: &Element, includer: &Path) -> Option<Vec<Element>> {
        element.allow_attributes(&["filename", "name"], self.log);
        let filename = element.require("filename", self.log)?;
        let name = self.parameters.substitute(&filename.value, &filename.location, self.log);
        let mut folders = self.folders.clone();
        folders.extend(includer.parent().map(Path::to_path_buf).filter(|folder| *folder != folders[0]));
        let (path, bytes) = match find(self.files, &folders, &name) {
            Ok(found) => found,
            Err(error) => {
                self.log.error(&filename.location, format!("cannot read \"{}\": {error}", shortened(&name)));
                return None;
            }
        };
        if self.open.contains(&normalized(&path)) {
            self.log.error(&filename.location, format!("\"{}\" includes itself", shortened(&name)));
            return None;
        }
        self.includes += 1;
        if self.open.len() > MAX_INCLUDE_DEPTH || self.includes > MAX_INCLUDES {
            self.log.error(&filename.location, "too many included files");
            return None;
        }
        let source = decode(&path.display().to_string(), bytes, Some(&filename.location), self.log)?;
        Some(self.file(&path, &source)?.0)
    }
}

fn tag_location(source: &Arc<Source>, node: &roxmltree::Node) -> Location {
    let start = node.range().start;
    Location::new(source, start..start + 1 + node.tag_name().name().len())
}

fn syntax_error(source: &Arc<Source>, error: &roxmltree::Error) -> Diagnostic {
    let place = error.pos();
    let byte = source.byte_at(place.row as usize, place.col as usize);
    let at = Location::new(source, byte..byte + 1);
    if matches!(error, roxmltree::Error::DtdDetected) {
        let start = source.text().find("<!DOCTYPE").unwrap_or(0);
        let at = Location::new(source, start..start + 9);
        return Diagnostic::error(&at, "document types and entities are not supported")
            .hint("remove <!DOCTYPE …>");
    }
    let text = error.to_string();
    let text = text.strip_suffix(&format!(" at {place}")).unwrap_or(&text);
    Diagnostic::error(&at, format!("not well-formed XML: {text}"))
}
