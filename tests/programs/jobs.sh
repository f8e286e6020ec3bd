# shellcheck shell=bash
# For tests that start programs in the background; sourced after common.sh. What a test puts into
# jobs_started ends with it, and so does what that has started.
set -m # jobs of their own get the signals that a shell's background job would ignore

jobs_started=()
clean_up() {
    local started
    for started in "${jobs_started[@]}"; do
        # Whoever drives another program ends it when told to.
        kill -TERM "$started" 2>/dev/null || true
    done
    sleep 0.2
    for started in "${jobs_started[@]}"; do
        kill -KILL -- "-$started" 2>/dev/null || true
    done
    wait 2>/dev/null || true
    rm -rf "$work"
}
trap clean_up EXIT

# within SECONDS COMMAND...: tries until it succeeds.
within() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.05
    done
}

alive() {
    kill -0 "$1" 2>/dev/null
}
