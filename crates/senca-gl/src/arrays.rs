//! Vertex arrays and buffer objects (OpenGL 1.5, sections 2.8, 2.9).

use crate::immediate::VertexArrays;
use crate::state::TEXTURE_UNITS;
use crate::{Context, Enum, gl};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Memory of the program that arrays given by address are read from.
///
/// Only the C interface has such arrays; Rust programs give [`ArraySource::Owned`] ones.
pub trait ClientMemory: Send + Sync + std::fmt::Debug {
    /// Calls `read` with the `len` bytes from `address` on, if they may be read.
    fn with(&self, address: usize, len: usize, read: &mut dyn FnMut(&[u8]));
}

/// Where the elements of an array are.
#[derive(Clone, Debug)]
pub enum ArraySource {
    /// Bytes of its own.
    Owned(Arc<[u8]>),
    /// An address in the [`ClientMemory`] of the context.
    Address(usize),
    /// So many bytes from the beginning of the buffer that is bound now.
    Buffer(usize),
}

/// One array.
#[derive(Clone, Debug)]
pub(crate) struct VertexArray {
    pub(crate) enabled: bool,
    pub(crate) size: i32,
    pub(crate) kind: Enum,
    pub(crate) stride: i32,
    pub(crate) source: ArraySource,
    /// Name of the buffer, and the buffer; 0 for none.
    pub(crate) buffer: (u32, Option<Buffer>),
}

impl VertexArray {
    fn new(size: i32, kind: Enum) -> Self {
        Self { enabled: false, size, kind, stride: 0, source: ArraySource::Address(0), buffer: (0, None) }
    }

    /// Bytes from one element to the next.
    fn step(&self) -> usize {
        match self.stride {
            0 => self.size as usize * type_bytes(self.kind),
            stride => stride as usize,
        }
    }

    /// Address or offset, as `get_pointer` tells.
    pub(crate) fn pointer(&self) -> usize {
        match self.source {
            ArraySource::Owned(_) => 0,
            ArraySource::Address(at) | ArraySource::Buffer(at) => at,
        }
    }
}

/// Bytes of a number; 0 for an unknown type.
pub(crate) fn type_bytes(kind: Enum) -> usize {
    match kind {
        gl::BYTE | gl::UNSIGNED_BYTE => 1,
        gl::SHORT | gl::UNSIGNED_SHORT => 2,
        gl::INT | gl::UNSIGNED_INT | gl::FLOAT => 4,
        gl::DOUBLE => 8,
        _ => 0,
    }
}

/// State of the client: arrays and bindings.
#[derive(Clone, Debug)]
pub(crate) struct ClientState {
    pub(crate) vertex: VertexArray,
    pub(crate) normal: VertexArray,
    pub(crate) color: VertexArray,
    pub(crate) secondary: VertexArray,
    pub(crate) fog_coord: VertexArray,
    pub(crate) index: VertexArray,
    pub(crate) edge_flag: VertexArray,
    pub(crate) tex_coords: [VertexArray; TEXTURE_UNITS],
    /// Unit that array commands mean.
    pub(crate) active: usize,
    pub(crate) array_buffer: (u32, Option<Buffer>),
    pub(crate) element_buffer: (u32, Option<Buffer>),
    pub(crate) memory: Option<Arc<dyn ClientMemory>>,
}

impl Default for ClientState {
    fn default() -> Self {
        Self {
            vertex: VertexArray::new(4, gl::FLOAT),
            normal: VertexArray::new(3, gl::FLOAT),
            color: VertexArray::new(4, gl::FLOAT),
            secondary: VertexArray::new(3, gl::FLOAT),
            fog_coord: VertexArray::new(1, gl::FLOAT),
            index: VertexArray::new(1, gl::FLOAT),
            edge_flag: VertexArray::new(1, gl::UNSIGNED_BYTE),
            tex_coords: std::array::from_fn(|_| VertexArray::new(4, gl::FLOAT)),
            active: 0,
            array_buffer: (0, None),
            element_buffer: (0, None),
            memory: None,
        }
    }
}

impl ClientState {
    /// The array of a capability of the client.
    pub(crate) fn array(&self, name: Enum) -> Option<&VertexArray> {
        Some(match name {
            gl::VERTEX_ARRAY => &self.vertex,
            gl::NORMAL_ARRAY => &self.normal,
            gl::COLOR_ARRAY => &self.color,
            gl::SECONDARY_COLOR_ARRAY => &self.secondary,
            gl::FOG_COORD_ARRAY => &self.fog_coord,
            gl::INDEX_ARRAY => &self.index,
            gl::EDGE_FLAG_ARRAY => &self.edge_flag,
            gl::TEXTURE_COORD_ARRAY => &self.tex_coords[self.active],
            _ => return None,
        })
    }

