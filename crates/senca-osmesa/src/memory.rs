//! The memory of the library: large blocks are kept when they are given back, and grow without being copied.
//!
//! A page that is new to the program costs the system about as much time as we need to fill it a dozen times
//! over: it has to be found, cleared and mapped when it is first touched. Vertices, planes and textures come in blocks of
//! many pages, so most of the time of a first picture goes there. The C library gives large blocks back to the
//! system at once, or, after some have come and gone, copies those that grow from one place of its heap to the
//! next, which touches twice the pages.
//!
//! Blocks of [`LARGE`] bytes and more are mapped by themselves here. They grow by being mapped elsewhere, and up
//! to [`MOST_KEPT`] bytes of those that are given back are kept for the next.

use std::alloc::{GlobalAlloc, Layout, System};
use std::ffi::c_void;
use std::sync::Mutex;

/// Bytes from which on a block is mapped by itself.
const LARGE: usize = 1 << 18;
/// Blocks have a multiple of these bytes, which every page size divides.
const GRAIN: usize = 1 << 16;
/// Most bytes that are kept for later.
const MOST_KEPT: usize = 1 << 26;
/// Most pieces they are in.
const MOST_PIECES: usize = 64;

/// Allocates memory: small blocks by the system's allocator.
struct Memory;

#[global_allocator]
static MEMORY: Memory = Memory;

/// What has been given back.
static KEPT: Mutex<Kept> = Mutex::new(Kept::NONE);

/// Some mapped memory that nobody uses: address and bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    at: usize,
    len: usize,
}

/// Pieces that no two of touch.
#[derive(Debug)]
struct Kept {
    pieces: [Piece; MOST_PIECES],
    count: usize,
    bytes: usize,
}

impl Kept {
    const NONE: Self = Self { pieces: [Piece { at: 0, len: 0 }; MOST_PIECES], count: 0, bytes: 0 };

    fn remove(&mut self, i: usize) -> Piece {
        let piece = self.pieces[i];
        self.count -= 1;
        self.pieces[i] = self.pieces[self.count];
        self.bytes -= piece.len;
        piece
    }

    /// Takes the first bytes of a piece; the others stay.
    fn cut(&mut self, i: usize, len: usize) -> usize {
        let piece = &mut self.pieces[i];
        let at = piece.at;
        if piece.len == len {
            self.remove(i);
        } else {
            *piece = Piece { at: at + len, len: piece.len - len };
            self.bytes -= len;
        }
        at
    }

    /// Takes a block out of the smallest piece that has it.
    fn take(&mut self, len: usize) -> Option<usize> {
        let fitting = (0..self.count).filter(|&i| self.pieces[i].len >= len);
        let i = fitting.min_by_key(|&i| self.pieces[i].len)?;
        Some(self.cut(i, len))
    }

    /// Takes the bytes behind a block; whether they are there.
    fn take_at(&mut self, at: usize, len: usize) -> bool {
        let found = (0..self.count).find(|&i| self.pieces[i].at == at && self.pieces[i].len >= len);
        found.is_some_and(|i| self.cut(i, len) == at)
    }

    /// Keeps a block, together with those it touches; whether there is room.
    fn keep(&mut self, block: Piece) -> bool {
        if self.bytes + block.len > MOST_KEPT {
            return false;
        }
        let mut whole = block;
        for i in (0..self.count).rev() {
            let piece = self.pieces[i];
            if piece.at + piece.len == whole.at || whole.at + whole.len == piece.at {
                self.remove(i);
                whole = Piece { at: piece.at.min(whole.at), len: piece.len + whole.len };
            }
        }
        // There is room for what was two or three pieces.
        let Some(place) = self.pieces.get_mut(self.count) else { return false };
        *place = whole;
        self.count += 1;
        self.bytes += whole.len;
        true
    }
}

/// Bytes of the block that a large layout gets; `None` for a small one.
fn block_bytes(size: usize, align: usize) -> Option<usize> {
    if size < LARGE || align > 4096 { None } else { size.checked_next_multiple_of(GRAIN) }
}

