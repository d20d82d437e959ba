//! Results that are made once.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A function's results, kept for the life of the process: what is made is a pure function of
/// its key, so that keeping it changes nothing but time.
pub(super) struct Memo<K, T> {
    made: Mutex<BTreeMap<K, Slot<T>>>,
}

/// Filled by the first who asks; others wait for it.
type Slot<T> = Arc<OnceLock<Arc<[T]>>>;

impl<K: Ord, T> Memo<K, T> {
    pub(super) const fn new() -> Self {
        Self { made: Mutex::new(BTreeMap::new()) }
    }

    /// The result of `make` for this key. Other keys do not wait for it.
    pub(super) fn get(&self, key: K, make: impl FnOnce() -> Vec<T>) -> Arc<[T]> {
        let slot = {
            let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(made.entry(key).or_default())
        };
        Arc::clone(slot.get_or_init(|| make().into()))
    }
}
