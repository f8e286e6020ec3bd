"""The journal's files, cut, damaged, too large for the disk, or in use.

usage: journal_check.py GATEWAY [SEED]
"""
import hashlib
import random
import shutil
import sys
import time

from harness import (ALL, Gateway, NotStarted, check, equal, finish, journal_records, run_gateway,
                     work)
from plc import ARRIVED, BELT_ITEMS, GONE, JOURNAL, PLAN, REJECT, Plc, words32

CUTS = 60
FLIPS = 2000 if ALL else 60
STARTS = 10  # of the cuts: the gateway itself, beside --print-journal
PARTS = ("", "-wal", "-marks")


def load(path, commands):
    """So many commands, then kill -9."""
    gateway = Gateway(path)
    plc = Plc(gateway.port)
    plc.bring("Execute")
    item = 1000 * plc.seq
    last = plc.seq + commands
    while plc.seq < last:
        item += 1
        plc.arrive(item, 1 + item % 5, 1 + item % 3)
        if item % 7 == 0:
            plc.must(GONE, *words32(item))
        if item % 5 == 0 and plc.send(PLAN, 200) == 0:
            if plc.wait_done() in (1, 2):
                for action in plc.actions():
                    plc.carry_out(action)
    gateway.kill()


def make_journal(path):
    """Half in the database, half in the WAL; what --print-journal says of an untouched copy."""
    load(path, 40)
    Gateway(path).end()
    load(path, 40)
    sizes = [part_of(path, part).stat().st_size for part in ("", "-wal")]
    print("a journal of %d bytes and a WAL of %d" % tuple(sizes))
    check(min(sizes) > 8192, "nothing in one of the two")
    return lines_of(copy_of(path, "whole"), "the untouched journal")


def copy_of(path, name):
    copy = work / name
    for part in PARTS:
        target = copy.with_name(name + part)
        target.unlink(missing_ok=True)
        source = path.with_name(path.name + part)
        if source.exists():
            shutil.copyfile(source, target)
    return copy


def part_of(journal, part):
    return journal.with_name(journal.name + part)


def state_of(journal):
    """An empty WAL is as good as none."""
    return [hashlib.sha256(part_of(journal, part).read_bytes()).hexdigest()
            for part in parts_of(journal)]


def lines_of(journal, what):
    code, out, errors = run_gateway("--journal", journal, "--print-journal")
    equal((code, errors), (0, []), what)
    return out.splitlines()


def judge(journal, whole, what):
    """An unbroken prefix, or a refusal of one line that leaves the files as they are. How many
    records there are; None: refused."""
    before = state_of(journal)
    code, out, errors = run_gateway("--journal", journal, "--print-journal")
    if code == 0:
        lines = out.splitlines()
        check(lines == whole[:len(lines)], "%s: not the records of before" % what)
        return len(lines)
    equal((code, len(errors), out), (1, 1, ""), "%s: exit code, lines, records" % what)
    check("journal" in errors[0] and len(errors[0]) < 500, "%s: %s" % (what, errors))
    equal(state_of(journal), before, "%s: refused, but changed" % what)
    return None


def start(journal, kept, what):
    """The gateway itself on a copy: it says where it stands, or refuses too."""
    try:
        gateway = Gateway(journal)
    except NotStarted as error:
        equal((error.code, len(error.lines), kept), (1, 1, None), "%s: a start is refused" % what)
        return
    match = gateway.logged(r"^journal .*: (\d+) records, the last is (\d+)$")
    equal([int(n) for n in match.groups()] if match else None, [kept, kept],
          "%s: where it stands" % what)
    plc = Plc(gateway.port)
    plc.arrive(999999, 1, 1)
    plc.close()
    equal(gateway.end(), 143, "%s: exit code" % what)


def parts_of(journal):
    return [part for part in ("-wal", "") if part_of(journal, part).exists() and
            part_of(journal, part).stat().st_size > 0]


