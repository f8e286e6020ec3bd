//! Says where the linker finds libpackcell.so: in the folder that PACKCELL_LIB_DIR names, else where
//! pkg-config says, else where the linker looks anyway. `cargo check` and `cargo doc` need no
//! library: one that is not found is a warning here and an error of the linker's.

use std::env;
use std::path::Path;
use std::process::{self, Command};

const LIBRARY: &str = "libpackcell.so";
const HELP: &str = "install libpackcell-dev, or name the library's folder in PACKCELL_LIB_DIR";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    for name in [
        "PACKCELL_LIB_DIR",
        "PKG_CONFIG",
        "PKG_CONFIG_PATH",
        "PKG_CONFIG_LIBDIR",
    ] {
        println!("cargo:rerun-if-env-changed={name}");
    }
    if let Ok(folder) = env::var("PACKCELL_LIB_DIR") {
        // A relative one would mean another folder to the linker than to this program.
        let path = Path::new(&folder);
        if !path.is_absolute() || !path.join(LIBRARY).exists() {
            let what = "must be the absolute path of a folder that has";
            eprintln!("PACKCELL_LIB_DIR {folder:?}: {what} {LIBRARY}");
            process::exit(1);
        }
        println!("cargo:rustc-link-search=native={folder}");
        return;
    }
    let tool = env::var("PKG_CONFIG").unwrap_or_else(|_| "pkg-config".into());
    let answer = Command::new(tool)
        .args(["--libs-only-L", "packcell"])
        .output();
    match answer {
        Ok(answer) if answer.status.success() => {
            for word in String::from_utf8_lossy(&answer.stdout).split_whitespace() {
                if let Some(folder) = word.strip_prefix("-L") {
                    println!("cargo:rustc-link-search=native={folder}");
                }
            }
        }
        _ => println!("cargo:warning=packcell was not found by pkg-config: {HELP}"),
    }
}
