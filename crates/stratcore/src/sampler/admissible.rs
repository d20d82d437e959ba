//! Which numbers of points a sampler has.

use super::jittered::root_floor;
use std::fmt;

/// Which N a sampler has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Admissible {
    /// Every N from 1 to this.
    UpTo(u64),
    /// The cells of a grid: k^d, and any N where unequal strata are allowed.
    Cells,
    /// Another rule, in words. The sampler says which N it means in
    /// [`Sampler::admits`](super::Sampler::admits) and
    /// [`Sampler::neighbours`](super::Sampler::neighbours).
    Rule(&'static str),
}

impl Admissible {
    pub(super) fn admits(self, n: u64, dim: usize, rectangular: bool) -> bool {
        match self {
            Self::UpTo(most) => (1..=most).contains(&n),
            Self::Cells => n >= 1 && (rectangular || cells(root_floor(n, dim), dim) == Some(n)),
            Self::Rule(_) => false,
        }
    }

    pub(super) fn neighbours(self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        match self {
            Self::UpTo(_) if n == 0 => (None, Some(1)),
            Self::UpTo(most) => (Some(most), None),
            Self::Cells => {
                let k = root_floor(n, dim);
                let above = k.checked_add(1).and_then(|k| cells(k, dim));
                (cells(k, dim).filter(|below| *below >= 1), above)
            }
            Self::Rule(_) => (None, None),
        }
    }
}

/// k^d.
fn cells(k: u64, dim: usize) -> Option<u64> {
    match u32::try_from(dim) {
        Ok(dim) => k.checked_pow(dim),
        Err(_) => (k <= 1).then_some(k),
    }
}

impl fmt::Display for Admissible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UpTo(most) if most.is_power_of_two() => write!(f, "1 to 2^{}", most.ilog2()),
            // Counts stay below 2^44.
            Self::UpTo(most) if most.checked_add(1).is_some_and(u64::is_power_of_two) => {
                write!(f, "1 to 2^{} - 1", (most + 1).ilog2())
            }
            Self::UpTo(most) => write!(f, "1 to {most}"),
            Self::Cells => f.write_str("k^d; any with --n-policy rect"),
            Self::Rule(words) => f.write_str(words),
        }
    }
}