def cuts(journal, whole, dice):
    kept = []
    for part in parts_of(journal):
        size = part_of(journal, part).stat().st_size
        if ALL:
            places = range(0, size + 1, 1 + size // 5000)
        else:
            share = CUTS * 2 // 3 if part else CUTS // 3
            places = [0, size - 1] + [dice.randrange(size) for _ in range(share)]
        for i, place in enumerate(places):
            what = "cut%s at %d of %d" % (part, place, size)
            copy = copy_of(journal, "cut")
            with open(part_of(copy, part), "r+b") as file:
                file.truncate(place)
            count = judge(copy, whole, what)
            kept.append(count)
            if i < STARTS:
                copy = copy_of(journal, "started")
                with open(part_of(copy, part), "r+b") as file:
                    file.truncate(place)
                start(copy, count, what)
    prefixes = [k for k in kept if k is not None]
    print("%d cuts: %d refused, prefixes of %s..%s of %d records"
          % (len(kept), kept.count(None), min(prefixes, default=None), max(prefixes, default=None),
             len(whole)))
    check(len(parts_of(journal)) == 1 or len(set(prefixes)) > 3, "the cuts gave no prefixes")


def flips(journal, whole, dice):
    """A byte is another one: refused, or what was hit holds no record, or it was the last."""
    refused = 0
    parts = parts_of(journal)
    for i in range(FLIPS):
        part = parts[i % len(parts)]
        copy = copy_of(journal, "flipped")
        path = part_of(copy, part)
        text = bytearray(path.read_bytes())
        place = dice.randrange(len(text))
        text[place] ^= 1 << dice.randrange(8)
        path.write_bytes(text)
        what = "byte %d of %d%s flipped" % (place, len(text), part)
        count = judge(copy, whole, what)
        refused += count is None
        check(count is None or count >= len(whole) - 1, "%s: %s of %d records" %
              (what, count, len(whole)))
    print("%d flipped bytes: %d refused" % (FLIPS, refused))
    check(refused > 0, "no flip was noticed")


def full_disk(clear_while_running):
    journal = work / ("full%d" % clear_while_running)
    gateway = Gateway(journal)
    plc = Plc(gateway.port)
    plc.bring("Execute")
    plc.arrive(1, 1, 1)
    used = max(part_of(journal, part).stat().st_size for part in ("", "-wal"))
    gateway.limit_files(used + 50000)
    item = 1
    while True:
        item += 1
        reject = plc.send(ARRIVED, *words32(item), 1, 1)
        if reject != 0 or item > 1000:
            break
    equal(reject, JOURNAL, "full disk: reject")
    equal(plc.ack(), item - 1, "full disk: ack_seq")
    plc.reaches("Aborted")
    gateway.says("^journal! ", "full disk")
    check(plc.send(ARRIVED, *words32(item), 1, 1) == JOURNAL, "full disk: again")
    plc.command("Clear")
    time.sleep(0.05)
    equal(plc.state() in ("Aborted", "Stopped"), True, "Clear on a full disk")
    if clear_while_running:
        gateway.limit_files(None)
        if plc.state() == "Aborted":
            plc.command("Clear")
        plc.reaches("Stopped")
    else:
        equal(gateway.end(), 143, "exit code on a full disk")
        gateway = Gateway(journal)
        plc = Plc(gateway.port)
        if plc.seq == item:  # it got in although it was not acknowledged
            item += 1
    equal(plc.ack(), item - 1, "with room again: ack_seq")
    equal(plc.read(BELT_ITEMS)[0], item - 1, "with room again: items on the belt")
    plc.arrive(item, 1, 1)
    equal(plc.read(REJECT)[0], 0, "with room again: reject_code")
    plc.bring("Execute")
    gateway.kill()
    got = [r["item"] for r in journal_records(journal) if r["kind"] == "command"]
    equal(got, list(range(1, item + 1)), "items in the journal after a full disk")


def two_gateways():
    journal = work / "shared"
    gateway = Gateway(journal)
    for options in ((), ("--print-journal",)):
        code, _, lines = run_gateway("--journal", journal, "--port", 0, *options)
        equal((code, len(lines)), (1, 1), "a second gateway %s: exit code, lines" % (options,))
        check("another gateway has it open" in lines[0], "a second gateway: %s" % lines)
    Plc(gateway.port).arrive(1, 1, 1)
    gateway.kill()
    gateway = Gateway(journal)  # kill -9 leaves no lock
    equal(Plc(gateway.port).seq, 1, "ack_seq after all that")
    gateway.end()


def main():
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else int(time.time()) % 1000000
    print("seed %d" % seed, flush=True)
    dice = random.Random(seed)
    journal = work / "journal"
    whole = make_journal(journal)
    cuts(journal, whole, dice)
    flips(journal, whole, dice)
    clean = copy_of(journal, "clean")
    Gateway(clean).end()  # everything is in the database then
    whole = lines_of(copy_of(clean, "whole"), "the journal after an orderly end")
    cuts(clean, whole, dice)
    flips(clean, whole, dice)
    full_disk(True)
    full_disk(False)
    two_gateways()
    finish()


main()
