//! Interactive programs: in a window, replayed from a script, or straight into a picture.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};
use senca::Image;
use senca::io::images::{PictureFormat, PictureOptions, encode};
use senca::math::Srgb8;
use senca_window::desktop::{self, DesktopError};
use senca_window::{Canvas, Event, Program, Script, Session};

use super::indexed::indexed_png;
use super::input::read_text;
use super::output::{self, check_writable, is_standard, tell};
use super::values::Size;
use super::{Failure, Interrupt};

/// Most pictures that Ctrl+S writes beside each other.
const MAX_SAVED: u32 = 10_000;

/// How an interactive program is run; flattened into the arguments of its subcommand.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Window and picture")]
pub(crate) struct InteractiveArguments {
    /// Opens a window, after the script if there is one; Ctrl+S saves the picture [default: without
    /// --script and -o]
    #[arg(long)]
    pub(crate) window: bool,

    /// Replays a session without a display, from a text with one command a line: key NAME, down NAME, up NAME,
    /// type TEXT, press|release|click [BUTTON] X Y, drag [BUTTON] X Y X Y, move X Y, wheel N, size W H,
    /// tick SECONDS [TIMES], save FILE, quit; - is standard input
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) script: Option<PathBuf>,

    /// Writes the last picture: of the script, of the window, or the one the program begins with. The
    /// extension tells the format; - is standard output, as PNG
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,

    /// Width and height in pixels [default: the program's own]
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<Size>,
}

/// Runs a program as the arguments say. `name` is what its pictures are called that Ctrl+S saves.
///
/// Without any of the arguments a window is opened; where there is no display, the message says what else there
/// is.
pub(crate) fn run(
    program: &mut dyn Program,
    name: &str,
    arguments: &InteractiveArguments,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let script = arguments.script.as_deref().map(read_script).transpose()?;
    let files = script.iter().flat_map(Script::files).map(Path::new);
    for path in files.chain(arguments.output.as_deref()) {
        format_of(path)?;
        check_writable(path)?;
    }

    let mut session = Session::new(program);
    if let Some(Size { width, height }) = arguments.size {
        if width as usize > senca_window::MAX_SIDE
            || height as usize > senca_window::MAX_SIDE
            || width as usize * height as usize > senca_window::MAX_PIXELS
        {
            return Err(Failure::usage(format!(
                "--size {width}x{height}: windows have sides up to {} pixels, and up to {} of them",
                senca_window::MAX_SIDE,
                senca_window::MAX_PIXELS
            )));
        }
        session.event(Event::Resize(width as usize, height as usize));
    }
    if let Some(script) = &script {
        script.replay(&mut session, |file, canvas| write(Path::new(file), canvas, interrupt))?;
    }
    let picture = if arguments.window || (script.is_none() && arguments.output.is_none()) {
        let place = arguments.output.as_deref().filter(|path| !is_standard(path));
        desktop::go_on(session, |canvas| save(place, name, canvas, interrupt)).map_err(no_window)?
    } else {
        session.finish()
    };
    arguments.output.as_deref().map_or(Ok(()), |path| write(path, &picture, interrupt))
}

fn read_script(path: &Path) -> Result<Script, Failure> {
    let (name, text) = read_text(path)?;
    Script::parse(&name, &text).map_err(Failure::input)
}

fn no_window(error: DesktopError) -> Failure {
    let instead = match error {
        DesktopError::NoDisplay(_) => {
            "; -o FILE writes a picture without one, --script FILE replays a session"
        }
        _ => "",
    };
    Failure::input(format!("{error}{instead}"))
}

fn format_of(path: &Path) -> Result<PictureFormat, Failure> {
    if is_standard(path) {
        return Ok(PictureFormat::Png);
    }
    let extension = path.extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
    PictureFormat::from_extension(&extension)
        .ok_or_else(|| Failure::usage(format!("{} names no picture format; take .png", path.display())))
}

/// Writes a picture, whose format its name tells.
fn write(path: &Path, canvas: &Canvas, interrupt: &Interrupt) -> Result<(), Failure> {
    output::write(path, &encoded(canvas, format_of(path)?)?, interrupt)
}

/// The file of a picture; a PNG has a palette, where 256 colours are enough.
pub(crate) fn encoded(canvas: &Canvas, format: PictureFormat) -> Result<Vec<u8>, Failure> {
    let few_colors = if format == PictureFormat::Png { indexed_png(canvas) } else { None };
    match few_colors {
        Some(bytes) => bytes.map_err(|error| Failure::input(format!("PNG: {error}"))),
        None => Ok(encode(&image_of(canvas), format, &PictureOptions::default())?),
    }
}

