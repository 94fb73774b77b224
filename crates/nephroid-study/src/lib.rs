//! The study: every experiment of the report *Photon Mapping* (S. Izquierdo and J. Guerrero Viu, 2019), run anew, with what
//! was right in it and what was not, as one web page.
//!
//! A study is a list of [`Section`]s. [`run`] runs each that is not kept from before, keeps it in the folder, and writes
//! the page. The library prints nothing and reads no command line: who calls it says how a `nephroid render …` becomes a
//! scene with settings ([`Command`]), and watches ([`Watch`]). So a command under a picture is what made it.
//!
//! # How to add a section
//!
//! 1. Write `sections/NAME.rs` with a `pub const SECTION: Section` and a `fn run(lab: &Lab) -> Result<Body, Stop>`, and name
//!    it in `sections/mod.rs`, in the order of the report. `sections/photon_count.rs` is a pattern for renders with curves,
//!    `sections/light_sampling.rs` for one that builds its scene in code and tests.
//! 2. Its `id` is `fig-2-6` or `question-1-3`, its `report` the report's own words for it, `Fig 2.6`: one heading a figure.
//!    Its [`Weight`] says how many seconds it takes on two cores, whole and quick; all of it takes 40 minutes or 2.
//! 3. Render by [`Lab::recipe`], which names a built-in scene and gives it the size of this study: `lab.recipe("report-2-6")
//!    .set("photons", 1000)`, then [`Lab::render`]. What no flag can say is a [`World`](nephroid::world::World) made in code
//!    and [`Lab::render_world`]; such a picture has no command, and its caption says so.
//! 4. Put parts into a [`Body`] in the order of the page: [`Body::say`] first, two or three plain sentences of what one sees
//!    and where the report was wrong; then [`Body::picture`], [`Body::strip`], [`Body::pair`] (a slider), [`Body::plot`],
//!    [`Body::table`], [`Body::numbers`].
//! 5. Each [`Number`] has a unit, a band and the reason for that band, as much for the quick study as for the whole one. A
//!    band is a claim: it follows from a formula, from statistics at a stated rate, or from what the report says. A number
//!    that cannot fail says nothing. Times have no band: [`Number::measured`].
//! 6. For each figure or question it answers, [`Body::finding`] gives a row of the table: what agrees, what differs, why.
//! 7. Nothing is copied in from elsewhere: references are rendered in the run, and state their error ([`Render::error`]).
//! 8. Wrong forms go to `wrong.rs`, nowhere else. Randomness comes from [`Lab::sampler`] and from `--seed`, transcendental
//!    functions from `libm`.
//! 9. Pictures are 8-bit PNG within the page, so keep them small: [`Lab::side`] is the usual side, strips of many pictures
//!    take half of it. The page must stay under 20 MB.
//! 10. Alt texts say what is in a picture to someone who does not see it; captions say what it shows about the experiment.

mod body;
mod chart;
mod compare;
mod format;
mod keep;
mod lab;
mod page;
mod picture;
mod recipe;
mod scenes;
mod section;
mod sections;
mod statistics;
mod study;
mod tracer;
mod wrong;

pub use body::{Body, Finding, Number, Part, Table};
pub use chart::{Chart, Plot};
pub use lab::{Lab, Render, Watch};
pub use picture::{Look, Picture};
pub use recipe::{Command, Recipe, Task};
pub use section::{Section, Stop, Weight};
pub use sections::SECTIONS;
pub use study::{Settings, Study, Trouble, run, select};
