#!/usr/bin/env bash
# What the packages say agrees with the tree: the version, the exported functions, a man page for
# each program, the licence. Quick. Usage: test_packaging.sh BUILD SOURCE.
set -euo pipefail
build=$1
source=$2

failures=0
complain() {
    echo "$1"
    failures=1
}

version=$(sed -nE 's/^#define PKC_VERSION_(MAJOR|MINOR|PATCH) //p' "$source/include/packcell.h" |
    paste -sd .)
packaged=$(sed -nE '1s/^packcell \(([^)]*)\).*/\1/p' "$source/debian/changelog")
[ "$version" = "$packaged" ] ||
    complain "debian/changelog is of version '$packaged', the header of $version"

named=$(sed -nE 's/^ (pkc_\w+)@PACKCELL_0 .*/\1/p' "$source/debian/libpackcell0.symbols")
exported=$(nm -D --defined-only "$build/lib/libpackcell.so" |
    awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | LC_ALL=C sort)
diff <(echo "$named") <(echo "$exported") ||
    complain "'<' is in debian/libpackcell0.symbols alone, '>' is exported but not there"

for program in "$build"/bin/packcell-*; do
    page=docs/man/$(basename "$program").h2m
    [ -f "$source/$page" ] || complain "$page: not there"
done

licence=$(sed -n '5,$p' "$source/LICENSE")
packaged=$(sed -n 's/^ \.$//p; t; s/^ //p' "$source/debian/copyright")
[ "$licence" = "$packaged" ] || complain "debian/copyright does not have the text of LICENSE"

"$source/docs/doxygen_filter.py" --check "$source/include/packcell.h" || failures=1
exit $failures
