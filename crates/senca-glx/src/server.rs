//! Xlib, which the program has loaded before it calls anything here.

use std::ffi::{c_int, c_uint, c_ulong};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use x11_dl::xlib::{Display, Visual, XErrorEvent, XVisualInfo, Xlib};
use x11_dl::xshm::Xext;

/// The functions of X.
pub(crate) struct Server {
    pub(crate) xlib: Xlib,
    /// Shared memory, where there is a library for it.
    pub(crate) ext: Option<Xext>,
}

/// The functions of X; `None` where there is no Xlib.
pub(crate) fn server() -> Option<&'static Server> {
    static SERVER: OnceLock<Option<Server>> = OnceLock::new();
    let open = || Some(Server { xlib: Xlib::open().ok()?, ext: Xext::open().ok() });
    SERVER.get_or_init(open).as_ref()
}

/// A program's connection to a server. The program answers for it being one, as long as it hands it over or
/// has windows that are drawn to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Connection(usize);

/// Width and height of a drawable, and bits of a pixel that count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Geometry {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) depth: u32,
}

/// A visual of a screen: how pixels of a window are colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct VisualKind {
    pub(crate) id: u64,
    pub(crate) depth: u32,
    /// Bits of red, green and blue in a pixel.
    pub(crate) masks: [u32; 3],
    /// Address of Xlib's own description.
    pub(crate) visual: usize,
}

/// One trap at a time: the handler of errors is the process's.
static TRAP: Mutex<()> = Mutex::new(());
static REFUSED: AtomicBool = AtomicBool::new(false);

unsafe extern "C" fn note(_: *mut Display, _: *mut XErrorEvent) -> c_int {
    REFUSED.store(true, Ordering::SeqCst);
    0
}

impl Connection {
    /// The connection that a program hands over; `None` for NULL.
    pub(crate) fn of(display: usize) -> Option<Self> {
        (display != 0).then_some(Self(display))
    }

    pub(crate) fn address(self) -> usize {
        self.0
    }

    pub(crate) fn display(self) -> *mut Display {
        std::ptr::with_exposed_provenance_mut(self.0)
    }

    /// Makes requests and waits for them; `None` when the server refuses one, which then is no error of the
    /// program.
    pub(crate) fn trapped<R>(self, x: &Server, requests: impl FnOnce() -> R) -> Option<R> {
        let _one = TRAP.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: a connection of the program's; what went wrong before is told to the program first.
        let old = unsafe {
            (x.xlib.XSync)(self.display(), 0);
            REFUSED.store(false, Ordering::SeqCst);
            (x.xlib.XSetErrorHandler)(Some(note))
        };
        let result = requests();
        // SAFETY: as before; the old handler is the one that was there.
        unsafe {
            (x.xlib.XSync)(self.display(), 0);
            (x.xlib.XSetErrorHandler)(old);
        }
        (!REFUSED.load(Ordering::SeqCst)).then_some(result)
    }

    /// Waits until the server has done everything.
    pub(crate) fn sync(self, x: &Server) {
        // SAFETY: a connection of the program's.
        unsafe { (x.xlib.XSync)(self.display(), 0) };
    }

    /// Size of a window or pixmap, within a trap; `None` when there is no such thing.
    pub(crate) fn geometry_in_trap(self, x: &Server, id: u64) -> Option<Geometry> {
        let (mut root, mut place, mut size): (c_ulong, [c_int; 2], [c_uint; 4]) = (0, [0; 2], [0; 4]);
        let [width, height, border, depth] = &mut size;
        let [left, top] = &mut place;
        // SAFETY: a connection of the program's, and places for all answers.
        let found = unsafe {
            (x.xlib.XGetGeometry)(self.display(), id, &mut root, left, top, width, height, border, depth)
        };
        (found != 0).then_some(Geometry { width: size[0], height: size[1], depth: size[3] })
    }

    /// Size of a window or pixmap; `None` when there is no such thing.
    pub(crate) fn geometry(self, x: &Server, id: u64) -> Option<Geometry> {
        self.trapped(x, || self.geometry_in_trap(x, id)).flatten()
    }

    /// Number of screens.
    pub(crate) fn screens(self, x: &Server) -> c_int {
        // SAFETY: a connection of the program's.
        unsafe { (x.xlib.XScreenCount)(self.display()) }
    }

    /// The visuals of a screen whose pixels are colours of at least 15 bits, the screen's own first.
    pub(crate) fn visuals(self, x: &Server, screen: c_int) -> Vec<VisualKind> {
        if screen < 0 || screen >= self.screens(x) {
            return Vec::new();
        }
        let mut wanted: XVisualInfo = XVisualInfo { screen, class: x11_dl::xlib::TrueColor, ..NO_VISUAL };
        let mask = x11_dl::xlib::VisualScreenMask | x11_dl::xlib::VisualClassMask;
        let mut count = 0;
        // SAFETY: a connection of the program's; the list has as many visuals as are counted, and is ours.
        let (all, own) = unsafe {
            let list = (x.xlib.XGetVisualInfo)(self.display(), mask, &mut wanted, &mut count);
            let all = if list.is_null() {
                Vec::new()
            } else {
                let all = std::slice::from_raw_parts(list, usize::try_from(count).unwrap_or(0)).to_vec();
                (x.xlib.XFree)(list.cast());
                all
            };
            let own: *mut Visual = (x.xlib.XDefaultVisual)(self.display(), screen);
            (all, (x.xlib.XVisualIDFromVisual)(own))
        };
        let kind = |v: &XVisualInfo| VisualKind {
            id: v.visualid,
            depth: v.depth as u32,
            masks: [v.red_mask, v.green_mask, v.blue_mask].map(|mask| mask as u32),
            visual: v.visual.expose_provenance(),
        };
        let mut kinds: Vec<_> = all.iter().filter(|v| v.depth >= 15).map(kind).collect();
        kinds.sort_by_key(|v| v.id != own);
        kinds
    }

    /// Xlib's description of a visual, which the program frees; 0 if there is none.
    pub(crate) fn visual_info(self, x: &Server, id: u64) -> usize {
        let mut wanted = XVisualInfo { visualid: id, ..NO_VISUAL };
        let mut count = 0;
        let mask = x11_dl::xlib::VisualIDMask;
        // SAFETY: a connection of the program's.
        let list = unsafe { (x.xlib.XGetVisualInfo)(self.display(), mask, &mut wanted, &mut count) };
        list.expose_provenance()
    }

    /// A new pixmap of one pixel: its number stands for something that the server does not know.
    pub(crate) fn new_number(self, x: &Server, screen: c_int) -> u64 {
        // SAFETY: a connection of the program's and one of its screens.
        unsafe {
            let root = (x.xlib.XRootWindow)(self.display(), screen);
            let depth = (x.xlib.XDefaultDepth)(self.display(), screen);
            (x.xlib.XCreatePixmap)(self.display(), root, 1, 1, depth as c_uint)
        }
    }

    /// Frees a number got by [`Self::new_number`].
    pub(crate) fn free_number(self, x: &Server, number: u64) {
        self.trapped(x, || {
            // SAFETY: a connection of the program's.
            unsafe { (x.xlib.XFreePixmap)(self.display(), number) }
        });
    }
}

/// Nothing is asked for.
const NO_VISUAL: XVisualInfo = XVisualInfo {
    visual: std::ptr::null_mut(),
    visualid: 0,
    screen: 0,
    depth: 0,
    class: 0,
    red_mask: 0,
    green_mask: 0,
    blue_mask: 0,
    colormap_size: 0,
    bits_per_rgb: 0,
};
