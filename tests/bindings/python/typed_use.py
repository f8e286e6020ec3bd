"""Uses of the package that mypy --strict must accept; nothing runs it."""
from packcell import (Action, Bin, Budget, Cell, Item, Method, Mode, Op, Plan, Planner, Policy, Queue,
                      Schedule, allocate, apply_step, bound_in_order, exact_pack, load_snapshot,
                      plan_hash, save_snapshot)
from packcell.env import PackingEnv, VectorPackingEnv


def plan_a_step() -> Plan:
    with Bin(10, 10) as bin, Queue("S-R5A3") as queue:
        queue.push((0, 2, 3))
        queue.extend(Item(id, 2, 2) for id in range(1, 4))
        queue.extend([(7, 1, 1, 0), (8, 1, 1)])
        bin.pack((99, 1, 1), 9, 9)
        planner = Planner(Policy("contact"), method=Method.EXACT, rotation=True)
        plan = planner.plan(bin, queue, Budget(nodes=2000))
        apply_step(bin, queue, plan.actions)
        apply_step(bin, queue, [(Op.TERMINATE,), Action(Op.TERMINATE)])
        again, line = load_snapshot(bytearray(save_snapshot(bin, queue)))
        schedule = Schedule(Cell(), line.scenario, Mode.COORDINATED)
        schedule.add_step(again, line, allocate(Cell(), line, [(Op.PACK, 7, 0, 0, 0, 0)]))
        fits: bool = exact_pack(again, [(1, 2, 3)]).placements is not None
        most: int = bound_in_order(again, [Item(1, 2, 3), (2, 1, 1)]).items
        print(fits, most, plan_hash([(Op.TERMINATE,)]))
        return plan


def play() -> float:
    with PackingEnv(5, 5) as env:
        _, info = env.reset(seed=1)
        reward: float = env.step(info["action_mask"].argmax())[1]
    many = VectorPackingEnv(4)
    many.reset(seed=[1, 2, 3, 4])
    return reward
