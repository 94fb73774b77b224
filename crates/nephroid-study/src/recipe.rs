use std::fmt::Display;

use nephroid::scene::Scene;
use nephroid::session::RenderSettings;

/// The arguments of a `nephroid render`: what the page shows and what is rendered are one.
#[derive(Clone, Debug, PartialEq)]
pub struct Recipe {
    words: Vec<String>,
}

impl Recipe {
    /// A scene as it is.
    pub fn of_scene(name: &str) -> Self {
        Self { words: vec![name.to_owned()] }
    }

    /// Sets a parameter of the scene, as `-D name=value`. The last of one name counts; it stands where the first stood.
    #[must_use]
    pub fn set(mut self, name: &str, value: impl Display) -> Self {
        let word = format!("{name}={value}");
        let prefix = format!("{name}=");
        let place = self.words.windows(2).position(|pair| pair[0] == "-D" && pair[1].starts_with(&prefix));
        match place {
            Some(i) => self.words[i + 1] = word,
            None => self.words.extend(["-D".to_owned(), word]),
        }
        self
    }

    /// Adds a flag with its value.
    #[must_use]
    pub fn flag(mut self, name: &str, value: impl Display) -> Self {
        self.words.extend([name.to_owned(), value.to_string()]);
        self
    }

    /// A square picture of so many pixels a side.
    #[must_use]
    pub fn side(self, pixels: u32) -> Self {
        self.set("width", pixels).set("height", pixels)
    }

    /// So many camera samples of each pixel.
    #[must_use]
    pub fn samples(self, count: u32) -> Self {
        self.set("spp", count)
    }

    /// Behind `nephroid render`.
    pub fn words(&self) -> &[String] {
        &self.words
    }

    /// For the page. No scene, parameter or flag of the study needs quoting, but for spaces.
    pub fn command(&self) -> String {
        let quoted = |word: &String| if word.contains(' ') { format!("'{word}'") } else { word.clone() };
        let words: Vec<String> = self.words.iter().map(quoted).collect();
        format!("nephroid render {}", words.join(" "))
    }
}

/// What a [`Recipe`] asks for.
#[derive(Debug)]
pub struct Task {
    /// What is to be seen.
    pub scene: Scene,
    /// How.
    pub settings: RenderSettings,
    /// Camera samples of each pixel after which to stop.
    pub samples: Option<u64>,
    /// Iterations after which to stop.
    pub passes: Option<u64>,
}

/// Reads command lines as the command itself does.
pub trait Command: Sync {
    /// What `nephroid render` with these arguments renders, or why it cannot.
    fn read(&self, arguments: &[String]) -> Result<Task, String>;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_value_of_a_parameter_counts_and_is_told_once() {
        let recipe = Recipe::of_scene("room").set("spp", 8).flag("--seed", 3).samples(2).set("a", "b c");
        assert_eq!(recipe.command(), "nephroid render room -D spp=2 --seed 3 -D 'a=b c'");
        assert_eq!(recipe.words().len(), 7);
    }
}
