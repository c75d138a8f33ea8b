//! From statements to arrays as they stand in the file.

use std::collections::HashMap;

use senca_scene::math::glam::{Vec2, Vec3, Vec4};

use super::freeform::{Basis, Freeform, FreeformSurface};
use crate::ReadError;
use crate::text::Cursor;

/// No texture coordinate or no normal.
pub(super) const NONE: u32 = u32::MAX;

/// Most warnings that are kept.
const WARNINGS: usize = 20;

/// Smoothing group in force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum Smoothing {
    /// Never mentioned.
    #[default]
    Unsaid,
    /// `s off` or `s 0`.
    Off,
    /// A numbered group.
    Group(u32),
}

/// What faces of one surface have in common.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct SurfaceKey {
    pub(super) object: u32,
    pub(super) material: Option<String>,
    pub(super) smoothing: Smoothing,
}

/// Faces in a row that share a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub(super) first_face: u32,
    pub(super) surface: u32,
}

/// One corner: indices of position, texture coordinate and normal, the latter two maybe [`NONE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) point: u32,
    pub(super) texcoord: u32,
    pub(super) normal: u32,
}

/// Corners of all faces; `texcoord` and `normal` are empty until the first comes, then as long as
/// `point`.
#[derive(Debug, Default)]
pub(super) struct Corners {
    pub(super) point: Vec<u32>,
    pub(super) texcoord: Vec<u32>,
    pub(super) normal: Vec<u32>,
}

impl Corners {
    #[cold]
    fn attach(&mut self, texcoord: u32, normal: u32) {
        let count = self.point.len();
        for (all, one) in [(&mut self.texcoord, texcoord), (&mut self.normal, normal)] {
            if one != NONE && all.is_empty() {
                all.resize(count, NONE);
            }
        }
    }

    #[inline]
    fn push(&mut self, corner: Corner) {
        if (corner.texcoord != NONE && self.texcoord.is_empty())
            || (corner.normal != NONE && self.normal.is_empty())
        {
            self.attach(corner.texcoord, corner.normal);
        }
        let had_corners = !self.point.is_empty();
        self.point.push(corner.point);
        if !self.texcoord.is_empty() || (!had_corners && corner.texcoord != NONE) {
            self.texcoord.push(corner.texcoord);
        }
        if !self.normal.is_empty() || (!had_corners && corner.normal != NONE) {
            self.normal.push(corner.normal);
        }
    }

    fn truncate(&mut self, count: usize) {
        self.point.truncate(count);
        self.texcoord.truncate(count);
        self.normal.truncate(count);
    }
}

/// Indices above those that were there when they were named. Only ones larger than all before can
/// be the first that the whole file does not bear out.
#[derive(Debug, Default)]
struct Forward(Vec<(u32, usize)>);

impl Forward {
    #[cold]
    fn note(&mut self, index: u32, pos: usize) {
        if self.0.last().is_none_or(|&(largest, _)| index > largest) {
            self.0.push((index, pos));
        }
    }

    /// The first place that names an index not below `count`.
    fn first_beyond(&self, count: usize) -> Option<(u32, usize)> {
        self.0.iter().copied().find(|&(index, _)| index as usize >= count)
    }
}

/// A file's content before vertices are made of it.
#[derive(Debug, Default)]
pub(super) struct Soup {
    pub(super) points: Vec<Vec3>,
    /// Colours as written, with alpha; empty or as long as `points`.
    pub(super) colors: Vec<Vec4>,
    /// Weights of control points; missing ones are 1.
    pub(super) weights: Vec<f32>,
    pub(super) texcoords: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) corners: Corners,
    /// First corner of every face and the end; empty while all are triangles.
    pub(super) starts: Vec<u32>,
    pub(super) face_count: u32,
    pub(super) runs: Vec<Run>,
    /// Segments with the object they belong to.
    pub(super) lines: Vec<([Corner; 2], u32)>,
    /// Dots with the object they belong to.
    pub(super) dots: Vec<(Corner, u32)>,
    pub(super) freeforms: Vec<FreeformSurface>,
    pub(super) objects: Vec<String>,
    pub(super) surfaces: Vec<SurfaceKey>,
    /// Name of the only group on each surface; empty where there are several.
    pub(super) surface_names: Vec<String>,
    pub(super) libraries: Vec<String>,
    pub(super) warnings: Vec<String>,
}