/// Does something with what is kept. `None` if another thread is at it, or was when the process was forked.
fn with_kept<R>(work: impl FnOnce(&mut Kept) -> R) -> Option<R> {
    KEPT.try_lock().ok().map(|mut kept| work(&mut kept))
}

/// Maps new memory, all zeros; null if there is none.
fn map(len: usize) -> *mut u8 {
    let (access, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
    // SAFETY: asks for memory at a place that the system chooses, which nobody uses.
    let at = unsafe { libc::mmap(std::ptr::null_mut(), len, access, kind, -1, 0) };
    if at == libc::MAP_FAILED { std::ptr::null_mut() } else { at.cast() }
}

/// Keeps a block, or gives it back to the system.
///
/// # Safety
/// The block is mapped, and nobody uses it any more.
unsafe fn give_back(block: *mut u8, len: usize) {
    let piece = Piece { at: block.expose_provenance(), len };
    if with_kept(|kept| kept.keep(piece)) != Some(true) {
        // SAFETY: the caller has said that it is mapped and not used.
        unsafe { libc::munmap(block.cast::<c_void>(), len) };
    }
}

/// A block that was kept; what is in it does not matter.
fn kept_block(len: usize) -> Option<*mut u8> {
    with_kept(|kept| kept.take(len)).flatten().map(std::ptr::with_exposed_provenance_mut)
}

/// A block with anything in it; null if there is no memory.
fn block(len: usize) -> *mut u8 {
    kept_block(len).unwrap_or_else(|| map(len))
}

/// A block of more bytes, with what is in `block`; null if there is no memory, then the block is as it was.
///
/// # Safety
/// The block is mapped, has `len` bytes, and is the caller's alone, who uses only the new one afterwards.
unsafe fn grown(block: *mut u8, len: usize, more: usize) -> *mut u8 {
    if with_kept(|kept| kept.take_at(block.addr() + len, more - len)) == Some(true) {
        // What lies behind a block was mapped and exposed when it was given back.
        return std::ptr::with_exposed_provenance_mut(block.expose_provenance());
    }
    let to = match kept_block(more) {
        Some(to) => to,
        None => {
            // SAFETY: the caller has said that the block is mapped and not used otherwise.
            let at = unsafe { libc::mremap(block.cast::<c_void>(), len, more, libc::MREMAP_MAYMOVE) };
            if at != libc::MAP_FAILED {
                return at.cast();
            }
            // Some systems do not move what was mapped in several parts.
            map(more)
        }
    };
    if !to.is_null() {
        // SAFETY: both are mapped, have so many bytes, and are not the same; nobody uses the first any more.
        unsafe {
            to.copy_from_nonoverlapping(block, len);
            give_back(block, len);
        }
    }
    to
}

// SAFETY: blocks are mapped for the one who asks alone until he gives them back; large ones have the bytes of
// [`block_bytes`], which depends on the layout alone, and begin with a page; the others are the system's.
unsafe impl GlobalAlloc for Memory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        match block_bytes(layout.size(), layout.align()) {
            Some(len) => block(len),
            // SAFETY: the layout is the caller's.
            None => unsafe { System.alloc(layout) },
        }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let Some(len) = block_bytes(layout.size(), layout.align()) else {
            // SAFETY: the layout is the caller's.
            return unsafe { System.alloc_zeroed(layout) };
        };
        match kept_block(len) {
            Some(at) => {
                // SAFETY: the block has so many bytes.
                unsafe { at.write_bytes(0, layout.size()) };
                at
            }
            None => map(len),
        }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        match block_bytes(layout.size(), layout.align()) {
            // SAFETY: it came from `alloc` with this layout, and the caller is done with it.
            Some(len) => unsafe { give_back(at, len) },
            // SAFETY: likewise.
            None => unsafe { System.dealloc(at, layout) },
        }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let (old, new) = (block_bytes(layout.size(), layout.align()), block_bytes(size, layout.align()));
        match (old, new) {
            // SAFETY: it came from the system with this layout.
            (None, None) => unsafe { System.realloc(at, layout, size) },
            (Some(old), Some(new)) if new > old => {
                // SAFETY: it came from `alloc` with this layout, and is the caller's alone.
                unsafe { grown(at, old, new) }
            }
            (Some(old), Some(new)) => {
                if new < old {
                    // SAFETY: so many bytes are mapped behind those that stay.
                    unsafe { give_back(at.add(new), old - new) };
                }
                at
            }
            _ => {
                // SAFETY: the caller has said that the size, rounded up to the alignment, is a layout's.
                let to = unsafe { self.alloc(Layout::from_size_align_unchecked(size, layout.align())) };
                if !to.is_null() {
                    // SAFETY: both have so many bytes; the first came from `alloc` with its layout.
                    unsafe {
                        to.copy_from_nonoverlapping(at, layout.size().min(size));
                        self.dealloc(at, layout);
                    }
                }
                to
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(kept: &Kept) -> Vec<(usize, usize)> {
        let mut pieces: Vec<_> = kept.pieces[..kept.count].iter().map(|p| (p.at, p.len)).collect();
        pieces.sort_unstable();
        assert_eq!(kept.bytes, pieces.iter().map(|p| p.1).sum::<usize>());
        pieces
    }

    #[test]
    fn pieces_that_touch_become_one() {
        let mut kept = Kept::NONE;
        for at in [100, 300, 200, 700] {
            assert!(kept.keep(Piece { at, len: 100 }));
        }
        assert_eq!(pieces(&kept), [(100, 300), (700, 100)]);
        // The smallest that has it.
        assert_eq!((kept.take(100), kept.take(100)), (Some(700), Some(100)));
        assert_eq!(
            (kept.take_at(250, 50), kept.take_at(200, 250), kept.take_at(200, 50)),
            (false, false, true)
        );
        assert_eq!((pieces(&kept), kept.take(200)), (vec![(250, 150)], None));
    }

    #[test]
    fn no_more_is_kept_than_there_is_room_for() {
        let mut kept = Kept::NONE;
        assert!(
            !kept.keep(Piece { at: 0, len: MOST_KEPT + 1 }) && kept.keep(Piece { at: 0, len: MOST_KEPT })
        );
        assert!(!kept.keep(Piece { at: 2 * MOST_KEPT, len: 1 }));
        let mut kept = Kept::NONE;
        assert!((0..MOST_PIECES).all(|k| kept.keep(Piece { at: 20 * k, len: 10 })));
        assert!(!kept.keep(Piece { at: 5000, len: 10 }) && kept.keep(Piece { at: 10, len: 10 }));
        assert_eq!(kept.count, MOST_PIECES - 1);
    }

    #[test]
    fn vectors_keep_their_values_as_they_grow_and_shrink() {
        let mut all: Vec<Vec<u32>> = vec![Vec::new(); 3];
        for k in 0..400_000_u32 {
            all[k as usize % 3].push(k);
        }
        for len in [100_000, 70_000, 66_000, 10] {
            all.iter_mut().for_each(|v| v.truncate(len));
            all.iter_mut().for_each(Vec::shrink_to_fit);
            assert!((0..3).all(|i| (0..len).all(|k| all[i][k] as usize == 3 * k + i)));
        }
        all[0].extend(0..300_000);
        assert!(all[0][10..].iter().zip(0..).all(|(a, b)| *a == b));
    }

    #[test]
    fn zeros_are_zeros_in_memory_that_was_used() {
        for _ in 0..3 {
            let mut zeros = vec![0_u8; 3 * LARGE + 5];
            assert!(zeros.iter().all(|v| *v == 0));
            zeros.fill(7);
        }
    }

    #[test]
    fn threads_do_not_get_the_same_block() {
        let work = |mark: u8| {
            for round in 0..40 {
                let mut bytes = vec![mark; LARGE + 70_000 * (round % 5)];
                bytes.resize(3 * LARGE + 10_000 * round, mark);
                let half = bytes.split_off(LARGE + 1);
                bytes.shrink_to_fit();
                assert!(bytes.iter().chain(&half).all(|byte| *byte == mark));
            }
        };
        std::thread::scope(|scope| (1..=4).for_each(|mark| drop(scope.spawn(move || work(mark)))));
    }
}
