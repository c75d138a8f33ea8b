//! What is drawn to: windows, pixmaps, off-screen buffers.
//!
//! A drawable has buffers of its own: two contexts can draw into one window by turns, and one context into two
//! windows. The record of a drawable is in the register, or with the context that draws to it.

use crate::config::FbConfig;
use crate::image::Image;
use crate::server::{Connection, Geometry, Server, server};
use senca_gl::{Context, WindowBuffers, gl};
use senca_gl_abi::current::{self, Current, Window};
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use x11_dl::xlib::GC;

/// A connection and a number of X.
pub(crate) type Key = (Connection, u64);

/// A drawable that there is no context for at the moment, or the one of a context.
pub(crate) struct Drawable {
    pub(crate) key: Key,
    pub(crate) config: FbConfig,
    kind: Kind,
    size: [u32; 2],
    depth: u32,
    /// Whether the program has destroyed it while a context drew to it.
    doomed: bool,
    buffers: Option<WindowBuffers>,
    output: Option<(GcPointer, Option<Image>)>,
}

/// What a drawable is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Window,
    /// A pixmap, whose buffers are not swapped.
    Pixmap,
    /// Memory of a size, which the server knows nothing of.
    OffScreen([u32; 2]),
}

/// A graphics context of X.
#[derive(Clone, Copy)]
struct GcPointer(GC);

// SAFETY: used by whoever has the drawable, one at a time.
unsafe impl Send for GcPointer {}

static DRAWABLES: Mutex<BTreeMap<Key, Drawable>> = Mutex::new(BTreeMap::new());

fn register() -> MutexGuard<'static, BTreeMap<Key, Drawable>> {
    DRAWABLES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Notes a drawable that a program makes.
pub(crate) fn create(key: Key, config: FbConfig, kind: Kind) {
    let mut drawable = Drawable { kind, depth: config.visual.depth, ..Drawable::new(key, config) };
    drawable.size = drawable.off_screen_size().unwrap_or_default();
    register().insert(key, drawable);
}

/// Forgets a drawable; what it was if it was known and no context has it.
pub(crate) fn destroy(x: &Server, key: Key) -> Option<Drawable> {
    let mut drawable = register().remove(&key)?;
    drawable.free_output(x);
    Some(drawable)
}

/// Asks about a drawable that is in the register or with the thread's context.
pub(crate) fn with<R>(key: Key, ask: impl FnOnce(&mut Drawable, Option<&mut Context>) -> R) -> Option<R> {
    let (mut ask, mut answer) = (Some(ask), None);
    current::with(|c| {
        if let Some((window, gl)) = c.window_and_gl::<GlxWindow>()
            && let Some(drawable) = window.drawable.as_mut().filter(|d| d.key == key)
        {
            answer = ask.take().map(|ask| ask(drawable, Some(gl)));
        }
    });
    let Some(ask) = ask else { return answer };
    register().get_mut(&key).map(|drawable| ask(drawable, None))
}

/// Where the picture of a context goes.
pub(crate) struct GlxWindow {
    pub(crate) config: FbConfig,
    pub(crate) drawable: Option<Drawable>,
}

impl Window for GlxWindow {
    fn present(&mut self, context: &mut Context) {
        context.finish_window();
        if let Some(drawable) = &mut self.drawable
            && (!self.config.double_buffered || draws_to_front(context))
        {
            drawable.show(context.window_pixels(), context.window_size());
        }
    }

    fn look(&mut self, context: &mut Context) {
        if let Some(drawable) = &mut self.drawable {
            drawable.look();
            drawable.fit(context);
        }
    }
}

/// Whether commands draw to the front buffer of the window.
fn draws_to_front(context: &mut Context) -> bool {
    let buffers = [gl::FRONT, gl::FRONT_LEFT, gl::FRONT_AND_BACK, gl::LEFT];
    context.get_integer(gl::DRAW_BUFFER).first().is_some_and(|now| buffers.contains(&(*now as u32)))
}

impl GlxWindow {
    /// Gives a context a drawable; `false` when there is no such one, or no memory.
    pub(crate) fn attach(&mut self, context: &mut Context, key: Key) -> bool {
        let known = register().remove(&key);
        let mut drawable = known.unwrap_or(Drawable::new(key, self.config));
        if drawable.config.gl() != self.config.gl() {
            drawable.buffers = None;
        }
        drawable.config = self.config;
        let there = drawable.look();
        if let Some(buffers) = drawable.buffers.take() {
            context.put_window(buffers);
        }
        let fits = there && drawable.fit(context);
        self.drawable = Some(drawable);
        if !fits {
            self.detach(context);
        }
        fits
    }

    /// Takes the drawable from a context, and what was drawn with it.
    pub(crate) fn detach(&mut self, context: &mut Context) -> Option<Key> {
        let mut drawable = self.drawable.take()?;
        let key = drawable.key;
        drawable.buffers = Some(context.take_window()).filter(|b| b.size() != [0; 2]);
        // A drawable that is gone is not kept.
        let gone = drawable.doomed || drawable.size == [0; 2];
        if !gone {
            register().insert(key, drawable);
        } else if let Some(x) = server() {
            drawable.free_output(x);
        }
        Some(key)
    }
}

