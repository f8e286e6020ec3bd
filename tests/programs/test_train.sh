#!/usr/bin/env bash
# packcell-train: a minute of training packs better than placing at random, a killed training goes
# on and gives the same curve, an interrupt keeps what was learned, bad options end in one line.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"

train=$(find_program packcell-train)
if [ -z "$train" ]; then
    echo "packcell-train is not under $build"
    exit 1
fi

# column FILE NAME: the last row's value of that column.
column() {
    awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) at = i }
                          END { print $at }' "$1"
}

above() {
    awk -v a="$1" -v b="$2" 'BEGIN { exit !(a + 0 > b + 0) }'
}

# ---- It learns -----------------------------------------------------------------------------------
# Items uniform on 1..5 placed anywhere on 10x10 until one has no position: mean use in per cent.
at_random=$(python3 - <<'PYTHON'
import random

random.seed(1)
total, bins = 0, 400
item = (random.randint(1, 5), random.randint(1, 5))
for _ in range(bins):
    taken = [[False] * 10 for _ in range(10)]
    while True:
        w, h = item
        open_at = [(x, y) for y in range(11 - h) for x in range(11 - w)
                   if not any(taken[j][i] for j in range(y, y + h) for i in range(x, x + w))]
        if not open_at:
            break
        x, y = random.choice(open_at)
        for j in range(y, y + h):
            taken[j][x:x + w] = [True] * w
        item = (random.randint(1, 5), random.randint(1, 5))
    total += sum(map(sum, taken))
print(total / bins)
PYTHON
)
small=(--workers 2 --channels 16 --features 64 --hidden 64)
"$train" "${small[@]}" --updates 1000 --every 500 --measure-bins 1000 --checkpoint "$work/a.pkt" \
    --csv "$work/a.csv" --svg "$work/a.svg" --out "$work/a.pkw" >"$work/rows"
learned=$(column "$work/a.csv" held_out)
echo "at random $at_random %, after $(column "$work/a.csv" bins) bins $learned %"
above "$learned" "$at_random" || fail "held-out $learned %, at random $at_random %"
above "$learned" 73 || fail "held-out $learned %, expected more than 73"
above "$(column "$work/a.csv" held_out_turning)" 79 || fail "turning items: 79 % expected"
[ "$(wc -l <"$work/rows")" = 3 ] || fail "$(wc -l <"$work/rows") rows told, expected 3"
python3 -c "import sys, xml.dom.minidom as m; m.parse(sys.argv[1])" "$work/a.svg" ||
    fail "the drawing is no XML"

# The policy is one that the packer loads and packs with.
"$gen" --kind random --count 20 --out "$work/in"
"$pack" --in "$work/in" --out "$work/episodes" --quiet --scenario S-R1A1 --rotation off \
    --policy "$work/a.pkw" || fail "packing with the trained policy"
if have_checker; then judge "$work/in" "$work/episodes" >/dev/null || fail "illegal episodes"; fi

# It can be timed.
bench=$(find_program packcell-bench)
"$bench" inference --policy "$work/a.pkw" --seconds 0.05 --json >"$work/json" ||
    fail "packcell-bench inference"
grep -q '"batch":64.*"evaluations_per_second":[1-9]' "$work/json" || fail "inference: $(cat "$work/json")"

# ---- Tables --------------------------------------------------------------------------------------
# Small bins are learned in seconds; the optimum is 92.07 % and 94.61 % where items turn.
"$train" --learner afterstate --bin 4x4 --updates 300001 --every 100000 --quiet \
    --csv "$work/t.csv" --out "$work/t.pkw" --checkpoint "$work/t.pkt" || fail "--learner afterstate"
above "$(column "$work/t.csv" held_out)" 90.5 || fail "tables: $(column "$work/t.csv" held_out) %"
above "$(column "$work/t.csv" held_out_turning)" 93.8 ||
    fail "tables, turning: $(column "$work/t.csv" held_out_turning) %"
above 92.8 "$(column "$work/t.csv" held_out)" || fail "tables: better than the optimum"
# Gone on with to more updates than were asked for at first.
"$train" --learner afterstate --bin 4x4 --updates 310000 --every 100000 --quiet \
    --checkpoint "$work/t.pkt" --out "$work/t.pkw" || fail "afterstate: more updates"
"$gen" --kind random --count 20 --bin 4x4 --out "$work/in4"
"$pack" --in "$work/in4" --out "$work/episodes" --quiet --scenario S-R5A1 --policy "$work/t.pkw" ||
    fail "packing with tables"
