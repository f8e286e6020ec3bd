#!/usr/bin/env python3
"""Judges the operator page: its server by plain sockets, the page in headless Chromium.

usage: page_check.py PAGE_SERVER [--shots DIRECTORY]

Exit status 77 where there is no Chromium and the server's part holds. With --shots the pages
as they look are left as PNG files. Times of day are expected in UTC (TZ=UTC).
"""
import argparse
import copy
import json
import os
import pathlib
import random
import re
import select
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "programs"))
from replay_check import BROWSERS, Browser  # noqa: E402

PATIENCE = 30  # seconds until something that must come counts as missing
MOST_STREAMS = 12
MOST_STREAMS_A_PEER = 4
SEED = 20260131

STATE = {
    "cell": "cell-1", "version": "0.1.0", "time": "2026-01-31T12:00:00.123Z", "boot_id": 3,
    "journal": 1234, "state": "Execute", "state_code": 6, "mode": 1, "job": {"id": 7},
    "jobs_waiting": 2, "scenario": "D-R5A3O1",
    "bin": {"w": 10, "h": 10, "utilization": 0.53, "closed": 4, "items": [
        {"id": 12, "x": 0, "y": 0, "w": 3, "h": 2, "rot": 0},
        {"id": 9, "x": 3, "y": 0, "w": 4, "h": 2, "rot": 1},
        {"id": 10, "x": 5, "y": 0, "w": 5, "h": 3, "rot": 0},
        {"id": 11, "x": 0, "y": 4, "w": 2, "h": 6, "rot": 0},
        {"id": 14, "x": 2, "y": 4, "w": 1, "h": 1, "rot": 0},
        {"id": 1005, "x": 5, "y": 3, "w": 3, "h": 5, "rot": 1}], "fixed": [[9, 9, 1, 1]]},
    "belt": [{"id": 13, "w": 2, "h": 2, "arms": 1, "recognized": True},
             {"id": 16, "w": 4, "h": 2, "arms": 3, "recognized": True},
             {"id": 17, "w": 1, "h": 5, "arms": 2, "recognized": True},
             {"id": 18, "w": 3, "h": 3, "arms": 0, "recognized": False},
             {"id": 19, "w": 2, "h": 4, "arms": 0, "recognized": False}],
    "buffers": [{"id": 5, "w": 1, "h": 4, "arm": 0}, {"id": 6, "w": 3, "h": 2, "arm": 1}],
    "step": [{"op": "pack", "item": 16, "x": 3, "y": 5, "rot": 1, "arm": 0, "state": "open"},
             {"op": "unpack", "item": 1005, "x": 5, "y": 3, "rot": 1, "arm": 1, "state": "open"},
             {"op": "skip", "item": 2, "state": "done"},
             {"op": "terminate", "state": "failed"}],
    "unresolved": [],
    "last_plan": {"ms": 12.3, "result": "plan", "deadline_ms": 50, "actions": 2,
                  "proof": "optimal"},
    "arms": [{"ack": 5, "done": 4, "result": 1, "result_name": "plan", "reject": 0,
              "reject_name": "none"},
             {"ack": 91, "done": 90, "result": 0, "result_name": "none", "reject": 6,
              "reject_name": "UNRESOLVED"}],
    "plc": {"seen": True, "age_ms": 120, "stale": False},
    "mqtt": {"enabled": True, "connected": False},
    "alarms": [
        {"time": "2026-01-31T11:58:12.003Z", "text": "arm B: reject 6 UNRESOLVED, sequence 91"},
        {"time": "2026-01-31T11:59:30.100Z", "text": "MQTT: connection refused by 10.0.0.5:8883"},
        {"time": "2026-01-30T23:10:00Z", "text": "started at journal 1200"}],
}


def changed(**fields):
    return {**copy.deepcopy(STATE), **fields}


