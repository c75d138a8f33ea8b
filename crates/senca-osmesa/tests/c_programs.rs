//! C programs compiled against the system's headers run on the library.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The folder with the library, which is built now if it is not up to date.
fn library() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let mut build = Command::new(env!("CARGO"));
        // With all of the workspace, so that what the tests of it have built need not be built again for other features.
        build.args(["build", "--quiet", "--workspace", "--lib", "--example", "opengl"]);
        let release = !cfg!(debug_assertions);
        if release {
            build.arg("--release");
        }
        assert!(build.status().unwrap().success(), "the library builds");
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
        target.join(if release { "release" } else { "debug" })
    })
}

/// Whether there is what these tests need; says so if not.
#[expect(clippy::print_stderr, reason = "a test that is left out is told")]
fn has_compiler() -> bool {
    let compiler = Command::new("cc").arg("--version").output().is_ok();
    let headers =
        ["gl.h", "glext.h", "osmesa.h"].iter().all(|h| Path::new("/usr/include/GL").join(h).exists());
    if !(compiler && headers) {
        eprintln!("left out: there is no C compiler, or no GL/osmesa.h (Debian: libosmesa6-dev)");
    }
    compiler && headers
}

/// Compiles and runs a program of `tests/c`; what it says is wrong fails the test.
fn runs(name: &str) {
    runs_with(&format!("tests/c/{name}.c"), &[]);
}

/// Compiles and runs a program of this crate with arguments.
fn runs_with(source: &str, arguments: &[&str]) {
    if !has_compiler() {
        return;
    }
    let library = library();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join(source);
    let name = source.file_stem().unwrap().to_str().unwrap();
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let compiled = Command::new("cc")
        .args(["-Wall", "-Wextra", "-O1", "-o"])
        .arg(&program)
        .arg(&source)
        .arg(library.join("libOSMesa.so.8"))
        .args(["-lpthread", "-ldl", "-lm"])
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let ran = Command::new(&program).args(arguments).env("LD_LIBRARY_PATH", library).output().unwrap();
    let said = String::from_utf8_lossy(&ran.stdout) + String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{name}: {}\n{said}", ran.status);
}

#[test]
fn drawing() {
    runs("drawing");
}

#[test]
fn contexts() {
    runs("contexts");
}

#[test]
fn nonsense_does_not_crash() {
    runs("nonsense");
}

#[test]
fn nothing_is_touched_beyond_what_is_given() {
    runs("sizes");
}

/// The programs whose speed is told; each is drawn twice.
#[test]
fn the_measured_pictures_are_drawn() {
    runs_with("benches/speed.c", &["libOSMesa.so.8", "0", "1"]);
}

/// No symbol but those of OpenGL and OSMesa is to be seen from outside, and the name is that programs ask for.
#[test]
fn only_commands_are_exported() {
    if !has_compiler() {
        return;
    }
    let file = library().join("libOSMesa.so");
    let output = |tool: &str, arguments: &[&str]| {
        let output = Command::new(tool).args(arguments).arg(&file).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let symbols = output("nm", &["-D", "--defined-only"]);
    let names: Vec<&str> = symbols.lines().filter_map(|line| line.split_whitespace().last()).collect();
    assert!(names.len() > 600, "{}", names.len());
    let others: Vec<_> = names.iter().filter(|n| !n.starts_with("gl") && !n.starts_with("OSMesa")).collect();
    assert!(others.is_empty(), "{others:?}");
    assert!(output("readelf", &["-d"]).contains("soname: [libOSMesa.so.8]"));
}

/// Commands of the `sh` blocks of `docs/opengl.md`, in their order. Those of examples run in the tests of
/// `senca-gl`, and what measures, for a shorter time, above.
fn commands_of_the_document() -> Vec<String> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(repository.join("docs/opengl.md")).unwrap();
    let blocks = text.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next());
    let commands = blocks
        .flat_map(str::lines)
        .filter(|line| !line.contains("--example") && !line.starts_with("./speed"));
    commands.map(str::to_owned).collect()
}

#[test]
fn the_commands_of_the_document_work() {
    if !has_compiler() {
        return;
    }
    let library = library();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("document");
    std::fs::create_dir_all(&folder).unwrap();
    let commands = commands_of_the_document();
    assert_eq!(commands[0], "cargo build --release -p senca-osmesa");
    for command in &commands[1..] {
        let here = command
            .replace("target/release", &library.display().to_string())
            .replace("crates/senca-osmesa", env!("CARGO_MANIFEST_DIR"));
        let done = Command::new("sh").args(["-c", &here]).current_dir(&folder).status().unwrap();
        assert!(done.success(), "{command}: {done}");
    }
    let picture = std::fs::read(folder.join("picture.ppm")).unwrap();
    assert_eq!(picture.len(), "P6 320 240 255\n".len() + 320 * 240 * 3);
    let middle = picture.len() - (120 * 320 + 160) * 3;
    assert!(picture[middle] > 60, "the cube is lit");
}
