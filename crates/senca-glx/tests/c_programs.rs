//! C programs compiled against the system's headers draw into windows of X.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A server without a screen, which ends with this.
struct Server {
    process: Child,
    display: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Starts a server with screens of a depth; `None` where there is none.
fn server(depth: u32) -> Option<Server> {
    let mut process = Command::new("Xvfb")
        .args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0", &format!("640x480x{depth}")])
        // The server is not to load the library itself.
        .env_remove("LD_LIBRARY_PATH")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .ok()?;
    let output = process.stdout.take()?;
    let mut server = Server { process, display: String::new() };
    let mut number = String::new();
    BufReader::new(output).read_line(&mut number).ok()?;
    server.display = format!(":{}", number.trim());
    (!number.trim().is_empty()).then_some(server)
}

/// Whether there is what these tests need; says so if not.
#[expect(clippy::print_stderr, reason = "a test that is left out is told")]
fn has_tools() -> bool {
    let works = |tool: &str, argument: &str| Command::new(tool).arg(argument).output().is_ok();
    let headers = ["GL/glx.h", "X11/Xlib.h"].iter().all(|h| Path::new("/usr/include").join(h).exists());
    let all = works("cc", "--version") && works("Xvfb", "-help") && headers;
    if !all {
        eprintln!(
            "left out: there is no C compiler, Xvfb, or GL/glx.h (Debian: gcc, xvfb, libgl-dev, libx11-dev)"
        );
    }
    all
}

#[test]
fn windows() {
    if !has_tools() {
        return;
    }
    let mut build = Command::new(env!("CARGO"));
    // With all of the workspace, so that what the tests of it have built need not be built again for other features.
    build.args(["build", "--quiet", "--workspace", "--lib", "--example", "opengl"]);
    let release = !cfg!(debug_assertions);
    if release {
        build.arg("--release");
    }
    assert!(build.status().unwrap().success(), "the library builds");
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let library = target.join(if release { "release" } else { "debug" });
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("windows");
    let compiled = Command::new("cc")
        .args(["-Wall", "-Wextra", "-O1", "-o"])
        .arg(&program)
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/c/windows.c"))
        .arg(library.join("libGL.so.1"))
        .arg("-lX11")
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    for depth in [24, 16] {
        let Some(server) = server(depth) else { return };
        let mut run = Command::new(&program);
        run.env("LD_LIBRARY_PATH", &library).env("DISPLAY", &server.display);
        let ran = run.output().unwrap();
        let said = String::from_utf8_lossy(&ran.stdout) + String::from_utf8_lossy(&ran.stderr);
        // Pixels of 16 bits have other values; what is asked there is that nothing fails.
        assert!(ran.status.code().is_some() && (depth != 24 || ran.status.success()), "{depth}: {said}");
    }
}
