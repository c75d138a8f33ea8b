//! The `glX*` functions (GLX 1.4).
//!
//! What cannot be answers NULL, `False` or an error code; no error of X is made up for it.

use crate::config::{self, FbConfig, MAX_ATTRIBUTES};
use crate::drawable::{self, GlxWindow, Kind};
use crate::font;
use crate::server::{Connection, Server, server};
use senca_gl_abi::Entry;
use senca_gl_abi::current;
use senca_gl_abi::memory::{In, Out};
use std::collections::BTreeMap;
use std::ffi::{CStr, c_void};
use std::sync::{Mutex, MutexGuard, PoisonError};
use x11_dl::glx::*;

const VENDOR_TEXT: &CStr = c"Senca";
const VERSION_TEXT: &CStr = c"1.4";
const EXTENSIONS_TEXT: &CStr =
    c"GLX_ARB_create_context GLX_ARB_create_context_profile GLX_ARB_get_proc_address \
    GLX_EXT_swap_control GLX_MESA_swap_control GLX_SGI_swap_control";

/// Attributes of drawables, and an answer, that are in no module of the crate for X.
const WIDTH: i32 = GLX_WIDTH;
const SWAP_INTERVAL: i32 = ext::GLX_SWAP_INTERVAL_EXT;
const MAX_SWAP_INTERVAL: i32 = ext::GLX_MAX_SWAP_INTERVAL_EXT;

/// Longest name of a function, and more.
const MAX_NAME: usize = 128;

/// What a context was made with, for questions while another thread has it.
struct Made {
    config: FbConfig,
    connection: Connection,
}

/// What has to be remembered between calls.
struct Memory {
    contexts: BTreeMap<usize, Made>,
    /// Which kind of buffers was last chosen for a visual, as the program will make contexts for the visual.
    chosen: BTreeMap<(Connection, u64), usize>,
    /// Frames of the display between swaps: kept, as there are none.
    swap_interval: i32,
}

static MEMORY: Mutex<Memory> =
    Mutex::new(Memory { contexts: BTreeMap::new(), chosen: BTreeMap::new(), swap_interval: 0 });

fn memory() -> MutexGuard<'static, Memory> {
    MEMORY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The server's functions and the program's connection.
fn reach(display: usize) -> Option<(&'static Server, Connection)> {
    Some((server()?, Connection::of(display)?))
}

fn configs(x: &Server, connection: Connection, screen: i32) -> Vec<FbConfig> {
    config::all(screen, &connection.visuals(x, screen))
}

/// The kind of buffers of a pointer.
fn config_of(display: usize, handle: usize) -> Option<FbConfig> {
    let (x, connection) = reach(display)?;
    let (screen, index) = FbConfig::place_of(handle)?;
    configs(x, connection, screen).get(index).copied()
}

/// The start of Xlib's description of a visual.
fn visual_of(info: In<u64>) -> Option<(u64, i32)> {
    // A pointer to the visual, its number, then a word with the screen.
    Some((info.get(1)?, In::<i32>::at(info.address()).get(4)?))
}

/// The kind of buffers that go with a visual: the one chosen last, or two buffers without accumulation.
fn config_of_visual(display: usize, info: In<u64>) -> Option<FbConfig> {
    let (x, connection) = reach(display)?;
    let (id, screen) = visual_of(info)?;
    let visuals = connection.visuals(x, screen);
    let visual = visuals.iter().find(|v| v.id == id)?;
    let all = config::all(screen, &visuals);
    let chosen = memory().chosen.get(&(connection, id)).copied();
    let alike = |c: &&FbConfig| (c.visual.depth, c.visual.masks) == (visual.depth, visual.masks);
    let default = || all.iter().filter(alike).find(|c| c.double_buffered && !c.accumulates).copied();
    let mut config = chosen.and_then(|k| all.get(k).copied()).or_else(default)?;
    config.visual = *visual;
    Some(config)
}

/// A list of pairs that ends with 0.
fn pairs(list: In<i32>) -> Vec<(i32, i32)> {
    let pair = |k: usize| {
        let name = list.get(2 * k).filter(|name| *name != 0)?;
        Some((name, list.get(2 * k + 1)?))
    };
    (0..MAX_ATTRIBUTES).map_while(pair).collect()
}

/// A list for `glXChooseVisual`, in which some names have no value.
fn short_list(list: In<i32>) -> Vec<i32> {
    let mut all = Vec::new();
    let mut value_next = false;
    while let Some(word) = list.get(all.len()).filter(|_| all.len() < 2 * MAX_ATTRIBUTES) {
        if word == 0 && !value_next {
            break;
        }
        let alone = matches!(word, GLX_USE_GL | GLX_RGBA | GLX_DOUBLEBUFFER | GLX_STEREO);
        value_next = !value_next && !alone;
        all.push(word);
    }
    all
}