class Server:
    """A page_server with its states; published ones are read by it in order."""

    def __init__(self, program, bind="127.0.0.1:0", *guests):
        # The memory that a sanitiser keeps back after it was freed is not the server's.
        options = os.environ.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=1"
        self.process = subprocess.Popen([program, bind, *guests], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True,
                                        env={**os.environ, "ASAN_OPTIONS": options})
        line = self.process.stdout.readline()
        if not line:
            self.process.wait()
            raise RuntimeError(f"page_server {bind} does not start")
        self.port = int(line)

    def publish(self, state):
        self.process.stdin.write((state if isinstance(state, str) else json.dumps(state)) + "\n")
        self.process.stdin.flush()

    def connect(self, receive_buffer=None, host="127.0.0.1"):
        connection = socket.socket()
        if receive_buffer:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        connection.settimeout(PATIENCE)
        connection.connect((host, self.port))
        return connection

    def ask(self, raw, host="127.0.0.1"):
        """All bytes that come back until the server closes."""
        answer = b""
        until = time.monotonic() + PATIENCE
        with self.connect(host=host) as connection:
            try:
                connection.sendall(raw)
                while time.monotonic() < until and (part := connection.recv(1 << 16)):
                    answer += part
            except OSError:  # closed or silent, both are its right
                pass
        return answer

    def get(self, path, method="GET", host="127.0.0.1", more=""):
        return Answer(self.ask(request(path, method, host, more)))

    def memory(self):
        """Kilobytes."""
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as file:
            return int(re.search(r"VmRSS:\s+(\d+)", file.read())[1])

    def stop(self):
        """Seconds that stopping took; None when it did not end by itself."""
        try:
            rest, _ = self.process.communicate(timeout=PATIENCE)
            return float(rest) if self.process.returncode == 0 else None
        except (subprocess.TimeoutExpired, BrokenPipeError, ValueError):
            return None
        finally:
            if self.process.poll() is None:
                self.process.kill()
                self.process.wait()


def request(path, method="GET", host="127.0.0.1", more=""):
    return f"{method} {path} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n".encode()


class Answer:
    def __init__(self, raw):
        self.head, _, self.body = raw.partition(b"\r\n\r\n")
        lines = self.head.decode("latin-1").split("\r\n")
        words = lines[0].split()
        self.status = int(words[1]) if len(words) > 1 and words[1].isdigit() else None
        self.headers = {k.lower(): v.strip() for k, _, v in (h.partition(":") for h in lines[1:])}


class Stream:
    """An open /events and the states that came by it."""

    def __init__(self, server, receive_buffer=None, host="127.0.0.1"):
        self.connection = server.connect(receive_buffer, host)
        self.connection.sendall(request("/events", host=host))
        self.buffer = b""
        self.events = []  # (id, data)
        self.ended = False

    def read(self, seconds):
        """What comes until a state did, or the time is over."""
        until = time.monotonic() + seconds
        seen = len(self.events)
        while len(self.events) == seen and not self.ended:
            left = until - time.monotonic()
            if left <= 0 or not select.select([self.connection], [], [], left)[0]:
                return False
            try:
                part = self.connection.recv(1 << 20)
            except OSError:
                part = b""
            self.ended = not part
            self.buffer += part
            self.parse()
        return len(self.events) > seen

    def parse(self):
        head, gap, body = self.buffer.partition(b"\r\n\r\n")
        if not gap:
            return
        text = b""
        while body:
            size, gap, rest = body.partition(b"\r\n")
            if not gap or len(rest) < int(size, 16) + 2:
                break
            text += rest[:int(size, 16)]
            body = rest[int(size, 16) + 2:]
        self.events = [(m[1].decode(), m[2].decode()) for m in
                       re.finditer(rb"id: (\S+)\ndata: ([^\n]*)\n\n", text)]

    def until(self, state, seconds=PATIENCE):
        end = time.monotonic() + seconds
        while not self.events or json.loads(self.events[-1][1]) != state:
            if self.ended or time.monotonic() > end:
                return False
            self.read(end - time.monotonic())
        return True

    def close(self):
        self.connection.close()


def eventually(holds, seconds=PATIENCE):
    until = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > until:
            return False
        time.sleep(0.05)
    return True


