//! The renderer's main program (1991 thesis, section 12.2).

use senca_io::classic::{ClassicOperation, ClassicScene, IndexBitmap, IntegerWidth};
use senca_io::{Location, ReadError};
use senca_math::ViewError;

use super::database::Database;
use super::device::empty_bitmap;
use super::shade::{Ranges, ShadeStyle, shade};
use super::view::DeviceView;
use super::wireframe::{NormalsDrawn, WireStyle, draw_normals, draw_wireframe};

/// Most pixels of a bitmap: a square of 8192.
const MAX_PIXELS: u64 = 1 << 26;

/// Settings of the renderer that its scene file does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Number of colour indices, 2 to 65536: 16 on a PC of the time, 256 with eight bit planes.
    /// Default 16.
    pub colors: u32,
    /// Width of the integers that depth has: 16 bits on a PC, 32 on a VAX. Default 32.
    pub width: IntegerWidth,
    /// Whether polygons that turn their back are drawn too. Default: no, as the text has it; with
    /// `as_printed` faces are, and edges are not.
    pub back_faces: Option<bool>,
    /// Whether polygons end at the sides of the window and at the planes F and B. Default no.
    pub clip: bool,
    /// Which normals the wireframe with normals shows.
    pub normals: NormalsDrawn,
    /// Width and height of the screen; a scene that wants more rows is refused, and so are more
    /// columns unless `as_printed`. Default none.
    pub screen: Option<[u32; 2]>,
    /// What has a range of colour indices of its own. Default the scene.
    pub ranges: Ranges,
    /// After Phong, the cosine from which highlights begin: polygons that cannot have it are shaded after
    /// Gouraud, which is cheaper. Default none: all are shaded after Phong.
    pub highlight: Option<f64>,
    /// Whether the listing is followed where it differs from the text. Default no.
    pub as_printed: bool,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            colors: 16,
            width: IntegerWidth::Bits32,
            back_faces: None,
            clip: false,
            normals: NormalsDrawn::default(),
            screen: None,
            ranges: Ranges::default(),
            highlight: None,
            as_printed: false,
        }
    }
}

/// What the renderer makes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rendering {
    /// Edges, and normals if they were asked for; always drawn first.
    pub wireframe: IndexBitmap,
    /// Faces, for the operations 2 and 3.
    pub shaded: Option<IndexBitmap>,
    /// Figures.
    pub report: RenderReport,
}

impl Rendering {
    /// The picture that the operation asks for.
    #[must_use]
    pub fn picture(&self) -> &IndexBitmap {
        self.shaded.as_ref().unwrap_or(&self.wireframe)
    }
}

/// Figures of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RenderReport {
    /// Vertices of all objects.
    pub vertices: usize,
    /// Polygons of all objects.
    pub polygons: usize,
    /// Surfaces of all objects.
    pub surfaces: usize,
    /// Vertex normals of all objects.
    pub normals: usize,
    /// Polygons that turn their back.
    pub culled: usize,
    /// Polygons that were shaded after Phong.
    pub after_phong: usize,
    /// Ranges of colour indices.
    pub ranges: u32,
    /// Pixels of the picture with each colour index.
    pub histogram: Vec<u64>,
}

/// Why the renderer gave up.
#[derive(Debug, thiserror::Error)]
pub enum ThesisError {
    /// A file is wrong, or a setting does not fit it.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The scene file describes no view.
    #[error("{name}: {source}")]
    View {
        /// The scene file.
        name: String,
        /// What is wrong with the view.
        source: ViewError,
    },
    /// A number of colours that is not 2 to 65536.
    #[error("{0} colours: there must be 2 to 65536")]
    Colors(u32),
    /// Too few colours for the ranges of the scene.
    #[error("{colors} colours are too few for {ranges} ranges: with the background they take {}", 2 * ranges + 1)]
    Ranges {
        /// Number of colours.
        colors: u32,
        /// Ranges of the scene, each of at least two colours.
        ranges: u32,
    },
}

