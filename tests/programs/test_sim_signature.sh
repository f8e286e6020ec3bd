#!/usr/bin/env bash
# Schedules and simulations are the same, bit for bit, in every build: the hashes are those that
# tests/golden/sim-hashes.txt has. After a change that is meant to change them:
#   bash tests/programs/test_sim_signature.sh BUILD_DIR SOURCE_DIR --store
set -euo pipefail
build=$1
source=$2
golden=$source/tests/golden/sim-hashes.txt

sim=$build/bin/packcell-sim
if ! "$sim" --print-cell >/dev/null 2>&1; then
    echo "this build has no cell"
    exit 77
fi

hashes() {
    local cell mode
    for cell in ur5e paper piper scara; do
        for mode in sync mutex coordinated; do
            echo "$cell $mode $("$sim" --cell "$cell" --mode "$mode" --policy contact --count 2 \
                --sigma 0.3 --sigma-yaw 0.1 --seed 4 --quiet --json \
                | grep -oE '"(schedule_)?hash":"[0-9a-f]+"' | tr '\n' ' ')"
        done
    done
}

if [ "${3:-}" = --store ]; then
    hashes >"$golden"
else
    diff "$golden" <(hashes)
fi
