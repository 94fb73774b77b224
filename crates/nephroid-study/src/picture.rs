use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nephroid::film::ToneMap;
use nephroid::texture::Image;
use nephroid_formats::image::encode_png;
use serde::{Deserialize, Serialize};

use crate::lab::Render;
use crate::section::Stop;

/// How radiance is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    name: String,
    operator: ToneMap,
    stops: f32,
}

impl Look {
    /// A tone map by its name on the command line, as `reinhard:0.18,1.5`.
    pub fn named(name: &str) -> Result<Self, Stop> {
        let operator = ToneMap::parse(name).map_err(Stop::because)?;
        Ok(Self { name: name.to_owned(), operator, stops: 0.0 })
    }

    /// The display's curve at a fixed exposure: pictures that are shown alike can be compared.
    pub fn exposed(stops: f32) -> Self {
        Self { name: "srgb".to_owned(), operator: ToneMap::Srgb, stops }
    }

    /// Values in [0, 1] that are a display's already.
    pub fn drawn() -> Self {
        Self { name: "linear".to_owned(), operator: ToneMap::Linear, stops: 0.0 }
    }

    /// The values of a display.
    pub fn apply(&self, image: &Image) -> Image {
        self.operator.apply(image, self.stops)
    }

    fn flags(&self) -> String {
        let exposure = if self.stops == 0.0 { String::new() } else { format!(" --exposure {}", self.stops) };
        let tonemap = if self.name == "srgb" { String::new() } else { format!(" --tonemap {}", self.name) };
        format!("{tonemap}{exposure}")
    }
}

/// A picture on the page.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Picture {
    /// What is in it, for who does not see it.
    pub alt: String,
    /// What it shows.
    pub caption: String,
    /// What makes it.
    pub command: Option<String>,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The name of its file in the folder of the sections, once it is kept.
    pub file: String,
    #[serde(skip)]
    pub(crate) png: Vec<u8>,
}

impl Picture {
    /// A picture of radiances or of values that are to be drawn, without a command.
    pub fn new(image: &Image, look: &Look, alt: &str, caption: &str) -> Result<Self, Stop> {
        Ok(Self {
            alt: alt.to_owned(),
            caption: caption.to_owned(),
            command: None,
            width: image.width,
            height: image.height,
            file: String::new(),
            png: encode_png(&look.apply(image)).map_err(Stop::because)?,
        })
    }

    /// A render, with the command that makes it.
    pub fn of(render: &Render, look: &Look, alt: &str, caption: &str) -> Result<Self, Stop> {
        let picture = Self::new(&render.image, look, alt, caption)?;
        let command = render.recipe.as_ref().map(|recipe| format!("{}{}", recipe.command(), look.flags()));
        Ok(Self { command, ..picture })
    }

    /// For the page.
    pub fn address(&self) -> String {
        format!("data:image/png;base64,{}", STANDARD.encode(&self.png))
    }
}
