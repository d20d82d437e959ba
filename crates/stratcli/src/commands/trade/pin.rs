//! Keeping a thread on one core while its time is measured.

/// The calling thread stays on one core until this is dropped.
pub struct Pinned {
    /// The core's number, where the system lets a thread be pinned.
    pub core: Option<usize>,
    #[cfg(target_os = "linux")]
    before: Option<rustix::thread::CpuSet>,
}

/// Pins the calling thread to the core that it is on. Where that is refused it stays free, and
/// `core` says so.
#[cfg(target_os = "linux")]
pub fn to_one_core() -> Pinned {
    use rustix::thread::{CpuSet, sched_getaffinity, sched_getcpu, sched_setaffinity};
    let core = sched_getcpu();
    let mut alone = CpuSet::new();
    let pinned = sched_getaffinity(None).ok().filter(|_| {
        core < CpuSet::MAX_CPU && {
            alone.set(core);
            sched_setaffinity(None, &alone).is_ok()
        }
    });
    Pinned { core: pinned.map(|_| core), before: pinned }
}

/// Other systems pin no thread from safe code.
#[cfg(not(target_os = "linux"))]
pub fn to_one_core() -> Pinned {
    Pinned { core: None }
}

#[cfg(target_os = "linux")]
impl Drop for Pinned {
    fn drop(&mut self) {
        if let Some(before) = &self.before {
            // Nothing is lost where it fails: the thread does what is left on one core.
            let _ = rustix::thread::sched_setaffinity(None, before);
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use rustix::thread::{sched_getaffinity, sched_getcpu};

    #[test]
    fn a_thread_is_on_its_core_alone_and_free_again_afterwards() {
        let before = sched_getaffinity(None).unwrap();
        let pinned = to_one_core();
        // A system may refuse; the thread is then as free as it was.
        if let Some(core) = pinned.core {
            let during = sched_getaffinity(None).unwrap();
            assert_eq!(during.count(), 1);
            assert!(during.is_set(core) && sched_getcpu() == core);
        }
        drop(pinned);
        assert!(sched_getaffinity(None).unwrap() == before);
    }
}
