#!/usr/bin/env python3
"""Compares what arm64_report printed on this machine, on arm64, and on arm64 once more.

Usage: compare.py HERE THERE THERE_AGAIN

Plans are to be equal: every score that a plan depends on is made of whole numbers, or rounded in the
same order by every compiler (-ffp-contract=off). What networks say may differ in the last digits, for
mathematical functions do. A run of the simulation repeats on one machine; between machines its hash
may differ, for it is bit for bit and Box2D is compiled by others.
"""

import sys

NETWORK_TOLERANCE = 1e-5
WORDS_OF_KEY = {"golden": 1, "plan": 4, "net": 4, "cell": 3}


def facts(path):
    """{key: values} of a report, the key being the words that name the fact."""
    found = {}
    with open(path, encoding="ascii") as lines:
        for line in lines:
            words = line.split()
            names = WORDS_OF_KEY[words[0]]
            found[" ".join(words[:names])] = words[names:]
    return found


def kind_of(key):
    return key.split()[0]


def main():
    here, there, again = (facts(path) for path in sys.argv[1:])
    faults = []
    if here.keys() != there.keys():
        faults.append(f"facts of one machine alone: {sorted(here.keys() ^ there.keys())}")
    if again != there:
        differing = [key for key in there if again.get(key) != there[key]]
        faults.append(f"not the same in a second run: {differing}")

    count = dict.fromkeys(WORDS_OF_KEY, 0)
    worst = 0.0
    schedules = runs = 0
    for key in here.keys() & there.keys():
        ours, theirs = here[key], there[key]
        count[kind_of(key)] += 1
        if kind_of(key) == "cell":
            schedules += ours[0] == theirs[0]
            runs += ours[1] == theirs[1]
        elif kind_of(key) == "net":
            if ours[0] != theirs[0] or len(ours) != len(theirs):
                faults.append(f"{key}: position {ours[0]} here, {theirs[0]} there")
                continue
            for mine, other in zip(ours[1:], theirs[1:]):
                # A logit is relative to its size; of numbers up to 1 this is the plain difference.
                difference = abs(float(mine) - float(other)) / max(1.0, abs(float(mine)))
                worst = max(worst, difference)
                # Written so that a NaN is a fault.
                if not difference <= NETWORK_TOLERANCE:
                    faults.append(f"{key}: {mine} here, {other} there")
        elif ours != theirs:
            faults.append(f"{key}: {' '.join(ours)} here, {' '.join(theirs)} there")
    for kind, number in count.items():
        if number == 0:
            faults.append(f"no line '{kind}' in the reports")

    for fault in faults:
        print(fault)
    if faults:
        return 1
    print(f"golden hash {here['golden'][0]} and {count['plan']} plan hashes equal")
    print(f"{count['net']} evaluations of networks: same positions, outputs within {worst:.1e}")
    print(f"{count['cell']} cells: schedule and simulation hashes repeat; against this machine "
          f"{schedules} schedules and {runs} simulations equal")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit("usage: compare.py HERE THERE THERE_AGAIN")
    sys.exit(main())
