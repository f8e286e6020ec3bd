#!/usr/bin/env bash
# A PLC in software and the gateway together: bins for simulated hours, gateways that are killed, places
# that fail, planners that die. What either wrote down is clean to the independent judge, and the same.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/../programs/common.sh" "$@"
# shellcheck source=tests/programs/jobs.sh
source "$here/../programs/jobs.sh"
PATH=$PATH:/usr/sbin
build=$(realpath "$build") # for programs that are started from elsewhere

gateway=$(find_program packcell-gateway)
softplc=$(find_program packcell-softplc)
planner=$(find_program packcell-planner)
sim=$(find_program packcell-sim)
for program in "$gateway" "$softplc" "$planner" "$sim"; do
    if [ -z "$program" ]; then
        echo "packcell-gateway, -softplc, -planner or -sim is not under $build"
        exit 1
    fi
done
if ! command -v python3 >/dev/null; then
    echo 'python3 is not installed'
    exit 77
fi
judged=no
if have_checker; then
    checker=$(realpath "$checker")
    judged=yes
fi
drive=$(realpath "$here/softplc/drive.py")

soak_seconds=600
kill_count=5
end_kills=2
seeds=1
if [ "${PACKCELL_CHECK_ALL:-}" = 1 ]; then
    soak_seconds=7200
    kill_count=25
    end_kills=25
    seeds=5
fi
scan=1 # cycle of the soft PLC, ms
# A sanitised gateway keeps what it freed for a while, which must not look as if it grew.
export ASAN_OPTIONS=quarantine_size_mb=2:thread_local_quarantine_size_kb=64${ASAN_OPTIONS:+:$ASAN_OPTIONS}
patience=120 # seconds that a slow machine gets for what must come

cd "$work"

# ---- Tools ---------------------------------------------------------------------------------------
# has FILE PATTERN
has() {
    grep -qE -- "$2" "$1"
}

# says WHAT FILE PATTERN: the file has it, now or soon.
says() {
    within $patience has "$2" "$3" || {
        fail "$1: nothing like '$3' in $2"
        tail -3 "$2" | cut -c1-300
    }
}

ended() {
    ! kill -0 "$1" 2>/dev/null
}

# ends WHAT CODE JOB [SIGNAL...]: with that exit code, once it got these signals.
ends() {
    local what=$1 code=$2 ending=$3 status=0 number
    shift 3
    for number in "$@"; do
        kill "-$number" "$ending" 2>/dev/null || true
        sleep 0.2 # two of them at once may arrive as one
    done
    if ! within $patience ended "$ending"; then
        fail "$what: still runs"
        return
    fi
    wait "$ending" 2>/dev/null || status=$?
    [ "$status" = "$code" ] || fail "$what: exit code $status, expected $code"
}

# start NAME [OPTION...]: a gateway with NAME.journal and NAME.log; sets `serving` and `port`.
start() {
    local name=$1
    shift
    rm -f "$name.log" # the last start's would be taken for this one's
    "$gateway" --journal "$name.journal" --port 0 "$@" 2>"$name.log" &
    serving=$!
    jobs_started+=("$serving")
    within $patience has "$name.log" 'modbus listens at ' || {
        fail "$name: does not listen"
        tail -2 "$name.log"
    }
    port=$(grep -oE 'listens at [0-9.]+:[0-9]+' "$name.log" | grep -oE '[0-9]+$' || echo 0)
}

# start_plc NAME [OPTION...]: at `port`; NAME.json has the totals once it ended; sets `plc`.
start_plc() {
    local name=$1
    shift
    "$softplc" --connect "127.0.0.1:$port" --scan "$scan" --patience $patience --json \
        --episodes "$name.episodes" --instances "$name.instances" "$@" \
        >"$name.json" 2>"$name.errors" &
    plc=$!
    jobs_started+=("$plc")
}

# plc_ends NAME CODE [SIGNAL...]
plc_ends() {
    local name=$1 code=$2
    shift 2
    ends "$name" "$code" "$plc" "$@"
    [ ! -s "$name.errors" ] || {
        fail "$name: it complains"
        head -3 "$name.errors" | cut -c1-300
    }
}

closed() {
    python3 "$drive" registers "$port" 224 2 | awk '{ print $1 * 65536 + $2 }'
}

# closes MANY: at least so many bins since the gateway's journal was made.
closes() {
    [ "$(closed)" -ge "$1" ]
}

# totals NAME CONDITION: of which the Python expression over the totals `r` is true.
totals() {
    python3 "$drive" fields "$1.json" "$2" || fail "$1: $2"
}