    pub(crate) fn array_mut(&mut self, name: Enum) -> Option<&mut VertexArray> {
        Some(match name {
            gl::VERTEX_ARRAY => &mut self.vertex,
            gl::NORMAL_ARRAY => &mut self.normal,
            gl::COLOR_ARRAY => &mut self.color,
            gl::SECONDARY_COLOR_ARRAY => &mut self.secondary,
            gl::FOG_COORD_ARRAY => &mut self.fog_coord,
            gl::INDEX_ARRAY => &mut self.index,
            gl::EDGE_FLAG_ARRAY => &mut self.edge_flag,
            gl::TEXTURE_COORD_ARRAY => &mut self.tex_coords[self.active],
            _ => return None,
        })
    }

    pub(crate) fn enabled(&self, name: Enum) -> Option<bool> {
        self.array(name).map(|a| a.enabled)
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut VertexArray> {
        let Self { vertex, normal, color, secondary, fog_coord, index, edge_flag, tex_coords, .. } = self;
        [vertex, normal, color, secondary, fog_coord, index, edge_flag].into_iter().chain(tex_coords)
    }
}

/// A buffer object.
pub(crate) type Buffer = Arc<Mutex<BufferData>>;

/// What a buffer object holds.
#[derive(Debug)]
pub(crate) struct BufferData {
    pub(crate) bytes: Vec<u8>,
    pub(crate) usage: Enum,
    /// `READ_ONLY`, `WRITE_ONLY` or `READ_WRITE` while it is mapped.
    pub(crate) mapped: Option<Enum>,
    pub(crate) last_access: Enum,
}

impl Default for BufferData {
    fn default() -> Self {
        Self { bytes: Vec::new(), usage: gl::STATIC_DRAW, mapped: None, last_access: gl::READ_WRITE }
    }
}

/// All buffer objects; names without one are reserved.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    names: HashMap<u32, Option<Buffer>>,
}

pub(crate) fn lock(buffer: &Buffer) -> MutexGuard<'_, BufferData> {
    buffer.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The lowest `n` names from 1 on that `taken` does not have.
pub(crate) fn free_names(n: usize, taken: impl Fn(u32) -> bool) -> Vec<u32> {
    (1..=u32::MAX).filter(|name| !taken(*name)).take(n).collect()
}

/// Most names that one call makes.
pub(crate) const MAX_NAMES: i32 = 1 << 22;

impl Context {
    /// Where arrays given by address are read.
    pub fn set_client_memory(&mut self, memory: Arc<dyn ClientMemory>) {
        self.client.memory = Some(memory);
    }

    /// What a pointer of the C interface means: an offset in the buffer bound to `target`, `ARRAY_BUFFER` or
    /// `ELEMENT_ARRAY_BUFFER`, else an address.
    #[must_use]
    pub fn pointer_source(&self, target: Enum, pointer: usize) -> ArraySource {
        match self.bound_buffer(target) {
            Ok(_) => ArraySource::Buffer(pointer),
            Err(_) => ArraySource::Address(pointer),
        }
    }

    /// `glGenBuffers`: unused names.
    pub fn gen_buffers(&mut self, n: i32) -> Vec<u32> {
        self.ask(|c| {
            if !(0..=MAX_NAMES).contains(&n) {
                c.error(gl::INVALID_VALUE);
                return Vec::new();
            }
            let buffers = &mut c.shared().buffers;
            let names = free_names(n as usize, |name| buffers.names.contains_key(&name));
            names.iter().for_each(|name| drop(buffers.names.insert(*name, None)));
            names
        })
    }

    /// `glDeleteBuffers`.
    pub fn delete_buffers(&mut self, names: &[u32]) {
        self.outside(|c| {
            for &name in names.iter().filter(|n| **n != 0) {
                if c.shared().buffers.names.remove(&name).is_none() {
                    continue;
                }
                let client = &mut c.client;
                for binding in [&mut client.array_buffer, &mut client.element_buffer] {
                    if binding.0 == name {
                        *binding = (0, None);
                    }
                }
                for array in client.all_mut().filter(|a| a.buffer.0 == name) {
                    array.buffer = (0, None);
                    array.source = ArraySource::Address(0);
                }
            }
        });
    }

    /// `glIsBuffer`.
    pub fn is_buffer(&mut self, name: u32) -> bool {
        self.ask(|c| c.shared().buffers.names.get(&name).is_some_and(Option::is_some))
    }

    /// `glBindBuffer`: `ARRAY_BUFFER` or `ELEMENT_ARRAY_BUFFER`; a new name makes a buffer.
    pub fn bind_buffer(&mut self, target: Enum, name: u32) {
        self.outside(|c| {
            if !matches!(target, gl::ARRAY_BUFFER | gl::ELEMENT_ARRAY_BUFFER) {
                return c.error(gl::INVALID_ENUM);
            }
            let object = (name != 0).then(|| {
                let mut shared = c.shared();
                Arc::clone(shared.buffers.names.entry(name).or_default().get_or_insert_default())
            });
            let binding = (name, object);
            match target {
                gl::ARRAY_BUFFER => c.client.array_buffer = binding,
                _ => c.client.element_buffer = binding,
            }
        });
    }

