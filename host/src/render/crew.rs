//! Who runs a render's jobs: threads of our own, that end with the render, or the caller's.

use super::RenderError;
use crate::memory::{STACK, room_for_threads};
use rayon::prelude::*;
use std::error::Error;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::available_parallelism;

/// The caller's way to run jobs: `run(jobs, job)` calls `job(i)` for every i < `jobs`, in any order and on as many
/// threads as it likes, and returns when all are done.
pub type Run<'a> = dyn Fn(u32, &(dyn Fn(u32) + Sync)) + Sync + 'a;

/// Who runs the jobs. The image is the same, whoever does.
#[derive(Clone, Copy)]
pub enum Crew<'a> {
    /// So many threads of our own; 0 for one per core.
    Own(usize),
    /// The caller's.
    Callers(&'a Run<'a>),
}

impl Crew<'_> {
    /// Calls `work` with something that runs jobs, and ends all threads that it started.
    pub(super) fn employ<R: Send>(
        self,
        work: impl FnOnce(&Run<'_>) -> Result<R, RenderError> + Send,
    ) -> Result<R, RenderError> {
        match self {
            Self::Callers(run) => work(run),
            Self::Own(threads) => on_threads(threads, || {
                work(&|jobs, job| {
                    let jobs = (0..jobs).into_par_iter().with_max_len(1);
                    jobs.for_each(job);
                })
            })
            .map_err(|source| RenderError::Threads {
                threads: counted(threads),
                source,
            })?,
        }
    }
}

/// How many threads are meant: 0 is one per core.
fn counted(threads: usize) -> usize {
    match threads {
        0 => available_parallelism().map_or(1, NonZero::get),
        n => n,
    }
}

/// Does `work`, whose parallel parts run on so many threads of its own (0: one per core), and ends them. The global pool is never started.
///
/// # Errors
/// If the operating system gives no threads, or no memory for them.
pub fn on_threads<R: Send>(
    threads: usize,
    work: impl FnOnce() -> R + Send,
) -> Result<R, Box<dyn Error + Send + Sync>> {
    let threads = counted(threads);
    room_for_threads(threads)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK);
    Ok(pool.build_scoped(|thread| thread.run(), |pool| pool.install(work))?)
}

/// Runs `jobs` jobs, each once, whatever `run` does.
///
/// # Errors
/// If `run` left one out.
pub(super) fn each_once(
    run: &Run<'_>,
    jobs: usize,
    job: &(dyn Fn(usize) + Sync),
) -> Result<(), RenderError> {
    let taken: Vec<AtomicBool> = (0..jobs).map(|_| AtomicBool::new(false)).collect();
    let finished = AtomicU32::new(0);
    run(jobs as u32, &|index| {
        let mine = taken.get(index as usize);
        if mine.is_some_and(|taken| !taken.swap(true, Ordering::Relaxed)) {
            job(index as usize);
            finished.fetch_add(1, Ordering::Release);
        }
    });
    if finished.load(Ordering::Acquire) as usize == jobs {
        Ok(())
    } else {
        Err(RenderError::Jobs)
    }
}

#[cfg(test)]
mod tests {
    use super::{Crew, each_once};
    use crate::render::RenderError;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn count(crew: Crew<'_>) -> (usize, Result<(), RenderError>) {
        let calls = AtomicUsize::new(0);
        let done = crew.employ(|run| {
            each_once(run, 10, &|i| {
                assert!(i < 10);
                calls.fetch_add(1, Ordering::Relaxed);
            })
        });
        (calls.into_inner(), done)
    }

    #[test]
    fn every_job_runs_once_however_often_it_is_called() {
        assert!(matches!(count(Crew::Own(3)), (10, Ok(()))));
        let backwards_and_again = |jobs: u32, job: &(dyn Fn(u32) + Sync)| {
            (0..2 * jobs).rev().for_each(job);
            (0..jobs).for_each(job);
        };
        assert!(matches!(
            count(Crew::Callers(&backwards_and_again)),
            (10, Ok(()))
        ));
        let lazy = |jobs: u32, job: &(dyn Fn(u32) + Sync)| (1..jobs).for_each(job);
        assert!(matches!(
            count(Crew::Callers(&lazy)),
            (9, Err(RenderError::Jobs))
        ));
    }
}
