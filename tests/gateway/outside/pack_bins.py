"""Packs bins through a gateway, as a PLC without failures does.

usage: pack_bins.py PORT BINS
"""
import random
import sys

from harness import check, finish
from plc import CHANGED, PACK, SKIP, TERMINATE, UNPACK, Plc

QUEUED = 8


def main():
    dice = random.Random(11)
    plc = Plc(int(sys.argv[1]))
    plc.bring("Execute")
    bins = int(sys.argv[2])
    item = queued = closed = 0
    while closed < bins:
        while queued < QUEUED:
            plc.arrive(item, dice.randint(1, 5), dice.randint(1, 5))
            item += 1
            queued += 1
        done = plc.state() in ("Suspending", "Suspended")  # filled to the last cell
        if not done:
            result, actions = plc.plan(500)
            for action in actions:
                check(plc.carry_out(action) == 0, "item %d" % action.item)
                queued += {PACK: -1, UNPACK: 1}.get(action.code, 0)
                check(action.code != SKIP, "a skip")
                done = done or action.code == TERMINATE
            check(result in (1, 2) or plc.reaches("Suspended"), "result %d" % result)
            done = done or result == 3
        if done:
            plc.must(CHANGED, 10, 10)
            plc.reaches("Execute")
            closed += 1
    finish()


main()
