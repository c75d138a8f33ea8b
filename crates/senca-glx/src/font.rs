//! Display lists of the characters of X's fonts (`glXUseXFont`).

use crate::server::{Connection, Server};
use senca_gl::{Context, gl};
use std::ffi::{c_uint, c_ulong};
use x11_dl::xlib::{XChar2b, XCharStruct, XFontStruct, ZPixmap};

/// Most pixels on a side of a character.
const MAX_SIDE: i32 = 1024;

/// A character: its place about the origin, and its bits, the lowest row first.
struct Glyph {
    metrics: XCharStruct,
    bits: Vec<u8>,
}

/// Makes lists `list..list + count` that draw the characters from `first` on; `false` when there is no such font.
pub(crate) fn use_font(
    c: &mut Context,
    x: &Server,
    connection: Connection,
    font: c_ulong,
    [first, count, list]: [i32; 3],
) -> bool {
    // SAFETY: a connection of the program's; the answer is ours.
    let queried = connection.trapped(x, || unsafe { (x.xlib.XQueryFont)(connection.display(), font) });
    let record = queried.unwrap_or(std::ptr::null_mut());
    // SAFETY: as Xlib made it, or NULL.
    let Some(info) = (unsafe { record.as_ref() }) else { return false };
    c.push_client_attrib(gl::CLIENT_PIXEL_STORE_BIT);
    for name in [gl::UNPACK_ROW_LENGTH, gl::UNPACK_SKIP_ROWS, gl::UNPACK_SKIP_PIXELS, gl::UNPACK_LSB_FIRST] {
        c.pixel_store(name, 0);
    }
    c.pixel_store(gl::UNPACK_ALIGNMENT, 1);
    for k in 0..count.max(0) {
        let (Some(code), Some(list)) = (first.checked_add(k), list.checked_add(k)) else { break };
        let glyph = metrics(info, code).map(|m| draw(x, connection, font, code, m));
        c.new_list(list as u32, gl::COMPILE);
        if let Some(Glyph { metrics: m, bits }) = glyph {
            let size = [i32::from(m.rbearing - m.lbearing), i32::from(m.ascent + m.descent)];
            let origin = [-f32::from(m.lbearing), f32::from(m.descent)];
            let advance = [f32::from(m.width), 0.0];
            c.bitmap(size, origin, advance, Some(&*bits).filter(|bits| !bits.is_empty()));
        }
        c.end_list();
    }
    c.pop_client_attrib();
    // SAFETY: the record that Xlib made for us, with no font of ours.
    unsafe { (x.xlib.XFreeFontInfo)(std::ptr::null_mut(), record, 1) };
    true
}

/// Place and size of a character; `None` when the font does not have it.
fn metrics(font: &XFontStruct, code: i32) -> Option<XCharStruct> {
    let code = u32::try_from(code).ok()?;
    let (row, column) = (code >> 8 & 0xff, code & 0xff);
    let rows = font.min_byte1..=font.max_byte1;
    let columns = font.min_char_or_byte2..=font.max_char_or_byte2;
    let (index, there) = if font.min_byte1 == 0 && font.max_byte1 == 0 {
        (code.wrapping_sub(font.min_char_or_byte2), columns.contains(&code))
    } else {
        let width = font.max_char_or_byte2.wrapping_sub(font.min_char_or_byte2).wrapping_add(1);
        let index = row.wrapping_sub(font.min_byte1).wrapping_mul(width);
        let index = index.wrapping_add(column.wrapping_sub(font.min_char_or_byte2));
        (index, rows.contains(&row) && columns.contains(&column))
    };
    if !there {
        return None;
    }
    // SAFETY: a list of all characters between the least and the greatest, or NULL when all are alike.
    Some(unsafe { font.per_char.as_ref().map_or(font.max_bounds, |_| *font.per_char.add(index as usize)) })
}

/// Lets the server draw a character, and looks at it.
fn draw(x: &Server, connection: Connection, font: c_ulong, code: i32, metrics: XCharStruct) -> Glyph {
    let width = i32::from(metrics.rbearing) - i32::from(metrics.lbearing);
    let height = i32::from(metrics.ascent) + i32::from(metrics.descent);
    let possible = 1..=MAX_SIDE;
    if !possible.contains(&width) || !possible.contains(&height) {
        return Glyph { metrics, bits: Vec::new() };
    }
    let line = (width as usize).div_ceil(8);
    let mut bits = vec![0; line * height as usize];
    let text = XChar2b { byte1: (code >> 8) as u8, byte2: code as u8 };
    let display = connection.display();
    connection.trapped(x, || {
        // SAFETY: a connection of the program's; everything that is made here is freed here.
        unsafe {
            let root = (x.xlib.XDefaultRootWindow)(display);
            let pixmap = (x.xlib.XCreatePixmap)(display, root, width as c_uint, height as c_uint, 1);
            let gc = (x.xlib.XCreateGC)(display, pixmap, 0, std::ptr::null_mut());
            (x.xlib.XSetForeground)(display, gc, 0);
            (x.xlib.XFillRectangle)(display, pixmap, gc, 0, 0, width as c_uint, height as c_uint);
            (x.xlib.XSetForeground)(display, gc, 1);
            (x.xlib.XSetFont)(display, gc, font);
            let (left, base) = (-i32::from(metrics.lbearing), i32::from(metrics.ascent));
            (x.xlib.XDrawString16)(display, pixmap, gc, left, base, &text, 1);
            let image =
                (x.xlib.XGetImage)(display, pixmap, 0, 0, width as c_uint, height as c_uint, 1, ZPixmap);
            if !image.is_null() {
                for row in 0..height {
                    for column in 0..width {
                        if (x.xlib.XGetPixel)(image, column, row) & 1 != 0 {
                            let at = (height - 1 - row) as usize * line + column as usize / 8;
                            bits[at] |= 0x80 >> (column % 8);
                        }
                    }
                }
                (x.xlib.XDestroyImage)(image);
            }
            (x.xlib.XFreeGC)(display, gc);
            (x.xlib.XFreePixmap)(display, pixmap);
        }
    });
    Glyph { metrics, bits }
}
