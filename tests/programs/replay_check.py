#!/usr/bin/env python3
"""Opens a replay page in headless Chromium and judges it as a reader would use it.

usage: replay_check.py REPLAY_HTML TIMELINE_CSV [--shots DIRECTORY]

The poses that the page draws are compared with those of the timeline, which the library computes by
itself. Talks to the browser through its debugging pipe, so nothing but Python is needed. Exit
status 77 where there is no Chromium. With --shots the pages as they look are left as PNG files.
"""
import argparse
import base64
import csv
import json
import math
import os
import pathlib
import select
import shutil
import subprocess
import sys
import tempfile
import time

NEAR = 0.0005  # metres
TURN = 0.002  # radians
TIMES = 60
WIDE = (1280, 900)
NARROW = (360, 740)
LEAST_TOUCH = 44  # pixels: what a thumb needs, of the playback's controls
BROWSERS = ["chromium", "chromium-browser", "google-chrome", "chrome"]


class Browser:
    """One tab of a headless browser."""

    def __init__(self, program, profile):
        to_browser, self.out = os.pipe()
        self.inp, from_browser = os.pipe()

        def place_pipes():  # the browser reads 3 and writes 4
            a, b = os.dup(to_browser), os.dup(from_browser)
            high_a, high_b = 100, 101
            os.dup2(a, high_a)
            os.dup2(b, high_b)
            os.dup2(high_a, 3)
            os.dup2(high_b, 4)

        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic",
             "--no-first-run", "--disable-background-networking", "--disable-component-update",
             "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars",
             f"--user-data-dir={profile}", "--remote-debugging-pipe", "about:blank"],
            preexec_fn=place_pipes, close_fds=False, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer = b""
        self.number = 0
        self.session = None
        self.events = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target,
                                 flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(domain + ".enable")

    def receive(self, until):
        while b"\0" not in self.buffer:
            left = until - time.monotonic()
            if left <= 0 or not select.select([self.inp], [], [], left)[0]:
                raise RuntimeError("the browser does not answer")
            part = os.read(self.inp, 1 << 20)
            if not part:
                raise RuntimeError("the browser has ended")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, seconds=60, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        until = time.monotonic() + seconds
        while True:
            answer = self.receive(until)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            if "method" in answer:
                self.events.append(answer)

    def wait(self, event, seconds=60):
        until = time.monotonic() + seconds
        while not any(e["method"] == event for e in self.events):
            answer = self.receive(until)
            if "method" in answer:
                self.events.append(answer)

    def run(self, script):
        """The value of an expression; a promise's once it is kept."""
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True,
                           awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def show(self, page, size, dark):
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1],
                  deviceScaleFactor=1, mobile=size[0] < 500)
        self.call("Emulation.setEmulatedMedia",
                  features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.events.clear()
        self.call("Page.navigate", url=page.as_uri())
        self.wait("Page.loadEventFired")
        self.settle()

    def settle(self):
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def shot(self, path, whole=False):
        data = self.call("Page.captureScreenshot", captureBeyondViewport=whole)["data"]
        path.write_bytes(base64.b64decode(data))

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", **more)

    def click(self, x, y):
        self.mouse("mousePressed", x, y, clickCount=1, buttons=1)
        self.mouse("mouseReleased", x, y, clickCount=1)

    def key(self, name, code, text=""):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=name or code,
                      windowsVirtualKeyCode=code, text=text if kind == "keyDown" else "")

    def close(self):
        self.session = None
        try:
            self.call("Browser.close", seconds=10)
            self.process.wait(timeout=10)
        except (RuntimeError, OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()


class Judge:
    def __init__(self, browser, page, rows):
        self.browser = browser
        self.page = page
        self.rows = rows
        self.faults = []
        self.checks = 0

    def expect(self, holds, what):
        self.checks += 1
        if not holds:
            self.faults.append(what)

    def centre(self, selector):
        box = self.browser.run(
            f"(() => {{ const e = document.querySelector('{selector}'); "
            "e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect(); "
            "return [b.left, b.top, b.width, b.height]; })()")
        return box[0] + box[2] / 2, box[1] + box[3] / 2, box

    # ---- What it shows ----------------------------------------------------------------------------

    def poses(self):
        """Tools, grippers and clearance against the timeline."""
        run = self.browser.run
        duration = run("replay.duration")
        rows = self.rows[:: max(1, len(self.rows) // TIMES)]
        times = [float(r["time_s"]) for r in rows]
        self.expect(not times or times[-1] <= duration + 0.01,
                    f"the timeline ends after {duration} s")
        shown = json.loads(run(f"JSON.stringify({json.dumps(times)}.map(replay.poses))"))
        # With noise an item sits off in its gripper.
        simulated = run("'simulation' in JSON.parse(document.getElementById('data').textContent)")
        worst = 0
        for row, pose in zip(rows, shown):
            t = row["time_s"]
            for arm, drawn in enumerate(pose["arms"]):
                x, y, yaw = (float(row[f"arm{arm}_{c}"]) for c in ("x_m", "y_m", "yaw_rad"))
                off = math.hypot(drawn["tool"][0] - x, drawn["tool"][1] - y)
                worst = max(worst, off)
                self.expect(off <= NEAR,
                            f"at {t} s the tool of arm {arm} is {1000 * off:.2f} mm off")
                turn = abs(math.remainder(drawn["yaw"] - yaw, 2 * math.pi))
                self.expect(turn <= TURN, f"at {t} s the tool of arm {arm} is {turn:.4f} rad off")
                held = row[f"arm{arm}_held_item"]
                self.expect(str(drawn["held"] if drawn["held"] is not None else "") == held,
                            f"at {t} s arm {arm} holds {drawn['held']}, not '{held}'")
                at = pose["items"].get(held)
                if held and at and not simulated:
                    off = math.hypot(at[0] - x, at[1] - y)
                    self.expect(off <= NEAR,
                                f"at {t} s item {held} is {1000 * off:.2f} mm off its tool")
            if row["clearance_m"]:
                off = abs(pose["clearance"] - float(row["clearance_m"]))
                self.expect(off <= NEAR, f"at {t} s the clearance is {1000 * off:.2f} mm off")
            for item, at in pose["items"].items():
                self.expect(all(isinstance(v, (int, float)) for v in at),
                            f"at {t} s item {item}: {at}")
        if not simulated:
            self.handovers()
        return worst

    def handovers(self):
        """An item does not jump as a gripper takes it or lets it go."""
        jumps = json.loads(self.browser.run(
            "JSON.stringify(JSON.parse(document.getElementById('data').textContent).handovers.map("
            "h => [h[0], h[4], replay.poses(h[0] - 1e-5).items[h[4]], "
            "replay.poses(h[0] + 1e-5).items[h[4]]]))"))
        for t, item, before, after in jumps:
            off = math.hypot(before[0] - after[0], before[1] - after[1])
            turn = abs(math.remainder(before[2] - after[2], math.pi))  # half a turn looks the same
            self.expect(off <= NEAR and turn <= TURN,
                        f"at {t} s item {item} jumps by {1000 * off:.2f} mm, {turn:.4f} rad")

    def pictures(self, name):
        """Neither canvas is empty, nothing is wider than the window, nothing is cut off."""
        run = self.browser.run
        for canvas in ("scene", "gantt"):
            colours = run(
                f"(() => {{ const c = document.getElementById('{canvas}'); const d = "
                "c.getContext('2d').getImageData(0, 0, c.width, c.height).data; "
                "const n = new Set(); "
                "for (let i = 0; i < d.length; i += 4 * 7) if (d[i + 3]) "
                "n.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]); return n.size; })()")
            self.expect(colours >= 8, f"{name}: canvas {canvas} shows {colours} colours")
            self.expect(run(f"!!document.getElementById('{canvas}').getAttribute('aria-label')"),
                        f"{name}: canvas {canvas} has no label")
        wide = run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        self.expect(wide <= 0, f"{name}: the page is {wide} pixels wider than the window")
        top = run("document.getElementById('scene').getBoundingClientRect().top")
        control = run("document.getElementById('play').getBoundingClientRect().top")
        self.expect(top < control, f"{name}: the picture is not above the controls")
        for selector in ("#play", "#time", "#speed label"):
            w, h = run(f"(() => {{ const b = document.querySelector('{selector}')"
                       ".getBoundingClientRect(); return [b.width, b.height]; })()")
            self.expect(h >= LEAST_TOUCH - 0.5 and w >= LEAST_TOUCH - 0.5,
                        f"{name}: {selector} is {w:.0f} x {h:.0f} pixels")
        back = run("getComputedStyle(document.body).backgroundColor")
        return [int(v) for v in back[back.index("(") + 1:-1].split(",")[:3]]

    # ---- What it does -----------------------------------------------------------------------------

    def controls(self):
        browser, run = self.browser, self.browser.run
        duration = run("replay.duration")
        self.expect(run("replay.time") == 0 and not run("replay.playing"),
                    "it does not begin at rest")
        if duration <= 0:
            run("replay.play()")
            self.expect(not run("replay.playing"), "it plays nothing")
            return
        x, y, _ = self.centre("#play")
        browser.click(x, y)
        self.expect(run("replay.playing"), "the button does not play")
        self.expect(run("document.getElementById('play').innerText").strip() == "Pause",
                    "the button does not offer a pause")
        time.sleep(1)
        gone = run("replay.time")
        self.expect(0.4 < gone < 3, f"after 1 s of playing it is at {gone} s")
        browser.click(x, y)
        self.expect(not run("replay.playing"), "the button does not pause")
        still = run("replay.time")
        time.sleep(0.2)
        self.expect(run("replay.time") == still, "it goes on while paused")

        label = self.centre("#speed span:nth-of-type(5) label")
        browser.click(label[0], label[1])
        run("replay.seek(0), replay.play()")
        time.sleep(0.5)
        run("replay.pause()")
        fast = run("replay.time")
        self.expect(fast > min(duration, 2) * 0.99, f"at 8 times it is at {fast} s after 0.5 s")
        label = self.centre("#speed span:nth-of-type(2) label")
        browser.click(label[0], label[1])
        run("document.activeElement.blur()")

        browser.key(" ", 32, " ")
        self.expect(run("replay.playing"), "the space bar does not play")
        browser.key(" ", 32, " ")
        self.expect(not run("replay.playing"), "the space bar does not pause")
        middle = duration / 2
        run(f"replay.seek({middle})")
        browser.key("ArrowRight", 39)
        self.expect(abs(run("replay.time") - min(duration, middle + 1)) < 1e-9, "the right arrow")
        browser.key("ArrowLeft", 37)
        self.expect(abs(run("replay.time") - middle) < 1e-9, "the left arrow")
        browser.key("End", 35)
        self.expect(run("replay.time") == duration, "the key End")
        run("replay.play()")
        self.expect(run("replay.time") < 1, "playing at the end does not begin again")
        run("replay.pause()")
        for wrong, right in ((-5, 0), (duration + 5, duration)):
            run(f"replay.seek({wrong})")
            self.expect(run("replay.time") == right, f"seek({wrong}) goes to {run('replay.time')}")
        run("replay.seek(NaN)")
        self.expect(run("replay.time") == duration, "seek(NaN) moves")

        run(f"(() => {{ const s = document.getElementById('time'); s.value = {middle}; "
            "s.dispatchEvent(new Event('input', {bubbles: true})); })()")
        self.expect(abs(run("replay.time") - middle) < 0.02, "the slider does not scrub")
        browser.settle()
        self.expect(abs(float(run("document.getElementById('now').textContent")) - middle) < 0.02,
                    "the clock does not follow")
        x, y, box = self.centre("#gantt")
        picture = "document.getElementById('scene').toDataURL()"
        first = run(picture)
        browser.click(box[0] + 70, y)
        early = run("replay.time")
        self.expect(early < 0.2 * duration, f"a click on the left of the chart goes to {early} s")
        browser.mouse("mousePressed", box[0] + 70, y, clickCount=1, buttons=1)
        browser.mouse("mouseMoved", box[0] + box[2] - 20, y, buttons=1)
        late = run("replay.time")
        browser.mouse("mouseReleased", box[0] + box[2] - 20, y, clickCount=1)
        self.expect(late > 0.8 * duration, f"a drag to the right of the chart goes to {late} s")
        browser.mouse("mouseMoved", box[0] + 100, y, buttons=0)
        self.expect(run("replay.time") == late, "the chart follows a mouse that is let go")
        browser.settle()
        self.expect(run(picture) != first, "the picture does not change")

    def steady(self, name):
        """Nothing jumps as the words change."""
        layouts = {}
        for i in range(24):
            self.browser.run(f"replay.seek(replay.duration * {i / 23})")
            self.browser.settle()
            layout = self.browser.run(
                "[...document.querySelectorAll('.panel')].map(e => e.getBoundingClientRect())"
                ".map(b => [b.top, b.height].join()).join(' ')")
            layouts.setdefault(layout, self.browser.run("replay.time"))
        self.expect(len(layouts) == 1, f"{name}: the layout changes at {list(layouts.values())} s")

    def quiet(self):
        """No request but for the page, no error."""
        for event in self.browser.events:
            parameters = event.get("params", {})
            if event["method"] == "Network.requestWillBeSent":
                url = parameters["request"]["url"]
                self.expect(url == self.page.as_uri() or url.startswith("data:"),
                            f"asks for {url[:80]}")
            elif event["method"] == "Runtime.exceptionThrown":
                self.expect(False, f"throws {json.dumps(parameters)[:300]}")
            elif event["method"] == "Log.entryAdded":
                self.expect(False, f"logs {json.dumps(parameters)[:300]}")

    def shots(self, folder):
        browser = self.browser
        for dark in (False, True):
            for size, name in ((WIDE, "wide"), (NARROW, "narrow")):
                browser.show(self.page, size, dark)
                browser.run("replay.seek(replay.duration * 0.37)")
                browser.settle()
                suffix = "dark" if dark else "light"
                browser.shot(folder / f"{name}-{suffix}.png")
                browser.shot(folder / f"{name}-{suffix}-whole.png", whole=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("replay", type=pathlib.Path)
    parser.add_argument("timeline", type=pathlib.Path)
    parser.add_argument("--shots", type=pathlib.Path)
    arguments = parser.parse_args()
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        print("Chromium is not here")
        return 77
    with open(arguments.timeline, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    page = arguments.replay.resolve()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(program, profile)
        try:
            judge = Judge(browser, page, rows)
            browser.show(page, WIDE, dark=False)
            worst = judge.poses()
            judge.controls()
            judge.quiet()
            shades = {}
            for dark in (False, True):
                for size in (WIDE, NARROW):
                    name = f"{size[0]} pixels, {'dark' if dark else 'light'}"
                    browser.show(page, size, dark)
                    browser.run("replay.seek(replay.duration * 0.4)")
                    browser.settle()
                    shades[dark] = sum(judge.pictures(name))
                    if not dark:
                        judge.steady(name)
                    judge.quiet()
            judge.expect(shades[True] < 200 < 500 < shades[False], f"light and dark: {shades}")
            if arguments.shots:
                arguments.shots.mkdir(parents=True, exist_ok=True)
                judge.shots(arguments.shots)
        finally:
            browser.close()
    for fault in judge.faults[:20]:
        print("FAILED:", fault)
    print(f"{judge.checks} checks, {len(judge.faults)} failed; tools at most {1000 * worst:.3f} mm off")
    return 1 if judge.faults else 0


if __name__ == "__main__":
    sys.exit(main())
