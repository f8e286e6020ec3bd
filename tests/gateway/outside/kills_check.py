"""Duplicates, torn and wrong numbers, the wrap through 65535, and kill -9 under load.

usage: kills_check.py GATEWAY [SEED]
"""
import hashlib
import random
import sqlite3
import struct
import sys
import threading
import time

from harness import (ALL, Gateway, NotStarted, check, equal, finish, journal_records, within, work)
from plc import (ACK, ARRIVED, BAD_PAYLOAD, BIN_ITEMS, CHANGED, CONFLICT, FAILED, GONE, Lost, PACK,
                 PLACED, PLAN, REJECT, RESOLVE, SEQ_GAP, TERMINATE, UNKNOWN_CODE, UNPACK, UNPACKED,
                 UNRESOLVED, WRONG_STATE, Plc, words32)

KILLS = 200 if ALL else 25
NAMES = {ARRIVED: "ITEM_ARRIVED", PLAN: "PLAN_NEXT", PLACED: "PLACED", FAILED: "PLACE_FAILED",
         UNPACKED: "UNPACKED", CHANGED: "BIN_CHANGED", RESOLVE: "RESOLVE", GONE: "ITEM_GONE"}
DEADLINE = 20
LONGEST_COMMIT = 0.012  # seconds, or so
BELT = 5


# ---- Numbers -------------------------------------------------------------------------------------
def numbers():
    journal = work / "numbers"
    gateway = Gateway(journal)
    plc = Plc(gateway.port)

    def judged(what, ack, reject, number, code, *payload, tail=None):
        plc.write(0, *plc.block(number, code, *payload, tail=tail))
        got = plc.read(ACK, 4)
        equal((got[0], got[3]), (ack, reject), "%s: ack_seq and reject_code" % what)

    def commands():
        return sum("command A" in line for line in gateway.log)

    one = words32(70000) + [3, 2]
    judged("the first command", 1, 0, 1, ARRIVED, *one)
    judged("the same again", 1, 0, 1, ARRIVED, *one)
    judged("the same, with another word beyond the payload", 1, 0, 1, ARRIVED, *one, 99)
    judged("the same number, another width", 1, CONFLICT, 1, ARRIVED, *words32(70000), 4, 2)
    judged("the first command once more", 1, CONFLICT, 1, ARRIVED, *one)  # nothing was accepted
    judged("a gap", 1, SEQ_GAP, 3, ARRIVED, *words32(5), 1, 1)
    judged("0 is no number", 1, SEQ_GAP, 0, ARRIVED, *words32(5), 1, 1)
    judged("torn: head before tail", 1, SEQ_GAP, 2, ARRIVED, *words32(5), 1, 1, tail=1)
    plc.write(47, 2)
    equal(plc.ack(), 2, "the tail comes last: ack_seq")
    judged("an unknown code", 2, UNKNOWN_CODE, 3, 11)
    judged("a side of 129", 2, BAD_PAYLOAD, 3, ARRIVED, *words32(6), 129, 1)
    judged("the number that was refused is still to be used", 3, 0, 3, ARRIVED, *words32(6), 1, 1)
    judged("PLAN_NEXT in Stopped", 3, WRONG_STATE, 4, PLAN, 50)
    # In pieces, in any order, the tail last.
    block = plc.block(4, ARRIVED, *words32(7), 2, 2)
    for start in (24, 0, 12, 36):
        plc.write(start, *block[start:start + 12])
    equal(plc.ack(), 4, "a block in four pieces: ack_seq")
    # Written every scan, as a cyclic master does.
    for _ in range(50):
        plc.write(0, *block)
    equal((plc.ack(), plc.read(REJECT)[0]), (4, 0), "50 scans: ack_seq and reject_code")
    arm_b = Plc(gateway.port, arm=1)
    equal(arm_b.seq, 0, "arm B's numbers are its own: ack_seq")
    arm_b.arrive(8, 1, 1)
    equal((plc.ack(), arm_b.ack()), (4, 1), "ack_seq of A and B")
    within(lambda: commands() == 4, "four commands in the log")
    gateway.end()
    got = [(r["arm"], r["number"], r["item"]) for r in journal_records(journal)
           if r["kind"] == "command"]
    equal(got, [(0, 1, 70000), (0, 2, 5), (0, 3, 6), (0, 4, 7), (1, 1, 8)], "the journal")


def number_last_command(journal, number):
    """The last record gets another number, as after so many commands more; the chain of
    sqlite_journal.hpp is made anew for it."""
    database = sqlite3.connect(journal)
    rows = database.execute("SELECT sequence, wall_ms, kind, arm, number, code, payload, chain "
                            "FROM journal ORDER BY sequence DESC LIMIT 2").fetchall()
    sequence, wall, kind, arm, _, code, payload, _ = rows[0]
    text = rows[1][7] + struct.pack("<QqBBHHI", sequence, wall, kind, arm, number, code,
                                    len(payload)) + payload
    chain = hashlib.blake2b(text, digest_size=16).digest()
    database.execute("UPDATE journal SET number = ?, chain = ? WHERE sequence = ?",
                     (number, chain, sequence))
    database.execute("UPDATE head SET chain = ?", (chain,))
    database.commit()
    database.close()


