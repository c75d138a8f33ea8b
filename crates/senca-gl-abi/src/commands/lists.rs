//! Display lists.

use crate::memory::Pointer;

commands! { COMMANDS, c:
    glNewList(list: u32, mode: u32) { c.new_list(list, mode) }
    glEndList() { c.end_list() }
    glCallList(list: u32) { c.call_list(list) }
    glCallLists(n: i32, kind: u32, lists: Pointer) {
        let size = senca_gl::list_name_bytes(kind).unwrap_or(0);
        let bytes = usize::try_from(n).unwrap_or(0).saturating_mul(size);
        c.call_lists_of(n, kind, lists.bytes(bytes).unwrap_or_default())
    }
    glListBase(base: u32) { c.list_base(base) }
    glGenLists(range: i32) -> u32 { c.gen_lists(range) }
    glDeleteLists(list: u32, range: i32) { c.delete_lists(list, range) }
    glIsList(list: u32) -> u8 { c.is_list(list).into() }
}
