#!/usr/bin/env bash
# The programs in a shell's daily life: interrupts, full disks, closed pipes, standard input,
# other programs' formats, narrow terminals, and equal output from equal work.
# shellcheck disable=SC2016 # inner shells expand their own arguments
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"
set -m # a job of its own gets the signals that a shell's background job would ignore

"$gen" --kind random --count 4 --seed 3 --out "$work/stream.jsonl"
"$gen" --kind full --count 12 --seed 4 --out "$work/sets.jsonl"
cat "$work/sets.jsonl" "$work/stream.jsonl" >"$work/mixed.jsonl"
"$gen" --kind random --count 100000 --seed 5 --out "$work/endless.jsonl"
scenario=(--scenario D-R5A3O1 --repack anytime --budget-nodes 5000)

# wait_for_lines FILE COUNT PID: until the file has so many lines, half a minute at most.
wait_for_lines() {
    for _ in $(seq 300); do
        if [ -f "$1" ] && [ "$(wc -l <"$1")" -ge "$2" ]; then return 0; fi
        kill -0 "$3" 2>/dev/null || return 1
        sleep 0.1
    done
    return 1
}

# ---- Interrupts ----------------------------------------------------------------------------------
for signal in INT TERM; do
    for threads in 1 2; do
        what="SIG$signal with $threads threads"
        rm -f "$work/part.jsonl"
        "$pack" --in "$work/endless.jsonl" --out "$work/part.jsonl" --quiet --threads $threads \
            "${scenario[@]}" 2>"$work/stderr" &
        job=$!
        wait_for_lines "$work/part.jsonl" 3 $job || fail "$what: no bins to interrupt"
        kill -$signal $job
        status=0
        wait $job || status=$?
        expected=$([ $signal = INT ] && echo 130 || echo 143)
        [ "$status" = "$expected" ] || fail "$what: exit code $status, expected $expected"
        [ ! -s "$work/stderr" ] || fail "$what: $(head -1 "$work/stderr")"
        bins=$(wc -l <"$work/part.jsonl")
        if [ "$bins" -ge 100000 ]; then fail "$what: came too late to tell"; fi
        if [ "$(tail -c 1 "$work/part.jsonl" | od -An -tx1 | tr -d ' ')" != 0a ]; then
            fail "$what: a torn line"
        fi
        if have_checker; then
            judge "$work/endless.jsonl" "$work/part.jsonl" --bins "$bins" >"$work/verdict" 2>&1 ||
                fail "$what: $(head -1 "$work/verdict")"
        fi
    done
done

# A reader that waits for more input hears the interrupt too.
mkfifo "$work/fifo"
rm "$work/part.jsonl"
"$pack" --in "$work/fifo" --out "$work/part.jsonl" --quiet &
job=$!
exec 7>"$work/fifo"
cat "$work/sets.jsonl" >&7
wait_for_lines "$work/part.jsonl" 12 $job || fail 'bins of a pipe are not written as they come'
kill -INT $job
status=0
wait $job || status=$?
exec 7>&-
[ "$status" = 130 ] || fail "an interrupt while reading: exit code $status"
[ "$(wc -l <"$work/part.jsonl")" = 12 ] || fail 'an interrupt while reading lost bins'

# A second interrupt ends a bin that takes long.
{
    printf '{"id":"slow","bin":[128,128],"items":[[1,1]'
    printf ',[2,1],[1,2],[1,1],[3,2]%.0s' $(seq 2000)
    printf ']}\n'
} >"$work/slow.jsonl"
"$pack" --in "$work/slow.jsonl" --out "$work/slow.out" --quiet --scenario D-R5A3O1 --budget-nodes 0 &
job=$!
sleep 1
kill -INT $job
sleep 1
kill -INT $job 2>/dev/null || fail 'the first interrupt ended a bin half-way'
status=0
{ wait $job || status=$?; } 2>/dev/null
[ "$status" = 130 ] || fail "the second interrupt: exit code $status"
[ ! -s "$work/slow.out" ] || fail 'a bin was written that the second interrupt cut off'

# timeout signals the process and its group: that is one interrupt, not two.
status=0
"$gen" --kind random --count 20000 --seed 6 --out "$work/long.jsonl"
timeout --preserve-status -s INT 3 "$pack" --in "$work/long.jsonl" --out "$work/part.jsonl" \
    --quiet "${scenario[@]}" || status=$?
[ "$status" = 130 ] || fail "under timeout: exit code $status"
[ -s "$work/part.jsonl" ] || fail 'under timeout: no bin was finished'

# ---- Writes that fail ----------------------------------------------------------------------------
expect_error 1 '/dev/full: No space left' 'a full disk' \
    "$pack" --in "$work/mixed.jsonl" --out /dev/full "${scenario[@]}"
expect_error 1 '/dev/full: No space left' 'a full disk' "$gen" --out /dev/full
expect_error 1 'standard output: No space left' 'a full disk for the summary' \
    bash -c '"$0" --in "$1" --out "$2" >/dev/full' "$pack" "$work/sets.jsonl" "$work/out"
