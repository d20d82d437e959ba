//! Time that does not depend on what else the machine does.

use std::time::{Duration, Instant};

/// What threads cost: their processor time over their number where the system tells it (Linux, in
/// steps of some milliseconds), the wall's elsewhere. Looking for work counts as work, so this is
/// the time of threads that have a core each.
pub struct Clock {
    own: bool,
    wall: Instant,
    processor: Option<Duration>,
}

impl Clock {
    /// Starts now; `own` for work that this thread does alone, else for its pool.
    pub fn start(own: bool) -> Self {
        Self { own, wall: Instant::now(), processor: Self::processor(own) }
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Duration {
        match (self.processor, Self::processor(self.own)) {
            (Some(start), Some(now)) => now - start,
            _ => self.wall.elapsed(),
        }
    }

    fn processor(own: bool) -> Option<Duration> {
        let of_thread = || {
            let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
            text.split(' ').next()?.parse().ok().map(Duration::from_nanos)
        };
        if own {
            return of_thread();
        }
        let times = rayon::broadcast(|_| of_thread());
        let n = times.len() as u32;
        times.into_iter().sum::<Option<Duration>>().map(|total| total / n)
    }
}