def wrap():
    journal = work / "wrap"
    gateway = Gateway(journal)
    plc = Plc(gateway.port)
    plc.arrive(1, 1, 1)
    if ALL:
        while plc.seq < 65534:
            if plc.seq % 2 == 1:
                plc.must(GONE, *words32(plc.seq))
            else:
                plc.arrive(plc.seq + 1, 1, 1)
        gateway.end()
    else:
        gateway.end()
        number_last_command(journal, 65534)
    gateway = Gateway(journal)
    plc = Plc(gateway.port)
    equal(plc.seq, 65534, "ack_seq that a cold PLC adopts")
    plc.arrive(200001, 1, 1)
    equal(plc.seq, 65535, "ack_seq at its end")
    plc.write(0, *plc.block(0, ARRIVED, *words32(200002), 1, 1))
    equal(plc.ack(), 65535, "0 does not follow 65535: ack_seq")
    plc.arrive(200002, 1, 1)
    equal(plc.ack(), 1, "1 follows 65535: ack_seq")
    plc.write(0, *plc.block(65535, ARRIVED, *words32(200001), 1, 1))
    equal((plc.ack(), plc.read(REJECT)[0]), (1, SEQ_GAP), "65535 again: ack_seq and reject_code")
    gateway.kill()
    gateway = Gateway(journal)
    equal(Plc(gateway.port).seq, 1, "ack_seq after kill -9")
    gateway.end()


# ---- kill -9 under load --------------------------------------------------------------------------
class Cell:
    """The cell as it really is, and a PLC's program that goes on after every kill."""

    def __init__(self, dice):
        self.dice = dice
        self.acknowledged = []  # (number, code, item or None) in order
        self.pending = None     # sent, not known whether acknowledged
        self.items = 0
        self.belt, self.packed, self.buffered = set(), set(), set()
        self.reported = set()  # (action, item) of the last plan that are done
        self.closed = self.gone = 0
        self.in_flight = 0  # commands that were under way at a kill
        self.kept = 0       # and turned out to be in the journal
        self.resolved = 0
        self.plc = None
        self.commands_left = None  # until the kill
        self.kill = None

    def took(self, number, code, item):
        self.acknowledged.append((number, code, item))
        if code == ARRIVED:
            self.belt.add(item)
        elif code == PLAN:
            self.reported.clear()
        elif code == PLACED:
            self.reported.add((PACK, item))
            self.belt.discard(item)
            self.buffered.discard(item)
            self.packed.add(item)
        elif code == UNPACKED:
            self.reported.add((UNPACK, item))
            self.packed.discard(item)
            self.buffered.add(item)
        elif code == CHANGED:
            self.closed += len(self.packed)
            self.packed.clear()
        elif code == GONE:
            self.gone += 1
            for place in (self.belt, self.packed, self.buffered):
                place.discard(item)

    def send(self, code, item, *payload):
        number = self.plc.next_number()
        self.pending = (number, code, item)
        if self.commands_left is not None:
            self.commands_left -= 1
            if self.commands_left == 0:
                threading.Timer(self.dice.uniform(0.0, LONGEST_COMMIT), self.kill).start()
        words = [] if item is None else words32(item)
        reject = self.plc.send(code, *words, *payload)
        self.pending = None
        if reject == 0:
            self.took(number, code, item)
        return reject

    def must(self, code, item, *payload):
        reject = self.send(code, item, *payload)
        check(reject == 0, "%s %s %s: reject %d" % (NAMES[code], item, payload, reject))

    def connect(self, port):
        """After a restart: the command in flight is in the journal or it is not."""
        self.plc = Plc(port)
        last = self.acknowledged[-1][0] if self.acknowledged else 0
        if self.pending is not None:
            self.in_flight += 1
            if self.plc.seq == self.pending[0]:
                self.kept += 1
                resolved = self.pending if self.pending[1] == RESOLVE else None
                self.took(*self.pending)
                if resolved:
                    self.take_resolution()
                last = self.pending[0]
            self.pending = None
        equal(self.plc.seq, last, "ack_seq after a kill")
        self.compare()

    def compare(self):
        got = tuple(self.plc.read(BIN_ITEMS, 3))
        equal(got, (len(self.packed), len(self.belt), len(self.buffered)),
              "items in the bin, on the belt, in buffers")

    def start(self, gateway):
        """RESOLVE in the order of the result block, then into Execute."""
        unresolved = [int(m.group(1)) for m in
                      (gateway.logged(r"^unresolved! item (\d+):", i) for i in
                       range(len(gateway.log))) if m]
        unresolved = list(dict.fromkeys(unresolved))
        if unresolved:
            equal(self.send(PLAN, None, DEADLINE), UNRESOLVED, "PLAN_NEXT before RESOLVE: reject")
        first = {}
        for action in self.plc.actions():
            if action.item in unresolved and (action.code, action.item) not in self.reported:
                first.setdefault(action.item, action)
        equal(sorted(first), sorted(unresolved), "items of the result that are unresolved")
        for item, action in first.items():
            done = self.dice.random() < 0.5
            in_bin = int(done == (action.code == PACK))
            self.resolution = (action, in_bin)
            reject = self.send(RESOLVE, item, in_bin)
            if reject == WRONG_STATE and action.code == PACK and in_bin:
                in_bin = 0  # its cells are taken: so it was not placed
                self.resolution = (action, in_bin)
                reject = self.send(RESOLVE, item, in_bin)
            if check(reject == 0, "RESOLVE %d %d: reject %d" % (item, in_bin, reject)):
                self.take_resolution()
        self.compare()
        self.plc.bring("Idle")
        self.plc.command("Start")
        # A bin that was done before the kill is to be changed still.
        if within(lambda: self.plc.state() in ("Execute", "Suspended"), "Execute or Suspended"):
            self.change_done_bin()

    def change_done_bin(self):
        if self.plc.state() != "Execute":
            self.must(CHANGED, None, 10, 10)
            self.plc.reaches("Execute")

    def take_resolution(self):
        action, in_bin = self.resolution
        self.resolved += 1
        if action.code == PACK and in_bin:
            self.belt.discard(action.item)
            self.buffered.discard(action.item)
            self.packed.add(action.item)
        elif action.code == UNPACK and not in_bin:
            self.packed.discard(action.item)
            self.buffered.add(action.item)

    def work(self):
        """Packs until the gateway is gone."""
        while True:
            while len(self.belt) + len(self.buffered) < BELT:
                self.items += 1
                self.must(ARRIVED, self.items, self.dice.randint(1, 5), self.dice.randint(1, 5))
            if self.dice.random() < 0.05:
                self.must(GONE, self.dice.choice(sorted(self.belt | self.buffered)))
            reject = self.send(PLAN, None, DEADLINE)
            if reject == WRONG_STATE:
                self.change_done_bin()
                continue
            check(reject == 0, "PLAN_NEXT: reject %d" % reject)
            if self.plc.wait_done() not in (1, 2):
                continue
            actions = self.plc.actions()
            for action in actions:
                if action.code == PACK and self.dice.random() < 0.1:
                    self.must(FAILED, action.item)
                    break  # what may depend on it is given up by the next PLAN_NEXT
                if action.code == PACK:
                    self.must(PLACED, action.item, action.x, action.y, action.rot)
                elif action.code == UNPACK:
                    self.must(UNPACKED, action.item)
                elif action.code == TERMINATE:
                    self.must(CHANGED, None, 10, 10)
                    self.plc.reaches("Execute")


