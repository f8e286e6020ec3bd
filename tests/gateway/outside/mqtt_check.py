"""The gateway beside an MQTT broker: last will, retained topics, events that get lost nowhere, job
orders, and a broker that comes, goes or refuses.

usage: mqtt_check.py GATEWAY
"""
import json
import os
import socket
import subprocess
import sys
import threading

from harness import (PATIENCE, Gateway, check, equal, finish, journal_records, spawn,
                     within, work)
from plc import FAILED, JOB_END, JOB_START, Plc, words32

CELL = "line-4"
BASE = "packcell/%s/" % CELL
OFFLINE = {"state": "Offline", "state_code": 0}


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def is_open(port):
    try:
        socket.create_connection(("127.0.0.1", port), 1).close()
        return True
    except OSError:
        return False


class Broker:
    """mosquitto, which keeps sessions and what is retained over a restart."""

    def __init__(self, name, *lines, port=None):
        self.name, self.lines = name, lines
        self.process = None
        for _ in range(5):  # a port may be taken between its choice and its use
            self.port = port or free_port()
            if self.start():
                return
        sys.exit("mosquitto does not start")

    def start(self):
        folder = work / (self.name + "-data")
        folder.mkdir(exist_ok=True)
        config = work / (self.name + ".conf")
        lines = ["listener %d 127.0.0.1" % self.port, "set_tcp_nodelay true", "persistence true",
                 "persistence_location %s/" % folder, *self.lines]
        if os.getuid() == 0:
            lines.append("user root")  # else it could not write to our folder
        config.write_text("\n".join(lines) + "\n", encoding="utf-8")
        with open(work / (self.name + ".log"), "ab") as log:
            self.process = spawn(["mosquitto", "-c", config], stdout=log, stderr=log)
        return within(lambda: is_open(self.port) or self.process.poll() is not None, "a broker") \
            and self.process.poll() is None

    def stop(self):
        self.process.terminate()
        self.process.wait(PATIENCE)

    def to(self, *options):
        return ["-h", "127.0.0.1", "-p", self.port, *options]

    def publish(self, topic, text, *options):
        subprocess.run([str(p) for p in
                        ["mosquitto_pub", *self.to(*options), "-q", "1", "-t", topic, "-s"]],
                       input=text.encode(), check=True, timeout=PATIENCE)

    def retained(self, topic):
        """What a newcomer gets; {} if that is nothing."""
        done = subprocess.run([str(p) for p in ["mosquitto_sub", *self.to(), "-t", topic, "-C", "1",
                                                "-W", "5"]],
                              capture_output=True, text=True, timeout=PATIENCE, check=False)
        return json.loads(done.stdout) if done.stdout else {}