/// Makes a context.
fn create_context(display: usize, config: Option<FbConfig>, share: usize) -> usize {
    let (Some(config), Some(connection)) = (config, Connection::of(display)) else { return 0 };
    let handle = current::create(config.gl(), Box::new(GlxWindow { config, drawable: None }), share);
    if handle != 0 {
        memory().contexts.insert(handle, Made { config, connection });
    }
    handle
}

/// Gives the thread a context and that a drawable.
fn make_current(display: usize, id: u64, context: usize) -> bool {
    if context == 0 && id == 0 {
        drawable::detach_current();
        current::release();
        return true;
    }
    let Some((x, connection)) = reach(display) else { return false };
    if context == 0 || id == 0 {
        return false;
    }
    let key = (connection, id);
    if current::current_handle() == context && current_key() == Some(key) {
        return drawable::look_at_current();
    }
    let is_known = drawable::with(key, |_, _| ()).is_some();
    if !is_known {
        drawable::sweep(x, connection);
    }
    let before = drawable::detach_current();
    let made = current::make_current(context, |c, is_current| {
        if is_current {
            c.present();
        }
        c.window_and_gl::<GlxWindow>().is_some_and(|(window, gl)| window.attach(gl, key))
    });
    if !made && let Some(before) = before {
        drawable::attach_current(before);
    }
    made
}

/// Drawable and connection of the thread's context.
fn current_key() -> Option<drawable::Key> {
    let mut key = None;
    current::with(|c| {
        key = c.window_and_gl::<GlxWindow>().and_then(|(w, _)| w.drawable.as_ref().map(|d| d.key));
    });
    key
}

/// Whether a version and a profile are had.
fn is_had(wanted: &[(i32, i32)]) -> bool {
    let value = |name, default| wanted.iter().rev().find(|(n, _)| *n == name).map_or(default, |(_, v)| *v);
    let version =
        (value(arb::GLX_CONTEXT_MAJOR_VERSION_ARB, 1), value(arb::GLX_CONTEXT_MINOR_VERSION_ARB, 0));
    let rgba = value(GLX_RENDER_TYPE, GLX_RGBA_TYPE) == GLX_RGBA_TYPE;
    // A profile has a meaning from version 3.2 on only.
    rgba && version.0 == 1 && (0..=5).contains(&version.1)
}

/// A list of pointers that the program frees; NULL for none.
fn list_of(configs: &[FbConfig], count: Out<i32>) -> usize {
    count.put(configs.len() as i32);
    if configs.is_empty() {
        return 0;
    }
    // SAFETY: memory for as many pointers; the program frees it by `XFree`, which is `free`.
    let list = unsafe { libc::malloc(size_of_val(configs).max(configs.len() * size_of::<usize>())) };
    let handles: Vec<usize> = configs.iter().map(FbConfig::handle).collect();
    let address = list.expose_provenance();
    Out::at(address).write(&handles);
    address
}

/// A text of the library, which stays.
fn text(name: i32) -> *const u8 {
    let text = match name {
        GLX_VENDOR => VENDOR_TEXT,
        GLX_VERSION => VERSION_TEXT,
        GLX_EXTENSIONS => EXTENSIONS_TEXT,
        _ => return std::ptr::null(),
    };
    text.as_ptr().cast()
}

/// The function of a name.
fn find(name: In<u8>) -> usize {
    let name = name.short_text::<MAX_NAME>().unwrap_or_default();
    let own = || FUNCTIONS.iter().find(|e| e.name == name);
    senca_gl_abi::find(&name).or_else(own).map_or(0, |e| e.address.expose_provenance())
}

/// Answers a question about a drawable; `None` for an unknown one.
fn drawable_value(display: usize, id: u64, name: i32) -> Option<u32> {
    let (x, connection) = reach(display)?;
    let key = (connection, id);
    let known = drawable::with(key, |d, _| (d.off_screen_size(), d.config.attribute(GLX_FBCONFIG_ID)));
    let size = || match known {
        Some((Some(size), _)) => Some(size),
        _ => connection.geometry(x, id).map(|g| [g.width, g.height]),
    };
    match name {
        WIDTH => Some(size()?[0]),
        GLX_HEIGHT => Some(size()?[1]),
        GLX_FBCONFIG_ID => Some(known?.1? as u32),
        GLX_PRESERVED_CONTENTS => Some(1),
        GLX_LARGEST_PBUFFER => Some(0),
        SWAP_INTERVAL => Some(memory().swap_interval.max(0) as u32),
        MAX_SWAP_INTERVAL => Some(i32::MAX as u32),
        _ => None,
    }
}

