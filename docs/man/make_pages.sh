#!/usr/bin/env bash
# Writes a man page for each program that is built, from its own --help, so that page and program
# cannot disagree; the rest of a page (examples, what to read next) is in NAME.h2m beside this file.
# Usage: docs/man/make_pages.sh FOLDER_OF_PROGRAMS FOLDER_OF_PAGES. Needs help2man.
set -euo pipefail

if [ $# != 2 ]; then
    echo "usage: $0 FOLDER_OF_PROGRAMS FOLDER_OF_PAGES" >&2
    exit 2
fi
programs=$1
pages=$2
here=$(cd "$(dirname "$0")" && pwd)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$pages"

# help2man knows "-h, --help", a list by its indented lines and a section by "NAME:" after an empty
# line; it also writes the name of what it runs into the page.
ask() {
    "$1" "$2" | sed -E 's/^  -h,--help /  -h, --help/
        s/^Benches:$/\n*Benches*\n/
        s/^([a-z-]+)  +([^ ].*)$/  \1              \2/
        s/^Exit codes: /\n&/'
}

shopt -s nullglob
for notes in "$here"/packcell-*.h2m; do
    name=$(basename "$notes" .h2m)
    if [ ! -x "$programs/$name" ]; then
        echo "$programs/$name: not there, but $notes describes it" >&2
        exit 1
    fi
done
for program in "$programs"/packcell-*; do
    name=$(basename "$program")
    if [ ! -f "$here/$name.h2m" ]; then
        echo "$here/$name.h2m: not there, but $program wants a page" >&2
        exit 1
    fi
    {
        echo "#!/usr/bin/env bash"
        declare -f ask
        printf 'ask %q "$1"\n' "$(realpath "$program")"
    } >"$work/$name"
    chmod +x "$work/$name"
    help2man --no-info --no-discard-stderr --section=1 --manual="packcell" --source="packcell" \
        --include="$here/$name.h2m" --output="$pages/$name.1" "$work/$name"
done
