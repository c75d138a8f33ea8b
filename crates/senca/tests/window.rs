//! The interactive programs in windows of an X server without a screen: each shows, to the last pixel, what its
//! script draws without a window.

mod common;

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use common::{repository, run_in, senca_in, told};
use senca::math::LinearRgb;

/// Width and height of the server's screen.
const SCREEN: [usize; 2] = [1280, 1024];

/// How long a window is waited for.
const PATIENCE: Duration = Duration::from_secs(60);

/// The programs with their sessions.
const SESSIONS: &[&str] = &[
    "lab 1 --script samples/lab/vectors.script",
    "lab 1 system --script samples/lab/system.script",
    "lab 1 barycentric --input samples/lab/triangle.txt --script samples/lab/triangle.script",
    "lab 2 --script samples/lab/line.script",
    "lab 3 --script samples/lab/polygon.script",
    "lab 4 samples/lab/dented.obj --point 2,2,3 --script samples/lab/solid.script",
    "lab 5 --solid samples/lab/cube.obj --eye 3,2,4 --script samples/lab/view.script",
    "lab 6 --script samples/lab/curve.script",
    "lab 7 samples/lab/cube.obj --script samples/lab/shading.script",
    "lab 8 --script samples/lab/fractal.script",
    "classic game --script samples/classic/game.script",
    "classic polygon --script samples/classic/polygon.script",
    "classic lut --script samples/classic/lut.script",
];

/// A process that ends with this.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        drop(self.0.kill());
        drop(self.0.wait());
    }
}

/// Starts a server that keeps its screen in a file of `folder`; its name, or `None` where there is none.
fn server(folder: &Path) -> Option<(Process, String)> {
    let screen = format!("{}x{}x24", SCREEN[0], SCREEN[1]);
    let mut command = Command::new("Xvfb");
    command.args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0", &screen, "-fbdir"]).arg(folder);
    let mut process = Process(command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?);
    let mut number = String::new();
    BufReader::new(process.0.stdout.take()?).read_line(&mut number).ok()?;
    (!number.trim().is_empty()).then(|| (process, format!(":{}", number.trim())))
}

/// The screen's pixels, `0x00RRGGBB`, from a file of the X window dump format: a header of big-endian numbers,
/// a name, colours, and the pixels with the lowest byte first.
fn screen(folder: &Path) -> Option<Vec<u32>> {
    let bytes = std::fs::read(folder.join("Xvfb_screen0")).ok()?;
    let word = |i: usize| bytes.get(4 * i..4 * i + 4)?.try_into().ok().map(u32::from_be_bytes);
    let (header, colors, row) = (word(0)? as usize, word(19)? as usize, word(12)? as usize);
    assert_eq!((word(4), word(5)), (Some(SCREEN[0] as u32), Some(SCREEN[1] as u32)));
    let pixels = bytes.get(header + 12 * colors..)?;
    let row = |y: usize| pixels.get(y * row..y * row + 4 * SCREEN[0]);
    let mut all = Vec::with_capacity(SCREEN[0] * SCREEN[1]);
    for y in 0..SCREEN[1] {
        let (words, _) = row(y)?.as_chunks::<4>();
        all.extend(words.iter().map(|&pixel| u32::from_le_bytes(pixel) & 0xff_ff_ff));
    }
    Some(all)
}

/// What the session draws without a window, row by row.
fn drawn(session: &[&str]) -> Vec<Vec<u32>> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("p.png");
    let output = path.to_str().expect("a name");
    let done = run_in(&repository(), &[session, &["-o", output]].concat());
    assert!(done.status.success(), "{session:?}: {}", told(&done));
    let bytes = std::fs::read(&path).expect("a picture");
    let limits = senca::io::Limits::default();
    let image = senca::io::images::decode_picture("p", &bytes, &limits).expect("a picture");
    let color = |&[r, g, b, _]: &[f32; 4]| {
        let color = LinearRgb::new(r, g, b).to_srgb8();
        u32::from_be_bytes([0, color.r, color.g, color.b])
    };
    image.pixels().chunks(image.width() as usize).map(|row| row.iter().map(color).collect()).collect()
}

/// Whether the upper left corner of the screen shows a picture.
fn shows(screen: &[u32], picture: &[Vec<u32>]) -> bool {
    picture.iter().enumerate().all(|(y, row)| screen[y * SCREEN[0]..][..row.len()] == row[..])
}

#[test]
#[expect(clippy::print_stderr, reason = "a test that is left out is told")]
fn windows_show_what_scripts_draw() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some((_server, display)) = server(folder.path()) else {
        return eprintln!("left out: there is no Xvfb (Debian: xvfb)");
    };
    for session in SESSIONS {
        let words: Vec<_> = session.split(' ').collect();
        let picture = drawn(&words);
        let mut command = senca_in(&repository(), &[&words[..], &["--window"]].concat());
        command.env("DISPLAY", &display).env_remove("WAYLAND_DISPLAY").env("WINIT_X11_SCALE_FACTOR", "1");
        let mut window = Process(
            command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the command starts"),
        );
        let start = Instant::now();
        while !screen(folder.path()).is_some_and(|screen| shows(&screen, &picture)) {
            if window.0.try_wait().expect("a process").is_some() {
                let mut told = String::new();
                window.0.stderr.take().expect("a pipe").read_to_string(&mut told).expect("a text");
                // Libraries of X that windows need are looked for when the command runs.
                assert!(told.contains("there is no display"), "{session}: the window has gone: {told}");
                return eprintln!("left out: {told}");
            }
            assert!(start.elapsed() < PATIENCE, "{session}: the window shows something else");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}