class Listener:
    """mosquitto_sub with a session that outlives the broker's absence: [(topic, message)]."""

    def __init__(self, broker):
        self.got = []
        command = ["mosquitto_sub", *broker.to(), "-V", "mqttv311", "-i", "mes", "-c", "-q", "1",
                   "-v", "-t", "ready"]
        for topic in ("state", "bin", "event"):
            command += ["-t", BASE + topic]
        self.process = spawn(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        threading.Thread(target=self._read, daemon=True).start()

        def subscribed():
            broker.publish("ready", "{}")
            return any(topic == "ready" for topic, _ in self.got)
        within(subscribed, "a subscription")

    def _read(self):
        for line in self.process.stdout:
            topic, _, text = line.partition(" ")
            self.got.append((topic, json.loads(text)))

    def events(self, kind=None):
        return [m for topic, m in list(self.got) if topic == BASE + "event" and
                (m["kind"] == kind if kind else "sequence" in m)]

    def state(self):
        """The last one that came, {} before the first."""
        return ([{}] + [m for topic, m in list(self.got) if topic == BASE + "state"])[-1]

    def answers(self):
        return self.events("order response")


def complete(listener, plc, what):
    """Every record of the journal has come, in order; some may have come twice."""
    def last():
        return 65536 * plc.read(218)[0] + plc.read(219)[0]

    within(lambda: any(e["sequence"] == last() for e in listener.events()), what + ": the last event")
    first = list(dict.fromkeys(e["sequence"] for e in listener.events()))
    equal(first, list(range(1, last() + 1)), what + ": sequences of the events")


def packing(plc, item):
    """A few commands and a plan that is carried out."""
    for i in range(5):
        plc.arrive(item + i, 2, 1 + i % 3)
    for action in plc.plan(200)[1]:
        check(plc.carry_out(action) == 0, "item %d" % action.item)


def start(journal, broker, *options, ready=True):
    gateway = Gateway(journal, "--cell", CELL, "--mqtt", "127.0.0.1:%d" % broker.port, *options)
    if ready:
        gateway.says("^mqtt connected", "a broker")
    return gateway


def events_and_state():
    broker = Broker("broker", "allow_anonymous true")
    listener = Listener(broker)
    journal = work / "journal"
    gateway = start(journal, broker)
    plc = Plc(gateway.port)
    plc.bring("Execute")
    packing(plc, 1)
    complete(listener, plc, "at first")
    within(lambda: broker.retained(BASE + "state").get("state") == "Execute", "the retained state")
    state = broker.retained(BASE + "state")
    equal(state, {"state": "Execute", "state_code": 6, "job": None, "jobs_waiting": 0,
                  "unresolved": [], "boot_id": 1}, "state")
    items = plc.read(221)[0]
    within(lambda: len(broker.retained(BASE + "bin").get("items", [])) == items, "items in the topic bin")
    shown = broker.retained(BASE + "bin")
    equal((shown["w"], shown["h"], shown["closed"]), (10, 10, 0), "bin")
    area = sum(i["w"] * i["h"] for i in shown["items"])
    check(items > 0 and abs(shown["utilization"] - area / 100) < 1e-9, "utilization: %s" % shown)

    # kill -9: the broker tells. What was planned and not confirmed is in the next state.
    check(plc.plan(200)[0] == 1, "a plan")
    planned = sorted({a.item for a in plc.actions() if a.item})
    gateway.kill()
    within(lambda: listener.state() == OFFLINE, "the last will")
    equal(broker.retained(BASE + "state"), OFFLINE, "the retained last will")
    gateway = start(journal, broker)
    plc = Plc(gateway.port)
    within(lambda: listener.state().get("unresolved") == planned, "unresolved items in state")
    equal(listener.state()["boot_id"], 2, "boot_id after a restart")
    complete(listener, plc, "after kill -9")
    for item in planned:
        plc.must(FAILED, *words32(item))
    plc.bring("Execute")

    # Without the broker the cell goes on, also over kill -9; nothing is missing afterwards.
    broker.stop()
    gateway.says("^mqtt away", "a broker that went")
    packing(plc, 100)
    gateway.kill()
    gateway = start(journal, broker, ready=False)
    plc = Plc(gateway.port)
    plc.bring("Execute")
    packing(plc, 200)
    broker.start()
    gateway.says("^mqtt connected", "the broker is back")
    complete(listener, plc, "after an outage")
    packing(plc, 300)
    # Gone in the midst of it.
    for i in range(20):
        plc.arrive(400 + i, 1, 1)
        if i == 5:
            broker.stop()
        if i == 15:
            broker.start()
    complete(listener, plc, "after a short outage")
    numbers = [e["sequence"] for e in listener.events()]
    print("%d events, %d of them twice" % (len(set(numbers)), len(numbers) - len(set(numbers))))
    equal([e["kind"] for e in listener.events()[:2]], ["boot", "command"], "the first events")

    equal(gateway.end(), 143, "exit code")
    within(lambda: listener.state() == OFFLINE, "the last word of an orderly end")
    by_number = {e["sequence"]: e for e in listener.events()}
    equal([by_number[r["sequence"]] for r in journal_records(journal)], journal_records(journal),
          "events and --print-journal")
    return broker, listener


def order(number, command="Store", **fields):
    return json.dumps({"Command": command, "JobOrder": {"JobOrderID": number, **fields}})


def job_orders(broker, listener):
    journal = work / "orders"
    gateway = start(journal, broker)
    plc = Plc(gateway.port)

    def answered(what, text, accepted, pattern=""):
        count = len(listener.answers())
        broker.publish(BASE + "job", text)
        if not within(lambda: len(listener.answers()) > count, what + ": an answer"):
            return
        answer = listener.answers()[-1]
        equal(answer["accepted"], accepted, "%s: accepted (%s)" % (what, answer))
        reason = answer.get("reason", "")
        check(pattern in reason and len(reason) < 500, "%s: reason '%s'" % (what, reason[:500]))

    def shown(what, number, waiting):
        equal(plc.read(229, 3), [*words32(number), waiting], what + ": registers 229..231")

    shown("no order", 0, 0)
    answered("an order", order(70000, Description="bins", Priority=3), True)
    shown("an order", 70000, 1)
    answered("a second one", order(4294967295), True)
    answered("the same again", order(70000), False, "known already")
    shown("two orders", 70000, 2)
    answered("not there", order(9, "Cancel"), False, "does not wait")
    answered("withdrawn", order(4294967295, "Cancel"), True)
    shown("withdrawn", 70000, 1)
    for what, text, pattern in (
            ("0", order(0), "'JobOrder.JobOrderID' 0: must be"),
            ("too large a number", order(4294967296), "must be a whole number"),
            ("a number below", order(-1), "must be a whole number"),
            ("a fraction", order(1.5), "must be a whole number"),
            ("no number", order([1]), "JobOrderID"),
            ("another command", order(5, "Erase"), "Store, Cancel"),
            ("no command", '{"JobOrder":{"JobOrderID":5}}', "'Command' is missing"),
            ("no order", '{"Command":"Store"}', "'JobOrder' is missing"),
            ("no id", '{"Command":"Store","JobOrder":{}}', "JobOrderID"),
            ("no JSON", "Store 7", "JSON"),
            ("a list", "[7]", "JSON object"),
            ("nothing", " ", "JSON"),
            ("very deep", "[" * 5000, "deep"),
            ("a megabyte", order(5, Description="x" * 1000000), "must have at most 65536"),
    ):
        answered(what, text, False, pattern)
    shown("after refusals", 70000, 1)
    gateway.kill()
    gateway = start(journal, broker)
    plc = Plc(gateway.port)
    shown("after kill -9", 70000, 1)
    answered("known over the restart", order(70000), False, "known already")
    equal(plc.state(), "Stopped", "an order moves nothing: state")
    plc.bring("Execute")
    plc.must(JOB_START, *words32(70000))
    shown("started", 0, 0)
    within(lambda: listener.state().get("job") == 70000, "the job in the topic state")
    plc.must(JOB_END)
    plc.reaches("Complete")
    within(lambda: listener.state().get("state") == "Complete", "Complete in the topic state")
    within(lambda: listener.state().get("job", 1) is None, "no job in the topic state")
    gateway.end()
    stored = [r["job"] for r in journal_records(journal) if r["kind"] == "order"]
    equal(stored, [70000, 4294967295], "orders in the journal")


def unreachable_and_password():
    port = free_port()
    password = work / "password"
    subprocess.run(["mosquitto_passwd", "-b", "-c", str(work / "users"), "cell", "right one"],
                   check=True, capture_output=True, timeout=PATIENCE)
    gateways = []
    for name, secret in (("right", "right one"), ("wrong", "wrong one")):
        password = work / name
        password.write_text(secret + "\n", encoding="utf-8")
        gateway = Gateway(work / ("login-" + name), "--mqtt", "127.0.0.1:%d" % port,
                          "--mqtt-user", "cell", "--mqtt-password-file", password)
        gateways.append(gateway)
        gateway.says("^mqtt away.*refused", "no broker")
        plc = Plc(gateway.port)
        plc.bring("Execute")
        packing(plc, 1)
    Broker("secure", "allow_anonymous false", "password_file %s" % (work / "users"), port=port)
    right, wrong = gateways
    right.says("^mqtt connected", "a broker that comes later")
    wrong.says("^mqtt away.*[Nn]ot authori", "a wrong password")
    with open("/proc/%d/cmdline" % right.process.pid, encoding="utf-8") as line:
        check("right one" not in line.read(), "the password is on the command line")
    for gateway in gateways:
        plc = Plc(gateway.port)
        equal(plc.state(), "Execute", "state beside a broker")
        packing(plc, 50)
        equal(gateway.end(), 143, "exit code")


def main():
    broker, listener = events_and_state()
    job_orders(broker, listener)
    unreachable_and_password()
    finish()


main()