    /// The buffer bound to `target`, or the error.
    pub(crate) fn bound_buffer(&self, target: Enum) -> Result<Buffer, Enum> {
        let bound = match target {
            gl::ARRAY_BUFFER => &self.client.array_buffer,
            gl::ELEMENT_ARRAY_BUFFER => &self.client.element_buffer,
            _ => return Err(gl::INVALID_ENUM),
        };
        bound.1.clone().ok_or(gl::INVALID_OPERATION)
    }

    fn with_buffer<R: Default>(
        &mut self,
        target: Enum,
        f: impl FnOnce(&mut BufferData) -> Result<R, Enum>,
    ) -> R {
        self.ask(|c| {
            let result = c.bound_buffer(target).and_then(|b| f(&mut lock(&b)));
            result.unwrap_or_else(|error| {
                c.error(error);
                R::default()
            })
        })
    }

    /// `glBufferData`: `size` bytes, from `data` if there are any, else zeros.
    pub fn buffer_data(&mut self, target: Enum, size: isize, data: Option<&[u8]>, usage: Enum) {
        self.with_buffer(target, |b| {
            let valid = (gl::STREAM_DRAW..=gl::STREAM_COPY).contains(&usage)
                || (gl::STATIC_DRAW..=gl::STATIC_COPY).contains(&usage)
                || (gl::DYNAMIC_DRAW..=gl::DYNAMIC_COPY).contains(&usage);
            if !valid {
                return Err(gl::INVALID_ENUM);
            }
            let size = usize::try_from(size).map_err(|_| gl::INVALID_VALUE)?;
            let mut bytes = Vec::new();
            bytes.try_reserve_exact(size).map_err(|_| gl::OUT_OF_MEMORY)?;
            bytes.extend_from_slice(&data.unwrap_or_default()[..size.min(data.map_or(0, <[u8]>::len))]);
            bytes.resize(size, 0);
            *b = BufferData { bytes, usage, ..BufferData::default() };
            Ok(())
        });
    }

    /// `glBufferSubData`: puts `data` at `offset`.
    pub fn buffer_sub_data(&mut self, target: Enum, offset: isize, data: &[u8]) {
        self.with_buffer(target, |b| {
            if b.mapped.is_some() {
                return Err(gl::INVALID_OPERATION);
            }
            let to =
                usize::try_from(offset).ok().and_then(|o| b.bytes.get_mut(o..o.checked_add(data.len())?));
            to.ok_or(gl::INVALID_VALUE)?.copy_from_slice(data);
            Ok(())
        });
    }

    /// `glGetBufferSubData`: fills `data` from `offset` on.
    pub fn get_buffer_sub_data(&mut self, target: Enum, offset: isize, data: &mut [u8]) {
        self.with_buffer(target, |b| {
            if b.mapped.is_some() {
                return Err(gl::INVALID_OPERATION);
            }
            let from = usize::try_from(offset).ok().and_then(|o| b.bytes.get(o..o.checked_add(data.len())?));
            data.copy_from_slice(from.ok_or(gl::INVALID_VALUE)?);
            Ok(())
        });
    }

    /// `glMapBuffer`: where the bytes are, until [`Context::unmap_buffer`]; `None` when that is an error. The buffer
    /// may not be used meanwhile.
    pub fn map_buffer(&mut self, target: Enum, access: Enum) -> Option<*mut u8> {
        self.with_buffer(target, |b| {
            if !(gl::READ_ONLY..=gl::READ_WRITE).contains(&access) {
                return Err(gl::INVALID_ENUM);
            }
            if b.mapped.is_some() {
                return Err(gl::INVALID_OPERATION);
            }
            (b.mapped, b.last_access) = (Some(access), access);
            Ok(Some(b.bytes.as_mut_ptr()))
        })
    }

    /// `glUnmapBuffer`: whether the bytes are still good, which they always are.
    pub fn unmap_buffer(&mut self, target: Enum) -> bool {
        self.with_buffer(target, |b| b.mapped.take().map(|_| true).ok_or(gl::INVALID_OPERATION))
    }

    /// `glGetBufferParameter`.
    pub fn get_buffer_parameter(&mut self, target: Enum, name: Enum) -> i32 {
        self.with_buffer(target, |b| {
            Ok(match name {
                gl::BUFFER_SIZE => i32::try_from(b.bytes.len()).unwrap_or(i32::MAX),
                gl::BUFFER_USAGE => b.usage as i32,
                gl::BUFFER_ACCESS => b.last_access as i32,
                gl::BUFFER_MAPPED => i32::from(b.mapped.is_some()),
                _ => return Err(gl::INVALID_ENUM),
            })
        })
    }

    /// `glGetBufferPointer`: where a mapped buffer's bytes are.
    pub fn get_buffer_pointer(&mut self, target: Enum, name: Enum) -> Option<*mut u8> {
        self.with_buffer(target, |b| {
            if name != gl::BUFFER_MAP_POINTER {
                return Err(gl::INVALID_ENUM);
            }
            Ok(b.mapped.map(|_| b.bytes.as_mut_ptr()))
        })
    }

