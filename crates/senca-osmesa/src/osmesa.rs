//! The `OSMesa*` functions.

use crate::picture::{Kind, Layout, Order, Picture};
use senca_gl::{Config, Context, gl};
use senca_gl_abi::Entry;
use senca_gl_abi::current::{self, Current, Window};
use senca_gl_abi::memory::{In, Out};
use std::ffi::c_void;

const ROW_LENGTH: i32 = 0x10;
const Y_UP: i32 = 0x11;
const WIDTH: i32 = 0x20;
const HEIGHT: i32 = 0x21;
const FORMAT: i32 = 0x22;
const TYPE: i32 = 0x23;
const MAX_WIDTH: i32 = 0x24;
const MAX_HEIGHT: i32 = 0x25;
const DEPTH_BITS: i32 = 0x30;
const STENCIL_BITS: i32 = 0x31;
const ACCUM_BITS: i32 = 0x32;
const PROFILE: i32 = 0x33;
const COMPAT_PROFILE: i32 = 0x35;
const CONTEXT_MAJOR_VERSION: i32 = 0x36;
const CONTEXT_MINOR_VERSION: i32 = 0x37;

/// Most pairs of a list of attributes that are read.
const MAX_ATTRIBUTES: usize = 64;
/// Longest name of a function, and more.
const MAX_NAME: usize = 128;

/// Makes a context; NULL for an unknown format or a context to share with that does not exist.
fn create(format: u32, [depth, stencil, accum]: [i32; 3], share: usize) -> usize {
    let Some(order) = Order::of(format) else { return 0 };
    let bits = |n: i32| u32::try_from(n).unwrap_or(0);
    // As with Mesa, fewer than 16 bits are none.
    let depth_bits = if depth >= 16 { bits(depth) } else { 0 };
    let config = Config {
        float_color: false,
        double_buffered: false,
        depth_bits,
        stencil_bits: bits(stencil),
        accum_bits: bits(accum),
    };
    current::create(config, Box::new(Picture::new(format, order, depth_bits)), share)
}

/// The picture of a context with its state machine.
fn picture(c: &mut Current) -> Option<(&mut Picture, &mut Context)> {
    c.window_and_gl()
}

/// Does something with the picture of the current context, if there is one.
fn with(work: impl FnOnce(&mut Picture, &mut Context)) {
    current::with(|c| {
        if let Some((window, gl)) = picture(c) {
            work(window, gl);
        }
    });
}

/// What a list of attributes asks for; `None` for what is not had.
fn attributes(list: In<i32>) -> Option<(u32, [i32; 3])> {
    let (mut format, mut bits, mut version) = (gl::RGBA, [0; 3], [1, 0]);
    for k in 0..if list.is_null() { 0 } else { MAX_ATTRIBUTES } {
        let [name, value] = match list.get(2 * k)? {
            0 => break,
            name => [name, list.get(2 * k + 1)?],
        };
        match name {
            FORMAT => format = value as u32,
            DEPTH_BITS => bits[0] = value,
            STENCIL_BITS => bits[1] = value,
            ACCUM_BITS => bits[2] = value,
            PROFILE if value == COMPAT_PROFILE => {}
            CONTEXT_MAJOR_VERSION => version[0] = value,
            CONTEXT_MINOR_VERSION => version[1] = value,
            _ => return None,
        }
    }
    let had = bits.iter().all(|b| *b >= 0) && version[0] == 1 && (0..=5).contains(&version[1]);
    had.then_some((format, bits))
}

/// Gives a context a picture to draw to; `false` when that is none.
fn attach(handle: usize, buffer: Out<u8>, kind: u32, width: i32, height: i32) -> bool {
    let limit = senca_gl::max_window_side();
    let size = |n: i32| u32::try_from(n).ok().filter(|n| (1..=limit).contains(n));
    let (Some(width), Some(height)) = (size(width), size(height)) else { return false };
    current::make_current(handle, |c, is_current| {
        let Some((window, gl)) = picture(c) else { return false };
        let order = window.layout.order;
        let Some(number) = Kind::of(kind, order) else { return false };
        let layout = Layout { order, kind: number };
        let float = matches!(number, Kind::Short | Kind::Float);
        let changed = (window.width, window.height) != (width, height) || gl.has_float_color() != float;
        // Nothing is written to memory that stays attached before somebody asks for it.
        if is_current && (changed || (window.layout, window.buffer) != (layout, buffer.address())) {
            window.present(gl);
        }
        if changed {
            gl.set_float_color(float);
            if !gl.resize(width, height) {
                return false;
            }
        }
        (window.layout, window.kind) = (layout, kind);
        (window.buffer, window.width, window.height) = (buffer.address(), width, height);
        window.forget_shown();
        true
    })
}