/// Size of an off-screen buffer from its attributes; `None` for what is not had.
fn pbuffer_size(wanted: &[(i32, i32)]) -> Option<[u32; 2]> {
    let value = |name| wanted.iter().rev().find(|(n, _)| *n == name).map_or(0, |(_, v)| *v);
    let limit = senca_gl::max_window_side();
    let largest = value(GLX_LARGEST_PBUFFER) != 0;
    let side = |name| match u32::try_from(value(name)).ok()? {
        n if n > limit && !largest => None,
        n => Some(n.clamp(1, limit)),
    };
    Some([side(GLX_PBUFFER_WIDTH)?, side(GLX_PBUFFER_HEIGHT)?])
}

/// An answer of a function, and what it is when something goes wrong.
trait Answer {
    const NONE: Self;
}

macro_rules! answers {
    ($($t:ty: $none:expr),*) => {$( impl Answer for $t { const NONE: Self = $none; } )*};
}
answers!((): (), i32: 0, u32: 0, u64: 0, usize: 0, *const u8: std::ptr::null());

/// Defines C functions of GLX.
macro_rules! functions {
    ($( $name:ident ($($arg:ident: $t:ty),* $(,)?) $(-> $r:ty)? $body:block )*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name($($arg: $t),*) $(-> $r)? {
                let body = move || $body;
                std::panic::catch_unwind(std::panic::AssertUnwindSafe(body)).unwrap_or(Answer::NONE)
            }
        )*

        /// The functions of this file by name.
        static FUNCTIONS: &[Entry] = &[$(Entry::new(stringify!($name), $name as *const c_void),)*];
    };
}

