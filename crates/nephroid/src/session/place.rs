/// How far a render is: so many iterations are complete, and of the next one every pixel has so many samples. A full
/// number of samples stands for the end of that iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// The iteration, from 0.
    pub iteration: u64,
    /// Samples of each pixel in it.
    pub samples: u32,
}

impl Place {
    /// The place before the sample of that number, when the samples of each pixel are numbered through all iterations.
    pub fn before_sample(number: u64, samples_per_iteration: u32) -> Self {
        let per_iteration = u64::from(samples_per_iteration.max(1));
        Self { iteration: number / per_iteration, samples: (number % per_iteration) as u32 }
    }

    /// Samples of each pixel before it, in all iterations.
    pub fn samples_before(self, samples_per_iteration: u32) -> u64 {
        self.iteration * u64::from(samples_per_iteration) + u64::from(self.samples)
    }
}
