use crate::body::Body;
use crate::lab::Lab;

/// One experiment.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Its name on the command line and in addresses: `fig-2-6`.
    pub id: &'static str,
    /// What the report calls it: `Fig 2.6`.
    pub report: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// How long it takes.
    pub weight: Weight,
    /// Does it.
    pub run: fn(&Lab) -> Result<Body, Stop>,
}

impl Section {
    /// The heading of the page: `Fig 2.6: the number of photons`.
    pub fn heading(&self) -> String {
        format!("{}: {}", self.report, self.title)
    }
}

/// Seconds on two cores: for the time that is left, and as a budget.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    /// Of the whole study.
    pub full: f64,
    /// Of the quick one.
    pub quick: f64,
}

impl Weight {
    /// Of one of the two.
    pub fn of(self, quick: bool) -> f64 {
        if quick { self.quick } else { self.full }
    }
}

/// Why a section was not finished.
#[derive(Debug, thiserror::Error)]
pub enum Stop {
    /// Somebody wanted it to stop.
    #[error("stopped")]
    Cancelled,
    /// It cannot be done.
    #[error("{0}")]
    Failed(String),
}

impl Stop {
    /// For what says why it failed by itself.
    pub fn because(reason: impl ToString) -> Self {
        Self::Failed(reason.to_string())
    }
}