/// Saves the picture of a window at `place`, or under a name in the current folder that is free, and tells so.
fn save(place: Option<&Path>, name: &str, canvas: &Canvas, interrupt: &Interrupt) {
    let numbered =
        |k: u32| PathBuf::from(if k == 1 { format!("{name}.png") } else { format!("{name}-{k}.png") });
    let free = || (1..=MAX_SAVED).map(numbered).find(|path| !path.exists());
    let Some(path) = place.map(Path::to_owned).or_else(free) else {
        return tell(&format!("senca: there are too many pictures {name}-*.png"));
    };
    match write(&path, canvas, interrupt) {
        Ok(()) => tell(&format!("senca: wrote {}", path.display())),
        Err(failure) => tell(&failure.message().unwrap_or_default()),
    }
}

/// The canvas, whose colours are as displays take them, in linear light.
pub(crate) fn image_of(canvas: &Canvas) -> Image {
    let (width, height) = (canvas.width() as u32, canvas.height() as u32);
    let mut image = Image::new(width, height, [0.0, 0.0, 0.0, 1.0]);
    for (to, color) in image.pixels_mut().iter_mut().zip(canvas.pixels()) {
        let [_, r, g, b] = color.to_be_bytes();
        let linear = Srgb8 { r, g, b }.to_linear();
        *to = [linear.r, linear.g, linear.b, 1.0];
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_window::{Flow, Key};

    /// A grey that keys count up.
    struct Counter(u32);

    impl Program for Counter {
        fn title(&self) -> String {
            self.0.to_string()
        }

        fn size(&self) -> (usize, usize) {
            (4, 3)
        }

        fn event(&mut self, event: Event) -> Flow {
            match event {
                Event::KeyDown(Key::Char('+')) => {
                    self.0 += 1;
                    Flow::Redraw
                }
                _ => Flow::Wait,
            }
        }

        fn draw(&mut self, canvas: &mut Canvas) {
            canvas.fill(0x01_02_03 * self.0);
        }
    }

    fn read(path: &Path) -> (u32, u32, [u8; 3]) {
        let bytes = std::fs::read(path).expect("was written");
        let image =
            senca::io::images::decode_picture("p", &bytes, &senca::io::Limits::default()).expect("a picture");
        let [r, g, b, _] = image.pixels()[0];
        let color = senca::math::LinearRgb::new(r, g, b).to_srgb8();
        (image.width(), image.height(), [color.r, color.g, color.b])
    }

    #[test]
    fn a_script_writes_its_pictures() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| folder.path().join(name);
        let script = format!("key plus\nsave {}\nkey +\nsize 6 5\n", file("first.ppm").display());
        std::fs::write(file("s"), script).expect("writes");
        let size = Some(Size { width: 8, height: 7 });
        let arguments = InteractiveArguments {
            script: Some(file("s")),
            output: Some(file("last.png")),
            size,
            ..Default::default()
        };
        run(&mut Counter(60), "counter", &arguments, &Interrupt::default()).expect("runs");
        assert_eq!(read(&file("first.ppm")), (8, 7, [61, 122, 183]));
        assert_eq!(read(&file("last.png")), (6, 5, [62, 124, 186]));
    }

    #[test]
    fn a_picture_needs_neither_window_nor_script() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("p.png");
        let arguments = InteractiveArguments { output: Some(path.clone()), ..Default::default() };
        run(&mut Counter(1), "counter", &arguments, &Interrupt::default()).expect("runs");
        assert_eq!(read(&path), (4, 3, [1, 2, 3]));
    }

    #[test]
    fn what_cannot_be_is_found_out_before() {
        let folder = tempfile::tempdir().expect("a folder");
        let script = folder.path().join("s");
        for (text, part) in
            [("key +\njump", ":2:1: there is no command"), ("save a.xyz", "no picture format")]
        {
            std::fs::write(&script, text).expect("writes");
            let arguments = InteractiveArguments { script: Some(script.clone()), ..Default::default() };
            let mut program = Counter(0);
            let failure = run(&mut program, "counter", &arguments, &Interrupt::default()).expect_err(text);
            assert!(failure.message().is_some_and(|m| m.contains(part)), "{failure:?}");
            assert_eq!(program.0, 0);
        }
    }

    #[test]
    fn every_colour_of_a_canvas_is_kept() {
        let mut canvas = Canvas::new(256, 1);
        (0..256).for_each(|v| canvas.set(v, 0, 0x01_01_01 * v as u32));
        for (v, [r, g, b, _]) in image_of(&canvas).pixels().iter().enumerate() {
            let color = senca::math::LinearRgb::new(*r, *g, *b).to_srgb8();
            assert_eq!([color.r, color.g, color.b], [v as u8; 3]);
        }
    }
}