/// Answers a question; `None` for an unknown one.
fn question(name: i32) -> Option<i32> {
    let limit = i32::try_from(senca_gl::max_window_side()).ok()?;
    let mut answer = match name {
        MAX_WIDTH | MAX_HEIGHT => return Some(limit),
        WIDTH | HEIGHT | FORMAT | TYPE | ROW_LENGTH | Y_UP => Some(0),
        _ => return None,
    };
    with(|window, _| {
        answer = Some(match name {
            WIDTH => window.width as i32,
            HEIGHT => window.height as i32,
            FORMAT => window.format as i32,
            TYPE => window.kind as i32,
            ROW_LENGTH => window.row_length as i32,
            _ => i32::from(window.y_up),
        });
    });
    answer
}

/// The function of a name.
fn find(name: &str) -> Option<&'static Entry> {
    senca_gl_abi::find(name).or_else(|| FUNCTIONS.iter().find(|e| e.name == name))
}

/// Defines C functions of OSMesa.
macro_rules! functions {
    ($( $name:ident ($($arg:ident: $t:ty),* $(,)?) $(-> $r:ty)? $body:block )*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name($($arg: $t),*) $(-> $r)? {
                let body = move || $body;
                std::panic::catch_unwind(std::panic::AssertUnwindSafe(body)).unwrap_or_default()
            }
        )*

        /// The functions of this file by name.
        static FUNCTIONS: &[Entry] = &[$(Entry::new(stringify!($name), $name as *const c_void),)*];
    };
}

functions! {
    OSMesaCreateContext(format: u32, share: usize) -> usize { create(format, [24, 8, 0], share) }
    OSMesaCreateContextExt(format: u32, depth: i32, stencil: i32, accum: i32, share: usize) -> usize {
        create(format, [depth, stencil, accum], share)
    }
    OSMesaCreateContextAttribs(list: In<i32>, share: usize) -> usize {
        attributes(list).map_or(0, |(format, bits)| create(format, bits, share))
    }
    OSMesaDestroyContext(context: usize) { current::destroy(context); }
    OSMesaMakeCurrent(context: usize, buffer: Out<u8>, kind: u32, width: i32, height: i32) -> u8 {
        if context == 0 && buffer.is_null() {
            current::release();
            return 1;
        }
        u8::from(!buffer.is_null() && attach(context, buffer, kind, width, height))
    }
    OSMesaGetCurrentContext() -> usize { current::current_handle() }
    OSMesaPixelStore(name: i32, value: i32) {
        with(|window, _| match (name, u32::try_from(value)) {
            (ROW_LENGTH, Ok(value)) => window.row_length = value.min(1 << 24),
            (Y_UP, _) => window.y_up = value != 0,
            _ => {}
        });
    }
    OSMesaGetIntegerv(name: i32, value: Out<i32>) {
        if let Some(answer) = question(name) {
            value.put(answer);
        }
    }
    OSMesaGetDepthBuffer(
        context: usize,
        width: Out<i32>,
        height: Out<i32>,
        value_bytes: Out<i32>,
        buffer: Out<usize>,
    ) -> u8 {
        let mut found = None;
        current::inspect(context, |c| {
            if let Some((window, gl)) = picture(c)
                && window.buffer != 0
                && window.depth_bits > 0
            {
                let (bytes, address) = window.read_depths(gl);
                found = Some(([window.width, window.height, bytes as u32].map(|v| v as i32), address));
            }
        });
        let ([w, h, bytes], address) = found.unwrap_or_default();
        width.put(w);
        height.put(h);
        value_bytes.put(bytes);
        buffer.put(address);
        u8::from(found.is_some())
    }
    OSMesaGetColorBuffer(
        context: usize,
        width: Out<i32>,
        height: Out<i32>,
        format: Out<i32>,
        buffer: Out<usize>,
    ) -> u8 {
        let mut found = None;
        current::inspect(context, |c| {
            if let Some((window, gl)) = picture(c)
                && window.buffer != 0
            {
                window.present(gl);
                let values = [window.width, window.height, window.format].map(|v| v as i32);
                found = Some((values, window.buffer));
            }
        });
        let ([w, h, f], address) = found.unwrap_or_default();
        width.put(w);
        height.put(h);
        format.put(f);
        buffer.put(address);
        u8::from(found.is_some())
    }
    OSMesaGetProcAddress(name: In<u8>) -> usize {
        let text = name.short_text::<MAX_NAME>();
        text.and_then(|name| find(&name)).map_or(0, |e| e.address.expose_provenance())
    }
    OSMesaColorClamp(enable: u8) { with(|window, _| window.clamp = enable != 0); }
    OSMesaPostprocess(_context: usize, _filter: *const c_void, _value: u32) {
        // There are no such filters; programs that ask for one get the picture as it is.
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_found_by_name() {
        assert!(
            ["OSMesaMakeCurrent", "OSMesaGetProcAddress", "glClear"].iter().all(|name| find(name).is_some())
        );
        assert!(["OSMesa", "glNoSuchCommand", ""].iter().all(|name| find(name).is_none()));
    }
}
