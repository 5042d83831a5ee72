//! Renders on all cores, or on the caller's threads.

use crate::arguments::{Sized32, input, optional_out, slice_mut};
use crate::boundary::guarded;
use crate::control::Control;
use etendue::capi::scene::EtdScene;
use etendue::capi::settings::EtdSettings;
use etendue::capi::status::{
    ETD_E_ARGUMENT, ETD_E_CANCELLED, ETD_E_JOBS, ETD_E_MEMORY, ETD_E_SIZE, ETD_E_THREADS,
    ETD_E_UNSUPPORTED, EtdStatus,
};
use etendue_host::render::{Budget, Crew, Progress, RenderError, Rendered, render_with};
use std::any::Any;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, TryLockError};
use std::time::Duration;

/// How much to render, on what.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdRender {
    /// sizeof(EtdRender).
    pub struct_size: u32,
    /// Threads of the library, 0: one per core. They end before the call returns. Not looked at where there is a `run`.
    pub threads: u32,
    /// Samples of each pixel; 0: `seconds` decides. With `error`, their mean is at most this (0: 65,536).
    pub samples: u64,
    /// How long, if `samples` is 0; > 0: ends with the first whole pass over the image that reaches it. With `error`, at most this long (0: any time).
    pub seconds: f64,
    /// 0, or the relative error at which to stop: the root of the squared error's mean over that of the image's square is not above it with 95 %
    /// confidence. Pixels have more samples where there is more noise. Not for `ETD_METROPOLIS` (`ETD_E_UNSUPPORTED`).
    pub error: f64,
    /// Handed to both functions.
    pub user: *mut c_void,
    /// The caller's threads, or null: calls `job(context, i)` once for each i < `jobs`, in any order and on as many threads at once as it likes, and
    /// returns when all calls have. Called several times, on the thread that called the library.
    pub run: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            jobs: u32,
            job: Option<unsafe extern "C" fn(context: *mut c_void, index: u32)>,
            context: *mut c_void,
        ),
    >,
    /// Told now and then how many samples of each pixel are done and which share of all (0 to 1), or null. Called from any of the threads, one at a time.
    /// Anything but 0 cancels: the passes that have begun end (half a second, or one pass), and the image so far is the result.
    pub progress: Option<unsafe extern "C" fn(user: *mut c_void, samples: u64, share: f64) -> i32>,
}

/// What was rendered.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EtdRendered {
    /// sizeof(EtdRendered), set by the caller.
    pub struct_size: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// 1 if there was an `error` to reach and it was reached, else 0.
    pub met: u32,
    /// Samples of each pixel; with `error`, their mean.
    pub samples: u64,
    /// How long it took.
    pub seconds: f64,
    /// Rays for which the closest hit was asked.
    pub closest_rays: u64,
    /// Segments that were asked to be free.
    pub shadow_rays: u64,
    /// Walks from a light.
    pub light_walks: u64,
    /// Contributions refused because they were NaN, infinite or negative, or too large for the film.
    pub rejected: u64,
    /// Contributions too small for the film.
    pub underflowed: u64,
    /// An estimate of the relative error, if there was an `error` to reach: infinite where too little was rendered to say. Else 0.
    pub error: f64,
}

// SAFETY: repr(C), the size first, numbers and nullable pointers only.
unsafe impl Sized32 for EtdRender {}
// SAFETY: repr(C), the size first, numbers only.
unsafe impl Sized32 for EtdRendered {}

/// What C's threads share.
struct Shared(EtdRender);

// SAFETY: it is read only, and the header says from which threads the functions in it are called with `user`.
unsafe impl Sync for Shared {}

/// A job on its way through C: what to call, and what it panicked with.
struct Errand<'a> {
    job: &'a (dyn Fn(u32) + Sync),
    panic: Mutex<Option<Box<dyn Any + Send>>>,
}