    /// `glClientActiveTexture`: the unit whose array `tex_coord_pointer` means.
    pub fn client_active_texture(&mut self, unit: Enum) {
        self.outside(|c| match unit.checked_sub(gl::TEXTURE0) {
            Some(k) if (k as usize) < TEXTURE_UNITS => c.client.active = k as usize,
            _ => c.error(gl::INVALID_ENUM),
        });
    }

    /// `glEnableClientState`.
    pub fn enable_client_state(&mut self, array: Enum) {
        self.switch_array(array, true);
    }

    /// `glDisableClientState`.
    pub fn disable_client_state(&mut self, array: Enum) {
        self.switch_array(array, false);
    }

    fn switch_array(&mut self, array: Enum, on: bool) {
        self.outside(|c| match c.client.array_mut(array) {
            Some(a) => a.enabled = on,
            None => c.error(gl::INVALID_ENUM),
        });
    }

    fn set_array(&mut self, name: Enum, size: i32, kind: Enum, stride: i32, source: ArraySource) {
        self.outside(|c| {
            let (sizes, kinds) = allowed(name);
            if !sizes.contains(&size) || stride < 0 {
                return c.error(gl::INVALID_VALUE);
            }
            if !kinds.contains(&kind) {
                return c.error(gl::INVALID_ENUM);
            }
            let buffer = match source {
                ArraySource::Buffer(_) => c.client.array_buffer.clone(),
                _ => (0, None),
            };
            if let Some(a) = c.client.array_mut(name) {
                *a = VertexArray { enabled: a.enabled, size, kind, stride, source, buffer };
            }
        });
    }

    /// `glVertexPointer`: `size` coordinates of type `kind`, every `stride` bytes (0: one after another).
    pub fn vertex_pointer(&mut self, size: i32, kind: Enum, stride: i32, source: ArraySource) {
        self.set_array(gl::VERTEX_ARRAY, size, kind, stride, source);
    }

    /// `glNormalPointer`.
    pub fn normal_pointer(&mut self, kind: Enum, stride: i32, source: ArraySource) {
        self.set_array(gl::NORMAL_ARRAY, 3, kind, stride, source);
    }

    /// `glColorPointer`.
    pub fn color_pointer(&mut self, size: i32, kind: Enum, stride: i32, source: ArraySource) {
        self.set_array(gl::COLOR_ARRAY, size, kind, stride, source);
    }

    /// `glSecondaryColorPointer`.
    pub fn secondary_color_pointer(&mut self, size: i32, kind: Enum, stride: i32, source: ArraySource) {
        self.set_array(gl::SECONDARY_COLOR_ARRAY, size, kind, stride, source);
    }

    /// `glFogCoordPointer`.
    pub fn fog_coord_pointer(&mut self, kind: Enum, stride: i32, source: ArraySource) {
        self.set_array(gl::FOG_COORD_ARRAY, 1, kind, stride, source);
    }

    /// `glIndexPointer`.
    pub fn index_pointer(&mut self, kind: Enum, stride: i32, source: ArraySource) {
        self.set_array(gl::INDEX_ARRAY, 1, kind, stride, source);
    }

    /// `glEdgeFlagPointer`: a byte each.
    pub fn edge_flag_pointer(&mut self, stride: i32, source: ArraySource) {
        self.set_array(gl::EDGE_FLAG_ARRAY, 1, gl::UNSIGNED_BYTE, stride, source);
    }

    /// `glTexCoordPointer`, of the active client unit.
    pub fn tex_coord_pointer(&mut self, size: i32, kind: Enum, stride: i32, source: ArraySource) {
        self.set_array(gl::TEXTURE_COORD_ARRAY, size, kind, stride, source);
    }

    /// `glInterleavedArrays`: several arrays in one, `V2F` to `T4F_C4F_N3F_V4F`.
    pub fn interleaved_arrays(&mut self, format: Enum, stride: i32, source: &ArraySource) {
        let Some(f) = Interleaved::of(format) else {
            return self.outside(|c| c.error(gl::INVALID_ENUM));
        };
        if stride < 0 {
            return self.outside(|c| c.error(gl::INVALID_VALUE));
        }
        let step = if stride == 0 { f.bytes as i32 } else { stride };
        self.disable_client_state(gl::EDGE_FLAG_ARRAY);
        self.disable_client_state(gl::INDEX_ARRAY);
        self.disable_client_state(gl::SECONDARY_COLOR_ARRAY);
        self.disable_client_state(gl::FOG_COORD_ARRAY);
        for (name, part) in [
            (gl::TEXTURE_COORD_ARRAY, f.tex_coord),
            (gl::COLOR_ARRAY, f.color),
            (gl::NORMAL_ARRAY, f.normal),
            (gl::VERTEX_ARRAY, Some(f.vertex)),
        ] {
            let Some((size, kind, offset)) = part else {
                self.disable_client_state(name);
                continue;
            };
            self.enable_client_state(name);
            self.set_array(name, size, kind, step, source.at(offset));
        }
    }

