#!/usr/bin/env bash
# The Debian packages: built, judged by lintian, installed into a fresh root of the release that
# this machine runs, and used there: the example by pkg-config and by find_package, the programs,
# their man pages, the Python binding. Not part of `make test`: it compiles everything anew, loads
# some hundred megabytes and must be root. Usage: test_packages.sh BUILD SOURCE. PACKCELL_PACKAGES
# names a folder of packages that are built already.
set -euo pipefail
build=$1
source=$2

fail() {
    echo "$1" >&2
    exit 1
}
[ "$(id -u)" = 0 ] || fail "a fresh root can only be made by root"

packages=${PACKCELL_PACKAGES:-$build/deb}
if [ -z "${PACKCELL_PACKAGES:-}" ]; then
    echo "building the packages"
    "$source/debian/make-packages" "$packages"
fi
packages=$(cd "$packages" && pwd)

names=(libpackcell0 libpackcell-dev packcell-tools python3-packcell)
debs=()
for name in "${names[@]}"; do
    found=("$packages/$name"_*.deb)
    [ -f "${found[0]}" ] || fail "$packages: no package $name"
    [ ${#found[@]} = 1 ] || fail "$packages: several packages $name"
    debs+=("${found[0]}")
done

echo "lintian"
changes=("$packages"/packcell_*_*.changes)
# As root it asks whether that is meant.
lintian --allow-root --fail-on error --tag-display-limit 0 "${changes[0]}" ||
    fail "lintian has found errors"

work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
root=$work/root

echo "a fresh root"
# One line an archive that this machine itself installs from: address, suite, component.
apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' \
    'Created-By: Packages' 'Origin: Debian' | sort -u >"$work/archives"
suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
mirror=$(awk -v suite="$suite" '$2 == suite { print $1; exit }' "$work/archives")
[ -n "$mirror" ] || fail "apt knows no archive of Debian '$suite'"
debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$work/debootstrap.log" 2>&1 ||
    { tail -n 20 "$work/debootstrap.log"; fail "debootstrap has failed"; }
sed 's/^/deb /' "$work/archives" >"$root/etc/apt/sources.list"
cp /etc/resolv.conf "$root/etc/resolv.conf"
# No service may start in there.
printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"
chmod +x "$root/usr/sbin/policy-rc.d"

inside() {
    chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root \
        DEBIAN_FRONTEND=noninteractive "$@" </dev/null
}
quietly() {
    inside "$@" >"$work/log" 2>&1 && return
    tail -n 40 "$work/log"
    fail "failed: $*"
}
install() { quietly apt-get -o Acquire::Retries=3 install -y --no-install-recommends "$@"; }

mkdir "$root/packages" "$root/user"
cp "${debs[@]}" "$root/packages"
cp "$source/examples/minimal.c" "$root/user"
quietly apt-get update

echo "each package alone, so that it brings along what it needs"
here() { echo "/packages/$(basename "$(ls "$root/packages/$1"_*.deb)")"; }
install "$(here libpackcell0)"
install "$(here packcell-tools)"
for page in "$source"/docs/man/packcell-*.h2m; do
    name=$(basename "$page" .h2m)
    inside "$name" --version >/dev/null || fail "$name --version failed"
    # The fresh root has no man; a page with a name and a synopsis is one.
    gzip -dc "$root/usr/share/man/man1/$name.1.gz" >"$work/page" || fail "no man page of $name"
    grep -q '^\.SH SYNOPSIS' "$work/page" || fail "the man page of $name is empty"
    if ldd_out=$(inside ldd "/usr/bin/$name") && grep -q 'not found' <<<"$ldd_out"; then
        fail "$name: $ldd_out"
    fi
done
inside packcell-pack --help | grep '^Usage: packcell-pack' >/dev/null ||
    fail "packcell-pack --help says nothing"
inside sh -c 'packcell-gen --kind full | packcell-pack --repack full' 2>/dev/null |
    grep '"steps":' >/dev/null || fail "packcell-pack has not packed a set"

echo "the example by pkg-config and by find_package"
install "$(here libpackcell-dev)" gcc libc6-dev pkgconf
cat >"$work/expected" <<'END'
pack 0 at (0, 0), turned 0
pack 1 at (0, 4), turned 1
pack 2 at (5, 0), turned 1
pack 3 at (6, 6), turned 0
END
same() { diff "$work/expected" <(inside "$1") || fail "$1 packs otherwise"; }
quietly sh -c 'cd /user && cc -std=c99 -Wall -Wextra -Werror minimal.c -o by_pkg_config \
    $(pkg-config --cflags --libs packcell)'
same /user/by_pkg_config

install cmake g++ make
cat >"$root/user/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES C)
find_package(packcell 0.1 REQUIRED)
add_executable(shared minimal.c)
target_link_libraries(shared PRIVATE packcell::packcell)
add_executable(static minimal.c)
target_link_libraries(static PRIVATE packcell::packcell_static)
END
quietly sh -c 'cmake -S /user -B /user/build && cmake --build /user/build'
same /user/build/shared
same /user/build/static
needs() { inside readelf -d "/user/build/$1" | grep 'NEEDED.*libpackcell\.so\.0' >/dev/null; }
needs shared || fail "shared is not linked to libpackcell.so.0"
if needs static; then fail "static is linked to the shared library"; fi

cat >"$root/user/main.cpp" <<'END'
#include <packcell.hpp>
int main() { return packcell::Bin(10, 10).info().w == 10 ? 0 : 1; }
END
quietly sh -c 'cd /user && c++ -std=c++17 -Wall -Wextra -Werror main.cpp -o by_cpp \
    $(pkg-config --cflags --libs packcell) && ./by_cpp'

echo "the Python binding"
install "$(here python3-packcell)"
cp "$source/bindings/python/examples/plan_golden.py" "$root/user"
inside python3 -c 'import packcell; print(packcell.__file__)' >"$work/python" ||
    fail "the Python binding cannot be imported"
grep -q '^/usr/lib/python3/dist-packages/' "$work/python" ||
    fail "the Python binding is imported from $(cat "$work/python")"
golden=$(grep -v '^#' "$source/tests/golden/binding-plan.txt")
planned=$(inside python3 /user/plan_golden.py)
[ "$planned" = "$golden" ] || fail "the golden plan is $golden, Python's is '$planned'"

echo "away again"
quietly apt-get purge -y "${names[@]}"
left=$(inside find /etc /usr /var -xdev -name '*packcell*')
[ -z "$left" ] || fail "left behind: $left"
