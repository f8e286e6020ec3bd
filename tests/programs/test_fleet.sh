#!/usr/bin/env bash
# Planners behind a broker: the documented request gets the documented answer, whatever else arrives is
# refused with a reason, nothing is planned twice, and planners and broker may die.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"
# shellcheck source=tests/programs/jobs.sh
source "$here/jobs.sh"

planner=$(find_program packcell-planner)
bench=$(find_program packcell-bench)
if [ -z "$planner" ] || [ -z "$bench" ]; then
    echo "packcell-planner and packcell-bench are not under $build"
    exit 1
fi
PATH=$PATH:/usr/sbin
for tool in mosquitto mosquitto_pub mosquitto_sub python3; do
    if ! command -v $tool >/dev/null; then
        echo "$tool is not installed"
        exit 77
    fi
done

requests=packcell/plan/request
answers=packcell/plan/answer

# ---- Tools ---------------------------------------------------------------------------------------
free_port() {
    python3 -c 'import socket
s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

port_open() {
    python3 -c 'import socket, sys
socket.create_connection(("127.0.0.1", int(sys.argv[1])), 1).close()' "$1"
}

# start_broker NAME PORT [LINE...]: with these lines of configuration; sets `broker`.
start_broker() {
    local name=$1 on=$2
    shift 2
    {
        echo "listener $on 127.0.0.1"
        [ "$(id -u)" != 0 ] || echo "user root" # else it could not read what lies in our folder
        printf '%s\n' "set_tcp_nodelay true" "$@"
    } >"$work/$name.conf"
    mosquitto -c "$work/$name.conf" >"$work/$name.log" 2>&1 &
    broker=$!
    jobs_started+=("$broker")
    within 10 port_open "$on"
}

# A port may be taken between its choice and its use.
for attempt in 1 2 3 4 5; do
    port=$(free_port)
    if start_broker broker "$port" "allow_anonymous true" && alive "$broker"; then break; fi
    [ "$attempt" != 5 ] || {
        echo "mosquitto does not start"
        exit 1
    }
done

# start_planner NAME [OPTION...]: its events go to NAME.log; sets `worker`.
start_planner() {
    local name=$1
    shift
    "$planner" "$@" 2>"$work/$name.log" &
    worker=$!
    jobs_started+=("$worker")
}

# has FILE PATTERN
has() {
    grep -qE -- "$2" "$work/$1"
}

# says WHAT FILE PATTERN: the file has it, now or soon.
says() {
    within 20 has "$2" "$3" || {
        fail "$1: nothing like '$3' in $2"
        tail -5 "$work/$2" | cut -c1-300
    }
}

# ends WHAT CODE JOB
ends() {
    local status=0
    if ! within 20 eval "! alive $3"; then
        fail "$1: still runs"
        return
    fi
    wait "$3" || status=$?
    [ "$status" = "$2" ] || fail "$1: exit code $status, expected $2"
}

# listen NAME [OPTION...]: every answer from now on goes to NAME.txt, a line "TOPIC JSON" each. Its
# subscription is there when the retained message came, for that one is asked for last.
listen() {
    local name=$1
    shift
    mosquitto_pub -V 5 -h 127.0.0.1 -p "$port" -r -t test/marker -m listening "$@"
    mosquitto_sub -V 5 -h 127.0.0.1 -p "$port" -v -t "$answers/#" -t test/marker "$@" >"$work/$name.txt" &
    listener=$!
    jobs_started+=("$listener")
    within 10 has "$name.txt" '^test/marker listening$' || fail "$name: no subscription"
}

# ask TOPIC OPTION...: a request whose answer is waited for at $answers/TOPIC.
ask() {
    local topic=$1
    shift
    mosquitto_pub -V 5 -h 127.0.0.1 -p "$port" -q 1 -t "$requests" -D publish response-topic "$answers/$topic" "$@"
}

# request ID [FIELD:VALUE...]: the documented one with other fields, as Python reads them.
request() {
    python3 - "$work/request.json" "$@" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
r["id"] = sys.argv[2]
for change in sys.argv[3:]:
    name, value = change.split(":", 1)
    r[name] = eval(value)
print(json.dumps(r))
PYTHON
}

# answered WHAT TOPIC CONDITION: an answer came there of which the Python expression over `a` is true.
answered() {
    if ! within 20 grep -q "^$answers/$2 " "$work/answers.txt"; then
        fail "$1: no answer"
        return
    fi
    python3 - "$work/answers.txt" "$answers/$2" "$3" <<'PYTHON' || fail "$1"
import json, re, sys
for line in open(sys.argv[1]):
    topic, _, payload = line.partition(" ")
    if topic == sys.argv[2]:
        a = json.loads(payload)
        if not eval("(" + sys.argv[3] + ")"):
            sys.exit("not so: %s: %s" % (sys.argv[3], payload[:300]))
PYTHON
}

count_of() {
    grep -c "^$answers/$1 " "$work/answers.txt" || true
}

# ---- Command line --------------------------------------------------------------------------------
"$planner" --help >"$work/text" || fail '--help'
for option in --mqtt --mqtt-user --mqtt-password-file --mqtt-tls-ca --threads --max-deadline 'Exit codes'; do
    grep -q -e "$option" "$work/text" || fail "--help: nothing about $option"
done
[ "$(wc -L <"$work/text")" -le 100 ] || fail '--help: a line of more than 100 columns'
"$planner" --version | grep -qE '^packcell-planner [0-9.]+$' || fail '--version'
refuses() {
    local pattern=$1
    shift
    expect_error 2 "^packcell-planner: $pattern" "$*" timeout 20 "$planner" "$@"
}
refuses '.*--bogus' --bogus
refuses "--mqtt 'host:0': must be HOST" --mqtt host:0
refuses "--mqtt '': must be HOST" --mqtt ''
refuses "--threads '0': must be a whole number, 1\.\." --threads 0
refuses "--max-deadline 'nan': must be" --max-deadline nan
refuses "--group 'a/b': must be" --group a/b
refuses "--topic '#': must be" --topic '#'
refuses "--mqtt-client-id 'a#': must be" --mqtt-client-id 'a#'
refuses "--mqtt-password-file: must go with --mqtt-user" --mqtt-password-file x
refuses "--mqtt-tls-cert and --mqtt-tls-key" --mqtt-tls-cert x
refuses ".*must go with --mqtt-tls-ca" --mqtt-tls-insecure
refuses "--mqtt-keepalive '1': must be" --mqtt-keepalive 1
expect_error 1 "^packcell-planner: --mqtt-password-file '.*none': must be a file" 'no password file' \
    timeout 20 "$planner" --mqtt-user u --mqtt-password-file "$work/none"
expect_error 1 "^packcell-planner: --mqtt-tls-ca '.*none': must be a file" 'no CA' \
    timeout 20 "$planner" --mqtt-tls-ca "$work/none"

# ---- The documented request ----------------------------------------------------------------------
python3 - "$source/docs/fleet.md" "$work" <<'PYTHON'
import json, re, sys
blocks = re.findall(r"```json\n(.*?)```", open(sys.argv[1]).read(), re.S)
for name, block in zip(("request", "answer"), blocks):
    json.dump(json.loads(block), open("%s/%s.json" % (sys.argv[2], name), "w"))
PYTHON
start_planner first --mqtt "127.0.0.1:$port"
first=$worker
says 'a planner' first.log 'ready at broker 127\.0\.0\.1'
listen answers
ask documented -f "$work/request.json"
same='all(a[k] == d[k] for k in d if k not in ("plan_ms", "repack_ms", "worker"))'
answered 'the documented answer' documented \
    "[d for d in [json.load(open('$work/answer.json'))] if $same and set(a) == set(d)]"
says 'a line for it' first.log "planned request 'cell-1/17' in [0-9.]+ ms"
mosquitto_pub -V 5 -h 127.0.0.1 -p "$port" -q 1 -t "$requests" -m "$(request by-field "reply_to:'$answers/field'")"
answered 'the topic as a field' field 'a["status"] == "planned" and a["id"] == "by-field"'
mosquitto_pub -V mqttv311 -h 127.0.0.1 -p "$port" -q 1 -t "$requests" -m "$(request nowhere)"
within 20 grep -q "^$answers {.*nowhere" "$work/answers.txt" || fail 'no topic: no answer for all'

# ---- What is no request --------------------------------------------------------------------------
refusals=0
# refused PATTERN OPTION...: answered so, with a reason that the regular expression matches.
refused() {
    local pattern=$1
    shift
    refusals=$((refusals + 1))
    ask "bad$refusals" "$@"
    answered "refused $pattern" "bad$refusals" \
        "a['status'] == 'refused' and re.search(r'''$pattern''', a['reason'])
         and len(a['reason']) < 1000"
    alive "$first" || fail "refused $pattern: the planner died"
}
refused '^no JSON: ' -m 'no JSON'
refused '^no JSON: ' -n
refused 'must be a JSON object' -m '[1]'
refused "'id' is missing" -m '{}'
refused "'version' 2: must be a whole number, 1\.\.1" -m "$(request v 'version:2')"
refused "'id' 7: must be a string" -m '{"id":7}'
refused "'scenario': .*S-R9" -m "$(request s 'scenario:"S-R9"')"
refused "'deadline_ms' -1: must be a number, 0\.\." -m "$(request d 'deadline_ms:-1')"
refused "'deadline_ms' 70000.*: must be 0\.\.60000 here" -m "$(request d 'deadline_ms:70000')"
refused "'deadline_ms' \"1\": must be" -m "$(request d 'deadline_ms:"1"')"
refused "'policy' \"/etc/passwd\": must be one of default" -m "$(request p 'policy:"/etc/passwd"')"
refused "'repack' \"some\": must be one of off, anytime, full" -m "$(request r 'repack:"some"')"
refused "'memory' 10+: must be a whole number" -m "$(request m 'memory:10**12')"
refused "'bin' an array: must be an object" -m "$(request b 'bin:[]')"
refused "'bin.w' 129: must be a whole number, 1\.\.128" -m "$(request b 'bin:{"w":129,"h":1}')"
refused "'bin.w' 1\.5: must be" -m "$(request b 'bin:{"w":1.5,"h":1}')"
item='{"id":1,"w":2,"h":2,"x":0,"y":0}'
refused "'bin.items\[0\]': .*2x2 at \(0, 0\)" -m "$(request b "bin:{'w':1,'h':1,'items':[$item]}")"
refused "'bin.items\[1\].id' 1: must be in the request once" \
    -m "$(request b "bin:{'w':9,'h':9,'items':[$item,$item]}")"
refused "'bin.fixed\[0\]' an array: must be \[x,y,w,h\]" \
    -m "$(request b 'bin:{"w":9,"h":9,"fixed":[[1]]}')"
refused "'belt\[0\].w' 0: must be" -m "$(request b 'belt:[{"id":9,"w":0,"h":1}]')"
refused "'belt\[0\].id' 2147483648: must be" -m "$(request b 'belt:[{"id":2**31,"w":1,"h":1}]')"
refused "'buffers\[0\].arm' 2: must be a whole number, 0\.\.1" \
    -m "$(request b 'buffers:[{"id":9,"w":1,"h":1,"arm":2}]')"
refused "'alpha_left' 65: must be" -m "$(request a 'alpha_left:65')"
refused '10x10|larger than|must be' -m "$(request l 'max_side:5')"
python3 -c 'print("[" * 5000)' >"$work/deep"
refused 'at most 6 deep' -f "$work/deep"
head -c 3000000 /dev/zero | tr '\0' 'x' >"$work/huge"
refused 'a message of 3000000 bytes: must have at most 1048576' -f "$work/huge"
# Always the same bytes: others may open more brackets than are allowed, which is another fault.
python3 -c 'import random, sys
sys.stdout.buffer.write(random.Random(1).randbytes(2000))' >"$work/random"
refused '^no JSON: ' -f "$work/random"
# Nothing is published anywhere else than below the answers' topic.
mosquitto_pub -V 5 -h 127.0.0.1 -p "$port" -q 1 -t "$requests" -D publish response-topic elsewhere \
    -m "$(request away)"
within 20 grep -q "^$answers {.*response topic 'elsewhere': must be" "$work/answers.txt" ||
    fail 'another topic: no refusal'
ask future -m "$(request future 'colour:"red"')"
answered 'a field of later versions' future 'a["status"] == "planned"'
ask late -m "$(request late 'deadline_ms:0')"
answered 'a deadline that has passed' late 'a["status"] == "expired" and "0 ms" in a["reason"]'

# ---- Duplicates ----------------------------------------------------------------------------------
for _ in 1 2 3; do ask twice -m "$(request twice)"; done
says 'a duplicate' first.log "duplicate request 'twice'"
ask twice -m "$(request twice 'deadline_ms:300')"
ask after -m "$(request after)"
answered 'after the duplicates' after 'a["status"] == "planned"'
[ "$(grep "^$answers/twice " "$work/answers.txt" | sort -u | wc -l)" = 1 ] ||
    fail 'a duplicate got another answer'
[ "$(grep -c "planned request 'twice'" "$work/first.log")" = 1 ] || fail 'a duplicate was planned'
ask other -m "$(request twice 'nodes:5')"
answered 'an id used for another request' other \
    'a["status"] == "refused" and "used for another request" in a["reason"]'

# ---- Two planners, and the end of one ------------------------------------------------------------
start_planner second --mqtt "[127.0.0.1]:$port" --mqtt-client-id second
second=$worker
says 'the second planner' second.log 'ready at'
for i in $(seq 10); do ask shared -m "$(request "shared-$i")"; done
all_shared() { [ "$(count_of shared)" = 10 ]; }
within 20 all_shared || fail "two planners: $(count_of shared) answers of 10"
workers=$(grep "^$answers/shared " "$work/answers.txt" | grep -o '"worker":"[^"]*"' | sort | uniq -c | wc -l)
[ "$workers" = 2 ] || fail "two planners: $workers of them worked"

kill -TERM "$first"
ends 'SIGTERM' 143 "$first"

# What is at hand is answered before the end: this one takes all the time that it may.
slow=(deadline_ms:2500 nodes:0 'repack:"anytime"' 'scenario:"D-R8A4O0"'
    'bin:{"w":20,"h":20,
          "items":[{"id":99+i,"w":3,"h":3,"x":4*(i%5),"y":4*(i//5)} for i in range(25)]}'
    'belt:[{"id":i,"w":4+i%3,"h":3+i*7%4} for i in range(8)]')
ask slow -m "$(request slow "${slow[@]}")"
received() { # by the planner: only one can be left
    ask quick -m "$(request slow "${slow[@]}")" && has second.log "duplicate request 'slow': in work"
}
within 10 received || fail 'the slow request is not in work'
kill -TERM "$second"
ends 'SIGTERM while it plans' 143 "$second"
answered 'what was at hand' slow 'a["status"] == "planned" and a["proof"] == "budget"'

# ---- Killed in mid-request -----------------------------------------------------------------------
# The bench's planners and cells have topics of their own.
# killed WHAT CONDITION OPTION...: of which the Python expression over the last row `r` is true.
killed() {
    local what=$1 condition=$2
    shift 2
    timeout 120 "$bench" fleet --broker "127.0.0.1:$port" --budget-nodes 20000 --json "$@" \
        >"$work/json" 2>"$work/stderr" || fail "$what: $(head -1 "$work/stderr")"
    python3 -c 'import json, sys
b = json.load(open(sys.argv[1]))
r = b["sections"][0]["rows"][-1]
if not eval("(" + sys.argv[2] + ")"): sys.exit("not so: %s: %s" % (sys.argv[2], r))' \
        "$work/json" "$condition" || fail "$what"
}
killed 'one of two is killed: nothing is lost' \
    'r["planned"] == 80 and r["unanswered"] == r["without_plan"] == r["different_plans"] == 0' \
    --workers 2 --requests 80 --clients 3 --kill-after 20 --deadline-ms 4000
killed 'the only one is killed: the cell is told' \
    'r["unanswered"] > 0 and r["planned"] + r["unanswered"] == 24 and r["without_plan"] == 0
     and "no answer within 500 ms" in r["problem"]' \
    --workers 1 --requests 24 --clients 2 --kill-after 16 --deadline-ms 500

# ---- The broker goes and comes -------------------------------------------------------------------
start_planner third --mqtt "127.0.0.1:$port"
third=$worker
says 'a third planner' third.log 'ready at'
kill -KILL "$broker"
wait "$broker" 2>/dev/null || true
says 'without a broker' third.log 'no connection to broker'
start_planner waiting --mqtt "127.0.0.1:$port"
waiting=$worker
says 'a start without a broker' waiting.log 'no connection to broker .*refused'
kill -INT "$waiting"
ends 'Ctrl-C without a broker' 130 "$waiting"
alive "$third" || fail 'the broker took its planner along'
start_broker broker "$port" "allow_anonymous true" || fail 'the broker does not come back'
twice_ready() { [ "$(grep -c 'ready at' "$work/third.log")" = 2 ]; }
within 30 twice_ready || fail 'the planner does not come back to the broker'
listen answers
ask again -m "$(request again)"
answered 'after the broker came back' again 'a["status"] == "planned"'
kill -TERM "$third"
ends 'SIGTERM after all that' 143 "$third"

# ---- Password and TLS ----------------------------------------------------------------------------
if command -v openssl >/dev/null && command -v mosquitto_passwd >/dev/null; then
    (
        cd "$work"
        openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=test-ca -keyout ca.key -out ca.pem
        openssl req -newkey rsa:2048 -nodes -subj /CN=127.0.0.1 -keyout server.key -out server.csr
        printf 'subjectAltName=IP:127.0.0.1\n' >server.ext
        openssl x509 -req -in server.csr -CA ca.pem -CAkey ca.key -CAcreateserial -days 2 \
            -extfile server.ext -out server.pem
        openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=other -keyout other.key \
            -out other.pem
        mosquitto_passwd -b -c passwords planner 'right one'
    ) >/dev/null 2>&1
    printf 'right one\n' >"$work/right"
    printf 'wrong one\n' >"$work/wrong"
    port=$(free_port)
    start_broker secure "$port" "allow_anonymous false" "password_file $work/passwords" \
        "cafile $work/ca.pem" "certfile $work/server.pem" "keyfile $work/server.key" ||
        fail 'no broker with TLS'
    login=(--cafile "$work/ca.pem" -u planner -P 'right one')
    ours=(--mqtt "127.0.0.1:$port" --mqtt-user planner --mqtt-tls-ca)
    start_planner tls "${ours[@]}" "$work/ca.pem" --mqtt-password-file "$work/right"
    tls=$worker
    says 'TLS and password' tls.log 'ready at'
    listen answers "${login[@]}"
    ask tls "${login[@]}" -m "$(request tls)"
    answered 'over TLS' tls 'a["status"] == "planned"'
    tr '\0' ' ' <"/proc/$tls/cmdline" >"$work/cmdline"
    ! grep -q 'right one' "$work/cmdline" || fail 'the password is on the command line'
    start_planner wrong "${ours[@]}" "$work/ca.pem" --mqtt-password-file "$work/wrong"
    says 'a wrong password' wrong.log 'no connection .*refused: Not authorized'
    kill -INT "$worker"
    ends 'Ctrl-C after a refusal' 130 "$worker"
    start_planner foreign "${ours[@]}" "$work/other.pem" --mqtt-password-file "$work/right"
    says 'a broker that nobody vouches for' foreign.log 'no connection'
    ! has foreign.log 'ready at' || fail 'a foreign certificate was taken'
    kill -INT "$worker"
    ends 'Ctrl-C after a foreign certificate' 130 "$worker"
    kill -TERM "$tls"
    ends 'SIGTERM over TLS' 143 "$tls"
else
    echo 'openssl or mosquitto_passwd is not installed: TLS is not tested'
fi
finish