struct Parser<'a> {
    cursor: Cursor<'a>,
    soup: Soup,
    now: SurfaceKey,
    group: String,
    freeform: Freeform,
    /// Whether `now` changed since the last face.
    stale: bool,
    surface_numbers: HashMap<SurfaceKey, u32>,
    object_numbers: HashMap<String, u32>,
    forward: [Forward; 3],
    warned: HashMap<String, ()>,
}

/// Reads all statements.
pub(super) fn parse(name: &str, bytes: &[u8]) -> Result<Soup, ReadError> {
    let mut parser = Parser {
        cursor: Cursor::with_continuation(name, bytes),
        soup: Soup { objects: vec![String::new()], ..Soup::default() },
        now: SurfaceKey::default(),
        group: String::new(),
        freeform: Freeform::default(),
        stale: true,
        surface_numbers: HashMap::new(),
        object_numbers: HashMap::new(),
        forward: Default::default(),
        warned: HashMap::new(),
    };
    let guess = bytes.len() / 70;
    parser.soup.points.reserve(guess);
    parser.soup.corners.point.reserve(6 * guess);
    let mut known = 0usize;
    while parser.cursor.start_line() {
        known += usize::from(parser.statement()?);
        parser.cursor.next_line();
    }
    parser.finish(known, bytes)
}

