//! The program's memory, as pointers tell of it.
//!
//! The types here are pointers to the machine and arrive only as parameters of C functions. OpenGL says how
//! many elements a command reads or writes behind each; the program that calls answers for that many being
//! there. Their methods are safe for whoever asks for no more than that.

use senca_gl::ClientMemory;
use smallvec::SmallVec;
use std::ffi::c_void;

/// No program has memory below this address. A pointer there is NULL, or an offset in a buffer of a kind that
/// there is not.
const LOWEST_ADDRESS: usize = 1 << 16;

/// Numbers that any bits are a value of.
///
/// # Safety
/// Every pattern of bits of that size is a value, and there is no padding.
pub unsafe trait Plain: Copy + 'static {}

macro_rules! plain {
    ($($t:ty)*) => {$(
        // SAFETY: a number of the machine.
        unsafe impl Plain for $t {}
    )*};
}
plain!(i8 u8 i16 u16 i32 u32 i64 u64 f32 f64 isize usize);

// SAFETY: a pointer, which may be anything until it is used.
unsafe impl Plain for Pointer {}

/// Some numbers, mostly few.
pub type Few<T> = SmallVec<[T; 16]>;

/// What a command reads; may be NULL.
#[repr(transparent)]
pub struct In<T>(*const T);

impl<T> Clone for In<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for In<T> {}

impl<T> In<T> {
    /// Whether it is NULL, or an address that no memory of a program has.
    #[must_use]
    pub fn is_null(self) -> bool {
        self.0.addr() < LOWEST_ADDRESS
    }

    /// Where it is.
    #[must_use]
    pub fn address(self) -> usize {
        self.0.expose_provenance()
    }

    /// What is at an address that was a pointer of the program's before.
    #[must_use]
    pub fn at(address: usize) -> Self {
        Self(std::ptr::with_exposed_provenance(address))
    }

    /// `len` bytes; nothing when there are none or the pointer is NULL.
    #[must_use]
    pub fn bytes(&self, len: usize) -> Option<&[u8]> {
        let possible = !self.is_null() && isize::try_from(len).is_ok();
        // SAFETY: the program answers for `len` bytes behind a pointer that is not NULL (see the module), and
        // does not change them during the call.
        possible.then(|| unsafe { std::slice::from_raw_parts(self.0.cast(), len) })
    }
}

impl<T: Plain> In<T> {
    /// The first `N` numbers.
    #[inline]
    #[must_use]
    pub fn array<const N: usize>(self) -> Option<[T; N]> {
        // SAFETY: the program answers for `N` numbers behind a pointer that is not NULL (see the module); they
        // need not be aligned, and any bits are a number.
        (!self.is_null()).then(|| unsafe { self.0.cast::<[T; N]>().read_unaligned() })
    }

    /// The number `k` places further.
    #[must_use]
    pub fn get(self, k: usize) -> Option<T> {
        // SAFETY: as in `array`.
        (!self.is_null()).then(|| unsafe { self.0.add(k).read_unaligned() })
    }

    /// The first `n` numbers; `None` for NULL or a negative `n`.
    #[must_use]
    pub fn values(self, n: i32) -> Option<Few<T>> {
        let n = usize::try_from(n).ok()?;
        if self.is_null() {
            return None;
        }
        let mut values = Few::new();
        values.try_reserve_exact(n).ok()?;
        // SAFETY: as in `array`, for `n` numbers.
        values.extend((0..n).map(|k| unsafe { self.0.add(k).read_unaligned() }));
        Some(values)
    }
}

impl In<u8> {
    /// A text with a closing zero and fewer than `N` bytes; nothing is read behind the zero or `N` bytes.
    #[must_use]
    pub fn short_text<const N: usize>(self) -> Option<String> {
        let mut bytes = Vec::new();
        while bytes.len() < N {
            match self.get(bytes.len())? {
                0 => return String::from_utf8(bytes).ok(),
                byte => bytes.push(byte),
            }
        }
        None
    }

    /// A text: `len` bytes, or up to the closing zero when `len` is negative. What is not UTF-8 is replaced.
    #[must_use]
    pub fn text(self, len: i32) -> Option<String> {
        let bytes = match usize::try_from(len) {
            Ok(len) => self.bytes(len)?,
            Err(_) if self.is_null() => return None,
            // SAFETY: the program answers for a closing zero behind a pointer that is not NULL.
            Err(_) => unsafe { std::ffi::CStr::from_ptr(self.0.cast()) }.to_bytes(),
        };
        Some(String::from_utf8_lossy(bytes).into_owned())
    }
}

/// What a command writes; may be NULL, then nothing is written.
#[repr(transparent)]
pub struct Out<T>(*mut T);

impl<T> Clone for Out<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Out<T> {}

impl<T> Out<T> {
    /// Whether it is NULL, or an address that no memory of a program has.
    #[must_use]
    pub fn is_null(self) -> bool {
        self.0.addr() < LOWEST_ADDRESS
    }

    /// Where it is.
    #[must_use]
    pub fn address(self) -> usize {
        self.0.expose_provenance()
    }

    /// What is at an address that was a pointer of the program's before.
    #[must_use]
    pub fn at(address: usize) -> Self {
        Self(std::ptr::with_exposed_provenance_mut(address))
    }

    /// What is `n` elements further; NULL stays NULL.
    #[must_use]
    pub fn skip(self, n: usize) -> Self {
        if self.is_null() { self } else { Self(self.0.wrapping_add(n)) }
    }

    /// `len` bytes to be written; `None` for NULL or more bytes than there can be.
    #[must_use]
    pub fn bytes(&mut self, len: usize) -> Option<&mut [u8]> {
        let possible = !self.is_null() && isize::try_from(len).is_ok();
        // SAFETY: the program answers for `len` bytes behind a pointer that is not NULL (see the module), and
        // does not touch them during the call.
        possible.then(|| unsafe { std::slice::from_raw_parts_mut(self.0.cast(), len) })
    }
}

impl<T: Copy> Out<T> {
    /// Writes numbers one after another.
    #[inline]
    pub fn write(self, values: &[T]) {
        if !self.is_null() {
            for (k, value) in values.iter().enumerate() {
                // SAFETY: the program answers for as many numbers as the command writes behind a pointer that
                // is not NULL; they need not be aligned.
                unsafe { self.0.add(k).write_unaligned(*value) }
            }
        }
    }

    /// Writes one number.
    #[inline]
    pub fn put(self, value: T) {
        self.write(&[value]);
    }
}

impl Out<u8> {
    /// Writes as much of a text as `size` bytes hold with a closing zero; returns how long it then is.
    pub fn write_text(self, text: &str, size: i32) -> usize {
        let Some(room) = usize::try_from(size).ok().and_then(|n| n.checked_sub(1)) else { return 0 };
        let bytes = &text.as_bytes()[..text.len().min(room)];
        self.write(bytes);
        self.skip(bytes.len()).put(0);
        bytes.len()
    }
}

/// An offset in a buffer when one is bound, else an address.
pub type Pointer = In<c_void>;

/// The memory that arrays given by address are in: all there is.
#[derive(Debug)]
pub struct ProgramMemory;

impl ClientMemory for ProgramMemory {
    fn with(&self, address: usize, len: usize, read: &mut dyn FnMut(&[u8])) {
        let start = std::ptr::with_exposed_provenance::<u8>(address);
        if address >= LOWEST_ADDRESS && isize::try_from(len).is_ok() {
            // SAFETY: the program answers for the elements of its arrays that it draws, and does not change
            // them during the call.
            read(unsafe { std::slice::from_raw_parts(start, len) });
        }
    }
}