def kills(seed):
    dice = random.Random(seed)
    cell = Cell(dice)
    journal = work / "kills"
    options = ("--repack", "full", "--scenario", "D-R5A3O1")
    for _ in range(KILLS):
        gateway = Gateway(journal, *options, wait=False)
        # Some at any time, while it starts or plans, most about the commit of a command.
        cell.commands_left, cell.kill = None, gateway.process.kill
        if dice.random() < 0.3:
            threading.Timer(dice.uniform(0.0, 0.6), gateway.process.kill).start()
        else:
            cell.commands_left = dice.randint(1, 40)
        try:
            gateway.wait_listening()
            cell.connect(gateway.port)
            cell.start(gateway)
            cell.work()
        except (Lost, NotStarted):
            pass
        gateway.kill()
    cell.commands_left = None
    gateway = Gateway(journal, *options)
    cell.connect(gateway.port)
    registers = cell.plc.read(BIN_ITEMS, 3)
    gateway.end()

    records = journal_records(journal)
    equal([r["sequence"] for r in records], list(range(1, len(records) + 1)), "sequences")
    got = [(r["number"], r["command"], r.get("item")) for r in records if r["kind"] == "command"]
    wanted = [(number, NAMES[code], item) for number, code, item in cell.acknowledged]
    equal(len(got), len(wanted), "commands in the journal, acknowledged")
    for i, (a, b) in enumerate(zip(got, wanted)):
        if not equal(a, b, "command %d" % i):
            break
    arrived = sum(code == ARRIVED for _, code, _ in cell.acknowledged)
    equal(sum(registers) + cell.closed + cell.gone, arrived, "items in the journal")
    print("%d kills, %d commands acknowledged, %d items, %d in flight at a kill of which %d were in "
          "the journal, %d resolved" % (KILLS, len(wanted), arrived, cell.in_flight, cell.kept,
                                        cell.resolved))
    check(cell.in_flight > 0, "no command was ever in flight: the kills came at the wrong time")


def main():
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else int(time.time()) % 1000000
    print("seed %d" % seed, flush=True)
    numbers()
    wrap()
    kills(seed)
    finish()


main()