/// Takes the drawable from the thread's context.
pub(crate) fn detach_current() -> Option<Key> {
    let mut key = None;
    current::with(|c: &mut Current| {
        c.present();
        if let Some((window, gl)) = c.window_and_gl::<GlxWindow>() {
            key = window.detach(gl);
        }
    });
    key
}

/// Brings the drawable of the thread's context up to date, and the context to its size; `false` when it is gone.
pub(crate) fn look_at_current() -> bool {
    let mut there = false;
    current::with(|c: &mut Current| {
        c.present();
        if let Some((window, gl)) = c.window_and_gl::<GlxWindow>() {
            window.look(gl);
            there = window.drawable.as_ref().is_some_and(|d| d.size != [0; 2]);
        }
    });
    there
}

/// Gives the thread's context its drawable back.
pub(crate) fn attach_current(key: Key) {
    current::with(|c: &mut Current| {
        if let Some((window, gl)) = c.window_and_gl::<GlxWindow>() {
            window.attach(gl, key);
        }
    });
}

/// Forgets windows that are not there any more.
pub(crate) fn sweep(x: &Server, connection: Connection) {
    let known: Vec<Key> =
        register().values().filter(|d| d.off_screen_size().is_none()).map(|d| d.key).collect();
    for key in known.into_iter().filter(|key| key.0 == connection) {
        if connection.geometry(x, key.1).is_none() {
            destroy(x, key);
        }
    }
}

impl Drawable {
    /// A window or pixmap of which nothing is known yet.
    fn new(key: Key, config: FbConfig) -> Self {
        let (buffers, output) = (None, None);
        Self { key, config, kind: Kind::Window, size: [0; 2], depth: 0, doomed: false, buffers, output }
    }

    /// The size of memory that the server knows nothing of.
    pub(crate) fn off_screen_size(&self) -> Option<[u32; 2]> {
        match self.kind {
            Kind::OffScreen(size) => Some(size),
            Kind::Window | Kind::Pixmap => None,
        }
    }

    /// Forgets it as soon as its context gets another one.
    pub(crate) fn doom(&mut self) {
        self.doomed = true;
    }

    /// Finds out the size; `false` when the server knows no such drawable any more.
    fn look(&mut self) -> bool {
        if self.off_screen_size().is_some() {
            return true;
        }
        let geometry = server().and_then(|x| self.key.0.geometry(x, self.key.1));
        self.take_over(geometry);
        geometry.is_some()
    }

    fn take_over(&mut self, geometry: Option<Geometry>) {
        match geometry {
            Some(Geometry { width, height, depth }) => (self.size, self.depth) = ([width, height], depth),
            None => self.size = [0; 2],
        }
    }

    /// Gives the context's window the drawable's size; `false` when there is no memory.
    fn fit(&self, context: &mut Context) -> bool {
        let limit = senca_gl::max_window_side();
        let [width, height] = self.size.map(|side| side.clamp(1, limit));
        context.window_size() == [width, height] || context.resize(width, height)
    }

    /// Shows the back buffer, with the context that draws to it if there is one.
    pub(crate) fn swap(&mut self, context: Option<&mut Context>) {
        if !self.config.double_buffered || self.kind == Kind::Pixmap {
            return;
        }
        if let Some(context) = context {
            context.swap_buffers();
            self.show(context.window_pixels(), context.window_size());
            self.fit(context);
        } else if let Some(mut buffers) = self.buffers.take() {
            buffers.swap();
            self.show(buffers.pixels(), buffers.size());
            self.buffers = Some(buffers);
        }
    }

    /// Brings colours, the lowest row first, to the window, and finds out its size.
    fn show(&mut self, colors: &[[u8; 4]], size: [u32; 2]) {
        let Some(x) = server() else { return };
        if self.off_screen_size().is_some() || self.size == [0; 2] || size == [0; 2] {
            return;
        }
        let (connection, id) = self.key;
        self.prepare(x, size);
        let Some((gc, Some(image))) = &mut self.output else { return };
        image.fill(colors);
        let requests = || {
            image.put(x, connection, id, gc.0);
            connection.geometry_in_trap(x, id)
        };
        let geometry = connection.trapped(x, requests).flatten();
        self.take_over(geometry);
    }

    /// Makes ready what pictures of a size are shown with.
    fn prepare(&mut self, x: &Server, size: [u32; 2]) {
        let (connection, id) = self.key;
        let (gc, image) = self.output.take().unwrap_or_else(|| {
            // SAFETY: a connection of the program's; no values are given.
            let gc = connection.trapped(x, || unsafe {
                (x.xlib.XCreateGC)(connection.display(), id, 0, std::ptr::null_mut())
            });
            (GcPointer(gc.unwrap_or(std::ptr::null_mut())), None)
        });
        if gc.0.is_null() {
            return;
        }
        let image = match image {
            Some(image) if image.is(size) => Some(image),
            other => {
                if let Some(old) = other {
                    old.detach(x, connection);
                }
                Image::new(x, connection, &self.config.visual, self.depth, size)
            }
        };
        self.output = Some((gc, image));
    }

    fn free_output(&mut self, x: &Server) {
        let connection = self.key.0;
        if let Some((gc, image)) = self.output.take() {
            if let Some(image) = image {
                image.detach(x, connection);
            }
            // SAFETY: a connection of the program's, and what was made with it.
            connection.trapped(x, || unsafe { (x.xlib.XFreeGC)(connection.display(), gc.0) });
        }
    }
}
