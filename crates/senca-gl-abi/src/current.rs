//! Contexts of the program, and the one that a thread has.
//!
//! A context is in one place: with the thread where it is current, or in the register. The program holds
//! numbers of contexts only, so a context that is gone is found to be gone.

use crate::memory::ProgramMemory;
use crate::table::Answer;
use senca_gl::{Config, Context, ShareGroup, gl};
use std::any::Any;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::{Deref, DerefMut};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A context and what C's interface knows of it.
pub struct Current {
    /// Its number, which C takes for a pointer.
    pub handle: usize,
    /// The state machine.
    pub gl: Context,
    /// Where its picture goes.
    pub window: Box<dyn Window>,
    /// Where the program wants hit records, and how many words fit.
    pub(crate) select_buffer: usize,
    /// Where it wants what is fed back.
    pub(crate) feedback_buffer: usize,
    /// Function and parameter that messages go to.
    pub(crate) debug_callback: [usize; 2],
}

/// Where a context's picture goes.
pub trait Window: Any + Send {
    /// Brings the picture up to date, for `glFlush` and `glFinish`, and when the context is released.
    fn present(&mut self, gl: &mut Context);

    /// Finds out whether the window has got another size, before `glViewport`.
    fn look(&mut self, _gl: &mut Context) {}
}

impl Deref for Current {
    type Target = Context;

    fn deref(&self) -> &Context {
        &self.gl
    }
}

impl DerefMut for Current {
    fn deref_mut(&mut self) -> &mut Context {
        &mut self.gl
    }
}

impl Current {
    /// Brings the program's picture up to date.
    pub fn present(&mut self) {
        self.window.present(&mut self.gl);
    }

    /// Finds out whether the window has got another size.
    pub(crate) fn look_at_window(&mut self) {
        self.window.look(&mut self.gl);
    }

    /// The window as what it is, with the state machine; `None` if it is of another kind.
    pub fn window_and_gl<W: Window>(&mut self) -> Option<(&mut W, &mut Context)> {
        let window: &mut dyn Any = &mut *self.window;
        Some((window.downcast_mut()?, &mut self.gl))
    }
}

/// Where a context is.
enum Place {
    Idle(Box<Current>),
    /// With some thread.
    Taken,
}

struct Known {
    group: ShareGroup,
    place: Place,
}

/// All contexts, by number.
struct Register {
    last: usize,
    contexts: BTreeMap<usize, Known>,
}

static REGISTER: Mutex<Register> = Mutex::new(Register { last: 0, contexts: BTreeMap::new() });

fn register() -> MutexGuard<'static, Register> {
    REGISTER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The thread's context. It goes back to the register when the thread ends.
struct Here(Cell<Option<Box<Current>>>);

impl Drop for Here {
    fn drop(&mut self) {
        if let Some(current) = self.0.take() {
            put_back(current);
        }
    }
}

thread_local! {
    static HERE: Here = const { Here(Cell::new(None)) };
}

/// Does a command with the current context. It is away meanwhile: a callback of the program's finds none.
#[inline]
pub fn with<R: Answer>(command: impl FnOnce(&mut Current) -> R) -> R {
    let run = |here: &Here| {
        let Some(mut current) = here.0.take() else { return R::NONE };
        let result = catch_unwind(AssertUnwindSafe(|| command(&mut current)));
        if result.is_err() {
            current.gl.raise(gl::INVALID_OPERATION);
        }
        here.0.set(Some(current));
        result.unwrap_or(R::NONE)
    };
    HERE.try_with(run).unwrap_or(R::NONE)
}

/// Makes a context that shares with another; 0 when there is no such other.
#[must_use]
pub fn create(config: Config, window: Box<dyn Window>, share: usize) -> usize {
    crate::pool::join();
    let mut register = register();
    let group = match (share, register.contexts.get(&share)) {
        (0, _) => ShareGroup::default(),
        (_, Some(other)) => other.group.clone(),
        (_, None) => return 0,
    };
    let mut gl = Context::in_group(config, &group);
    gl.set_client_memory(Arc::new(ProgramMemory));
    register.last += 16;
    let handle = register.last;
    let none = [0; 2];
    let current = Current { handle, gl, window, select_buffer: 0, feedback_buffer: 0, debug_callback: none };
    let place = Place::Idle(Box::new(current));
    register.contexts.insert(handle, Known { group, place });
    handle
}

/// Forgets a context. One that is current with this thread is released; with another, when that releases it.
pub fn destroy(handle: usize) {
    if current_handle() == handle {
        release();
    }
    forget(handle);
}

/// Forgets a context as soon as no thread has it.
pub fn forget(handle: usize) {
    let known = register().contexts.remove(&handle);
    drop(known);
}

/// Looks at a context that is current with this thread or with none.
pub fn inspect(handle: usize, look: impl FnOnce(&mut Current)) {
    if handle != 0 && current_handle() == handle {
        return with(look);
    }
    let taken = take(handle);
    if let Some(mut current) = taken {
        let looked = catch_unwind(AssertUnwindSafe(|| look(&mut current)));
        put_back(current);
        drop(looked);
    }
}

/// Number of the thread's context; 0 for none.
#[must_use]
pub fn current_handle() -> usize {
    let run = |here: &Here| {
        let current = here.0.take();
        let handle = current.as_ref().map_or(0, |c| c.handle);
        here.0.set(current);
        handle
    };
    HERE.try_with(run).unwrap_or(0)
}

/// Takes the thread's context from it, its picture complete.
pub fn release() {
    with(Current::present);
    if let Ok(Some(current)) = HERE.try_with(|here| here.0.take()) {
        put_back(current);
    }
}

/// Takes a context out of the register; `None` when there is none or a thread has it.
fn take(handle: usize) -> Option<Box<Current>> {
    let mut register = register();
    let place = &mut register.contexts.get_mut(&handle)?.place;
    match std::mem::replace(place, Place::Taken) {
        Place::Idle(current) => Some(current),
        Place::Taken => None,
    }
}

/// Puts a context back into the register, unless it is destroyed.
fn put_back(current: Box<Current>) {
    let mut register = register();
    match register.contexts.get_mut(&current.handle) {
        Some(known) => known.place = Place::Idle(current),
        None => {
            drop(register);
            drop(current);
        }
    }
}

/// Gives the thread a context, with its window made ready by `prepare`, which is told whether the thread has the
/// context already; `false` when there is no such context, another thread has it, or `prepare` says so. Then everything
/// is as before.
#[must_use]
pub fn make_current(handle: usize, prepare: impl FnOnce(&mut Current, bool) -> bool) -> bool {
    if handle != 0 && current_handle() == handle {
        let mut done = false;
        with(|c| done = prepare(c, true));
        return done;
    }
    let Some(mut next) = take(handle) else { return false };
    let ready = catch_unwind(AssertUnwindSafe(|| prepare(&mut next, false))).unwrap_or(false);
    if !ready {
        put_back(next);
        return false;
    }
    release();
    let mut next = Some(next);
    let set = HERE.try_with(|here| here.0.set(next.take())).is_ok();
    if let Some(next) = next {
        put_back(next);
    }
    set
}
