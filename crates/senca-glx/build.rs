//! Gives the library the name that programs look for.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libGL.so.1");
        if let Err(error) = link_name() {
            println!("cargo::warning=libGL.so.1 could not be made beside libGL.so: {error}");
        }
    }
}

/// Makes `libGL.so.1`, a link to the `libGL.so` that will be beside it, in the folder of what is built.
fn link_name() -> std::io::Result<()> {
    let out = std::env::var_os("OUT_DIR").unwrap_or_default();
    // OUT_DIR is `<folder>/build/<package>/out`.
    let Some(folder) = Path::new(&out).ancestors().nth(3) else { return Ok(()) };
    let link = folder.join("libGL.so.1");
    if link.is_symlink() {
        return Ok(());
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink("libGL.so", link)?;
    Ok(())
}