expect_error 1 'standard output: Broken pipe' 'a pipe closed early' \
    bash -c '"$0" --in "$1" --quiet | head -1 >/dev/null; exit "${PIPESTATUS[0]}"' \
    "$pack" "$work/endless.jsonl"
expect_error 1 'standard output: Broken pipe' 'a pipe closed early' \
    bash -c '"$0" --kind full --count 100000 | head -1 >/dev/null; exit "${PIPESTATUS[0]}"' "$gen"
# A file that may not grow further ends with a whole line.
expect_error 1 'limited.jsonl: File too large' 'a file size limit' \
    bash -c 'ulimit -f 8; trap "" XFSZ; exec "$0" --in "$1" --out "$2"' \
    "$pack" "$work/endless.jsonl" "$work/limited.jsonl"
if [ "$(wc -l <"$work/limited.jsonl")" -lt 2 ] ||
    [ "$(tail -c 1 "$work/limited.jsonl" | od -An -tx1 | tr -d ' ')" != 0a ]; then
    fail 'a file at its size limit ends in a torn line'
fi

# ---- Equal work, equal output --------------------------------------------------------------------
run() {
    local out=$1
    shift
    "$pack" --in "$work/mixed.jsonl" --out "$out" --quiet "${scenario[@]}" "$@" ||
        fail "packing with $*: exit code $?"
}
run "$work/a.jsonl" --seed 7
run "$work/b.jsonl" --seed 7
same_episodes 'the same run twice' "$work/a.jsonl" "$work/b.jsonl"
for threads in 2 5; do
    run "$work/b.jsonl" --seed 7 --threads $threads
    same_episodes "$threads threads" "$work/a.jsonl" "$work/b.jsonl"
done
"$pack" --out "$work/b.jsonl" --quiet --seed 7 "${scenario[@]}" <"$work/mixed.jsonl"
same_episodes 'standard input' "$work/a.jsonl" "$work/b.jsonl"
"$pack" --in - --out - --quiet --seed 7 "${scenario[@]}" <"$work/mixed.jsonl" >"$work/b.jsonl"
same_episodes 'standard output' "$work/a.jsonl" "$work/b.jsonl"
"$pack" --seed 7 "${scenario[@]}" <"$work/mixed.jsonl" >"$work/b.jsonl" 2>"$work/summary"
same_episodes 'standard output beside a summary' "$work/a.jsonl" "$work/b.jsonl"
grep -q '^utilisation' "$work/summary" || fail 'no summary on stderr beside episodes'
{
    printf '\xef\xbb\xbf'
    sed 's/$/\r/' "$work/mixed.jsonl"
    printf '\r\n'
} >"$work/dos.jsonl"
"$pack" --in "$work/dos.jsonl" --out "$work/b.jsonl" --quiet --seed 7 "${scenario[@]}"
same_episodes 'CR LF and a byte order mark' "$work/a.jsonl" "$work/b.jsonl"
for kind in random full; do
    "$gen" --kind $kind --count 5 --seed 9 >"$work/one"
    "$gen" --kind $kind --count 5 --seed 9 --out "$work/two"
    cmp -s "$work/one" "$work/two" || fail "$kind: the same seed gives other instances"
    "$gen" --kind $kind --count 5 --seed 10 >"$work/two"
    ! cmp -s "$work/one" "$work/two" || fail "$kind: another seed gives the same instances"
done
[ "$("$gen" --kind random --count 3 | grep -o '\],\[' | wc -l)" = 41 ] ||
    fail 'a stream on 10x10 has 14 items a bin'

# ---- Formats -------------------------------------------------------------------------------------
echo '{"id":"s1","bin":[10,8],"items":[[3,4],[5,2],[5,2],[2,6],[4,4]]}' >"$work/set.jsonl"
printf '3 4\n5 2\n5\t2\n\n 2 6 \n4 4' >"$work/plain"
echo ' [[3,4],[5,2],[5,2],[2,6],[4,4]]' >"$work/arrays"
printf 'ID,WIDTH,HEIGHT,PROFIT,COPIES\n0,3,4,12,1\n1,5,2,10,2\n2,2,6,12,1\n3,4,4,16,1\n' >"$work/csv"
printf 'ID,WIDTH,HEIGHT\n0,10,8\n' >"$work/bins.csv"
printf ' 1\n 4\n 10 8\n 3 4 1 12\n 5 2 2 10\n 2 6 1 12\n 4 4 1 16\n' >"$work/ngcut"
printf '1\n4\n10 8\n3 4 0 1 12\n5 2 0 2 10\n2 6 1 1 12\n4 4 0 1 16\n' >"$work/ngcut5"
printf '4\n10 8\n3 4 1 12\n5 2 2 10\n2 6 1 12\n4 4 1 16\n' >"$work/ngcut1"
echo '{"id":"s1","bin":[320,260],"items":[[90,120],[149.5,58],[148,60],[60,176],[120,118.5]]}' >"$work/mm"
printf '90 120\n149.5 58\n148 60\n60 176\n120 118.5\n' >"$work/mm-plain"
"$pack" --in "$work/set.jsonl" --out "$work/a.jsonl" --quiet --scenario S-R5A3
same_as_set() {
    local file=$1
    shift
    "$pack" --in "$work/$file" --out "$work/b.jsonl" --quiet --scenario S-R5A3 "$@" ||
        fail "$file: exit code $?"
    same_episodes "format $file" "$work/a.jsonl" "$work/b.jsonl"
}
same_as_set plain --bin 10x8
same_as_set plain --bin 10x8 --format plain
same_as_set plain --bins-file "$work/bins.csv"
same_as_set arrays --bin 10x8
same_as_set csv --bins-file "$work/bins.csv"
same_as_set csv --bin 10x8
same_as_set ngcut
same_as_set ngcut5
same_as_set ngcut1
same_as_set mm --cell 30 --margin 10
same_as_set mm --cell 30 --margin 10 --clearance 0
same_as_set mm-plain --cell 30 --margin 10 --bin 320x260
# Several problems in a file, several lines of arrays, a stream of several bins.
printf '2\n1\n5 5\n2 3 2 1\n2\n6 4\n3 3 1 1\n1 4 2 1\n' >"$work/ngcut2"
"$pack" --in "$work/ngcut2" --quiet >"$work/b.jsonl"
[ "$(grep -o '"id":"[^"]*","bin_index":[0-9]*,"bin":[^]]*]' "$work/b.jsonl" | tr '\n' ' ')" = \
    '"id":"s1","bin_index":0,"bin":[5,5] "id":"s2","bin_index":0,"bin":[6,4] ' ] ||
    fail 'two ngcut problems'