# agree NAME [OPTION...]: once its gateway has ended: the soft PLC and the journal tell the same, and
# both keep the rules. The options are the gateway's.
agree() {
    local name=$1 wrote bins
    shift
    timeout $patience "$gateway" --journal "$name.journal" "$@" \
        --episodes "$name.journal.episodes" --instances "$name.journal.instances" \
        2>"$name.stderr" || fail "$name: no episodes of its journal"
    python3 "$drive" same "$name.episodes" "$name.journal.episodes" ||
        fail "$name: soft PLC and journal tell different things"
    bins=$(wc -l <"$name.episodes")
    [ "$bins" -gt 0 ] || fail "$name: no bin"
    timeout $patience "$gateway" --journal "$name.journal" --print-journal >"$name.records" ||
        fail "$name: --print-journal"
    # The first one says that there is a bin at all.
    [ "$(grep -c BIN_CHANGED "$name.records")" = $((bins + 1)) ] ||
        fail "$name: $bins bins, but another number in --print-journal"
    [ $judged = yes ] || return 0
    for wrote in "$name" "$name.journal"; do
        judge "$wrote.instances" "$wrote.episodes" --bins "$bins" || fail "$name: the judge of $wrote"
    done
}

# packs NAME "GATEWAY OPTIONS" [OPTION...]: a run of both from the first to the last bin.
packs() {
    local name=$1 counted
    read -ra ours <<<"$2"
    shift 2
    start "$name" "${ours[@]}"
    start_plc "$name" "$@"
    plc_ends "$name" 0
    counted=$(closed)
    # Where two ask, the second one may be too late for a plan that only ends the bin.
    totals "$name" "r['bins'] == $counted and r['rejects'] <= r['bins'] and r['restarts'] == 0"
    ends "$name: the gateway" 130 "$serving" INT
    agree "$name" "${ours[@]}"
}

# ---- Command line --------------------------------------------------------------------------------
"$softplc" --help >text || fail '--help'
[ "$(wc -L <text)" -le 100 ] || fail '--help: a line of more than 100 columns'
for option in --connect --channels --cyclic --accelerate --resolve --place-failures 'Exit codes: '; do
    grep -q -e "$option" text || fail "--help: nothing about $option"
done
"$softplc" --version | grep -qE '^packcell-softplc [0-9]+\.[0-9]+\.[0-9]+$' || fail '--version'
# refuses PATTERN OPTION...: bad usage.
refuses() {
    local pattern=$1
    shift
    expect_error 2 "^packcell-softplc: $pattern" "$*" timeout $patience "$softplc" "$@"
}
refuses '.*--bogus' --bogus
refuses '.*bare' bare
refuses "--connect 'host': must be" --connect host
refuses "--connect 'host:0': must be" --connect host:0
refuses "--connect 'host:70000': must be" --connect host:70000
refuses "--scenario 'S-R9': " --scenario S-R9
refuses "--kind 'odd': must be" --kind odd
refuses "--bins '0': must be" --bins 0
refuses "--seconds '0': must be" --seconds 0
refuses "--seconds 'nan': must be" --seconds nan
refuses "--place-failures '1': must be a number 0\.\.0\.9" --place-failures 1
refuses "--deadline '60001': must be" --deadline 60001
refuses "--channels '3': must be" --channels 3
refuses "--channels '2': must go with a scenario of two arms" --scenario S-R5A3 --channels 2
refuses "--scan '0': must be" --scan 0
refuses "--resolve 'maybe': must be" --resolve maybe
refuses "--job '0': must be" --job 0
refuses "--instances 'x': must be another file" --episodes x --instances x
refuses "--episodes and --instances '-': must be a file" --episodes -
[ ! -e x ] || fail 'a refusal leaves a file'
expect_error 1 "^packcell-softplc: .*none/x" 'no such folder' \
    timeout $patience "$softplc" --episodes none/x
expect_error 1 "^packcell-softplc: .*none\.json" 'no such cell' \
    timeout $patience "$softplc" --cell ./none.json

