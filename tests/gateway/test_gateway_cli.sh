#!/usr/bin/env bash
# packcell-gateway's command line: help, refusals in one line, its configuration file, its ends, its log,
# and the episodes that it writes of a journal.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/../programs/common.sh" "$@"
# shellcheck source=tests/programs/jobs.sh
source "$here/../programs/jobs.sh"

gateway=$(find_program packcell-gateway)
if [ -z "$gateway" ]; then
    echo "packcell-gateway is not under $build"
    exit 1
fi
cd "$work"

# has FILE PATTERN
has() {
    grep -qE -- "$2" "$1"
}

# start NAME [OPTION...]: its log goes to NAME.log; sets `job`.
start() {
    local name=$1
    shift
    rm -f "$name.log" # the last start's would be taken for this one's
    "$gateway" --journal "$name.journal" --port 0 "$@" >"$name.out" 2>"$name.log" &
    job=$!
    jobs_started+=("$job")
    within 30 has "$name.log" 'modbus listens at ' || {
        fail "$name: does not listen"
        tail -2 "$name.log"
    }
    port=$(grep -oE 'listens at [0-9.]+:[0-9]+' "$name.log" | grep -oE '[0-9]+$' || echo 0)
}

ended() {
    ! alive "$1"
}

# ends WHAT CODE SIGNAL: the last one that was started.
ends() {
    local status=0
    kill "-$3" "$job" 2>/dev/null || true
    if ! within 30 ended "$job"; then
        fail "$1: still runs"
        return
    fi
    wait "$job" || status=$?
    [ "$status" = "$2" ] || fail "$1: exit code $status, expected $2"
}

# ---- Help ----------------------------------------------------------------------------------------
"$gateway" --help >text || fail '--help'
for option in $(grep -oE '`--[a-z-]+' "$source/docs/gateway.md" | tr -d '`' | sort -u); do
    # The page names options of other programs too.
    case $option in --cell | --clearance | --connect | --accelerate) continue ;; esac
    grep -qE -- "$option( |,|$)" text || fail "--help: nothing about $option of docs/gateway.md"
done
[ "$(wc -L <text)" -le 100 ] || fail '--help: a line of more than 100 columns'
grep -q 'Exit codes: ' text || fail '--help: no exit codes'
"$gateway" --version | grep -qE '^packcell-gateway [0-9]+\.[0-9]+\.[0-9]+$' || fail '--version'
[ ! -e packcell-gateway.journal ] || fail '--help or --version leaves a journal'

# ---- Refusals ------------------------------------------------------------------------------------
# refuses PATTERN OPTION...: bad usage.
refuses() {
    local pattern=$1
    shift
    expect_error 2 "^packcell-gateway: $pattern" "$*" timeout 5 "$gateway" "$@"
}
# fails PATTERN OPTION...
fails() {
    local pattern=$1
    shift
    expect_error 1 "^([0-9TZ:.-]+ )?packcell-gateway: $pattern" "$*" \
        timeout 20 "$gateway" --quiet --port 0 "$@"
}
refuses '.*--bogus' --bogus
refuses '.*stray' stray
refuses '.*--port.*' --port
refuses "--port '65536': must be a whole number, 0\.\.65535" --port 65536
refuses "--port 'x': must be" --port x
refuses "--port '-1': must be" --port -1
refuses "--bind 'localhost': must be an IPv4 address" --bind localhost
refuses "--bind '0.0.0.0': must go with --allow" --bind 0.0.0.0
refuses "--allow '10.0.0.1/8': must be an IPv4 network" --bind 0.0.0.0 --allow 10.0.0.1/8
refuses "--writer-a '10.0.0.5': must be an address inside" --writer-a 10.0.0.5
refuses "--writer-b 'x': must be an IPv4 address" --writer-b x
refuses "--cell '': must be 1\.\.64" --cell ''
refuses "--cell 'a/b': must be" --cell a/b
refuses "--cell '#': must be" --cell '#'
refuses "--bin '0x10': must be" --bin 0x10
refuses "--bin '10': must be" --bin 10
refuses "--bin '129x1': must be" --bin 129x1
refuses ".*--scenario.*S-R9" --scenario S-R9
refuses "--word-order 'DCBA': must be ABCD or CDAB" --word-order DCBA
refuses "--heartbeat-ms '99': must be a whole number, 100\.\.60000" --heartbeat-ms 99
refuses "--reserve-ms '1001': must be a whole number, 0\.\.1000" --reserve-ms 1001
refuses "--rotation 'maybe': must be" --rotation maybe
refuses "--repack 'some': must be" --repack some
refuses "--mqtt 'host:0': must be HOST" --mqtt host:0
refuses "--mqtt-password-file: must go with --mqtt-user" --mqtt 127.0.0.1 --mqtt-password-file x
refuses '--pool: must go with --mqtt' --pool
refuses ".*--http" --http nonsense
refuses '.*--config.*|.*none\.conf' --config none.conf
printf 'bogus = 1\n' >bad.conf
refuses '.*bogus' --config bad.conf
printf 'port = many\n' >bad.conf
refuses "--port 'many': must be" --config bad.conf
printf 'port = 0\nno line of a configuration\n' >bad.conf
refuses '.*' --config bad.conf
[ -z "$(ls -- *.journal* 2>/dev/null)" ] || fail "bad usage leaves a journal: $(echo *.journal*)"