    /// `glArrayElement`: the vertex number `i` of the arrays.
    pub fn array_element(&mut self, i: i32) {
        let Ok(first) = usize::try_from(i) else { return self.error(gl::INVALID_VALUE) };
        let arrays = match self.read_arrays(first, 1, true) {
            Ok(arrays) => arrays,
            Err(error) => return self.error(error),
        };
        use crate::list::Attribute as A;
        let mut say = |a: Option<A>| {
            if let Some(a) = a {
                self.attribute(a);
            }
        };
        say(arrays.edge_flags.first().map(|v| A::EdgeFlag(*v)));
        for (unit, coords) in arrays.tex_coords.iter().enumerate() {
            say(coords.first().map(|v| A::TexCoord(unit as u8, *v)));
        }
        say(arrays.colors.first().map(|v| A::Color(*v)));
        say(arrays.secondary.first().map(|v| A::Secondary(*v)));
        say(arrays.fog_coords.first().map(|v| A::FogCoord(*v)));
        say(arrays.normals.first().map(|v| A::Normal(*v)));
        say(arrays.positions.first().map(|v| A::Vertex(*v)));
    }

    /// `glDrawArrays`: primitives of `count` vertices from number `first` on.
    pub fn draw_arrays(&mut self, mode: Enum, first: i32, count: i32) {
        self.draws(|c| {
            let (Ok(first), Ok(count)) = (usize::try_from(first), usize::try_from(count)) else {
                return c.error(gl::INVALID_VALUE);
            };
            if mode > gl::POLYGON {
                return c.error(gl::INVALID_ENUM);
            }
            if count == 0 || !c.client.vertex.enabled {
                return c.draw_nothing();
            }
            match c.read_arrays(first, count, c.compiling.is_some()) {
                Ok(arrays) => c.draw_read(mode, arrays, None),
                Err(error) => c.error(error),
            }
        });
    }

    /// Does a command that draws arrays. Between `begin` and `end` it is an error, which a list being made remembers.
    fn draws(&mut self, draw: impl FnOnce(&mut Self)) {
        if self.immediate.active() {
            self.submit(|_| {});
        } else {
            draw(self);
        }
    }

    /// Nothing is to be drawn; a list remembers even that, which is an error between `begin` and `end`.
    fn draw_nothing(&mut self) {
        if self.compiling.is_some() {
            self.submit(|_| {});
        }
    }

    /// `glDrawElements` with numbers of vertices already read.
    pub fn draw_elements(&mut self, mode: Enum, elements: &[u32]) {
        self.draws(|c| {
            if mode > gl::POLYGON {
                return c.error(gl::INVALID_ENUM);
            }
            if elements.is_empty() || !c.client.vertex.enabled {
                return c.draw_nothing();
            }
            let (low, high) = elements.iter().fold((u32::MAX, 0), |(l, h), e| (l.min(*e), h.max(*e)));
            let (first, count) = (low as usize, (high - low) as usize + 1);
            if count / 4 > elements.len() + 64 {
                return c.draw_sparse(mode, elements);
            }
            match c.read_arrays(first, count, c.compiling.is_some()) {
                Ok(arrays) => {
                    let elements = elements.iter().map(|e| e - low).collect();
                    c.draw_read(mode, arrays, Some(elements));
                }
                Err(error) => c.error(error),
            }
        });
    }

    /// Few elements of arrays that reach far.
    fn draw_sparse(&mut self, mode: Enum, elements: &[u32]) {
        self.begin(mode);
        elements.iter().for_each(|e| match i32::try_from(*e) {
            Ok(e) => self.array_element(e),
            Err(_) => self.error(gl::INVALID_VALUE),
        });
        self.end();
    }

    /// `glDrawElements`: `count` numbers of type `kind` (`UNSIGNED_BYTE`, `UNSIGNED_SHORT`, `UNSIGNED_INT`), from `source`,
    /// where [`ArraySource::Buffer`] is the bound element buffer.
    pub fn draw_elements_of(&mut self, mode: Enum, count: i32, kind: Enum, source: &ArraySource) {
        self.draws(|c| {
            let Ok(count) = usize::try_from(count) else { return c.error(gl::INVALID_VALUE) };
            if mode > gl::POLYGON
                || !matches!(kind, gl::UNSIGNED_BYTE | gl::UNSIGNED_SHORT | gl::UNSIGNED_INT)
            {
                return c.error(gl::INVALID_ENUM);
            }
            if count == 0 || !c.client.vertex.enabled {
                return c.draw_nothing();
            }
            match c.read_elements(count, kind, source) {
                Ok(elements) => c.draw_elements(mode, &elements),
                Err(error) => c.error(error),
            }
        });
    }

