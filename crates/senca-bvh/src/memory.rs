//! Memory as large hierarchies want it: in few pages, and asked for before it is needed.
#![expect(unsafe_code, reason = "the system and the processor are told what memory is for")]

/// An empty list with room for `capacity`, in pages of 2 MiB where the system has them.
///
/// A ray touches places all over a large hierarchy; with pages of 4 KiB nearly each of them is unknown to the
/// processor's table of pages. On other systems than Linux, and where it declines, the list is a plain one.
pub(crate) fn list_in_large_pages<T>(capacity: usize) -> Vec<T> {
    let list = Vec::<T>::with_capacity(capacity);
    #[cfg(target_os = "linux")]
    linux::advise_large_pages(&list);
    list
}

#[cfg(target_os = "linux")]
mod linux {
    /// Below, large pages would waste more than they gain.
    const SMALLEST: usize = 4 << 20;
    /// Whole pages of any size Linux has are whole multiples of it, and of 2 MiB.
    const PAGE: usize = 1 << 16;

    /// Asks for large pages in the part of an empty list that is whole pages.
    pub(super) fn advise_large_pages<T>(list: &Vec<T>) {
        debug_assert!(list.is_empty());
        let bytes = list.capacity() * size_of::<T>();
        if bytes < SMALLEST {
            return;
        }
        let start = list.as_ptr().cast::<u8>();
        let skipped = start.align_offset(PAGE).min(bytes);
        let length = (bytes - skipped) / PAGE * PAGE;
        let start = start.wrapping_add(skipped).cast_mut().cast();
        // SAFETY: the range is within the list's own allocation, in which nothing has been written. The first
        // advice lets go of small pages that are there from before, and leaves zeros. The second changes
        // neither contents nor access. An error means that pages stay as they are.
        unsafe {
            libc::madvise(start, length, libc::MADV_DONTNEED);
            libc::madvise(start, length, libc::MADV_HUGEPAGE);
        }
    }
}

/// Asks for `list[index]`, which will be needed soon.
#[inline(always)]
pub(crate) fn prefetch<T>(list: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start = list.as_ptr().wrapping_add(index).cast::<i8>();
        for line in 0..size_of::<T>().div_ceil(64) {
            // SAFETY: a prefetch neither changes memory nor fails, whatever the address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(64 * line)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (list, index);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_have_room_whatever_their_size() {
        for capacity in [0, 1, 1 << 10, (1 << 20) + 1, 1 << 21] {
            let mut list = list_in_large_pages::<u64>(capacity);
            assert!(list.is_empty() && list.capacity() >= capacity);
            list.extend(0..capacity as u64);
            assert!(list.iter().enumerate().all(|(i, &value)| value == i as u64));
        }
    }

    #[test]
    fn any_place_may_be_asked_for() {
        let list = [[0u8; 256]; 3];
        for index in [0, 2, 3, usize::MAX] {
            prefetch(&list, index);
        }
        prefetch::<[u8; 320]>(&[], 7);
    }
}
