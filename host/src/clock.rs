//! The clock: moments, and the time since.

use std::ops::Add;
use std::time::{Duration, Instant};

/// A moment on a clock that never goes back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment(Instant);

impl Moment {
    /// Returns this moment.
    pub fn now() -> Self {
        Self(Instant::now())
    }

    /// Returns the time that has passed since.
    pub fn elapsed(self) -> Duration {
        self.0.elapsed()
    }

    /// Returns the time until then; nothing if it has passed.
    pub fn remaining_time(self) -> Duration {
        self.0.saturating_duration_since(Instant::now())
    }

    /// Returns whether it has come.
    pub fn has_come(self) -> bool {
        self.remaining_time().is_zero()
    }
}

impl Add<Duration> for Moment {
    type Output = Self;

    fn add(self, later: Duration) -> Self {
        Self(self.0 + later)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moment_comes_and_passes() {
        let now = Moment::now();
        let later = now + Duration::from_secs(600);
        assert!(now.has_come() && !later.has_come() && now < later);
        assert!(now.remaining_time().is_zero() && later.remaining_time() > Duration::from_secs(500));
        assert!(now.elapsed() < Duration::from_secs(500));
    }
}
