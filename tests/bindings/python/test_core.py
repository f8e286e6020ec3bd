"""Bin, queue, policy, planner, exact packer, generator, trainer, snapshots and millimetres."""
import copy
import gc
import pathlib
import re
import tempfile
import threading
import unittest

from setting import GOLDEN_SIZES, numpy

import packcell
from packcell import (Action, Bin, Budget, Generate, Generator, Grid, Item, ItemFlag, Learner,
                      Method, Op, Packing, Placement, Planner, Policy, Proof, Queue, Repack,
                      Rotation, Scenario, Trainer, TrainerOptions)

GOLDEN = pathlib.Path(__file__).parents[2] / "golden" / "binding-plan.txt"


def golden_cell():
    queue = Queue("D-R5A3O1")
    queue.extend(Item(id, w, h) for id, (w, h) in enumerate(GOLDEN_SIZES))
    return Bin(10, 10), queue


def golden_planner():
    return Planner("contact", method=Method.EXACT, rotation=True, repack=Repack.FULL)


class BinTest(unittest.TestCase):
    def test_packs_and_unpacks(self):
        with Bin(5, 4) as bin:
            bin.block(4, 3, 1, 1)
            bin.pack(Item(7, 2, 3), 0, 0, rot=1)
            self.assertEqual(bin.items(), [Placement(Item(7, 2, 3, 0), 0, 0, 1)])
            self.assertEqual((bin.items()[0].w, bin.items()[0].h), (3, 2))
            info = bin.info
            self.assertEqual((info.w, info.h, info.items, info.occupied_cells, info.fixed_cells),
                             (5, 4, 1, 7, 1))
            self.assertEqual(bin.utilization, 7 / 20)
            self.assertEqual([list(row) for row in bin.cells()],
                             [[7, 7, 7, -1, -1], [7, 7, 7, -1, -1], [-1] * 5, [-1] * 4 + [-2]])
            self.assertEqual(bin.unpack(7), Placement(Item(7, 2, 3, 0), 0, 0, 1))
            self.assertEqual(bin.items(), [])

    def test_arrays_are_numpys_where_it_is(self):
        bin = Bin(3, 2)
        if numpy is None:
            self.assertIsInstance(bin.cells(), list)
            self.assertIsInstance(bin.feasible(1, 1), bytes)
        else:
            self.assertEqual((bin.cells().shape, bin.cells().dtype), ((2, 3), numpy.int32))
            self.assertEqual((bin.feasible(1, 1).shape, bin.feasible(1, 1).dtype), ((7,), bool))
            bin.pack(Item(numpy.int64(3), numpy.int32(1), 1), numpy.uint8(0), 0)
            self.assertEqual(bin.items()[0].item.id, 3)

    def test_feasible_and_contact(self):
        bin = Bin(4, 3)
        bin.pack(Item(0, 2, 3), 0, 0)
        self.assertEqual([i for i, fits in enumerate(bin.feasible(2, 2)) if fits], [2, 6])
        self.assertEqual([i for i, fits in enumerate(bin.feasible(3, 3)) if fits], [12])
        self.assertEqual(bin.contact(2, 0, 2, 3), 10)

    def test_copies_are_apart(self):
        bin = Bin(3, 3)
        for other in (bin.clone(), copy.copy(bin), copy.deepcopy(bin)):
            other.pack(Item(1, 1, 1), 0, 0)
            self.assertEqual((bin.info.items, other.info.items), (0, 1))

    def test_a_handle_is_freed_once(self):
        freed = []

        class Watched(Bin):
            @staticmethod
            def _free(pointer):
                freed.append(pointer)
                Bin._free(pointer)

        with Watched(3, 3) as bin:
            bin.close()
        self.assertEqual(len(freed), 1)
        bin = Watched(3, 3)
        del bin
        gc.collect()
        self.assertEqual(len(freed), 2)