// Pointers to records of X and of GLX are numbers here; `display` is one of the program's connections.
functions! {
    glXQueryExtension(_display: usize, error_base: Out<i32>, event_base: Out<i32>) -> i32 {
        error_base.put(0);
        event_base.put(0);
        i32::from(server().is_some())
    }
    glXQueryVersion(_display: usize, major: Out<i32>, minor: Out<i32>) -> i32 {
        major.put(1);
        minor.put(4);
        1
    }
    glXGetClientString(_display: usize, name: i32) -> *const u8 { text(name) }
    glXQueryServerString(_display: usize, _screen: i32, name: i32) -> *const u8 { text(name) }
    glXQueryExtensionsString(_display: usize, _screen: i32) -> *const u8 { text(GLX_EXTENSIONS) }
    glXGetProcAddress(name: In<u8>) -> usize { find(name) }
    glXGetProcAddressARB(name: In<u8>) -> usize { find(name) }

    glXChooseVisual(display: usize, screen: i32, list: In<i32>) -> usize {
        let Some((x, connection)) = reach(display) else { return 0 };
        let wanted = config::visual_pairs(&short_list(list));
        let found = wanted.and_then(|w| config::choose(&configs(x, connection, screen), &w).first().copied());
        let Some(config) = found else { return 0 };
        memory().chosen.insert((connection, config.visual.id), config.index);
        connection.visual_info(x, config.visual.id)
    }
    glXGetConfig(display: usize, visual: In<u64>, name: i32, value: Out<i32>) -> i32 {
        if visual_of(visual).is_none() {
            return GLX_BAD_VISUAL;
        }
        let Some(config) = config_of_visual(display, visual) else {
            // A visual without colours is one that OpenGL does not draw to.
            value.put(0);
            return if name == GLX_USE_GL { 0 } else { GLX_BAD_VISUAL };
        };
        match config.attribute(name) {
            Some(found) => {
                value.put(found);
                0
            }
            None => GLX_BAD_ATTRIBUTE,
        }
    }
    glXGetFBConfigs(display: usize, screen: i32, count: Out<i32>) -> usize {
        let all = reach(display).map(|(x, connection)| configs(x, connection, screen));
        list_of(&all.unwrap_or_default(), count)
    }
    glXChooseFBConfig(display: usize, screen: i32, list: In<i32>, count: Out<i32>) -> usize {
        let all = reach(display).map(|(x, connection)| configs(x, connection, screen));
        list_of(&config::choose(&all.unwrap_or_default(), &pairs(list)), count)
    }
    glXGetFBConfigAttrib(display: usize, config: usize, name: i32, value: Out<i32>) -> i32 {
        match config_of(display, config).map(|c| c.attribute(name)) {
            Some(Some(found)) => {
                value.put(found);
                0
            }
            _ => GLX_BAD_ATTRIBUTE,
        }
    }
    glXGetVisualFromFBConfig(display: usize, config: usize) -> usize {
        let (Some((x, connection)), Some(config)) = (reach(display), config_of(display, config)) else { return 0 };
        memory().chosen.insert((connection, config.visual.id), config.index);
        connection.visual_info(x, config.visual.id)
    }

    glXCreateContext(display: usize, visual: In<u64>, share: usize, _direct: i32) -> usize {
        create_context(display, config_of_visual(display, visual), share)
    }
    glXCreateNewContext(display: usize, config: usize, kind: i32, share: usize, _direct: i32) -> usize {
        if kind != GLX_RGBA_TYPE {
            return 0;
        }
        create_context(display, config_of(display, config), share)
    }
    glXCreateContextAttribsARB(display: usize, config: usize, share: usize, _direct: i32, list: In<i32>) -> usize {
        if !is_had(&pairs(list)) {
            return 0;
        }
        create_context(display, config_of(display, config), share)
    }
    glXDestroyContext(_display: usize, context: usize) {
        memory().contexts.remove(&context);
        current::forget(context);
    }
    glXCopyContext(_display: usize, from: usize, to: usize, mask: u64) {
        let mut state = None;
        current::inspect(from, |c| state = Some(c.gl.save_state(mask as u32)));
        if let Some(state) = state {
            current::inspect(to, |c| c.gl.load_state(state));
        }
    }
    glXIsDirect(_display: usize, context: usize) -> i32 { i32::from(memory().contexts.contains_key(&context)) }
    glXQueryContext(_display: usize, context: usize, name: i32, value: Out<i32>) -> i32 {
        let memory = memory();
        let Some(made) = memory.contexts.get(&context) else { return GLX_BAD_CONTEXT };
        value.put(match name {
            GLX_RENDER_TYPE => GLX_RGBA_TYPE,
            GLX_FBCONFIG_ID | GLX_SCREEN => made.config.attribute(name).unwrap_or(0),
            _ => return GLX_BAD_ATTRIBUTE,
        });
        0
    }
    glXGetCurrentContext() -> usize { current::current_handle() }
    glXGetCurrentDrawable() -> u64 { current_key().map_or(0, |key| key.1) }
    glXGetCurrentReadDrawable() -> u64 { current_key().map_or(0, |key| key.1) }
    glXGetCurrentDisplay() -> usize {
        let context = current::current_handle();
        let made = memory().contexts.get(&context).map(|made| made.connection);
        current_key().map(|key| key.0).or(made).map_or(0, Connection::address)
    }

    glXMakeCurrent(display: usize, drawable: u64, context: usize) -> i32 {
        i32::from(make_current(display, drawable, context))
    }
    glXMakeContextCurrent(display: usize, draw: u64, read: u64, context: usize) -> i32 {
        i32::from(draw == read && make_current(display, draw, context))
    }
    glXSwapBuffers(display: usize, drawable: u64) {
        if let Some(connection) = Connection::of(display) {
            drawable::with((connection, drawable), |d, context| d.swap(context));
        }
    }
    glXWaitGL() {
        current::with(|c| {
            c.finish();
            c.present();
        });
    }
    glXWaitX() {
        if let (Some(x), Some((connection, _))) = (server(), current_key()) {
            connection.sync(x);
        }
    }
    glXUseXFont(font: u64, first: i32, count: i32, list: i32) {
        let Some((x, (connection, _))) = server().zip(current_key()) else { return };
        current::with(|c| {
            if count < 0 {
                c.raise(senca_gl::gl::INVALID_VALUE);
            } else {
                font::use_font(&mut c.gl, x, connection, font, [first, count, list]);
            }
        });
    }

    glXCreateWindow(display: usize, config: usize, window: u64, _list: In<i32>) -> u64 {
        let (Some(connection), Some(config)) = (Connection::of(display), config_of(display, config)) else {
            return 0;
        };
        drawable::create((connection, window), config, Kind::Window);
        window
    }
    glXCreatePixmap(display: usize, config: usize, pixmap: u64, _list: In<i32>) -> u64 {
        let (Some(connection), Some(config)) = (Connection::of(display), config_of(display, config)) else {
            return 0;
        };
        drawable::create((connection, pixmap), config, Kind::Pixmap);
        pixmap
    }
    glXCreateGLXPixmap(display: usize, visual: In<u64>, pixmap: u64) -> u64 {
        let config = config_of_visual(display, visual);
        let (Some(connection), Some(config)) = (Connection::of(display), config) else { return 0 };
        drawable::create((connection, pixmap), config, Kind::Pixmap);
        pixmap
    }
    glXCreatePbuffer(display: usize, config: usize, list: In<i32>) -> u64 {
        let (Some((x, connection)), Some(config)) = (reach(display), config_of(display, config)) else { return 0 };
        let Some(size) = pbuffer_size(&pairs(list)) else { return 0 };
        let number = connection.new_number(x, config.screen);
        drawable::create((connection, number), config, Kind::OffScreen(size));
        number
    }
    glXDestroyWindow(display: usize, window: u64) { destroy_drawable(display, window); }
    glXDestroyPixmap(display: usize, pixmap: u64) { destroy_drawable(display, pixmap); }
    glXDestroyGLXPixmap(display: usize, pixmap: u64) { destroy_drawable(display, pixmap); }
    glXDestroyPbuffer(display: usize, pbuffer: u64) { destroy_drawable(display, pbuffer); }
    glXQueryDrawable(display: usize, drawable: u64, name: i32, value: Out<u32>) {
        if let Some(found) = drawable_value(display, drawable, name) {
            value.put(found);
        }
    }
    glXSelectEvent(_display: usize, _drawable: u64, _mask: u64) {
        // The only events tell that an off-screen buffer was lost, which never happens.
    }
    glXGetSelectedEvent(_display: usize, _drawable: u64, mask: Out<u64>) { mask.put(0); }

    glXSwapIntervalEXT(_display: usize, _drawable: u64, interval: i32) { memory().swap_interval = interval.max(0); }
    glXSwapIntervalMESA(interval: u32) -> i32 {
        memory().swap_interval = i32::try_from(interval).unwrap_or(i32::MAX);
        0
    }
    glXGetSwapIntervalMESA() -> i32 { memory().swap_interval }
    glXSwapIntervalSGI(interval: i32) -> i32 {
        if interval <= 0 {
            return GLX_BAD_VALUE;
        }
        memory().swap_interval = interval;
        0
    }
}

