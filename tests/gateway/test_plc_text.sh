#!/usr/bin/env bash
# The function blocks in Structured Text, which nothing here compiles: read as far as a script can, and
# their constants beside those of the twin in C. Some faults that must be seen come after that.
set -euo pipefail
plc=$2/examples/gateway/plc
read_text=$2/tests/gateway/plc_text.py
command -v python3 >/dev/null || {
    echo "python3 is not installed"
    exit 77
}

python3 "$read_text" "$plc/packcell.st" "$plc/packcell_fb.h"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
# seen WHAT PATTERN SED_SCRIPT: the text, changed so, is refused like that
seen() {
    sed -E "$3" "$plc/packcell.st" >"$work/changed.st"
    if cmp -s "$plc/packcell.st" "$work/changed.st"; then
        echo "$1: nothing was changed"
    elif python3 "$read_text" "$work/changed.st" "$plc/packcell_fb.h" >"$work/said" 2>&1; then
        echo "$1: unseen"
    elif ! grep -q "$2" "$work/said"; then
        echo "$1: $(head -1 "$work/said")"
    else
        return 0
    fi
    failures=$((failures + 1))
}
seen "a torn :=" "must be ':='" '/PACKCELL_JOB_END : WORD/s/:=/: =/'
seen "a torn number" "no token" 's/16#504B/16 #504B/'
seen "another value" "PACKCELL_SEQ_GAP: 3" '/PACKCELL_SEQ_GAP : /s/2;/3;/'
seen "a constant that is missing" "PACKCELL_NO_PLAN: None" '/PACKCELL_NO_PLAN : /d'
seen "an IF without an end" "ends nothing" '0,/END_IF;/s/END_IF;//'
seen "a name of nothing" "'ack_sec' is not declared" '0,/ack_seq = seq/s/ack_seq = seq/ack_sec = seq/'
[ "$failures" = 0 ]