mkdir folder
fails "'.*missing/journal.*No such file" --journal missing/journal
fails "'folder': Is a directory" --journal folder
head -c 5000 /dev/urandom >random
cp random before
fails "journal 'random': is not a journal" --journal random
printf 'x' >short
fails "journal 'short': is not a journal" --journal short
python3 -c 'import sqlite3
c = sqlite3.connect("other"); c.execute("CREATE TABLE t(x)"); c.commit()'
fails "journal 'other': is an SQLite file of another program" --journal other
fails "journal 'other': is an SQLite" --journal other --print-journal
fails ".*absent" --journal absent --print-journal
fails ".*absent" --journal absent --episodes absent.episodes
[ ! -e absent ] || fail 'a journal that is only to be printed is made'
cmp -s random before || fail 'a file that is no journal was changed'
fails ".*nothing.pkw" --journal policy --policy ./nothing.pkw
fails "--mqtt-password-file 'nothing': must be a file" --journal mqtt --mqtt 127.0.0.1:1 --mqtt-user u --mqtt-password-file nothing

# ---- At work -------------------------------------------------------------------------------------
start one
[ ! -s one.out ] || fail 'something on stdout'
expect_error 1 "^packcell-gateway: Modbus at 127\.0\.0\.1:$port: Address already in use" 'a port in use' \
    timeout 20 "$gateway" --quiet --journal two.journal --port "$port"
expect_error 1 "another gateway has it open" 'a journal in use' \
    timeout 20 "$gateway" --journal one.journal --port 0
ends 'SIGTERM' 143 TERM
start one
ends 'Ctrl-C' 130 INT
start one
{ kill -KILL "$job" && wait "$job"; } 2>/dev/null || true # the shell would tell of a kill
# A line an event, each with its time and kind.
while read -r line; do
    [[ $line =~ ^[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9:]{8}\.[0-9]{3}Z\ [a-z]+!?\ .+$ ]] ||
        fail "a log line: '$line'"
done <one.log
has one.log 'journal one\.journal: 2 records, the last is 2$' || fail 'the log does not say where it stands'
has one.log 'start boot 3, journal at 3$' || fail 'the log does not say which boot'

# Nothing is said, so the port tells when it is there; it may be taken between its choice and its use.
answers() {
    (exec 3<>"/dev/tcp/127.0.0.1/$port") || ended "$job"
}
for _ in 1 2 3; do
    port=$(python3 -c 'import socket
s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
    "$gateway" --quiet --journal one.journal --port "$port" 2>quiet.log &
    job=$!
    jobs_started+=("$job")
    within 30 answers || fail '--quiet: does not start'
    if alive "$job"; then break; fi
done
ends '--quiet' 143 TERM
[ ! -s quiet.log ] || fail "--quiet: '$(head -1 quiet.log)'"
timeout 20 "$gateway" --journal one.journal --print-journal >records.txt || fail '--print-journal'
[ "$(grep -c '"kind":"boot"' records.txt)" -ge 4 ] || fail '--print-journal: not all boots'
[ "$(wc -l <records.txt)" = "$(grep -c '^{"sequence":[0-9]*,"time":"2.*}$' records.txt)" ] ||
    fail '--print-journal: other lines than records'

cat >cell.conf <<'CONF'
# A cell of its own.
cell = "line-7"
journal = "configured.journal"
bin = "12x9"
word-order = "CDAB"
scenario = "S-R4A2"
CONF
"$gateway" --config cell.conf --port 0 2>configured.log &
job=$!
jobs_started+=("$job")
within 30 has configured.log 'modbus listens at ' || fail "--config: $(tail -1 configured.log)"
ends '--config' 143 TERM
[ -e configured.journal ] || fail '--config: another journal'
# What stands on the command line counts more.
"$gateway" --config cell.conf --port 0 --journal line.journal 2>line.log &
job=$!
jobs_started+=("$job")
within 30 has line.log 'modbus listens at ' || fail "--config and options: $(tail -1 line.log)"
ends '--config and options' 143 TERM
[ -e line.journal ] || fail 'an option does not count more than --config'

# ---- Episodes ------------------------------------------------------------------------------------
python=/usr/bin/python3
if ! "$python" -c 'import pymodbus' 2>/dev/null; then
    [ "${PACKCELL_REQUIRE_CLIENTS:-}" != 1 ] || fail 'pymodbus is not installed'
    echo 'pymodbus is not installed: episodes are not tested'
elif have_checker; then
    # judged NAME BINS [OPTION...]: as a PLC packs them; then they are judged.
    judged() {
        local name=$1 bins=$2
        shift 2
        start "$name" "$@"
        "$python" "$source/tests/gateway/outside/pack_bins.py" "$port" "$bins" ||
            fail "$name: packing"
        ends "$name" 143 TERM
        "$gateway" --journal "$name.journal" --episodes "$name.episodes" \
            --instances "$name.instances" "$@" || fail "$name: --episodes"
        [ "$(wc -l <"$name.episodes")" = "$bins" ] ||
            fail "$name: $(wc -l <"$name.episodes") episodes of $bins"
        judge "$name.instances" "$name.episodes" --bins "$bins" --summary >judge.txt 2>&1 || {
            fail "$name: the checker refuses its episodes"
            tail -3 judge.txt
        }
        echo "$name: $(head -1 judge.txt | cut -c1-200)"
    }
    judged packing 3
    judged repacking 3 --repack full --scenario D-R5A3O1
    judged single 2 --scenario S-R4A2 --repack anytime
else
    echo "the checker is not there: episodes are not judged"
fi
finish