/// Draws the scene with its database: places all vertices, makes normals, marks the polygons that turn
/// their back, draws edges and then, if the operation says so, faces. `name` is the scene file's.
///
/// # Errors
/// [`ThesisError`], with the line of the scene file for a raster that is too large, and that of the
/// object file for a polygon without a normal.
pub fn render(
    name: &str,
    scene: &ClassicScene,
    database: &mut Database,
    settings: &RenderSettings,
) -> Result<Rendering, ThesisError> {
    if !(2..=65_536).contains(&settings.colors) {
        return Err(ThesisError::Colors(settings.colors));
    }
    check_raster(name, scene, settings)?;
    let ranges = settings.ranges.count(database);
    let range = (settings.colors - 1) / ranges;
    if ranges > 1 && range < 2 {
        return Err(ThesisError::Ranges { colors: settings.colors, ranges });
    }
    database.place();
    let view = view(name, scene, database, settings)?;
    for vertex in database.objects.iter_mut().flat_map(|object| &mut object.vertices) {
        vertex.screen = view.screen(view.normalized(vertex.world));
    }
    database.compute_normals()?;
    database.cull(&view.kind);
    let wireframe = wireframe(scene, database, &view, settings);
    let faces = matches!(scene.operation, ClassicOperation::Phong | ClassicOperation::Gouraud);
    let shaded = scene.light.filter(|_| faces).map(|light| {
        let style = ShadeStyle {
            raster: raster(scene),
            colors: range + 1,
            ranges: settings.ranges,
            highlight: settings.highlight,
            light: light.normalize_or_zero(),
            culled: settings.back_faces.unwrap_or(settings.as_printed),
            clip: settings.clip,
            width: settings.width,
            as_printed: settings.as_printed,
        };
        shade(database, &view, scene.operation, &style)
    });
    let (shaded, after_phong) = shaded.unzip();
    let report = RenderReport {
        after_phong: after_phong.unwrap_or(0),
        ranges,
        ..report(database, shaded.as_ref().unwrap_or(&wireframe), settings.colors)
    };
    Ok(Rendering { wireframe, shaded, report })
}

fn raster(scene: &ClassicScene) -> [u32; 2] {
    [scene.raster_width(), scene.raster_height]
}

/// The raster height stands on line 8 of the scene file.
fn check_raster(name: &str, scene: &ClassicScene, settings: &RenderSettings) -> Result<(), ReadError> {
    let at = || Location::text(name, 8, 1);
    let [width, height] = raster(scene);
    let wanted = format!("{width} x {height} pixels");
    if width == 0 {
        return Err(ReadError::malformed(at(), format!("the window is too narrow: it gives {wanted}")));
    }
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(ReadError::limit(
            at(),
            format!("{wanted} are more than the limit of {MAX_PIXELS} pixels"),
        ));
    }
    let Some([screen_width, screen_height]) = settings.screen else { return Ok(()) };
    if height > screen_height || (width > screen_width && !settings.as_printed) {
        let message =
            format!("cannot get the desired screen resolution: {wanted} on {screen_width} x {screen_height}");
        return Err(ReadError::limit(at(), message));
    }
    Ok(())
}

fn view(
    name: &str,
    scene: &ClassicScene,
    database: &Database,
    settings: &RenderSettings,
) -> Result<DeviceView, ThesisError> {
    let view = if settings.as_printed {
        DeviceView::as_printed(scene, settings.width)
    } else {
        let extent = if settings.clip { None } else { Some(extent(scene, database)) };
        DeviceView::new(scene, extent, settings.width)
    };
    view.map_err(|source| ThesisError::View { name: name.to_owned(), source })
}

/// Least and greatest distance of vertices from VRP along VPN.
fn extent(scene: &ClassicScene, database: &Database) -> (f64, f64) {
    let towards = scene.vpn.normalize_or_zero();
    let vertices = database.objects.iter().flat_map(|object| &object.vertices);
    let distances = vertices.map(|vertex| (vertex.world - scene.vrp).dot(towards));
    distances.fold((0.0, 0.0), |(least, greatest), d| (d.min(least), d.max(greatest)))
}

fn wireframe(
    scene: &ClassicScene,
    database: &Database,
    view: &DeviceView,
    settings: &RenderSettings,
) -> IndexBitmap {
    let [width, height] = raster(scene);
    let mut bitmap = empty_bitmap(width, height);
    let style = WireStyle {
        index: settings.colors - 1,
        raster: [width, height],
        culled: settings.back_faces.unwrap_or(false),
        clip: settings.clip,
    };
    draw_wireframe(&mut bitmap, database, view, &style);
    if scene.operation == ClassicOperation::WireframeWithNormals {
        draw_normals(&mut bitmap, database, view, &style, scene.window[0], settings.normals);
    }
    bitmap
}

fn report(database: &Database, picture: &IndexBitmap, colors: u32) -> RenderReport {
    let [vertices, polygons, surfaces, normals] = database.counts();
    let mut histogram = vec![0; colors as usize];
    for &index in &picture.indices {
        histogram[index as usize] += 1;
    }
    let all = database.objects.iter().flat_map(|object| &object.polygons);
    let culled = all.filter(|polygon| polygon.culled).count();
    RenderReport { vertices, polygons, surfaces, normals, culled, histogram, ..RenderReport::default() }
}

#[cfg(test)]
mod tests;