class QueueTest(unittest.TestCase):
    def test_scenarios_have_names(self):
        scenario = Scenario.parse("D-R5A3O1")
        self.assertEqual(scenario, Scenario(2, 5, 3, 1))
        self.assertEqual(scenario.name, "D-R5A3O1")
        self.assertEqual(Queue(scenario).scenario, scenario)
        self.assertEqual(Queue().scenario.name, "S-R1A1")

    def test_belt_and_buffer(self):
        queue = Queue("S-R3A2")
        queue.extend([(0, 1, 1), (1, 2, 1), Item(2, 3, 1, ItemFlag.NO_ROTATE)])
        self.assertEqual([q.item.id for q in queue.belt()], [0, 1, 2])
        self.assertEqual([q.recognized for q in queue.belt()], [True] * 3)
        self.assertEqual(queue.belt()[2].item.flags, ItemFlag.NO_ROTATE)
        queue.put_in_buffer(Item(9, 2, 2), 0)
        self.assertEqual([q.item.id for q in queue.buffer()], [9])
        queue.remove_items([0, 9])
        queue.remove(1)
        queue.set_alpha_left(0)
        self.assertEqual((queue.info.belt, queue.info.buffered), (1, 0))
        self.assertEqual(queue.clone().belt(), queue.belt())

    def test_snapshots_come_back(self):
        bin, queue = golden_cell()
        bin.pack(Item(99, 3, 2), 1, 1)
        saved = packcell.save_snapshot(bin, queue)
        self.assertIsInstance(saved, bytes)
        for given in (saved, bytearray(saved), memoryview(saved)):
            again, line = packcell.load_snapshot(given)
            self.assertEqual((again.items(), line.belt()), (bin.items(), queue.belt()))


class PlannerTest(unittest.TestCase):
    def test_the_golden_plan(self):
        bin, queue = golden_cell()
        actions, steps, terminate = [], 0, False
        with golden_planner() as planner:
            while not terminate:
                plan = planner.plan(bin, queue, Budget(nodes=20000))
                packcell.apply_step(bin, queue, plan.actions)
                self.assertEqual(plan.info.hash, packcell.plan_hash(plan.actions))
                actions += plan.actions
                steps += 1
                terminate = plan.terminate
        self.assertIn(f"{packcell.plan_hash(actions):016x}", GOLDEN.read_text())
        self.assertEqual((steps, len(actions), actions[-1].op), (7, 22, Op.TERMINATE))
        self.assertEqual((bin.info.items, bin.utilization), (13, 1.0))

    def test_slices_give_the_same_plan(self):
        bin, queue = golden_cell()
        planner = golden_planner()
        whole = planner.plan(bin, queue, 20000)
        planner.begin(bin, queue, 20000)
        self.assertTrue(planner.result().actions)
        slices = 1
        while not planner.step(100):
            slices += 1
        self.assertGreater(slices, 1)
        self.assertEqual(planner.result().actions, whole.actions)
        self.assertIsInstance(whole.info.proof, Proof)

    def test_other_threads_run_and_cancel(self):
        bin, queue = Bin(40, 40), Queue("S-R12A3")
        queue.extend(Generator(w=40, h=40, seed=3).next(30))
        planner = Planner(repack=Repack.ANYTIME)
        plans = []
        thread = threading.Thread(target=lambda: plans.append(
            planner.plan(bin, queue, Budget(0, 20000))))
        thread.start()
        while thread.is_alive():  # a plan begun after a cancel is not affected by it
            planner.cancel()
        thread.join()
        self.assertTrue(plans[0].actions)

    def test_exact_packer_and_bound(self):
        bin = Bin(4, 4)
        found = packcell.exact_pack(bin, [(0, 4, 2), (1, 2, 4)])
        self.assertEqual(found.answer, Packing.FOUND)
        for placement in found.placements:
            bin.pack(*placement)
        self.assertEqual(bin.utilization, 1)
        fixed = packcell.exact_pack(Bin(4, 4), [(0, 4, 2), (1, 2, 4)], rotation=False)
        self.assertEqual((fixed.answer, fixed.placements), (Packing.IMPOSSIBLE, None))
        items = [Item(i, 2, 2) for i in range(9)]
        self.assertEqual(packcell.bound_in_order(Bin(4, 4), items), (4, Packing.FOUND))
        self.assertEqual(packcell.exact_pack(bin, []).placements, [])


