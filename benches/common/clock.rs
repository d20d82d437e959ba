//! Time that does not depend on what else the machine does.

use std::time::{Duration, Instant};

/// What a thread costs: its own processor time where the system tells it (Linux, in steps of some
/// milliseconds), the wall's elsewhere and for work on several threads.
pub struct Clock {
    wall: Instant,
    processor: Option<Duration>,
}

impl Clock {
    /// Starts now; `own` for work that this thread does alone.
    pub fn start(own: bool) -> Self {
        let processor = if own { Self::processor() } else { None };
        Self { wall: Instant::now(), processor }
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Duration {
        match (self.processor, Self::processor()) {
            (Some(start), Some(now)) => now - start,
            _ => self.wall.elapsed(),
        }
    }

    fn processor() -> Option<Duration> {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        text.split(' ').next()?.parse().ok().map(Duration::from_nanos)
    }
}
