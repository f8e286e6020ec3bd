#!/usr/bin/env python3
"""Plans the golden scenario (bindings/README.md) and prints the hash of its plan."""
from packcell import (Bin, Item, Method, Planner, Queue, Repack, apply_step, plan_hash)

SIZES = [(2, 1), (4, 3), (2, 2), (4, 4), (2, 4), (3, 4), (3, 2),
         (3, 1), (3, 5), (2, 2), (2, 2), (2, 3), (5, 5), (2, 4)]

with Bin(10, 10) as bin, Queue("D-R5A3O1") as queue, \
        Planner("contact", method=Method.EXACT, rotation=True, repack=Repack.FULL) as planner:
    queue.extend(Item(id, w, h) for id, (w, h) in enumerate(SIZES))
    actions = []
    terminate = False
    while not terminate:
        plan = planner.plan(bin, queue, budget=20000)
        apply_step(bin, queue, plan.actions)
        actions += plan.actions
        terminate = plan.terminate
    print(f"{plan_hash(actions):016x}")
