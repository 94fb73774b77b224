//! XML as it is written: indented elements, numbers that come back to the bit.

use std::fmt::Write;

use nephroid::color::Rgb;
use nephroid::math::{DAffine3, Transform, Vec3};

/// A document in the making.
#[derive(Default)]
pub(super) struct Xml {
    text: String,
    /// Elements that are open.
    open: Vec<&'static str>,
}

impl Xml {
    /// An element with others in it, until [`Self::close`].
    pub(super) fn open(&mut self, tag: &'static str, attributes: &[(&str, &str)]) {
        self.line(&format!("<{tag}{}>", written(attributes)));
        self.open.push(tag);
    }

    pub(super) fn close(&mut self) {
        if let Some(tag) = self.open.pop() {
            self.line(&format!("</{tag}>"));
        }
    }

    /// An element with nothing in it.
    pub(super) fn leaf(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.line(&format!("<{tag}{}/>", written(attributes)));
    }

    /// A plugin, with its id unless that is empty.
    pub(super) fn plugin(&mut self, tag: &'static str, kind: &str, id: &str) {
        let attributes = [("type", kind), ("id", id)];
        self.open(tag, if id.is_empty() { &attributes[..1] } else { &attributes });
    }

    /// A plugin without properties.
    pub(super) fn bare_plugin(&mut self, tag: &str, kind: &str) {
        self.leaf(tag, &[("type", kind)]);
    }

    pub(super) fn float(&mut self, name: &str, value: f32) {
        self.property("float", name, &number(value));
    }

    pub(super) fn integer(&mut self, name: &str, value: u32) {
        self.property("integer", name, &value.to_string());
    }

    pub(super) fn boolean(&mut self, name: &str, value: bool) {
        self.property("boolean", name, if value { "true" } else { "false" });
    }

    pub(super) fn string(&mut self, name: &str, value: &str) {
        self.property("string", name, value);
    }

    pub(super) fn rgb(&mut self, name: &str, value: Rgb) {
        self.property("rgb", name, &rgb(value));
    }

    pub(super) fn point(&mut self, name: &str, p: Vec3) {
        self.property("point", name, &list(&p.to_array()));
    }

    pub(super) fn vector(&mut self, name: &str, v: Vec3) {
        self.property("vector", name, &list(&v.to_array()));
    }

    /// Nothing where it changes nothing.
    pub(super) fn transform(&mut self, name: &str, transform: &Transform) {
        if *transform != Transform::IDENTITY {
            self.matrix(name, &transform.0);
        }
    }

    pub(super) fn matrix(&mut self, name: &str, map: &DAffine3) {
        let (m, t) = (map.matrix3, map.translation);
        let row = |i: usize| [m.x_axis[i], m.y_axis[i], m.z_axis[i], t[i]];
        let numbers = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]].concat();
        let text = numbers.iter().map(|v| plain(format!("{v:?}"))).collect::<Vec<_>>().join(" ");
        self.open("transform", &[("name", name)]);
        self.leaf("matrix", &[("value", &text)]);
        self.close();
    }

    /// A reference, with the name of a property unless that is empty.
    pub(super) fn reference(&mut self, name: &str, id: &str) {
        let attributes = [("id", id), ("name", name)];
        self.leaf("ref", if name.is_empty() { &attributes[..1] } else { &attributes });
    }

    /// The whole text; every element must be closed.
    pub(super) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn property(&mut self, tag: &str, name: &str, value: &str) {
        self.leaf(tag, &[("name", name), ("value", value)]);
    }

    fn line(&mut self, text: &str) {
        for _ in 0..self.open.len() {
            self.text.push_str("    ");
        }
        self.text.push_str(text);
        self.text.push('\n');
    }
}

fn written(attributes: &[(&str, &str)]) -> String {
    let mut out = String::new();
    for (name, value) in attributes {
        // Writing to a text cannot fail.
        let _ = write!(out, " {name}=\"{}\"", escaped(value));
    }
    out
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The shortest text that is read as the same number.
pub(super) fn number(value: f32) -> String {
    plain(format!("{value:?}"))
}

fn plain(text: String) -> String {
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

fn list(values: &[f32]) -> String {
    values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ")
}

/// One number if all channels are the same.
fn rgb(value: Rgb) -> String {
    let channels = value.to_array();
    if channels == [channels[0]; 3] { number(channels[0]) } else { list(&channels) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::math::DVec3;

    #[test]
    fn elements_are_indented_and_escaped() {
        let mut xml = Xml::default();
        xml.open("scene", &[("version", "3.0.0")]);
        xml.plugin("shape", "obj", "");
        xml.string("filename", "a<b&\"c\".obj");
        xml.close();
        let text = xml.finish();
        let expected = "<scene version=\"3.0.0\">\n    <shape type=\"obj\">\n        <string name=\"filename\" \
                        value=\"a&lt;b&amp;&quot;c&quot;.obj\"/>\n    </shape>\n</scene>\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn numbers_are_short_and_come_back() {
        for (value, text) in [(1.0, "1"), (0.1, "0.1"), (-2.5e-30, "-2.5e-30"), (1e20, "1e20"), (0.0, "0")] {
            assert_eq!(number(value), text);
            assert_eq!(text.parse::<f64>().unwrap() as f32, value);
        }
        assert_eq!(rgb(Rgb::splat(0.5)), "0.5");
        assert_eq!(rgb(Rgb::new(1.0, 0.25, 0.0)), "1, 0.25, 0");
    }

    #[test]
    fn maps_that_change_nothing_are_left_out() {
        let mut xml = Xml::default();
        xml.transform("to_world", &Transform::IDENTITY);
        assert_eq!(xml.text, "");
        xml.transform("to_world", &Transform::translate(DVec3::new(1.0, 0.1, 3.0)));
        assert!(xml.text.contains("value=\"1 0 0 1 0 1 0 0.1 0 0 1 3 0 0 0 1\""), "{}", xml.text);
    }
}
