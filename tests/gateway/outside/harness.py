"""What every check of the gateway from outside needs: the program as a process, its log, verdicts.

A check is a statement with check(); it goes on after a failure, and finish() ends the script with
the number of failures. What is started ends with the script, whatever happens.
"""
import atexit
import ctypes
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

ALL = os.environ.get("PACKCELL_CHECK_ALL") == "1"
PATIENCE = 30  # seconds until something that must come counts as missing
SIGNAL_OF_PARENTS_DEATH = 1

work = pathlib.Path(tempfile.mkdtemp(prefix="packcell-outside-"))
_processes = []
_failures = []


def check(holds, what):
    if not holds:
        _failures.append(what)
        print("FAILED: %s" % what, flush=True)
    return holds


def equal(got, wanted, what):
    return check(got == wanted, "%s: %s, expected %s" % (what, str(got)[:300], str(wanted)[:300]))


def finish():
    if _failures:
        sys.exit("%d failures" % len(_failures))


def within(condition, what, seconds=PATIENCE):
    """Waits for what must come; its last value."""
    end = time.monotonic() + seconds
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            check(False, "%s: not within %g s" % (what, seconds))
            return value
        time.sleep(0.005)


def percentile(values, share):
    """The smallest value that is not below this share of all of them."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def _prepare_child():
    ctypes.CDLL(None).prctl(SIGNAL_OF_PARENTS_DEATH, signal.SIGKILL)
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as a shell leaves it


def spawn(command, **options):
    process = subprocess.Popen([str(part) for part in command], preexec_fn=_prepare_child,
                               **options)
    _processes.append(process)
    return process


@atexit.register
def _clean_up():
    for process in _processes:
        if process.poll() is None:
            process.kill()
        process.wait()
    shutil.rmtree(work, ignore_errors=True)


def program():
    """The gateway, the script's first argument."""
    return sys.argv[1]


def run_gateway(*options, seconds=PATIENCE):
    """Until it ends by itself; the exit code, stdout, stderr's lines without their times."""
    done = subprocess.run([program(), *map(str, options)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=seconds, check=False)
    return done.returncode, done.stdout, [without_time(line) for line in done.stderr.splitlines()]


def without_time(line):
    return re.sub(r"^\d{4}-\d\d-\d\dT[\d:.]+Z ", "", line)


def journal_records(journal):
    """--print-journal, one dictionary a record."""
    code, out, lines = run_gateway("--journal", journal, "--print-journal")
    if not equal(code, 0, "--print-journal"):
        print("\n".join(lines[-3:]))
        return []
    return [json.loads(line) for line in out.splitlines()]


class NotStarted(Exception):
    """It ended before it listened: its exit code and its log."""

    def __init__(self, code, lines):
        super().__init__("exit code %s: %s" % (code, lines[-1:]))
        self.code = code
        self.lines = lines


class Gateway:
    """The program at work. Its log comes by a pipe, so that a limit on files does not touch it."""

    def __init__(self, journal, *options, port=0, wait=True):
        command = [program(), "--journal", journal, "--port", port, *options]
        # Left ignored, SIGXFSZ lets a write beyond the limit fail as on a full disk.
        self.process = spawn(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                             stderr=subprocess.PIPE, text=True, restore_signals=False)
        self.log = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self.port = 0
        if wait:
            self.wait_listening()

    def _read(self):
        for line in self.process.stderr:
            self.log.append(without_time(line.rstrip("\n")))

    def wait_listening(self):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            ended = self.process.poll() is not None
            if ended:
                self._reader.join()
            match = self.logged(r"^modbus listens at [\d.]+:(\d+)$")
            if match:
                self.port = int(match.group(1))
                return
            if ended:
                break
            time.sleep(0.002)
        raise NotStarted(self.process.poll(), list(self.log))

    def logged(self, pattern, start=0):
        """The first line from `start` on that has it."""
        for line in self.log[start:]:
            match = re.search(pattern, line)
            if match:
                return match
        return None

    def says(self, pattern, what, start=0):
        return within(lambda: self.logged(pattern, start), "%s: '%s' in the log" % (what, pattern))

    def limit_files(self, size):
        """No file of its may grow beyond; None: as they like."""
        soft = resource.RLIM_INFINITY if size is None else size
        resource.prlimit(self.process.pid, resource.RLIMIT_FSIZE, (soft, resource.RLIM_INFINITY))

    def kill(self):
        """As a power cut of the program: kill -9. Its exit code."""
        return self.end(signal.SIGKILL)

    def end(self, number=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(number)
        try:
            code = self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            check(False, "signal %d does not end it" % number)
            self.process.kill()
            code = self.process.wait()
        self._reader.join()
        return code
