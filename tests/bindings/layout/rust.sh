#!/usr/bin/env bash
# Turns the lines of `generate.py --layout` into a program that prints the same as rustc has it.
# usage: rust.sh RAW_FILE <lines >program.rs
set -euo pipefail

echo "#[path = \"$1\"]"
cat <<'PROGRAM'
#[allow(dead_code)]
mod raw;

// std::mem::offset_of is younger than Debian's compiler.
macro_rules! offset {
    ($struct:ident, $field:ident) => {{
        let place = std::mem::MaybeUninit::<raw::$struct>::uninit();
        let whole = place.as_ptr();
        unsafe { std::ptr::addr_of!((*whole).$field) as usize - whole as usize }
    }};
}

fn main() {
PROGRAM
sed -E -e 's/^([a-z_]+)\.([a-z_0-9]+) .*/    println!("\1.\2 {}", offset!(\1, \2));/' \
    -e 's/^([a-z_]+) [0-9]+$/    println!("\1 {}", std::mem::size_of::<raw::\1>());/'
echo "}"