away=$(python3 -c 'import socket
s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
expect_error 1 "^packcell-softplc: 127\.0\.0\.1:$away: no living gateway for [12] s" 'no gateway' \
    timeout $patience "$softplc" --connect "127.0.0.1:$away" --patience 1

# ---- In real time, beside all that follows -------------------------------------------------------
# Small bins and arms in a hurry: some ten seconds.
"$sim" --cell scara --print-cell | python3 -c 'import json, sys
cell = json.load(sys.stdin)
cell["dwells"].update(stroke=0.001, grip=0, release=0, scale=0.01)
cell["belt"].update(speed=5, acceleration=50)
cell["bin"]["cell_mm"] = 90
cell["tool_speed"] = 20
cell["planning"] = {"task": [[0, 0], [0, 0]], "motion": [[0, 0], [0, 0]]}
json.dump(cell, open("fast.json", "w"))'
start real
start_plc real --cell ./fast.json --kind full
real_serving=$serving real_plc=$plc real_port=$port real_began=$SECONDS

# ---- Soak ----------------------------------------------------------------------------------------
start soak --repack full
python3 "$drive" sample "$serving" "$port" soak.samples &
jobs_started+=("$!")
start_plc soak --accelerate --repack full --seconds "$soak_seconds"
# Longer than any patience where it is the long one.
soak_end=$((SECONDS + 60 + soak_seconds / 2))
until ended "$plc" || [ "$SECONDS" -ge "$soak_end" ]; do sleep 0.1; done
plc_ends soak 0
counted=$(closed)
totals soak "r['bins'] == $counted and r['seconds'] >= $soak_seconds and r['utilization'] > 0.99"
totals soak "r['rejects'] == r['restarts'] == r['resolved'] == 0"
ends 'soak: the gateway' 130 "$serving" INT
python3 "$drive" grown soak.samples "$soak_seconds" || fail 'soak: memory'
agree soak --repack full

# ---- Killed gateways -----------------------------------------------------------------------------
# killed NAME SEED "GATEWAY OPTIONS" OPTION...: drive.py tells of the seed. The last bin is finished by
# Ctrl-C once the last kill is over.
killed() {
    local name=$1 seed=$2 killer
    read -ra ours <<<"$3"
    shift 3
    python3 "$drive" kills "$gateway" "$kill_count" "$seed" "$name" "${ours[@]}" 2>"$name.kills" &
    killer=$!
    jobs_started+=("$killer")
    if ! within $patience test -s "$name.port"; then
        fail "$name: no gateway"
        return
    fi
    port=$(cat "$name.port")
    start_plc "$name" --accelerate --seconds 1000000 "${ours[@]}" "$@"
    is_over() { [ -e "$name.done" ] || ended "$plc" || ended "$killer"; }
    within $((patience + 10 * kill_count)) is_over || fail "$name: not all of the kills"
    plc_ends "$name" 130 INT
    totals "$name" "r['restarts'] == $kill_count and r['bins'] == $(closed)"
    ends "$name: the killer" 0 "$killer" TERM
    [ ! -s "$name.kills" ] || fail "$name, seed $seed: $(tail -1 "$name.kills")"
    agree "$name" "${ours[@]}"
}
killed resolve $RANDOM '--repack full' --resolve on
killed finish $RANDOM '--repack full' --resolve off
killed resolve_two $RANDOM '--repack full' --resolve on --channels 2
killed finish_two $RANDOM '--repack full' --resolve off --channels 2 --cyclic
# A plan that only ends the bin leaves nothing to resolve; a slow scan has not read it by then.
scan=20 kill_count=$end_kills
killed bin_end end '--repack off' --resolve on
scan=1

# ---- Places that fail ----------------------------------------------------------------------------
for seed in $(seq $seeds); do
    packs "failing$seed" '--repack full' --accelerate --bins 2 --repack full --place-failures 0.2 \
        --seed "$seed"
    totals "failing$seed" "r['failed_places'] > 0"
done
packs two '' --accelerate --bins 1 --channels 2
packs failing_two '' --accelerate --bins 2 --place-failures 0.2 --channels 2

# ---- One arm, other items, every image in every scan ---------------------------------------------
packs single '--scenario S-R5A3' --scenario S-R5A3 --accelerate --bins 1
packs full '--repack anytime' --accelerate --bins 1 --repack anytime --kind full
packs cyclic '--scenario S-R5A3 --rotation off --buffer 1 --repack full' --scenario S-R5A3 \
    --rotation off --accelerate --bins 2 --repack full --cyclic

# ---- Scenarios and states that do not fit --------------------------------------------------------
start other
expect_error 1 "^packcell-softplc: .*: scenario D-R5A3O1: must be S-R5A3$" 'another scenario' \
    timeout $patience "$softplc" --connect "127.0.0.1:$port" --scan 1 --accelerate --quiet \
    --scenario S-R5A3
recorded() { python3 "$drive" registers "$port" 218 2 | cut -d' ' -f2; }
before=0
works() { [ "$(recorded)" -gt $((before + 10)) ]; }
start_plc left --accelerate --seconds 1000000
within $patience works || fail 'a cell that somebody left: no work'
kill -KILL "$plc"
expect_error 1 "^packcell-softplc: the gateway knows [0-9]+ items .*must begin empty" \
    'a cell that somebody left' \
    timeout $patience "$softplc" --connect "127.0.0.1:$port" --scan 1 --accelerate --quiet
ends 'another scenario: the gateway' 143 "$serving" TERM

# ---- Ctrl-C --------------------------------------------------------------------------------------
start interrupted
start_plc interrupted --accelerate --seconds 1000000
within $patience works || fail 'Ctrl-C: no work'
plc_ends interrupted 130 INT
totals interrupted "r['bins'] == $(closed) and r['bins'] > 0"
python3 "$drive" registers "$port" 221 3 >left
[ "$(cat left)" = '0 0 0' ] || fail "Ctrl-C: bin, belt and buffers hold $(cat left)"
before=$(recorded)
start_plc terminated --accelerate --seconds 1000000
within $patience works || fail 'SIGTERM: no work'
plc_ends terminated 143 TERM
# In real time a bin takes a minute: the second one does not wait for it.
begun=$SECONDS
start_plc twice
reports() { [ "$(python3 "$drive" registers "$port" 222 1)" -gt 0 ]; }
within $patience reports || fail 'two Ctrl-C: no work'
ends 'two Ctrl-C' 130 "$plc" INT INT
[ ! -s twice.episodes ] || [ $((SECONDS - begun)) -gt 30 ] || fail 'two Ctrl-C: a bin was finished'
ends 'Ctrl-C: the gateway' 130 "$serving" INT

# ---- A pool of planners --------------------------------------------------------------------------
if command -v mosquitto >/dev/null; then
    port_open() {
        python3 -c 'import socket, sys
socket.create_connection(("127.0.0.1", int(sys.argv[1])), 1).close()' "$1"
    }
    # A port may be taken between its choice and its use.
    for attempt in 1 2 3 4 5; do
        broker_port=$((20000 + RANDOM % 12000))
        {
            echo "listener $broker_port 127.0.0.1"
            [ "$(id -u)" != 0 ] || echo 'user root' # else it could not read what lies in our folder
            printf '%s\n' 'set_tcp_nodelay true' 'allow_anonymous true'
        } >broker.conf
        mosquitto -c broker.conf >broker.log 2>&1 &
        broker=$!
        jobs_started+=("$broker")
        if within 10 port_open "$broker_port" && ! ended "$broker"; then break; fi
        [ "$attempt" != 5 ] || fail 'mosquitto does not start'
    done
    for name in first second; do
        "$planner" --mqtt "127.0.0.1:$broker_port" 2>$name.log &
        jobs_started+=("$!")
        declare "$name=$!"
        says 'a planner' $name.log 'ready at broker'
    done
    start pool --pool --mqtt "127.0.0.1:$broker_port"
    says 'the pool' pool.log 'mqtt.*(ready|connected)'
    start_plc pool --accelerate --seconds 1000000 --deadline 400
    says 'the first planner' first.log 'planned request'
    says 'the second planner' second.log 'planned request'
    within $patience closes 1 || fail 'pool: no bin'
    # shellcheck disable=SC2154 # declared above
    kill -KILL "$first"
    wait "$first" 2>/dev/null || true
    within $patience closes $(($(closed) + 2)) || fail 'pool: no bins without one planner'
    # shellcheck disable=SC2154
    kill -KILL "$second"
    wait "$second" 2>/dev/null || true
    says 'without planners' pool.log 'no plan from the pool.*planned here'
    within $patience closes $(($(closed) + 1)) || fail 'pool: no bins without planners'
    plc_ends pool 130 INT
    totals pool "r['bins'] == $(closed) and r['rejects'] == r['restarts'] == 0"
    ends 'pool: the gateway' 130 "$serving" INT
    agree pool
else
    echo 'mosquitto is not installed: the pool is not tested'
fi

# ---- What was begun in real time -----------------------------------------------------------------
plc=$real_plc port=$real_port
plc_ends real 0
totals real "r['bins'] == 1 == $(closed) and r['rejects'] == r['restarts'] == 0 and r['seconds'] > 2"
[ $((SECONDS - real_began)) -ge 2 ] || fail 'real time: it did not wait for the arms'
ends 'real time: the gateway' 130 "$real_serving" INT
agree real
finish