if have_checker; then judge "$work/in4" "$work/episodes" >/dev/null || fail "illegal episodes"; fi
"$train" --help >"$work/help"
for updates in 60000 20000000 1000000; do
    grep -q "$updates" "$work/help" || fail "--help: nothing about $updates updates"
done

# ---- Killed and resumed --------------------------------------------------------------------------
tiny=("${small[@]}" --environments 8 --updates 200 --every 20 --checkpoint-every 3
    --measure-bins 50 --seed 5)
"$train" "${tiny[@]}" --csv "$work/whole.csv" --out "$work/whole.pkw" --quiet
for round in 1 2 3 4; do
    "$train" "${tiny[@]}" --csv "$work/killed.csv" --checkpoint "$work/killed.pkt" --quiet &
    pid=$!
    sleep "0.$((round * 2))"
    kill -9 "$pid" 2>/dev/null || true
    wait "$pid" 2>/dev/null || true
done
"$train" "${tiny[@]}" --csv "$work/killed.csv" --checkpoint "$work/killed.pkt" \
    --out "$work/killed.pkw" --quiet
cmp -s "$work/whole.csv" "$work/killed.csv" || fail "the curve of the killed training differs"
cmp -s "$work/whole.pkw" "$work/killed.pkw" || fail "the policy of the killed training differs"

# ---- Interrupted ---------------------------------------------------------------------------------
"$train" --csv "$work/int.csv" --checkpoint "$work/int.pkt" --out "$work/int.pkw" --quiet \
    --measure-bins 10 --workers 1 &
pid=$!
for _ in $(seq 100); do
    [ -s "$work/int.csv" ] && break
    sleep 0.1
done
sleep 0.5
kill -TERM "$pid"
status=0
wait "$pid" || status=$?
[ "$status" = 143 ] || fail "exit code $status after SIGTERM"
for file in int.pkt int.pkw int.csv; do
    [ -s "$work/$file" ] || fail "$file is missing after an interrupt"
done

# ---- Bad options ---------------------------------------------------------------------------------
refuses() {
    local pattern=$1
    shift
    expect_error 2 "^packcell-train: $pattern" "$*" "$train" "$@"
}
refuses "--learner 'q': must be one of a3c, afterstate" --learner q
refuses "--network 'x': must be one of one-bin, any-bin" --network x
refuses "--bin '0x5': must be WxH" --bin 0x5
refuses "--sides '0-5': must be A-B" --sides 0-5
refuses "--sides '3-11': must be A-B, two whole numbers, 1..10" --sides 3-11
refuses "--protocol '0': must be carry or a whole number" --protocol 0
refuses "--rotation 'maybe': must be one of off, on, mixed" --rotation maybe
refuses "--reward-fill '1.5': must be a number 0..1" --reward-fill 1.5
refuses "--workers '0': must be a whole number, 1..64" --workers 0
refuses "--updates '-1': must be" --updates=-1
refuses "--hours '0': must be a number above 0" --hours 0
refuses "--gamma 'nan': must be a number" --gamma nan
refuses "--name 'A B': must be 1..31 characters" --name 'A B'
refuses "" --no-such-option
for option in '--network one-bin' '--reward-fill 0' '--workers 1' '--environments 2' '--steps 8' \
    '--gamma 0.9' '--learning-rate 0.01' '--entropy 0' '--value-weight 1' '--clip 1' \
    '--channels 8' '--features 8' '--hidden 8' '--anneal 0'; do
    # shellcheck disable=SC2086
    refuses "${option% *}: must go with --learner a3c" --learner afterstate $option
done
expect_error 1 "bin 13x9: an afterstate policy needs sides 2..12" "a bin too large for tables" \
    "$train" --learner afterstate --bin 13x9
expect_error 1 "network bin w 2: must be 3..32" "a bin too small" "$train" --bin 2x9 --updates 1
expect_error 1 "$work/killed.pkt: was made with another --seed" "another seed" \
    "$train" "${tiny[@]:0:${#tiny[@]}-1}" 6 --checkpoint "$work/killed.pkt"
head -c 1000 "$work/killed.pkt" >"$work/short.pkt"
expect_error 1 "short.pkt: byte 992: the checksum" "a checkpoint cut short" \
    "$train" "${tiny[@]}" --checkpoint "$work/short.pkt"
expect_error 1 "^packcell-train: .*No such file" "a folder that is not there" \
    "$train" --updates 1 --measure-bins 1 --out "$work/none/a.pkw" --quiet

finish
