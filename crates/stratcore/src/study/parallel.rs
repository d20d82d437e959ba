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

/// Two things at a time.
pub fn both<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    rayon::join(one, other)
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
/// the items while the next ones are worked on. No more than `most` results (two at the least)
/// are in memory, whatever the number of items.
///
/// # Errors
/// The first error, by the order of the items, of `work` or `each`.
pub fn in_order<T: Send, R: Send, E: Send>(
    mut items: impl Iterator<Item = T>,
    most: usize,
    work: impl Fn(T) -> Result<R, E> + Sync,
    mut each: impl FnMut(R) -> Result<(), E> + Send,
) -> Result<(), E> {
    let mut done: Vec<Result<R, E>> = Vec::new();
    loop {
        let batch: Vec<T> = items.by_ref().take((most / 2).max(1)).collect();
        let is_last = batch.is_empty();
        let (handed, made) = both(
            || done.into_iter().try_for_each(|result| each(result?)),
            || batch.into_par_iter().map(&work).collect(),
        );
        handed?;
        if is_last {
            return Ok(());
        }
        done = made;
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
