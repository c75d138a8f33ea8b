//! Ray tracing by the command: figures, explanations, partial pictures.

mod common;

use std::path::Path;
use std::process::Output;

use common::{run_in, sample, told};
use serde_json::Value;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Runs `senca render` on a sample by method trace.
fn trace(folder: &Path, name: &str, more: &[&str]) -> Output {
    let scene = sample(name).display().to_string();
    let mut arguments = vec!["render", &scene, "--method", "trace", "--size", "48x36"];
    arguments.extend(more);
    run_in(folder, &arguments)
}

#[track_caller]
fn assert_done(output: &Output) {
    assert!(output.status.success(), "{}", told(output));
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(bytes)))
}

#[test]
fn figures_tell_of_rays_and_tests() {
    let folder = folder();
    for accel in ["none", "grid", "bvh"] {
        assert_done(&trace(
            folder.path(),
            "mirrors.toml",
            &["-o", "a.png", "--accel", accel, "--stats", "a.json", "--aa", "none"],
        ));
        let stats = json(&read(folder.path(), "a.json"));
        assert_eq!(stats["rays"]["primary"], 48 * 36, "{accel}");
        assert!(stats["rays"]["reflected"].as_u64() > Some(0), "{stats}");
        assert!(stats["rays"]["shadow"].as_u64() > Some(0) && stats["tests"].as_u64() > Some(0));
        assert_eq!((&stats["samples"], &stats["samples_total"]), (&Value::from(1), &Value::from(48 * 36)));
        assert!(stats["per_ray"]["tests"].as_f64() > Some(0.0));
    }
}

#[test]
fn all_accelerators_and_thread_counts_give_the_same_bytes() {
    let folder = folder();
    let picture = |more: &[&str]| {
        let all = [&["-o", "a.png"], more].concat();
        assert_done(&trace(folder.path(), "shadows.toml", &all));
        read(folder.path(), "a.png")
    };
    let first = picture(&["--accel", "none"]);
    for accel in ["spheres", "bounds", "hierarchy", "grid", "octree", "sah", "bvh"] {
        assert_eq!(picture(&["--accel", accel]), first, "{accel}");
    }
    assert_eq!(picture(&["--threads", "1"]), picture(&["--threads", "3"]));
}

#[test]
fn a_pixel_is_explained_in_every_form() {
    let folder = folder();
    let explain = |more: &[&str]| {
        let all = [&["--pixel", "24,18"], more].concat();
        let done = trace(folder.path(), "mirrors.toml", &all);
        assert_done(&done);
        String::from_utf8(done.stdout).expect("text")
    };
    let text = explain(&["--explain"]);
    assert!(text.starts_with("pixel 24,18 of 48x36") && text.contains("primary ray"), "{text}");
    for (name, start) in [("t.txt", "pixel 24,18"), ("t.svg", "<svg"), ("t.dot", "digraph")] {
        assert_eq!(explain(&["--explain", name]), "");
        let written = String::from_utf8(read(folder.path(), name)).expect("text");
        assert!(written.starts_with(start), "{name}: {written}");
    }
    explain(&["--explain", "t.json"]);
    let tree = json(&read(folder.path(), "t.json"));
    assert_eq!(tree["pixel"], serde_json::json!([24, 18]));
    assert_eq!(tree["samples"][0]["rays"][0]["kind"], "primary");
    let outside = trace(folder.path(), "mirrors.toml", &["--pixel", "48,0", "--explain"]);
    assert_eq!(outside.status.code(), Some(2), "{}", told(&outside));
}

#[test]
fn partial_pictures_are_gone_on_with() {
    let folder = folder();
    let part = |samples: &str, out: &str| {
        trace(folder.path(), "glass.toml", &["-o", out, "--samples", samples, "--resume", "a.part"])
    };
    assert_done(&part("2", "first.png"));
    assert_done(&part("5", "resumed.png"));
    std::fs::remove_file(folder.path().join("a.part")).expect("the partial picture");
    assert_done(&part("5", "whole.png"));
    assert_eq!(read(folder.path(), "resumed.png"), read(folder.path(), "whole.png"));

    let other =
        trace(folder.path(), "mirrors.toml", &["-o", "b.png", "--samples", "5", "--resume", "a.part"]);
    assert_eq!(other.status.code(), Some(1));
    assert!(told(&other).contains("a.part: belongs to another picture"), "{}", told(&other));
    std::fs::write(folder.path().join("a.part"), b"SENCAPAR").expect("a file");
    let damaged = part("5", "c.png");
    assert_eq!(damaged.status.code(), Some(1));
    assert!(told(&damaged).contains("is damaged"), "{}", told(&damaged));
}

#[test]
fn time_limits_give_a_picture_in_time() {
    let folder = folder();
    for limit in [["--time-limit", "0.01s"], ["--time", "0.01s"]] {
        let done =
            trace(folder.path(), "glass.toml", &[&["-o", "a.png", "--stats", "a.json"][..], &limit].concat());
        assert_done(&done);
        assert!(json(&read(folder.path(), "a.json"))["samples"].as_u64() >= Some(1));
    }
}

#[test]
fn maps_of_samples_are_pictures() {
    let folder = folder();
    assert_done(&trace(
        folder.path(),
        "jaggies.toml",
        &["-o", "a.png", "--aa", "adaptive", "--samples-map", "map.png"],
    ));
    assert!(read(folder.path(), "map.png").starts_with(b"\x89PNG"));
}

#[test]
fn samples_draw_without_options() {
    let folder = folder();
    for name in ["mirrors.toml", "glass.toml", "lens.toml", "motion.toml", "csg.toml", "environment.toml"] {
        let scene = sample(name).display().to_string();
        let arguments = ["render", &scene, "--size", "24x18", "--samples", "2", "-o", "a.png"];
        assert_done(&run_in(folder.path(), &arguments));
    }
}