impl Parser<'_> {
    /// Reads one statement; false if it is none of the format.
    #[inline]
    fn statement(&mut self) -> Result<bool, ReadError> {
        match *self.cursor.rest() {
            [b'v', b' ' | b'\t', ..] => {
                self.cursor.pos += 2;
                self.position()?;
            }
            [b'f', b' ' | b'\t', ..] => {
                self.cursor.pos += 2;
                self.face()?;
            }
            [b'#', ..] => return Ok(false),
            _ => return self.other_statement(),
        }
        Ok(true)
    }

    fn other_statement(&mut self) -> Result<bool, ReadError> {
        let start = self.cursor.pos;
        let word = self.cursor.word();
        match word {
            b"vt" => self.texcoord()?,
            b"vn" => self.normal()?,
            b"v" => self.position()?,
            b"f" | b"fo" => self.face()?,
            b"l" => self.line()?,
            b"p" => self.dots()?,
            b"o" => self.object(),
            b"g" => {
                self.group = self.cursor.rest_of_line();
                self.stale = true;
            }
            b"s" => self.smoothing()?,
            b"usemtl" => {
                self.now.material = Some(self.cursor.rest_of_line()).filter(|name| !name.is_empty());
                self.stale = true;
            }
            b"mtllib" => {
                let library = self.cursor.rest_of_line();
                self.soup.libraries.push(library);
            }
            b"cstype" => self.basis(),
            b"deg" => self.degree()?,
            b"surf" => self.surface_statement(start)?,
            b"parm" => self.parameters()?,
            b"end" => self.end_freeform()?,
            b"step" | b"bmat" => {}
            b"curv" | b"curv2" | b"trim" | b"hole" | b"scrv" | b"sp" | b"con" => {
                let word = String::from_utf8_lossy(word);
                self.warn_once(start, &format!("\"{word}\" is passed over: curves and trims are not drawn"));
            }
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj" | b"usemap"
            | b"maplib" | b"mg" | b"vp" | b"ctech" | b"stech" => {}
            _ => {
                self.unknown(start, word);
                return Ok(false);
            }
        }
        Ok(true)
    }

    #[cold]
    fn unknown(&mut self, start: usize, word: &[u8]) {
        let word: String = String::from_utf8_lossy(word).chars().take(30).collect();
        self.warn_once(start, &format!("the statement \"{}\" is not known", word.escape_debug()));
    }

    /// Warns of `what` the first time.
    #[cold]
    fn warn_once(&mut self, pos: usize, what: &str) {
        if self.soup.warnings.len() < WARNINGS && self.warned.insert(what.to_owned(), ()).is_none() {
            self.soup.warnings.push(format!("{}: {what}", self.cursor.location(pos)));
        }
    }

    #[inline]
    fn position(&mut self) -> Result<(), ReadError> {
        let x = self.cursor.f32("x of a position")?;
        let y = self.cursor.f32("y of a position")?;
        let z = self.cursor.f32("z of a position")?;
        self.soup.points.push(Vec3::new(x, y, z));
        if self.cursor.number_follows() {
            return self.position_extras();
        }
        if !self.soup.colors.is_empty() {
            self.soup.colors.push(Vec4::ONE);
        }
        self.end_of_statement()
    }

    /// Weight or colour behind a position.
    #[cold]
    fn position_extras(&mut self) -> Result<(), ReadError> {
        let mut extras = [1.0; 4];
        let mut count = 0;
        while count < 4 && self.cursor.number_follows() {
            extras[count] = self.cursor.f32("a number")?;
            count += 1;
        }
        if count == 1 {
            self.soup.weights.resize(self.soup.points.len() - 1, 1.0);
            self.soup.weights.push(extras[0]);
        }
        let colored = count >= 3;
        if colored || !self.soup.colors.is_empty() {
            self.soup.colors.resize(self.soup.points.len() - 1, Vec4::ONE);
            self.soup.colors.push(if colored { Vec4::from(extras) } else { Vec4::ONE });
        }
        self.end_of_statement()
    }

    fn texcoord(&mut self) -> Result<(), ReadError> {
        let u = self.cursor.f32("u of a texture coordinate")?;
        let v =
            if self.cursor.number_follows() { self.cursor.f32("v of a texture coordinate")? } else { 0.0 };
        if self.cursor.number_follows() {
            self.cursor.f32("w of a texture coordinate")?;
        }
        self.soup.texcoords.push(Vec2::new(u, 1.0 - v));
        self.end_of_statement()
    }

    fn normal(&mut self) -> Result<(), ReadError> {
        let x = self.cursor.f32("x of a normal")?;
        let y = self.cursor.f32("y of a normal")?;
        let z = self.cursor.f32("z of a normal")?;
        self.soup.normals.push(Vec3::new(x, y, z));
        self.end_of_statement()
    }

    /// Makes sure that nothing but a comment is left on the line.
    #[inline]
    fn end_of_statement(&mut self) -> Result<(), ReadError> {
        self.cursor.skip_blanks();
        if self.cursor.at_line_end() || self.cursor.peek() == Some(b'#') {
            return Ok(());
        }
        Err(self.cursor.expected("the end of the line"))
    }

    #[inline]
    fn face(&mut self) -> Result<(), ReadError> {
        let start = self.cursor.pos;
        let first = self.soup.corners.point.len();
        while let Some(corner) = self.corner()? {
            self.soup.corners.push(corner);
        }
        let count = self.soup.corners.point.len() - first;
        if count < 3 {
            self.soup.corners.truncate(first);
            self.warn_once(start, "a face needs at least three corners; left out");
            return Ok(());
        }
        if self.stale {
            self.enter_surface();
        }
        self.soup.face_count += 1;
        if !self.soup.starts.is_empty() {
            self.soup.starts.push((first + count) as u32);
        } else if count != 3 {
            self.soup.starts.extend((0..self.soup.face_count).map(|face| 3 * face));
            self.soup.starts.push((first + count) as u32);
        }
        Ok(())
    }

    /// The next corner on this line, `None` at its end.
    #[inline]
    fn corner(&mut self) -> Result<Option<Corner>, ReadError> {
        self.cursor.skip_blanks();
        let pos = self.cursor.pos;
        let Some(index) = self.cursor.index() else {
            self.end_of_statement()?;
            return Ok(None);
        };
        let point = self.resolve(index, 0, pos)?;
        let mut corner = Corner { point, texcoord: NONE, normal: NONE };
        if self.cursor.peek() == Some(b'/') {
            corner.texcoord = self.reference(1)?;
            if self.cursor.peek() == Some(b'/') {
                corner.normal = self.reference(2)?;
            }
        }
        match self.cursor.peek() {
            None | Some(b' ' | b'\n' | b'\r' | b'\t' | b'#' | b'\\') => Ok(Some(corner)),
            _ => Err(self.cursor.expected("a blank after a corner")),
        }
    }

    /// The reference behind a slash, [`NONE`] if there is none.
    #[inline]
    fn reference(&mut self, kind: usize) -> Result<u32, ReadError> {
        self.cursor.pos += 1;
        let pos = self.cursor.pos;
        match self.cursor.index() {
            Some(index) => self.resolve(index, kind, pos),
            None => Ok(NONE),
        }
    }

    /// Index from 0 of a reference: from 1 forwards or from -1 backwards.
    #[inline]
    fn resolve(&mut self, index: i64, kind: usize, pos: usize) -> Result<u32, ReadError> {
        let count = self.count_of(kind);
        let resolved = if index > 0 { index - 1 } else { count as i64 + index };
        if index == 0 || resolved < 0 || resolved >= i64::from(u32::MAX) {
            return Err(self.out_of_range(index, kind, pos));
        }
        if resolved as usize >= count {
            self.forward[kind].note(resolved as u32, pos);
        }
        Ok(resolved as u32)
    }

    #[inline]
    fn count_of(&self, kind: usize) -> usize {
        match kind {
            0 => self.soup.points.len(),
            1 => self.soup.texcoords.len(),
            _ => self.soup.normals.len(),
        }
    }

    #[cold]
    fn out_of_range(&self, index: i64, kind: usize, pos: usize) -> ReadError {
        let what = ["vertex", "texture coordinate", "normal"][kind];
        let message = match (index, self.count_of(kind)) {
            (0, _) => format!("{what} 0: indices count from 1, or from -1 backwards"),
            (_, 0) => format!("{what} {index} is out of range: there is none"),
            (_, count) => format!("{what} {index} is out of range: there are {count}"),
        };
        self.cursor.malformed(pos, message)
    }

    #[cold]
    fn enter_surface(&mut self) {
        self.stale = false;
        let next = self.soup.surfaces.len() as u32;
        let surface = *self.surface_numbers.entry(self.now.clone()).or_insert(next);
        if surface == next {
            self.soup.surfaces.push(self.now.clone());
            self.soup.surface_names.push(self.group.clone());
        } else if self.soup.surface_names[surface as usize] != self.group {
            self.soup.surface_names[surface as usize].clear();
        }
        if self.soup.runs.last().is_none_or(|run| run.surface != surface) {
            self.soup.runs.push(Run { first_face: self.soup.face_count, surface });
        }
    }

    fn line(&mut self) -> Result<(), ReadError> {
        let Some(mut from) = self.corner()? else { return Err(self.cursor.expected("a vertex index")) };
        while let Some(to) = self.corner()? {
            self.soup.lines.push(([from, to], self.now.object));
            from = to;
        }
        Ok(())
    }

    fn dots(&mut self) -> Result<(), ReadError> {
        while let Some(corner) = self.corner()? {
            self.soup.dots.push((corner, self.now.object));
        }
        Ok(())
    }

    fn object(&mut self) {
        let name = self.cursor.rest_of_line();
        let next = self.soup.objects.len() as u32;
        self.now.object = *self.object_numbers.entry(name.clone()).or_insert(next);
        if self.now.object == next {
            self.soup.objects.push(name);
        }
        self.stale = true;
    }

    fn smoothing(&mut self) -> Result<(), ReadError> {
        self.cursor.skip_blanks();
        let start = self.cursor.pos;
        self.now.smoothing = match self.cursor.word() {
            b"off" | b"0" => Smoothing::Off,
            b"on" => Smoothing::Group(1),
            word => {
                let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
                let Some(number) = number else {
                    self.cursor.pos = start;
                    return Err(self.cursor.expected("the number of a smoothing group or \"off\""));
                };
                Smoothing::Group(number)
            }
        };
        self.stale = true;
        Ok(())
    }

    fn basis(&mut self) {
        self.cursor.skip_blanks();
        self.freeform.rational = self.cursor.rest().starts_with(b"rat ");
        if self.freeform.rational {
            self.cursor.word();
            self.cursor.skip_blanks();
        }
        self.freeform.basis = match self.cursor.word() {
            b"bezier" => Basis::Bezier,
            b"bspline" => Basis::BSpline,
            _ => Basis::Other,
        };
    }

    fn degree(&mut self) -> Result<(), ReadError> {
        self.freeform.degree = [self.cursor.count("the degree in u")?; 2];
        if self.cursor.number_follows() {
            self.freeform.degree[1] = self.cursor.count("the degree in v")?;
        }
        Ok(())
    }

    fn surface_statement(&mut self, start: usize) -> Result<(), ReadError> {
        for i in 0..4 {
            self.freeform.range[i] = self.cursor.f64("an end of the parameter range")?;
        }
        self.freeform.pos = start;
        self.freeform.control.clear();
        self.freeform.parameters = Default::default();
        while let Some(corner) = self.corner()? {
            self.freeform.control.push(corner.point);
        }
        Ok(())
    }

    fn parameters(&mut self) -> Result<(), ReadError> {
        self.cursor.skip_blanks();
        let direction = match self.cursor.peek() {
            Some(b'u') => 0,
            Some(b'v') => 1,
            _ => return Err(self.cursor.expected("the direction \"u\" or \"v\"")),
        };
        self.cursor.pos += 1;
        while self.cursor.number_follows() {
            let value = self.cursor.f64("a parameter")?;
            self.freeform.parameters[direction].push(value);
        }
        self.end_of_statement()
    }

    /// Makes the surface, if there is one: curves end here too.
    fn end_freeform(&mut self) -> Result<(), ReadError> {
        if self.freeform.control.is_empty() {
            return Ok(());
        }
        let pos = self.freeform.pos;
        if self.freeform.basis == Basis::Other {
            self.warn_once(pos, "a surface in another basis than Bézier and B-spline is left out");
        } else {
            if self.freeform.is_cut() {
                self.warn_once(
                    pos,
                    "a surface is drawn over its whole parameter range, not the part that is named",
                );
            }
            let shape =
                self.freeform.shape(&self.soup).map_err(|message| self.cursor.malformed(pos, message))?;
            let (key, name) = (self.now.clone(), self.group.clone());
            self.soup.freeforms.push(FreeformSurface { shape, key, name });
        }
        self.freeform.control.clear();
        Ok(())
    }

    fn finish(self, known: usize, bytes: &[u8]) -> Result<Soup, ReadError> {
        for kind in 0..3 {
            if let Some((index, pos)) = self.forward[kind].first_beyond(self.count_of(kind)) {
                return Err(self.out_of_range(i64::from(index) + 1, kind, pos));
            }
        }
        let blank = bytes.iter().all(u8::is_ascii_whitespace);
        if known == 0 && (blank || !self.soup.warnings.is_empty()) {
            return Err(self.cursor.malformed(0, "no statement of an OBJ file is here"));
        }
        Ok(self.soup)
    }
}