class PolicyTest(unittest.TestCase):
    def test_names(self):
        self.assertIn("contact", Policy.builtins())
        self.assertEqual(Policy("contact").name, "contact")
        self.assertEqual(Policy("contact").info.learner, "")

    def test_batches_agree_with_single_calls(self):
        policy = Policy("default")
        bins = [Bin(10, 10) for _ in range(3)]
        bins[1].pack(Item(0, 3, 3), 0, 0)
        sizes = [(1, 2), (3, 3), (5, 4)]
        batch = policy.evaluate_batch(bins, sizes)
        self.assertEqual(list(batch.positions),
                         [policy.select(bin, *size) for bin, size in zip(bins, sizes)])
        self.assertIsNone(batch.probabilities)
        again = policy.evaluate_batch(iter(bins), iter(sizes))
        self.assertEqual(list(again.positions), list(batch.positions))
        if numpy is not None:
            again = policy.evaluate_batch(bins, numpy.array(sizes))
            self.assertEqual(list(again.positions), list(batch.positions))

    def test_a_trained_network_is_saved_and_evaluated(self):
        with Trainer(TrainerOptions(bin_w=4, bin_h=4, most_side=2, workers=1, environments=2,
                                    steps=2, channels=2, features=4, hidden=4)) as trainer:
            trainer.run(3)
            self.assertEqual(trainer.info.updates, 3)
            self.assertEqual(trainer.options.bin_w, 4)
            self.assertEqual(trainer.options.name, "a3c")
            trainer.cancel()
            policy = trainer.policy()
            measured = trainer.measure(rotation=Rotation.ON, bins=20)
            self.assertTrue(0 < measured.mean <= 1)
            with tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder, "t.pkt")
                trainer.save_file(file)
                with Trainer.load_file(file) as again:
                    self.assertEqual(again.info.updates, 3)
                policy.save_file(pathlib.Path(folder, "t.pkw"))
                loaded = Policy.load_file(pathlib.Path(folder, "t.pkw"))
        self.assertEqual(loaded.save(), policy.save())
        same = Policy.load(policy.save())
        self.assertEqual(same.info.learner, "a3c")
        bin = Bin(4, 4)
        single = same.evaluate(bin, 2, 1)
        self.assertEqual((len(single.logits), len(single.probabilities)), (17, 17))
        self.assertAlmostEqual(sum(map(float, single.probabilities)), 1, places=5)
        batch = same.evaluate_batch([bin, bin], [(2, 1), (1, 1)], probabilities=True, values=True)
        self.assertEqual(list(batch.probabilities[0]), list(single.probabilities))
        self.assertEqual(len(batch.values), 2)
        options = TrainerOptions(bin_w=4, bin_h=4, most_side=2)
        self.assertGreater(Policy("contact").measure(options, bins=50).mean, 0.5)

    def test_keywords_train_too(self):
        with Trainer(learner=Learner.AFTERSTATE, bin_w=4, bin_h=4, most_side=4) as trainer:
            self.assertEqual(trainer.options.learner, Learner.AFTERSTATE)


class GeneratorTest(unittest.TestCase):
    def test_streams_and_sets(self):
        stream = Generator(w=8, h=6, seed=5)
        items = stream.next(10) + stream.next()
        self.assertEqual([item.id for item in items], list(range(11)))
        self.assertEqual(Generator(w=8, h=6, seed=5).next(11), items)
        whole = Generator(Generate.FULL, preset="text", seed=2).next()
        self.assertEqual(sum(item.w * item.h for item in whole), 100)


class GridTest(unittest.TestCase):
    def test_the_papers(self):
        grid = Grid()
        self.assertEqual(grid.bin(), (10, 8))
        self.assertEqual(grid.item(31, 30), (2, 1))
        self.assertEqual(grid.centre(0, 0, 2, 1), (40.0, 25.0))


class VersionTest(unittest.TestCase):
    def test_package_and_library(self):
        self.assertEqual(packcell.__version__, ".".join(map(str, packcell.version())))
        self.assertEqual(sorted(packcell.__all__), packcell.__all__)
        for name in packcell.__all__:
            self.assertTrue(hasattr(packcell, name), name)

    def test_nothing_of_the_header_is_left_out(self):
        folder = pathlib.Path(packcell.__file__).parent
        code = "".join(file.read_text() for file in folder.glob("*.py") if file.name != "_raw.py")
        used = set(re.findall(r"\braw\.(pkc_\w+)", code))
        raw = packcell.bin.raw
        offered = {name for name in vars(raw) if name.startswith("pkc_")
                   and not name.endswith("_init") and not isinstance(vars(raw)[name], type)}
        self.assertEqual(offered - used, {"pkc_status_name"})  # Status has the names

    def test_actions_are_tuples(self):
        self.assertEqual(packcell.plan_hash([(4,)]), packcell.plan_hash([Action(Op.TERMINATE)]))


if __name__ == "__main__":
    unittest.main()
