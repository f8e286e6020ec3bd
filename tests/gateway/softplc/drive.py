#!/usr/bin/env python3
"""Beside a packcell-softplc at work: looks at its gateway, kills it, and compares what both wrote.

usage: drive.py registers PORT FIRST COUNT
       drive.py sample PID PORT FILE          until that process has ended
       drive.py grown FILE SECONDS            of simulated time that the samples cover
       drive.py kills GATEWAY KILLS SEED|end PREFIX [OPTION...]   until SIGTERM
       drive.py same EPISODES EPISODES
       drive.py fields FILE CONDITION         a Python expression over the file's JSON line `r`

Only the standard library is used.
"""
import json
import pathlib
import random
import signal
import socket
import struct
import subprocess
import sys
import time

PATIENCE = 60  # seconds until something that must come counts as missing
STATUS, STATE, QUEUE_DEPTH, JOURNAL_SEQUENCE, BINS_CLOSED = 200, 5, 15, 18, 24
SUSPENDING = 13
WARM_UP = 0.25  # of the bins, until caches and heaps have found their size
MEGABYTES_AN_HOUR = 2


class Client:
    """Reads registers; a failure of any kind is an OSError."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), PATIENCE)

    def receive(self, size):
        data = b""
        while len(data) < size:
            part = self.socket.recv(size - len(data))
            if not part:
                raise ConnectionError("closed by the gateway")
            data += part
        return data

    def read(self, first, count):
        self.socket.sendall(struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, first, count))
        length, _, code = struct.unpack(">4xHBB", self.receive(8))
        body = self.receive(length - 2)
        if code != 3:
            raise ConnectionError("exception %d" % body[0])
        return struct.unpack(">%dH" % count, body[1:])

    def status(self):
        return self.read(STATUS, 32)


def double_word(words, at):
    return words[at] << 16 | words[at + 1]


# ---- A run that is watched -----------------------------------------------------------------------
def resident_kilobytes(pid):
    with open("/proc/%d/status" % pid, encoding="ascii") as lines:
        return next((int(line.split()[1]) for line in lines if line.startswith("VmRSS:")), None)


def sample(pid, port, path):
    """A line each: bins closed, journal sequence, resident kilobytes."""
    client = Client(int(port))
    with open(path, "w", encoding="ascii") as out:
        while True:
            try:
                size = resident_kilobytes(int(pid))
                words = client.status()
            except OSError:
                return
            if size is None:
                return
            print(double_word(words, BINS_CLOSED), double_word(words, JOURNAL_SEQUENCE), size,
                  file=out, flush=True)
            time.sleep(0.05)


def grown(path, seconds):
    """From the first quarter's most to the last quarter's least: what is kept, not what is lent."""
    rows = [tuple(map(int, line.split())) for line in pathlib.Path(path).read_text().splitlines()]
    bins = rows[-1][0]
    if bins < 4 or len(rows) < 8:
        sys.exit("too few samples: %d, of %d bins" % (len(rows), bins))
    share = {}
    for closed, _, size in rows:
        share.setdefault(closed * 10 // bins, size)
    warm = max(size for closed, _, size in rows if closed <= WARM_UP * bins)
    end = min(size for closed, _, size in rows if closed >= (1 - WARM_UP) * bins)
    hours = float(seconds) / 3600
    print("resident: %s kB at 10 %%, %s at 50 %%, %d at the end; %d records, %.2f hours" %
          (share.get(1, "?"), share.get(5, "?"), rows[-1][2], rows[-1][1], hours))
    # Over less than an hour the allowance is an hour's: pages come in larger pieces.
    if end - warm > 1024 * MEGABYTES_AN_HOUR * max(1, hours):
        sys.exit("it grew from %d to %d kB in %.2f simulated hours" % (warm, end, hours))


# ---- A gateway that is killed --------------------------------------------------------------------
class Killed:
    """A gateway on a port of its own that is killed and started again, always with one journal."""

    def __init__(self, program, prefix, options):
        self.command = [program, "--journal", prefix + ".journal", *options]
        self.log = prefix + ".log"
        self.process = self.client = self.port = None

    def start(self):
        """On the port that it had; a new one below those of outgoing connections at first."""
        end = time.monotonic() + PATIENCE
        fixed = self.port
        while time.monotonic() < end:
            self.port = fixed or random.randrange(20000, 32000)
            with open(self.log, "a", encoding="ascii") as log:
                # pylint: disable=consider-using-with
                self.process = subprocess.Popen([*self.command, "--port", str(self.port)],
                                                stderr=log, stdin=subprocess.DEVNULL)
            while self.process.poll() is None and time.monotonic() < end:
                try:
                    self.client = Client(self.port)
                    if self.client.status()[0] == 0x504B and self.process.poll() is None:
                        return
                except OSError:
                    pass
                time.sleep(0.01)
            self.stop(signal.SIGKILL)
        sys.exit("the gateway does not start")

    def stop(self, number):
        if self.process and self.process.poll() is None:
            self.process.send_signal(number)
        return self.process.wait(PATIENCE) if self.process else 0

    def wait_for(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition(self.client.status()):
            if time.monotonic() > end:
                sys.exit("nothing more is done")
            time.sleep(0.001)


def await_moment(gateway, chance):
    """Until it is to be killed: somewhere, within a plan, or without `chance` at a bin's end."""
    if chance is None:
        gateway.wait_for(lambda s: s[STATE] == SUSPENDING)
        return
    wanted = double_word(gateway.client.status(), JOURNAL_SEQUENCE) + chance.randint(3, 40)
    gateway.wait_for(lambda s: double_word(s, JOURNAL_SEQUENCE) >= wanted)
    if chance.random() < 0.5:
        gateway.wait_for(lambda s: s[QUEUE_DEPTH] > 0)
    time.sleep(chance.uniform(0, 0.006))


