# shellcheck shell=bash
# Shared by the tests of the console programs; sourced with the build and the source folder as
# arguments. Sets build, source, work, gen, pack, checker.
set -euo pipefail
build=$1
source=$2

find_program() {
    find "$build" -name "$1" -type f -perm -u+x | head -1
}

gen=$(find_program packcell-gen)
pack=$(find_program packcell-pack)
checker=$source/../shared/check/check_episodes.py
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

finish() {
    if [ "$failures" -gt 0 ]; then
        echo "$failures failures"
        exit 1
    fi
}

for program in "$gen" "$pack"; do
    if [ -z "$program" ]; then
        echo "packcell-gen and packcell-pack are not under $build"
        exit 1
    fi
done

# The independent judge lies beside the checkout, or this part is skipped.
have_checker() {
    if [ -f "$checker" ] && command -v python3 >/dev/null; then
        return 0
    fi
    if [ "${PACKCELL_REQUIRE_CHECKER:-}" = 1 ]; then
        echo "the checker $checker is required and not there"
        exit 1
    fi
    return 1
}

# judge INSTANCES EPISODES [OPTION...]
judge() {
    python3 "$checker" "$@"
}

# The episodes less their times, which differ from run to run.
without_times() {
    sed -E 's/"plan_ms":[0-9.e+-]+/"plan_ms":0/g' "$1"
}

# same_episodes WHAT A B
same_episodes() {
    if ! cmp -s <(without_times "$2") <(without_times "$3"); then
        fail "$1: episodes differ"
        diff <(without_times "$2") <(without_times "$3") | cut -c1-300 | head -4 || true
    fi
}

# expect_error CODE PATTERN WHAT COMMAND...: that exit code, and exactly one line on stderr that
# the extended regular expression matches.
expect_error() {
    local code=$1 pattern=$2 what=$3 status=0
    shift 3
    "$@" >"$work/stdout" 2>"$work/stderr" || status=$?
    if [ "$status" != "$code" ]; then
        fail "$what: exit code $status, expected $code"
    fi
    if [ "$(wc -l <"$work/stderr")" != 1 ]; then
        fail "$what: $(wc -l <"$work/stderr") lines on stderr, expected one"
        head -5 "$work/stderr" | cut -c1-300
    elif ! grep -qE -- "$pattern" "$work/stderr"; then
        fail "$what: '$(cut -c1-300 "$work/stderr")' does not match '$pattern'"
    fi
    if [ "$(wc -c <"$work/stderr")" -gt 1000 ]; then
        fail "$what: an error line of $(wc -c <"$work/stderr") bytes"
    fi
}