/// What the caller's `run` calls.
unsafe extern "C" fn job(context: *mut c_void, index: u32) {
    // SAFETY: the context that `Shared::run` gave, which outlives the caller's `run`.
    let errand = unsafe { &*context.cast::<Errand<'_>>() };
    let body = AssertUnwindSafe(|| {
        let _control = Control::set();
        (errand.job)(index);
    });
    if let Err(payload) = catch_unwind(body) {
        let mut panic = errand.panic.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::forget(panic.replace(payload));
    }
}

impl Shared {
    /// Has the caller's threads do the jobs.
    fn run(&self, jobs: u32, work: &(dyn Fn(u32) + Sync)) {
        let errand = Errand {
            job: work,
            panic: Mutex::new(None),
        };
        if let Some(run) = self.0.run {
            let context = (&raw const errand).cast_mut().cast();
            // SAFETY: the caller's function, called as it is documented; it returns after the last call of `job`.
            unsafe { run(self.0.user, jobs, Some(job), context) };
        }
        let panic = errand
            .panic
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        if let Some(payload) = panic {
            resume_unwind(payload);
        }
    }

    /// Whether to go on.
    fn progress(&self, samples: u64, share: f64) -> bool {
        // SAFETY: the caller's function, called as it is documented.
        let answer = self
            .0
            .progress
            .map(|f| unsafe { f(self.0.user, samples, share) });
        answer.unwrap_or(0) == 0
    }
}

fn status(e: &RenderError) -> EtdStatus {
    match e {
        RenderError::Threads { .. } => ETD_E_THREADS,
        RenderError::TooLarge { .. } => ETD_E_MEMORY,
        RenderError::Jobs => ETD_E_JOBS,
        // Not reached: nothing here asks for a GPU.
        RenderError::Gpu(_) => ETD_E_UNSUPPORTED,
        RenderError::Estimator(_) => ETD_E_UNSUPPORTED,
    }
}

/// What to spend. `seconds` isn't looked at where `samples` decides.
fn budget(how: &EtdRender) -> Result<Budget, EtdStatus> {
    let time = || Duration::try_from_secs_f64(how.seconds).map_err(|_| ETD_E_ARGUMENT);
    if how.error == 0.0 {
        return match how.samples {
            0 if how.seconds > 0.0 => Ok(Budget::Time(time()?)),
            0 => Err(ETD_E_ARGUMENT),
            n => Ok(Budget::Passes(n)),
        };
    }
    if !(how.error > 0.0 && how.error.is_finite()) {
        return Err(ETD_E_ARGUMENT);
    }
    Ok(Budget::Error {
        relative: how.error,
        passes: match how.samples {
            0 => Budget::MOST_PASSES,
            n => n,
        },
        time: (how.seconds != 0.0).then(time).transpose()?,
    })
}

/// Renders the whole image into `rgb`, linear RGB radiance, row by row from the top, `floats` = 3 · width · height of the scene's crop window
/// (`etd_scene_inspect`). `rendered` may be null. The same scene, settings and samples give the same bits on any number of threads, the library's or the caller's.
///
/// `ETD_E_CANCELLED`: `progress` said so; `rgb` and `rendered` hold the whole passes that were done. Takes 48 bytes a pixel, and as much again per thread for
/// estimators with splats. Any thread may call it, any number at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_host_render(
    scene: *const EtdScene,
    with: *const EtdSettings,
    how: *const EtdRender,
    rgb: *mut f32,
    floats: usize,
    rendered: *mut EtdRendered,
) -> EtdStatus {
    guarded(|| {
        // SAFETY: the caller's promises are those that these functions ask for.
        let (scene, settings) = unsafe { (EtdScene::get(scene)?, EtdSettings::get(with)?) };
        let shared = Shared(input(how)?);
        let how = &shared.0;
        let out = optional_out(rendered)?;
        let [width, height] = scene.size();
        if (width as usize * height as usize).checked_mul(3) != Some(floats) {
            return Err(ETD_E_SIZE);
        }
        let rgb = slice_mut(rgb, floats)?;
        let budget = budget(how)?;
        // Threads that are started below inherit the control word, where they don't begin with the default.
        let _control = Control::set();
        let stop = AtomicBool::new(false);
        let speaking = Mutex::new(());
        let watch = |p: Progress| {
            // One at a time; who comes while another speaks has nothing newer to say.
            let turn = match speaking.try_lock() {
                Ok(turn) => turn,
                Err(TryLockError::Poisoned(turn)) => turn.into_inner(),
                Err(TryLockError::WouldBlock) => return,
            };
            if !stop.load(Ordering::Relaxed) && !shared.progress(p.passes, p.done) {
                stop.store(true, Ordering::Relaxed);
            }
            drop(turn);
        };
        let run = |jobs: u32, work: &(dyn Fn(u32) + Sync)| shared.run(jobs, work);
        let crew = match how.run {
            Some(_) => Crew::Callers(&run),
            None => Crew::Own(how.threads as usize),
        };
        let image =
            render_with(scene, settings, budget, crew, &stop, &watch).map_err(|e| status(&e))?;
        rgb.copy_from_slice(image.image.as_flattened());
        if let Some(out) = out {
            *out = report(&image);
        }
        if image.interrupted {
            return Err(ETD_E_CANCELLED);
        }
        // The last word, whatever was left unsaid.
        if !stop.load(Ordering::Relaxed) {
            shared.progress(image.passes, 1.0);
        }
        Ok(())
    })
}

fn report(r: &Rendered) -> EtdRendered {
    EtdRendered {
        struct_size: size_of::<EtdRendered>() as u32,
        width: r.size[0],
        height: r.size[1],
        met: r.accuracy.is_some_and(|a| a.met).into(),
        samples: r.passes,
        seconds: r.seconds,
        closest_rays: r.counters.closest_rays,
        shadow_rays: r.counters.shadow_rays,
        light_walks: r.counters.light_walks,
        rejected: r.counters.rejected + r.refused.saturated + r.refused.invalid,
        underflowed: r.refused.underflowed,
        error: r.accuracy.map_or(0.0, |a| a.found),
    }
}

#[cfg(test)]
mod tests {
    use super::{EtdRender, Shared};
    use crate::boundary::guarded;
    use etendue::capi::status::ETD_E_PANIC;
    use std::ffi::c_void;
    use std::sync::atomic::{AtomicU32, Ordering};

    unsafe extern "C" fn one_by_one(
        _user: *mut c_void,
        jobs: u32,
        job: Option<unsafe extern "C" fn(context: *mut c_void, index: u32)>,
        context: *mut c_void,
    ) {
        for i in 0..jobs {
            // SAFETY: the context that came with it.
            job.into_iter().for_each(|job| unsafe { job(context, i) });
        }
    }

    #[test]
    fn a_panic_in_a_job_crosses_the_callers_frames_as_a_value() {
        let shared = Shared(EtdRender {
            struct_size: size_of::<EtdRender>() as u32,
            threads: 0,
            samples: 1,
            seconds: 0.0,
            error: 0.0,
            user: std::ptr::null_mut(),
            run: Some(one_by_one),
            progress: None,
        });
        let ran = AtomicU32::new(0);
        let status = guarded(|| {
            shared.run(4, &|i| {
                ran.fetch_add(1, Ordering::Relaxed);
                assert!(i != 1, "this panic is a test");
            });
            Ok(())
        });
        assert_eq!((status, ran.into_inner()), (ETD_E_PANIC, 4));
    }
}