    fn read_elements(&self, count: usize, kind: Enum, source: &ArraySource) -> Result<Vec<u32>, Enum> {
        let mut elements = Vec::new();
        let len = count.checked_mul(type_bytes(kind)).ok_or(gl::OUT_OF_MEMORY)?;
        let mut read = |bytes: &[u8]| {
            elements = match kind {
                gl::UNSIGNED_BYTE => bytes.iter().map(|b| u32::from(*b)).collect(),
                gl::UNSIGNED_SHORT => {
                    bytes.as_chunks().0.iter().map(|b| u32::from(u16::from_ne_bytes(*b))).collect()
                }
                _ => bytes.as_chunks().0.iter().map(|b| u32::from_ne_bytes(*b)).collect(),
            };
        };
        self.with_bytes(source, &self.client.element_buffer.1, 0, len, &mut read)?;
        Ok(elements)
    }

    /// Draws vertices read from arrays, or puts them into the list being made. Attributes that arrays gave are
    /// undefined afterwards; here they stay as they were.
    fn draw_read(&mut self, mode: Enum, arrays: VertexArrays, elements: Option<Arc<[u32]>>) {
        let Some(list) = &mut self.compiling else {
            return self.draw_indexed(mode, &arrays, elements);
        };
        let executes = list.executes();
        let arrays = Arc::new(arrays);
        let recorded = (Arc::clone(&arrays), elements.clone());
        list.push_call(move |c| c.draw_indexed(mode, &recorded.0, recorded.1.clone()));
        if executes {
            self.draw_indexed(mode, &arrays, elements);
        }
    }

    /// Reads `count` vertices from number `first` on from all enabled arrays that matter; with `all`, from all.
    fn read_arrays(&mut self, first: usize, count: usize, all: bool) -> Result<VertexArrays, Enum> {
        self.make_plan();
        let plan = &self.immediate.plan;
        let client = &self.client;
        let mut out = VertexArrays::default();
        if client.vertex.enabled {
            out.positions = self.read4(&client.vertex, first, count, false)?;
        }
        if client.normal.enabled && (all || plan.needs_normals) {
            out.normals = self.read(&client.normal, first, count, true, |[x, y, z, _]| [x, y, z])?;
        }
        if client.color.enabled && (all || plan.needs_colors()) {
            out.colors = self.read4(&client.color, first, count, true)?;
        }
        if client.secondary.enabled && (all || plan.needs_secondary()) {
            out.secondary = self.read(&client.secondary, first, count, true, |[x, y, z, _]| [x, y, z])?;
        }
        if client.fog_coord.enabled && (all || plan.needs_fog_coords()) {
            out.fog_coords = self.read(&client.fog_coord, first, count, false, |[v, ..]| v)?;
        }
        if client.edge_flag.enabled && (all || plan.needs_edges) {
            out.edge_flags = self.read(&client.edge_flag, first, count, false, |[v, ..]| v != 0.0)?;
        }
        for (unit, array) in client.tex_coords.iter().enumerate() {
            if array.enabled && (all || plan.needs_tex_coords(unit)) {
                out.tex_coords[unit] = self.read4(array, first, count, false)?;
            }
        }
        Ok(out)
    }

    fn read4(
        &self,
        a: &VertexArray,
        first: usize,
        count: usize,
        normalized: bool,
    ) -> Result<Vec<[f32; 4]>, Enum> {
        self.read(a, first, count, normalized, |v| v)
    }

    /// Reads elements of an array, with 0, 0, 0, 1 where it has fewer components.
    fn read<T>(
        &self,
        a: &VertexArray,
        first: usize,
        count: usize,
        normalized: bool,
        make: impl Fn([f32; 4]) -> T,
    ) -> Result<Vec<T>, Enum> {
        let (step, element) = (a.step(), a.size as usize * type_bytes(a.kind));
        let from = first.checked_mul(step).ok_or(gl::OUT_OF_MEMORY)?;
        let len =
            (count - 1).checked_mul(step).and_then(|n| n.checked_add(element)).ok_or(gl::OUT_OF_MEMORY)?;
        let mut out = Vec::new();
        out.try_reserve_exact(count).map_err(|_| gl::OUT_OF_MEMORY)?;
        let mut read = |bytes: &[u8]| {
            let elements = (0..count).map_while(|k| bytes.get(k * step..));
            match (a.kind, a.size) {
                (gl::FLOAT, 2) => out.extend(elements.map_while(floats::<2>).map(&make)),
                (gl::FLOAT, 3) => out.extend(elements.map_while(floats::<3>).map(&make)),
                (gl::FLOAT, 4) => out.extend(elements.map_while(floats::<4>).map(&make)),
                _ => {
                    let whole = elements.map_while(|bytes| bytes.get(..element));
                    out.extend(whole.map(|bytes| make(element_of(bytes, a.kind, normalized))));
                }
            }
        };
        self.with_bytes(&a.source, &a.buffer.1, from, len, &mut read)?;
        // What cannot be read is left out: the whole command is.
        if out.len() == count { Ok(out) } else { Err(gl::INVALID_OPERATION) }
    }

