//! Gives the library the name that programs look for.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libOSMesa.so.8");
        if let Err(error) = link_name() {
            println!("cargo::warning=libOSMesa.so.8 could not be made beside libOSMesa.so: {error}");
        }
    }
}

/// Makes `libOSMesa.so.8`, a link to the `libOSMesa.so` that will be beside it, in the folder of what is built.
fn link_name() -> std::io::Result<()> {
    let out = std::env::var_os("OUT_DIR").unwrap_or_default();
    // OUT_DIR is `<folder>/build/<package>/out`.
    let Some(folder) = Path::new(&out).ancestors().nth(3) else { return Ok(()) };
    let link = folder.join("libOSMesa.so.8");
    if link.is_symlink() {
        return Ok(());
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink("libOSMesa.so", link)?;
    Ok(())
}