class Judge:
    def __init__(self, program):
        self.program = program
        self.faults = []
        self.checks = 0
        self.figures = []

    def expect(self, holds, what):
        self.checks += 1
        if not holds:
            self.faults.append(what)
        return holds

    def alive(self, server, what):
        self.expect(server.process.poll() is None and server.get("/state").status == 200,
                    f"{what}: it answers no more")

    # ---- What is answered -----------------------------------------------------------------------

    def answers(self, server):
        expect = self.expect
        expect(server.get("/state").body == b"{}", "the state before any was published")
        server.publish(STATE)
        expect(eventually(lambda: json.loads(server.get("/state").body) == STATE), "/state")
        pages = [server.get("/") for _ in range(2)]
        nonces = []
        for page in pages:
            expect(page.status == 200 and page.headers["content-type"].startswith("text/html"), "/")
            policy = page.headers.get("content-security-policy", "")
            nonces += re.findall(r"script-src 'nonce-([0-9a-f]{32})'", policy)
            expect("default-src 'none'" in policy and "unsafe" not in policy, f"policy: {policy}")
            expect(page.body.decode().count(f'nonce="{nonces[-1]}"') == 2, "the page's nonces")
        expect(len(set(nonces)) == 2, "a nonce is used twice")
        expect(b"PACKCELL" not in pages[0].body, "a placeholder is left")
        expect(int(pages[0].headers["content-length"]) == len(pages[0].body), "the page's length")
        for path in ("/", "/state", "/events", "/nowhere"):
            answer = server.get(path, "HEAD")
            expect(answer.status == (404 if path == "/nowhere" else 200), f"HEAD {path}")
            expect(answer.body == b"", f"HEAD {path} has a body")
            for name, value in (("cache-control", "no-store"),
                                ("x-content-type-options", "nosniff"),
                                ("x-frame-options", "DENY"), ("connection", "close")):
                expect(answer.headers.get(name) == value, f"{path}: header {name}")
            expect("default-src 'none'" in answer.headers.get("content-security-policy", ""),
                   f"{path}: policy")
        for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "get"):
            for more in ("", "Content-Length: 4000000000\r\n"):
                answer = server.get("/state", method, more=more)
                expect(answer.status == 405 and answer.headers.get("allow") == "GET, HEAD",
                       f"{method} {more.strip()}: {answer.status}")
        for path in ("/../../etc/passwd", "/..%2f..%2fetc/passwd", "/state/", "//", "/state%00",
                     "/%73tate", "/page.html", "/STATE", "/.", "/events/x", "*"):
            expect(server.get(path).status == 404, f"path {path}")
        expect(server.get("/state?x=1").status == 200, "a query")

    def hosts(self, server):
        for host in ("127.0.0.1", f"127.0.0.1:{server.port}", "localhost", "LocalHost:80",
                     "[::1]:8080", "[::1]", "192.168.7.9:8080"):
            self.expect(server.get("/state", host=host).status == 200, f"Host {host} is refused")
        for host in ("evil.example", "localhost.evil.example", "127.0.0.1.evil.example", "", "[::1",
                     "[evil]", "127.0.0.1:x", "localhost:80:80", "127.0.0.1@evil.example", "[]",
                     "1270.0.0.1", "[::1]evil", ":80"):
            for path in ("/", "/state", "/events"):
                self.expect(server.get(path, host=host).status in (400, 403),
                            f"Host '{host}' gets {path}")
        for raw in (b"GET /state HTTP/1.1\r\n\r\n", b"GET /state HTTP/1.0\r\n\r\n",
                    request("/state", more="Host: evil.example\r\n"),
                    request("/state", host="evil.example", more="Host: localhost\r\n")):
            self.expect(Answer(server.ask(raw)).status in (400, 403), f"{raw} is answered")

    def binds(self, server):
        for bind, code in ((f"127.0.0.1:{server.port}", 1), ("nowhere.invalid:0", 1),
                           ("192.0.2.1:0", 1), ("", 2), ("127.0.0.1", 2), (":80", 2),
                           ("127.0.0.1:65536", 2), ("127.0.0.1:-1", 2), ("127.0.0.1:http", 2),
                           ("::1:80", 2)):
            done = subprocess.run([self.program, bind], stdin=subprocess.DEVNULL, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
            self.expect(done.returncode == code and done.stderr.count("\n") == 1,
                        f"bind '{bind}': {done.returncode}, {done.stderr[:200]}")

    def peers(self):
        """A client that does not come from loopback, if this machine has another address."""
        probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing
            own = probe.getsockname()[0]
        except OSError:
            return
        finally:
            probe.close()
        if own.startswith("127."):
            return
        for guests, welcome in (((), False), ((own,), True), (("192.0.2.1",), False)):
            server = Server(self.program, "0.0.0.0:0", *guests)
            answer = server.ask(request("/state"), own)
            self.expect(bool(answer) == welcome, f"from {own}, allowed {guests}: {answer[:60]}")
            self.alive(server, "after a stranger")
            if guests and welcome:
                self.hog(server, own)
            server.stop()

    def hog(self, server, own):
        """One peer that opens streams until it is refused keeps nobody else out."""
        server.publish(STATE)
        streams = [Stream(server, host=own) for _ in range(MOST_STREAMS_A_PEER)]
        self.expect(all(s.read(PATIENCE) for s in streams), "a stream of a peer's share is refused")
        for _ in range(2):
            refused = Answer(server.ask(request("/events", host=own), own))
            self.expect(refused.status == 429 and "retry-after" in refused.headers,
                        f"stream {MOST_STREAMS_A_PEER + 1} of a peer: {refused.status}")
        others = [Stream(server) for _ in range(MOST_STREAMS - MOST_STREAMS_A_PEER)]
        self.expect(all(s.read(PATIENCE) for s in others), "a peer holds the streams of others")
        self.expect(server.get("/events").status == 503, "more streams than there are")
        others.pop().close()
        streams.pop().close()
        self.expect(eventually(lambda: self.opens(server, own)), "a peer's place is not given back")
        for stream in (*streams, *others):
            stream.close()

    def opens(self, server, own):
        stream = Stream(server, host=own)
        opened = stream.read(PATIENCE)
        stream.close()
        return opened

    # ---- Who misbehaves -----------------------------------------------------------------------

    def garbage(self, server):
        chance = random.Random(SEED)
        kinds = [
            lambda: chance.randbytes(chance.randrange(1, 3000)),
            lambda: b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + chance.randbytes(500),
            lambda: b"\x00\x01\x00\x00\x00\x06\x01\x03\x00\xc8\x00\x20",
            lambda: b"GET /" + b"a" * 100000 + b" HTTP/1.1\r\n\r\n",
            lambda: b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 20000 + b"\r\n",
            lambda: b"GET / HTTP/9.9\r\nHost: localhost\r\n\r\n",
            lambda: b"\r\n" * 5000, lambda: b"\x00" * 5000,
            lambda: request("/", more="Content-Length: -5\r\n"),
            lambda: request("/", more="Transfer-Encoding: chunked\r\n") + b"zz\r\n" * 50,
            lambda: request("/state", "POST", more="Content-Length: 9\r\n") + chance.randbytes(9),
            lambda: request("/")[:chance.randrange(1, 30)],
        ]
        for i in range(100):
            with server.connect() as connection:
                try:
                    connection.sendall(kinds[i % len(kinds)]())
                    if chance.random() < 0.5:
                        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER,
                                              b"\x01\0\0\0\0\0\0\0")  # closes by a reset
                    elif chance.random() < 0.5:
                        connection.shutdown(socket.SHUT_WR)
                        connection.recv(100)
                except OSError:  # closed or silent, both are its right
                    pass
        self.expect(eventually(lambda: server.get("/state").status == 200),
                    "no answer after garbage")
        self.expect(json.loads(server.get("/state").body) == STATE, "garbage changes the state")

    def slow(self, server):
        """Beside a client that drips, a silent one and streams that nobody reads."""
        end = threading.Event()
        closed = []

        def drip():
            start = time.monotonic()
            with server.connect() as connection:
                for byte in request("/state", more="X-Slow: " + "z" * 4000 + "\r\n"):
                    try:
                        connection.sendall(bytes([byte]))
                        if select.select([connection], [], [], 0.1)[0] and not connection.recv(99):
                            break
                    except OSError:
                        break
                    if end.is_set():
                        return
            closed.append(time.monotonic() - start)

        dripping = threading.Thread(target=drip)
        dripping.start()
        silent = server.connect()
        deaf = [Stream(server, receive_buffer=4096) for _ in range(3)]
        quick = Stream(server)
        self.expect(quick.read(PATIENCE), "a stream without a state")
        start = server.memory()
        took = []
        for i in range(400):
            server.publish(changed(journal=i, filler="x" * 50000))
            if i % 10 == 0:
                begin = time.monotonic()
                self.expect(server.get("/state").status == 200, "no answer beside slow clients")
                took.append(time.monotonic() - begin)
        last = changed(journal=100000)
        server.publish(last)
        self.expect(quick.until(last), "a quick stream does not get the latest state")
        grown = server.memory() - start
        self.expect(grown < 30000, f"memory grew by {grown} kB beside streams that nobody reads")
        self.expect(sorted(took)[len(took) // 2] < 0.5, f"answers took {sorted(took)[-5:]} s")
        self.figures.append(f"{len(took)} answers beside slow clients: at most "
                            f"{1000 * max(took):.1f} ms, memory +{grown} kB")
        # One wakes up: it gets what was under way, then the latest.
        if self.expect(deaf[0].until(last), "a slow stream does not get the latest state"):
            self.expect(len(deaf[0].events) < 300, f"{len(deaf[0].events)} states were kept")
            numbers = [int(name.rsplit("-", 1)[1]) for name, _ in deaf[0].events]
            self.expect(numbers == sorted(set(numbers)), "states come out of order")
        dripping.join(PATIENCE)
        end.set()
        dripping.join()
        self.expect(closed and closed[0] < 20, f"a dripping client stays: {closed}")
        # By now the last state is no news; a stream that begins says so.
        late = Stream(server)
        self.expect(late.read(PATIENCE) and b"\nevent: old\nid: " in late.buffer,
                    f"an old state: {late.buffer[-200:]}")
        self.expect(b"event: old" not in quick.buffer, "a new state is said to be old")
        for stream in (*deaf, quick, late):
            stream.close()
        silent.close()
        server.publish(STATE)

    def crowd(self, server):
        """Streams beyond the limit, then more connections than there are."""
        def open_stream():
            stream = Stream(server)
            if stream.read(PATIENCE):
                return stream
            stream.close()
            return None

        server.publish(STATE)
        streams = [s for s in (open_stream() for _ in range(MOST_STREAMS)) if s]
        self.expect(len(streams) == MOST_STREAMS, f"{len(streams)} streams")
        refused = server.get("/events")
        self.expect(refused.status == 503 and "retry-after" in refused.headers,
                    f"stream {MOST_STREAMS + 1}: {refused.status}")
        self.expect(server.get("/").status == 200, "no page beside all streams")
        streams.pop().close()
        more = []

        def another():
            more.append(open_stream())
            return more[-1] is not None
        self.expect(eventually(another), "no stream after one was closed")
        streams += [s for s in more if s]
        idle = []
        for _ in range(40):
            idle.append(server.connect())
        last = changed(journal=7)
        server.publish(last)
        for stream in streams:
            self.expect(stream.until(last), "a stream ends in a crowd")
        self.expect(eventually(lambda: server.get("/state").status == 200),
                    "idle connections keep all others out")
        for connection in (*idle, *(s.connection for s in streams[1:])):
            connection.close()
        took = server.stop()
        self.expect(took is not None and took < 1, f"stopping took {took} s")
        self.expect(not streams[0].read(PATIENCE) and streams[0].ended, "a stream outlives it")
        self.figures.append(f"stopped in {1000 * (took or 0):.1f} ms with open streams")

    def served(self):
        server = Server(self.program)
        try:
            self.answers(server)
            self.hosts(server)
            self.binds(server)
            self.garbage(server)
            self.slow(server)
            self.alive(server, "after slow clients")
        finally:
            server.stop()
        server = Server(self.program)
        try:
            self.crowd(server)
        finally:
            server.stop()
        self.peers()


class Page:
    """The page of a server in a browser."""

    def __init__(self, judge, browser):
        self.judge = judge
        self.browser = browser
        self.expect = judge.expect
        self.run = browser.run

    def as_uri(self):
        return f"http://127.0.0.1:{self.server.port}/"

    def show(self, size=(1280, 900), dark=False):
        self.browser.show(self, size, dark)

    def text(self, selector):
        return self.run(f"(document.querySelector({json.dumps(selector)}) || {{}}).innerText || ''")

    def has(self, script, what, seconds=PATIENCE):
        return self.expect(eventually(lambda: self.run(script), seconds), what)

    def reads(self, selector, words, what=None):
        holds = eventually(lambda: words in " ".join(self.text(selector).split()))
        return self.expect(holds, f"{what or selector}: '{self.text(selector)[:200]}', "
                                  f"not '{words}'")

    def shows(self, state):
        """Publishes and waits until it is there."""
        state = {**state, "boot_id": state.get("boot_id", 0), "journal": random.randrange(10 ** 9)}
        self.server.publish(state)
        return self.reads("#links", str(state["journal"]), "a published state")

    def fresh(self, when):
        """While states come all is live, however slow this machine is."""
        def live():
            self.server.publish(STATE)
            return self.run("document.getElementById('link-text').textContent === 'Live' && "
                            "document.getElementById('old').hidden && "
                            "!document.body.classList.contains('old')")
        self.expect(eventually(live), f"{when}: it is not live, '{self.text('#link')}'")

    def fields(self):
        self.server.publish(STATE)
        self.show()
        for selector, words in (
                ("#cell", "cell-1"), ("#about", "gateway 0.1.0 · boot 3 · 12:00:00"),
                ("#state", "Execute"), ("#facts", "Job 7 + 2 waiting"),
                ("#facts", "Bin full 53 %"), ("#facts", "Items in bin 6"),
                ("#facts", "Bins closed 4"), ("#facts", "Mode Production"),
                ("#facts", "Scenario D-R5A3O1"), ("#bin-note", "10 × 10 cells"),
                ("#links", "PLC heartbeat 120 ms ago"), ("#links", "MQTT not connected"),
                ("#links", "Journal 1234"), ("#links", "12 ms of 50 ms"),
                ("#links", "plan, 2 actions"), ("#links", "optimal"),
                ("#arms", "Acknowledged 5 91"), ("#arms", "Done 4 90"),
                ("#arms", "Result plan none"), ("#arms", "Reject none 6 UNRESOLVED"),
                ("#step", "A Pack 16 to 3, 5, turned ○ open"),
                ("#step", "B Take out 1005 ○ open"),
                ("#step", "Skip 2 ✓ done Close the bin ✗ failed"),
                ("#alarms", "11:58:12 arm B: reject 6 UNRESOLVED, sequence 91"),
                ("#alarms", "2026-01-30 23:10:00 started at journal 1200"),
                ("#belt-note", "5 items, 3 recognised"), ("#buffers", "5 1×4"),
                ("#buffers", "6 3×2")):
            self.reads(selector, words)
        self.expect(self.run("document.title") == "cell-1: Execute", "the title")
        self.expect(self.text("#alarms li:first-child").startswith("11:59:30"), "order of alarms")
        self.expect(self.run("document.getElementById('unresolved').hidden"), "a banner too many")
        self.fresh("at first")
        self.expect(self.run("!!document.querySelector('#state').closest('[aria-live=polite]')"),
                    "the state is not announced")
        items = self.run("[...document.querySelectorAll('#bin > svg > g')].map(g => [g.dataset.id, "
                         "g.textContent, g.className.baseVal, g.querySelector('rect').getBBox()]"
                         ").map(([i, t, c, b]) => [i, t, c, b.x, b.y, b.width, b.height])")
        want = {str(i["id"]): i for i in STATE["bin"]["items"]}
        self.expect({i[0] for i in items} == set(want), f"items in the bin: {items}")
        for name, words, kind, x, y, w, h in items:
            item = want[name]
            sides = [item["w"], item["h"]][::-1 if item["rot"] else 1]
            place = (item["x"], item["y"], *sides)
            near = all(abs(a - 20 * b) <= 2 for a, b in zip((x, y, w, h), place))
            self.expect(near, f"item {name} is drawn at {x}, {y}, {w} x {h}")
            self.expect(words.endswith(name), f"item {name} is labelled '{words}'")
            self.expect(("turned" in kind) == bool(item["rot"]) and "new" not in kind,
                        f"item {name} looks {kind}")
        ghost = self.run("(() => { const b = "
                         "document.querySelector('#bin .ghost:not(.out)').getBBox(); "
                         "return [b.x, b.y, b.width, b.height].map(v => Math.round(v / 20)); })()")
        self.expect(ghost == [3, 5, 2, 4], f"the planned place: {ghost}")
        self.expect(self.run("document.querySelectorAll('#bin .ghost.out').length") >= 1,
                    "what is to be taken out")
        belt = self.run("[...document.querySelectorAll('#belt li')].map(l => [l.dataset.id, "
                        "l.querySelector('.reach').innerText.replace(/\\s/g, ''), "
                        "l.querySelector('svg').getBoundingClientRect().width, "
                        "l.querySelector('svg').getBoundingClientRect().height, "
                        "l.querySelector('g.unknown') !== null])")
        reach = {0: "noarm", 1: "A", 2: "B", 3: "AB"}
        unit = belt[0][2] / STATE["belt"][0]["w"]
        for shown, item in zip(belt, STATE["belt"]):
            self.expect(shown[:2] == [str(item["id"]), reach[item["arms"]]], f"belt: {shown}")
            self.expect(abs(shown[2] - unit * item["w"]) < 0.5 and
                        abs(shown[3] - unit * item["h"]) < 0.5, f"belt: {shown} is out of scale")
            self.expect(shown[4] != item["recognized"], f"belt: {shown} recognised?")
        self.expect(len(belt) == len(STATE["belt"]), "belt: not all items")
        self.expect(not self.run("document.querySelector('button, input, form, a, select')"),
                    "it has something to act by")

    def live(self):
        """States come without a reload; what is new is marked."""
        self.run("window.mark = 1")
        more = changed()
        more["bin"]["items"].append({"id": 77, "x": 3, "y": 4, "w": 2, "h": 1, "rot": 0})
        self.shows(more)
        self.expect(self.run("[...document.querySelectorAll('#bin > svg > .new')].map("
                             "g => g.dataset.id).join()") == "77", "the new item is not marked")
        self.server.publish(changed(state="Held", state_code=11, unresolved=[13, 16], mode=3,
                                    plc={"seen": True, "age_ms": 4200, "stale": True}))
        self.reads("#state", "Held")
        self.reads("#unresolved", "Items 13, 16 unresolved")
        self.reads("#unresolved", "RESOLVE (code 9)")
        self.reads("#links", "4200 ms – lost")
        self.reads("#facts", "Mode Manual")
        self.expect(self.run("document.title").startswith("! "), "the title does not warn")
        colours = {}
        for code in range(0, 20):
            self.server.publish(changed(state=f"S{code}", state_code=code))
            self.reads("#state", f"S{code}")
            colours[code] = self.run(
                "getComputedStyle(document.getElementById('state-panel')).backgroundColor")
        self.expect(len({colours[c] for c in (0, 1, 2, 4, 6, 9, 11)}) >= 6, f"colours: {colours}")
        self.expect(self.run("window.mark") == 1, "the page was loaded again")

    def strange(self):
        """Fields that are missing, of another kind, or markup."""
        evil = "<img src=x onerror=\"window.hit=1\"><script>window.hit=1</script>"

        def poison(value):
            if isinstance(value, dict):
                return {k: poison(v) for k, v in value.items()}
            if isinstance(value, list):
                return [poison(v) for v in value]
            return evil
        words = changed(cell=evil, version=evil, scenario=evil, state=evil, job={"id": evil})
        words["bin"]["items"][0]["id"] = evil
        words["belt"][0]["id"] = evil
        words["buffers"][0]["id"] = evil
        words["step"][0].update(op=evil, item=evil, state=evil)
        words["unresolved"] = [evil]
        words["alarms"][0] = {"time": evil, "text": evil}
        words["arms"][0].update(reject=1, reject_name=evil)
        words["last_plan"].update(result=evil, proof=evil)
        self.shows(words)
        for selector in ("#cell", "#about", "#facts", "#state", "#belt", "#buffers", "#step",
                         "#unresolved-title", "#alarms", "#arms", "#links"):
            self.expect("<img src=x onerror=" in self.run(
                f"document.querySelector('{selector}').textContent"), f"{selector}: not as text")
        for state in (poison(STATE), {}, [], None, 7, "text", {"bin": {"w": 1e9, "h": -4}},
                      {key: None for key in STATE}, {key: [None, 5, {}] for key in STATE},
                      {key: {"w": 3, "h": 3, "items": 5} for key in STATE},
                      {"state": "toString", "state_code": "constructor", "mode": "constructor",
                       "step": [{"op": "constructor", "state": "toString", "arm": "x"}]},
                      {"bin": {"w": 128, "h": 128, "items": [
                          {"id": i, "x": i % 128, "y": i // 128, "w": 1, "h": 1}
                          for i in range(2000)]}}):
            self.server.publish(state)
            if isinstance(state, dict) and state:
                self.shows({**state, "journal": 0})
        self.server.publish("not JSON {")
        self.shows(STATE)
        self.reads("#state", "Execute")
        self.expect(self.run("window.hit === undefined && "
                             "!document.querySelector('img, main script')"),
                    "markup of a state became part of the page")

    def stale(self, program):
        """Old states, a server that goes away and one that comes back on its port."""
        self.fresh("before silence")
        self.has("document.body.classList.contains('old')", "silence is not marked")
        self.reads("#link", "No news for")
        self.reads("#old", "What is shown is old")
        self.show()
        self.reads("#old", "has sent no news", "an old state after a reload")
        self.shows(STATE)
        self.fresh("after silence")
        port = self.server.port
        self.run("window.mark = 2")
        self.server.stop()
        self.reads("#link", "Connection lost, trying again")
        self.has("document.body.classList.contains('old')", "a lost connection is not marked")
        self.reads("#state", "Execute")
        self.server = Server(program, f"127.0.0.1:{port}")
        self.server.publish(changed(state="Stopped", state_code=2, boot_id=4))
        self.reads("#state", "Stopped", "after a restart")
        self.reads("#about", "boot 4")
        self.fresh("after a restart")
        self.expect(self.run("window.mark") == 2, "the page was loaded again")

    def layouts(self, shots):
        long_name = changed(cell="a-cell-with-quite-a-long-name-" * 4, unresolved=list(range(60)))
        long_name["alarms"] = [{"time": "2026-01-31T12:00:00Z", "text": "word" * 40}] * 60
        long_name["belt"] = [{"id": 4294967295 - i, "w": 1 + 9 * i % 40, "h": 1 + 7 * i % 40,
                              "arms": 3} for i in range(40)]
        held = changed(state="Held", state_code=11, unresolved=[13, 16], step=[])
        tall = changed(bin={**copy.deepcopy(STATE["bin"]), "w": 10, "h": 60})
        shades = {}
        for name, size in (("narrow", (360, 740)), ("tablet", (800, 1100)), ("wide", (1280, 900)),
                           ("wall", (1920, 1080))):
            for dark in (False, True):
                self.show(size, dark)
                shade = self.run("getComputedStyle(document.body).backgroundColor")
                shades[dark] = sum(int(v) for v in re.findall(r"\d+", shade)[:3])
                for what, state in (("plain", STATE), ("held", held), ("tall", tall),
                                    ("long", long_name)):
                    self.shows(state)
                    self.browser.settle()
                    wider = self.run("document.documentElement.scrollWidth - "
                                     "document.documentElement.clientWidth")
                    self.expect(wider <= 0, f"{name}, {what}: {wider} pixels wider than the window")
                    if shots:
                        file = f"{name}-{'dark' if dark else 'light'}-{what}.png"
                        self.browser.shot(shots / file, whole=True)
                if name == "wall":
                    self.shows(STATE)
                    self.fresh("on the wall")
                    tall_by = self.run("document.documentElement.scrollHeight - innerHeight")
                    self.expect(tall_by <= 0, f"the wall screen scrolls by {tall_by} pixels")
        self.expect(shades[True] < 200 < 500 < shades[False], f"light and dark: {shades}")

    def quiet(self, what, lost=False):
        """No request elsewhere, nothing thrown or blocked."""
        for event in self.browser.events:
            parameters = event.get("params", {})
            if event["method"] == "Network.requestWillBeSent":
                url = parameters["request"]["url"]
                self.expect(url.startswith((self.as_uri(), "data:")),
                            f"{what}: asks for {url[:80]}")
            elif event["method"] in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled"):
                self.expect(False, f"{what}: {json.dumps(parameters)[:300]}")
            elif event["method"] == "Log.entryAdded" and not lost:
                self.expect(False, f"{what}: logs {json.dumps(parameters)[:300]}")
        self.browser.events.clear()


def browse(judge, program, browser_program, shots):
    random.seed(SEED)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(browser_program, profile)
        page = Page(judge, browser)
        page.server = Server(program)
        try:
            page.fields()
            page.live()
            page.quiet("live")
            page.strange()
            page.quiet("strange states")
            page.layouts(shots)
            page.quiet("layouts")
            page.stale(program)
            page.quiet("stale", lost=True)
        finally:
            browser.close()
            page.server.stop()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("server")
    parser.add_argument("--shots", type=pathlib.Path)
    arguments = parser.parse_args()
    judge = Judge(arguments.server)
    judge.served()
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser:
        if arguments.shots:
            arguments.shots.mkdir(parents=True, exist_ok=True)
        browse(judge, arguments.server, browser, arguments.shots)
    for fault in judge.faults[:20]:
        print("FAILED:", fault)
    print(f"{judge.checks} checks, {len(judge.faults)} failed; {'; '.join(judge.figures)}")
    if judge.faults:
        return 1
    if not browser:
        print("Chromium is not here")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())