fn destroy_drawable(display: usize, id: u64) {
    let Some((x, connection)) = reach(display) else { return };
    if current_key() == Some((connection, id)) {
        drawable::with((connection, id), |d, _| d.doom());
        return;
    }
    if drawable::destroy(x, (connection, id)).is_some_and(|d| d.off_screen_size().is_some()) {
        connection.free_number(x, id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_display_there_is_nothing() {
        assert_eq!(create_context(0, None, 0), 0);
        assert!(!make_current(0, 1, 16));
        assert!(make_current(0, 0, 0));
        assert_eq!((current_key(), drawable_value(0, 1, WIDTH)), (None, None));
    }

    #[test]
    fn versions_that_are_had() {
        let version = |major, minor| {
            [(arb::GLX_CONTEXT_MAJOR_VERSION_ARB, major), (arb::GLX_CONTEXT_MINOR_VERSION_ARB, minor)]
        };
        assert!(is_had(&[]) && is_had(&version(1, 5)));
        assert!(!is_had(&version(2, 0)) && !is_had(&version(1, 6)) && !is_had(&version(0, 0)));
        assert!(!is_had(&[(GLX_RENDER_TYPE, GLX_COLOR_INDEX_TYPE)]));
    }

    #[test]
    fn sizes_of_off_screen_buffers() {
        let pairs = |w, h| [(GLX_PBUFFER_WIDTH, w), (GLX_PBUFFER_HEIGHT, h)];
        assert_eq!(pbuffer_size(&pairs(20, 10)), Some([20, 10]));
        assert_eq!(pbuffer_size(&pairs(i32::MAX, 10)), None);
        assert_eq!(pbuffer_size(&pairs(-1, 10)), None);
        let [a, b] = pairs(i32::MAX, 10);
        assert_eq!(pbuffer_size(&[a, b, (GLX_LARGEST_PBUFFER, 1)]), Some([16_384, 10]));
    }

    #[test]
    fn functions_are_found_by_name() {
        let all = ["glXSwapBuffers", "glXGetProcAddressARB", "glClear", "glXChooseFBConfig"];
        for name in all {
            let name = std::ffi::CString::new(name).unwrap_or_default();
            assert_ne!(find(In::at(name.as_ptr().expose_provenance())), 0, "{name:?}");
        }
        assert_eq!(find(In::at(c"glXNothing".as_ptr().expose_provenance())), 0);
    }
}