    fn with_bytes(
        &self,
        source: &ArraySource,
        buffer: &Option<Buffer>,
        from: usize,
        len: usize,
        read: &mut dyn FnMut(&[u8]),
    ) -> Result<(), Enum> {
        let end = from.checked_add(len).ok_or(gl::OUT_OF_MEMORY)?;
        match source {
            ArraySource::Owned(bytes) => read(bytes.get(from..end).ok_or(gl::INVALID_OPERATION)?),
            ArraySource::Address(0) => return Err(gl::INVALID_OPERATION),
            ArraySource::Address(at) => {
                let at = at.checked_add(from).ok_or(gl::INVALID_OPERATION)?;
                self.client.memory.as_ref().ok_or(gl::INVALID_OPERATION)?.with(at, len, read);
            }
            ArraySource::Buffer(offset) => {
                let buffer = lock(buffer.as_ref().ok_or(gl::INVALID_OPERATION)?);
                if buffer.mapped.is_some() {
                    return Err(gl::INVALID_OPERATION);
                }
                let at = offset.checked_add(from).ok_or(gl::INVALID_OPERATION)?;
                let bytes = at.checked_add(len).and_then(|end| buffer.bytes.get(at..end));
                read(bytes.ok_or(gl::INVALID_OPERATION)?);
            }
        }
        Ok(())
    }
}

impl ArraySource {
    /// So many bytes further on.
    fn at(&self, offset: usize) -> Self {
        match self {
            Self::Owned(bytes) => Self::Owned(bytes.get(offset..).unwrap_or_default().into()),
            Self::Address(at) => Self::Address(at.wrapping_add(offset)),
            Self::Buffer(at) => Self::Buffer(at.wrapping_add(offset)),
        }
    }
}