def kills(program, count, seed, prefix, *options):
    """PREFIX.port, PREFIX.journal, PREFIX.log; PREFIX.done when it was killed that often."""
    chance = None if seed == "end" else random.Random(int(seed))
    gateway = Killed(program, prefix, options)

    def end(*_):
        # The exit code of an orderly end, whatever it was told before.
        sys.exit(0 if gateway.stop(signal.SIGTERM) == 143 else "the gateway's last end")

    try:
        gateway.start()
        signal.signal(signal.SIGTERM, end)
        pathlib.Path(prefix + ".port").write_text(str(gateway.port), encoding="ascii")
        for _ in range(int(count)):
            await_moment(gateway, chance)
            gateway.stop(signal.SIGKILL)
            gateway.start()
        pathlib.Path(prefix + ".done").touch()
        while True:
            signal.pause()
    finally:
        gateway.stop(signal.SIGKILL)


# ---- What was written ----------------------------------------------------------------------------
def same(path_a, path_b):
    """Bin by bin and action by action; what stands in the episodes of the steps themselves too."""
    episodes = [[json.loads(line) for line in pathlib.Path(path).read_text().splitlines()]
                for path in (path_a, path_b)]
    if len(episodes[0]) != len(episodes[1]):
        sys.exit("%d and %d bins" % (len(episodes[0]), len(episodes[1])))
    for a, b in zip(*episodes):
        for name in ("bin_index", "bin", "scenario", "rotation", "repack", "utilization", "packed"):
            if a[name] != b[name]:
                sys.exit("bin %d: %s %s and %s" % (a["bin_index"], name, a[name], b[name]))
        actions = [[action for step in e["steps"] for action in step["actions"]] for e in (a, b)]
        for i, (one, other) in enumerate(zip(*actions)):
            if one != other:
                sys.exit("bin %d, action %d: %s and %s" % (a["bin_index"], i, one, other))
        if len(actions[0]) != len(actions[1]):
            sys.exit("bin %d: %d and %d actions" % (a["bin_index"], *map(len, actions)))


def fields(path, condition):
    text = pathlib.Path(path).read_text()
    r = json.loads(text)
    if not eval("(" + condition + ")", {"r": r}):  # pylint: disable=eval-used
        sys.exit("not so: %s: %s" % (condition, text[:600]))


def main():
    commands = {
        "registers": lambda port, first, count: print(*Client(int(port)).read(int(first),
                                                                              int(count))),
        "sample": sample, "grown": grown, "kills": kills, "same": same, "fields": fields}
    commands[sys.argv[1]](*sys.argv[2:])


main()
