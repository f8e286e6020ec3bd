//! Says where the linker finds libpackcell.so: in the folder that PACKCELL_LIB_DIR names, else where
//! pkg-config says, else where the linker looks anyway.

use std::env;
use std::process::Command;

fn main() {
    for name in ["PACKCELL_LIB_DIR", "PKG_CONFIG", "PKG_CONFIG_PATH"] {
        println!("cargo:rerun-if-env-changed={name}");
    }
    if let Ok(folder) = env::var("PACKCELL_LIB_DIR") {
        println!("cargo:rustc-link-search=native={folder}");
        return;
    }
    let tool = env::var("PKG_CONFIG").unwrap_or_else(|_| "pkg-config".into());
    let answer = Command::new(tool)
        .args(["--libs-only-L", "packcell"])
        .output();
    if let Ok(answer) = answer {
        if answer.status.success() {
            for word in String::from_utf8_lossy(&answer.stdout).split_whitespace() {
                if let Some(folder) = word.strip_prefix("-L") {
                    println!("cargo:rustc-link-search=native={folder}");
                }
            }
        }
    }
}