/// Sizes and types that an array may have.
fn allowed(name: Enum) -> (std::ops::RangeInclusive<i32>, &'static [Enum]) {
    use gl::{BYTE, DOUBLE, FLOAT, INT, SHORT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
    match name {
        gl::VERTEX_ARRAY => (2..=4, &[SHORT, INT, FLOAT, DOUBLE]),
        gl::TEXTURE_COORD_ARRAY => (1..=4, &[SHORT, INT, FLOAT, DOUBLE]),
        gl::NORMAL_ARRAY => (3..=3, &[BYTE, SHORT, INT, FLOAT, DOUBLE]),
        gl::COLOR_ARRAY | gl::SECONDARY_COLOR_ARRAY => {
            let sizes = if name == gl::COLOR_ARRAY { 3..=4 } else { 3..=3 };
            (sizes, &[BYTE, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, INT, UNSIGNED_INT, FLOAT, DOUBLE])
        }
        gl::FOG_COORD_ARRAY => (1..=1, &[FLOAT, DOUBLE]),
        gl::EDGE_FLAG_ARRAY => (1..=1, &[UNSIGNED_BYTE]),
        _ => (1..=1, &[UNSIGNED_BYTE, SHORT, INT, FLOAT, DOUBLE]),
    }
}

/// As [`element_of`], of `N` floats.
#[inline]
fn floats<const N: usize>(bytes: &[u8]) -> Option<[f32; 4]> {
    let mut out = [0.0, 0.0, 0.0, 1.0];
    for (to, from) in out.iter_mut().zip(bytes.as_chunks::<4>().0.first_chunk::<N>()?) {
        *to = f32::from_ne_bytes(*from);
    }
    Some(out)
}

/// The components of an element.
#[inline]
fn element_of(bytes: &[u8], kind: Enum, normalized: bool) -> [f32; 4] {
    use crate::component::Component;
    let mut out = [0.0, 0.0, 0.0, 1.0];
    fn each<const N: usize, T: Component>(
        out: &mut [f32; 4],
        bytes: &[u8],
        normalized: bool,
        number: impl Fn([u8; N]) -> T,
    ) {
        for (to, from) in out.iter_mut().zip(bytes.as_chunks::<N>().0) {
            let v = number(*from);
            *to = if normalized { v.normalized() } else { v.value() };
        }
    }
    match kind {
        gl::FLOAT => each(&mut out, bytes, normalized, f32::from_ne_bytes),
        gl::UNSIGNED_BYTE => each(&mut out, bytes, normalized, |b: [u8; 1]| b[0]),
        gl::BYTE => each(&mut out, bytes, normalized, i8::from_ne_bytes),
        gl::SHORT => each(&mut out, bytes, normalized, i16::from_ne_bytes),
        gl::UNSIGNED_SHORT => each(&mut out, bytes, normalized, u16::from_ne_bytes),
        gl::INT => each(&mut out, bytes, normalized, i32::from_ne_bytes),
        gl::UNSIGNED_INT => each(&mut out, bytes, normalized, u32::from_ne_bytes),
        _ => each(&mut out, bytes, normalized, f64::from_ne_bytes),
    }
    out
}

/// Size, type and offset of an interleaved array's part.
type Part = (i32, Enum, usize);

/// A format of interleaved arrays (OpenGL 1.5, table 2.5).
struct Interleaved {
    tex_coord: Option<Part>,
    color: Option<Part>,
    normal: Option<Part>,
    vertex: Part,
    bytes: usize,
}

impl Interleaved {
    fn of(format: Enum) -> Option<Self> {
        // Texture coordinates, colour (negative: four bytes), normal, vertex: how many numbers of each.
        let (t, c, n, v) = match format {
            gl::V2F => (0, 0, 0, 2),
            gl::V3F => (0, 0, 0, 3),
            gl::C4UB_V2F => (0, -4, 0, 2),
            gl::C4UB_V3F => (0, -4, 0, 3),
            gl::C3F_V3F => (0, 3, 0, 3),
            gl::N3F_V3F => (0, 0, 3, 3),
            gl::C4F_N3F_V3F => (0, 4, 3, 3),
            gl::T2F_V3F => (2, 0, 0, 3),
            gl::T4F_V4F => (4, 0, 0, 4),
            gl::T2F_C4UB_V3F => (2, -4, 0, 3),
            gl::T2F_C3F_V3F => (2, 3, 0, 3),
            gl::T2F_N3F_V3F => (2, 0, 3, 3),
            gl::T2F_C4F_N3F_V3F => (2, 4, 3, 3),
            gl::T4F_C4F_N3F_V4F => (4, 4, 3, 4),
            _ => return None,
        };
        let mut at = 0;
        let mut take = |count: i32| {
            let (kind, bytes) =
                if count < 0 { (gl::UNSIGNED_BYTE, 4) } else { (gl::FLOAT, 4 * count as usize) };
            let part = (count.abs(), kind, at);
            at += bytes;
            (count != 0).then_some(part)
        };
        let (tex_coord, color, normal) = (take(t), take(c), take(n));
        let vertex = take(v)?;
        Some(Self { tex_coord, color, normal, vertex, bytes: at })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;

    #[test]
    fn interleaved_formats_have_the_specified_offsets() {
        let f = Interleaved::of(gl::T2F_C4UB_V3F).unwrap();
        assert_eq!((f.tex_coord, f.color), (Some((2, gl::FLOAT, 0)), Some((4, gl::UNSIGNED_BYTE, 8))));
        assert_eq!((f.normal, f.vertex, f.bytes), (None, (3, gl::FLOAT, 12), 24));
        let f = Interleaved::of(gl::T4F_C4F_N3F_V4F).unwrap();
        assert_eq!((f.normal, f.vertex, f.bytes), (Some((3, gl::FLOAT, 32)), (4, gl::FLOAT, 44), 60));
        assert!(Interleaved::of(gl::FLOAT).is_none());
    }

    #[test]
    fn floats_are_read_as_elements_of_any_type_are() {
        let bytes: Vec<u8> =
            [1.5f32, -2.0, f32::NAN, 0.1, 7.0].iter().flat_map(|v| v.to_ne_bytes()).collect();
        let bits = |v: [f32; 4]| v.map(f32::to_bits);
        let plain = |n: usize| bits(element_of(&bytes[..4 * n], gl::FLOAT, true));
        assert_eq!(floats::<2>(&bytes).map(bits), Some(plain(2)));
        assert_eq!(floats::<3>(&bytes).map(bits), Some(plain(3)));
        assert_eq!(floats::<4>(&bytes).map(bits), Some(plain(4)));
        assert_eq!(floats::<3>(&bytes[..11]), None);
    }

    #[test]
    fn buffers_keep_their_bytes_and_their_rules() {
        let mut c = Context::new(Config::default());
        let name = c.gen_buffers(1)[0];
        assert!(!c.is_buffer(name));
        c.bind_buffer(gl::ARRAY_BUFFER, name);
        assert!(c.is_buffer(name));
        c.buffer_data(gl::ARRAY_BUFFER, 8, Some(&[1, 2, 3, 4, 5, 6, 7, 8]), gl::STATIC_DRAW);
        c.buffer_sub_data(gl::ARRAY_BUFFER, 2, &[9, 9]);
        let mut read = [0; 4];
        c.get_buffer_sub_data(gl::ARRAY_BUFFER, 1, &mut read);
        assert_eq!(read, [2, 9, 9, 5]);
        c.buffer_sub_data(gl::ARRAY_BUFFER, 7, &[0, 0]);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        assert!(c.map_buffer(gl::ARRAY_BUFFER, gl::READ_ONLY).is_some());
        c.buffer_sub_data(gl::ARRAY_BUFFER, 0, &[0]);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
        assert!(c.unmap_buffer(gl::ARRAY_BUFFER));
        assert_eq!(c.get_buffer_parameter(gl::ARRAY_BUFFER, gl::BUFFER_SIZE), 8);
        c.delete_buffers(&[name]);
        c.buffer_data(gl::ARRAY_BUFFER, 1, None, gl::STATIC_DRAW);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    }
}