printf '[[5,5],[5,5]]\n[[2,2]]\n' >"$work/arrays2"
[ "$("$pack" --in "$work/arrays2" --bin 5x5 --bins 3 --quiet | wc -l)" = 3 ] ||
    fail 'streams from arrays'
printf 'WIDTH,HEIGHT,COPIES\n5,5,2\n' >"$work/bins.csv"
printf '5 5\n5 5\n5 5\n' >"$work/plain"
[ "$("$pack" --in "$work/plain" --bins-file "$work/bins.csv" --quiet | grep -c '"id":"r1"')" = 2 ] ||
    fail 'a stream of COPIES bins'
# Clearance and fixed rectangles in millimetres take the cells that they touch.
echo '{"id":"s1","bin":[100,100],"fixed":[[20,20,10,10]],"items":[[40,40],[10,10]]}' >"$work/mm"
"$pack" --in "$work/mm" --out "$work/b.jsonl" --quiet --cell 10 --clearance 2 --rotation off
grep -q '"utilization":0.38,' "$work/b.jsonl" || # 9 fixed, 25 and 4
    fail "clearance: $(grep -o '"utilization":[^,]*' "$work/b.jsonl")"

# ---- Drawings ------------------------------------------------------------------------------------
"$pack" --in "$work/stream.jsonl" --out "$work/a.jsonl" --svg "$work/new/svg" >"$work/summary"
[ "$(find "$work/new/svg" -name '*-r1-*.svg' | wc -l)" = "$(wc -l <"$work/a.jsonl")" ] ||
    fail 'not one drawing a bin'
if command -v python3 >/dev/null; then
    for drawing in "$work"/new/svg/*.svg; do
        python3 -c 'import sys, xml.dom.minidom as m; m.parse(sys.argv[1])' "$drawing" ||
            fail "$drawing is not XML"
    done
fi
grep -q '^bins  *4,' "$work/summary" || fail 'no summary on standard output'
echo '{"id":"../x/<&>","bin":[5,5],"items":[[2,3]]}' >"$work/odd.jsonl"
"$pack" --in "$work/odd.jsonl" --out "$work/a.jsonl" --svg "$work/odd" --quiet
[ "$(ls "$work/odd")" = 000001-.._x____-0.svg ] || fail "an odd id is drawn as $(ls "$work/odd")"
echo '{"id":"wide","bin":[128,2],"fixed":[[0,0,64,2]],"items":[[64,2]]}' >"$work/wide.jsonl"
COLUMNS=20 "$pack" --in "$work/wide.jsonl" --out "$work/a.jsonl" >"$work/summary"
grep -q '^##########aaaaaaaaa$' "$work/summary" || fail 'a wide bin on a narrow terminal'
if "$pack" --in "$work/sets.jsonl" --out "$work/a.jsonl" 2>&1 >/dev/null | grep -q .; then
    fail 'progress in a pipe'
fi
if script -qec true /dev/null >/dev/null 2>&1; then
    COLUMNS=20 TERM=xterm script -qec \
        "'$pack' --in '$work/stream.jsonl' --out '$work/a.jsonl'" /dev/null </dev/null >"$work/typed"
    tr '\r' '\n' <"$work/typed" | sed -E 's/\x1b\[K//g' >"$work/lines"
    grep -qE '^[0-9]+ %  [0-9]+ bins' "$work/lines" || fail 'no progress on a terminal'
    if grep -E '^[0-9]+ %|^[a-zA-Z.#]+$' "$work/lines" | grep -qE '.{21}'; then
        fail 'a line wider than a narrow terminal'
    fi
fi
finish
