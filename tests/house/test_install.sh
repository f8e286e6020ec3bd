#!/usr/bin/env bash
# The installed library serves a plain C99 program by pkg-config and by find_package, shared and
# static, and its header stands alone in C and in C++.
set -euo pipefail
build=$1

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
cmake --install "$build" --prefix "$prefix" >"$work/install.log"

strict=(-pedantic -Wall -Wextra -Werror)
cat >"$work/main.c" <<'EOF'
#include <packcell.h>
#include <stdio.h>

int main(void) {
    pkc_bin *bin = NULL;
    if (pkc_bin_create(10, 10, &bin) != PKC_OK) {
        fprintf(stderr, "%s\n", pkc_last_error());
        return 1;
    }
    pkc_bin_free(bin);
    return pkc_version() == PKC_VERSION_MAJOR * 10000 + PKC_VERSION_MINOR * 100 + PKC_VERSION_PATCH
               ? 0
               : 1;
}
EOF
cd "$work"

echo "the header alone"
header=$prefix/include/packcell.h
cc -std=c99 "${strict[@]}" -Wconversion -Wshadow -fsyntax-only -x c "$header"
c++ -std=c++17 "${strict[@]}" -Wconversion -Wshadow -fsyntax-only -x c++ "$header"

echo "pkg-config"
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name packcell.pc)")
export PKG_CONFIG_PATH
libdir=$(pkg-config --variable=libdir packcell)
read -ra flags <<<"$(pkg-config --cflags --libs packcell)"
cc -std=c99 "${strict[@]}" main.c -o shared "${flags[@]}" -Wl,-rpath,"$libdir"
./shared
readelf -d shared | grep -q 'NEEDED.*libpackcell\.so\.' || { echo "not linked to the shared library"; exit 1; }
read -ra flags <<<"$(pkg-config --static --cflags --libs packcell)"
# Debian has Box2D and NLopt as shared libraries alone: only packcell is linked statically.
cc -std=c99 "${strict[@]}" main.c -o static "${flags[@]/#-lpackcell/$libdir/libpackcell.a}"
./static
if readelf -d static | grep -q 'NEEDED.*libpackcell'; then echo "not linked statically"; exit 1; fi

echo "find_package"
mkdir package
cat >package/CMakeLists.txt <<'EOF'
cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES C)
set(CMAKE_C_STANDARD 99)
set(CMAKE_C_EXTENSIONS OFF)
add_compile_options(-pedantic -Wall -Wextra -Werror)
find_package(packcell REQUIRED)
add_executable(shared ../main.c)
target_link_libraries(shared PRIVATE packcell::packcell)
add_executable(static ../main.c)
target_link_libraries(static PRIVATE packcell::packcell_static)
EOF
cmake -S package -B package/build -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >package.log
cmake --build package/build >>package.log || { cat package.log; exit 1; }
package/build/shared
package/build/static
if readelf -d package/build/static | grep 'NEEDED.*libpackcell'; then
    echo "packcell::packcell_static is linked to the shared library"
    exit 1
fi

echo "programs"
shopt -s nullglob
for program in "$prefix"/bin/packcell-*; do
    "$program" --version >/dev/null
done
