//! Threads.

use rayon::prelude::*;

/// Runs `work` with this many threads; `None` for one per core. Results never depend on it.
pub fn with_threads<R: Send>(threads: Option<usize>, work: impl FnOnce() -> R + Send) -> R {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    match builder.build() {
        Ok(pool) => pool.install(work),
        // The system refused new threads. Rayon's global pool would ask for them again, and
        // panic; a pool of the calling thread alone asks for none.
        Err(_) => {
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
            match alone.build() {
                Ok(pool) => pool.install(work),
                // This thread belongs to a pool already: the work runs there.
                Err(_) => work(),
            }
        }
    }
}

/// Does `work` for each item, several at a time and nearly in order, until one of them fails.
/// Items are drawn as they are needed: as many are in flight as there are threads.
///
/// # Errors
/// The first error that any `work` returned; items that were in flight are finished.
pub fn for_each<T: Send, E: Send>(
    items: impl Iterator<Item = T> + Send,
    work: impl Fn(T) -> Result<(), E> + Sync,
) -> Result<(), E> {
    items.par_bridge().try_for_each(&work)
}

/// Does `work` for each item, several at a time, and hands the results to `each` in the order of
/// the items. Results wait in memory for a few items per thread, whatever their number.
///
/// # Errors
/// The first error, by the order of the items, of `work` or `each`.
pub fn in_order<T: Send, R: Send, E: Send>(
    mut items: impl Iterator<Item = T>,
    work: impl Fn(T) -> Result<R, E> + Sync,
    mut each: impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    let batch_len = 4 * rayon::current_num_threads();
    loop {
        let batch: Vec<T> = items.by_ref().take(batch_len).collect();
        if batch.is_empty() {
            return Ok(());
        }
        let results: Vec<Result<R, E>> = batch.into_par_iter().map(&work).collect();
        for result in results {
            each(result?)?;
        }
    }
}

/// The results of `work` for each item, in their order.
///
/// # Errors
/// One of those that `work` returned.
pub fn collect<T: Send, R: Send, E: Send>(
    items: Vec<T>,
    work: impl Fn(T) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    items.into_par_iter().map(&work).collect()
}

/// Threads that work is shared among here.
pub fn thread_count() -> usize {
    rayon::current_num_threads()
}
