"""Bad input: an exception with the library's line, never a crash."""
import copy
import gc
import os
import pickle
import threading
import unittest

from setting import numpy

import packcell
from packcell import (Action, Bin, Budget, BusyError, Cell, ClosedError, Generate, Generator, Grid,
                      Item, Mode, PackcellError, Planner, Policy, Queue, Repack, Schedule, Status,
                      Trainer)


class StatusTest(unittest.TestCase):
    def test_the_librarys_line(self):
        with self.assertRaises(packcell.ArgumentError) as caught:
            Bin(0, 10)
        error = caught.exception
        self.assertIsInstance(error, (PackcellError, ValueError))
        self.assertEqual(error.status, Status.ARGUMENT)
        self.assertEqual(str(error), error.message)
        self.assertRegex(error.message, r"0.*1\.\.128")

    def test_classes(self):
        bin, queue = Bin(3, 3), Queue()
        bin.pack(Item(0, 2, 2), 0, 0)
        cases = [
            (packcell.StateError, lambda: bin.pack(Item(1, 2, 2), 1, 1)),
            (packcell.StateError, lambda: bin.unpack(5)),
            (packcell.StateError, lambda: queue.remove(1)),
            (packcell.StateError, lambda: Planner().result()),
            (packcell.StateError, lambda: packcell.apply_step(bin, queue, [Action(2, 5)])),
            (packcell.FormatError, lambda: packcell.load_snapshot(b"nonsense")),
            (packcell.FormatError, lambda: packcell.load_snapshot(b"")),
            (packcell.FormatError, lambda: Policy.load(b"nonsense")),
            (packcell.FormatError, lambda: Cell.load("{")),
            (packcell.FileError, lambda: Policy.load_file("/nowhere/at/all.pkw")),
            (packcell.FileError, lambda: Trainer.load_file("/nowhere/at/all.pkt")),
            (packcell.UnsupportedError, lambda: Policy("contact").evaluate(bin, 1, 1)),
            (packcell.UnsupportedError, lambda: Policy("contact").save()),
            (packcell.LimitError, lambda: Planner(max_side=2).plan(bin, queue)),
            (packcell.CapacityError, lambda: Generator(Generate.FULL).next(1)),
            (packcell.ArgumentError, lambda: Policy("no such")),
            (packcell.ArgumentError, lambda: Queue("D-R5")),
            (packcell.ArgumentError, lambda: Planner(method=9)),
            (packcell.ArgumentError, lambda: Schedule(Cell(), "S-R1A1", 9)),
            (packcell.ArgumentError, lambda: Trainer(name="Bad Name")),
        ]
        for wanted, call in cases:
            with self.assertRaises(wanted) as caught:
                call()
            self.assertTrue(caught.exception.message)


class ValueTest(unittest.TestCase):
    def test_numbers_that_c_would_cut(self):
        bin, queue = Bin(3, 3), Queue()
        for call in (
                lambda: Bin((1 << 32) + 5, 5),
                lambda: bin.pack(Item(1 << 40, 1, 1), 0, 0),
                lambda: bin.pack(Item(1, 1, 1, -1), 0, 0),
                lambda: queue.remove_items([1 << 31]),
                lambda: packcell.plan_hash([(1 << 32,)]),
                lambda: Planner(memory=-1),
                lambda: Planner(method=(1 << 32) + 2),
                lambda: Planner().step(-1),
                lambda: Planner().plan(bin, queue, -5),
                lambda: Generator().next(-1),
                lambda: Generator().next(1 << 40),
                lambda: Trainer(name="a" * 32),
                lambda: Policy("con\0tact"),
                lambda: Policy.load_file("a\0b"),
                lambda: Policy("contact").evaluate_batch([bin], []),
                lambda: Policy("contact").evaluate_batch([], []),
                lambda: Cell().inverse(0, [0.0] * 3),
                lambda: Cell().forward(0, [0.0] * 7),
                lambda: Cell().forward(0, [10 ** 400] * 6),
                lambda: Grid(bin_w=10 ** 400),
                lambda: Bin(10 ** 6000, 3),
                lambda: Policy("\ud800"),
                lambda: Policy.load_file("\ud800"),
                lambda: Cell.load("\ud800"),
                lambda: Trainer(name="\ud800"),
        ):
            with self.assertRaises(ValueError) as caught:
                call()
            self.assertIsInstance(caught.exception, packcell.ArgumentError)

    def test_wrong_types(self):
        bin, queue, planner = Bin(3, 3), Queue(), Planner()
        for call in (
                lambda: Bin("3", 3),
                lambda: Bin(3.0, 3),
                lambda: Bin(None, 3),
                lambda: bin.pack("item", 0, 0),
                lambda: bin.pack((1, 2), 0, 0),
                lambda: bin.pack(None, 0, 0),
                lambda: queue.push(bin),
                lambda: queue.extend([1]),
                lambda: queue.remove_items(5),
                lambda: Queue(5),
                lambda: planner.plan(queue, bin),
                lambda: planner.plan(None, None),
                lambda: planner.plan(bin, queue, "much"),
                lambda: planner.plan(bin, queue, Budget(1, "long")),
                lambda: Planner(bin),
                lambda: packcell.apply_step(bin, queue, ["x"]),
                lambda: packcell.load_snapshot(5),
                lambda: packcell.load_snapshot("text"),
                lambda: Policy(5),
                lambda: Policy.load(5),
                lambda: Policy("contact").select(queue, 1, 1),
                lambda: Policy("contact").evaluate_batch([queue], [(1, 1)]),
                lambda: Policy("contact").evaluate_batch([bin], [5]),
                lambda: Cell.load(5),
                lambda: Schedule(bin, "S-R1A1", Mode.COORDINATED),
                lambda: Trainer(5),
                lambda: Trainer(no_such=1),
                lambda: Generator(seed="x"),
                lambda: Generator(None),
                lambda: Generator().next(1.5),
                lambda: Generator().next("1"),
                lambda: Queue(packcell.Scenario(None, 1, 1, 0)),
                lambda: Policy("contact").evaluate_batch([bin], [(1, 1, 1)]),
                lambda: Grid().item(1j, 1),
        ):
            with self.assertRaises(TypeError):
                call()
        with self.assertRaisesRegex(TypeError, "w must be an integer, not float"):
            Bin(3.0, 3)
        if numpy is not None:
            with self.assertRaises(TypeError):
                Bin(numpy.zeros(2), 3)

    def test_what_cannot_be_copied(self):
        for made in (Bin(2, 2), Policy("contact"), Planner()):
            with self.assertRaises(TypeError):
                pickle.dumps(made)
        with self.assertRaises(TypeError):
            copy.deepcopy(Planner())
        with self.assertRaises(TypeError):
            copy.copy(Planner()._handle)


class ClosedTest(unittest.TestCase):
    def test_closed_objects_say_so(self):
        bin, queue, planner, policy = Bin(3, 3), Queue(), Planner(), Policy("contact")
        for made in (bin, queue, planner, policy):
            self.assertFalse(made.closed)
            made.close()
            made.close()
            self.assertTrue(made.closed)
            with self.assertRaisesRegex(ClosedError, "closed"):
                made.__enter__()
        for call in (
                lambda: bin.info,
                lambda: bin.items(),
                lambda: bin.pack(Item(0, 1, 1), 0, 0),
                lambda: bin.clone(),
                lambda: queue.push(Item(0, 1, 1)),
                lambda: planner.cancel(),
                lambda: planner.plan(Bin(3, 3), Queue()),
                lambda: Planner().plan(bin, Queue()),
                lambda: Planner().plan(Bin(3, 3), queue),
                lambda: Planner(policy),
                lambda: policy.name,
                lambda: policy.select(Bin(3, 3), 1, 1),
                lambda: Policy("contact").evaluate_batch([bin], [(1, 1)]),
                lambda: packcell.save_snapshot(bin, queue),
        ):
            with self.assertRaises(ClosedError):
                call()

    def test_one_that_was_never_made(self):
        for kind in (Bin, Planner, Policy):
            with self.assertRaises(ClosedError):
                kind.__new__(kind)._handle
        with self.assertRaises(PackcellError):
            Bin(0, 0).close()

    @unittest.skipUnless(hasattr(os, "fork"), "a system without fork")
    def test_a_forked_child_has_objects_of_its_own(self):
        bin, queue, planner = Bin(3, 3), Queue(), Planner("contact")
        child = os.fork()
        if child == 0:
            status = 1
            try:
                queue.push(Item(0, 1, 1))
                packcell.apply_step(bin, queue, planner.plan(bin, queue).actions)
                for made in (bin, queue, planner):
                    made.close()
                status = 0
            finally:
                os._exit(status)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertEqual(bin.info.items, 0)

    def test_objects_in_cycles_are_freed(self):
        freed = []

        class Watched(Bin):
            @staticmethod
            def _free(pointer):
                freed.append(1)
                Bin._free(pointer)

        for _ in range(20):
            bin = Watched(3, 3)
            bin.itself = bin
        del bin
        gc.collect()
        self.assertEqual(len(freed), 20)

    def test_parts_may_go_first(self):
        policy = Policy("contact")
        planner = Planner(policy)
        policy.close()
        queue = Queue()
        queue.push(Item(0, 1, 1))
        self.assertTrue(planner.plan(Bin(3, 3), queue).actions)


class ThreadTest(unittest.TestCase):
    def setUp(self):
        self.bin, self.queue = Bin(40, 40), Queue("S-R12A3")
        self.queue.extend(Generator(w=40, h=40, seed=3).next(30))
        self.planner = Planner(repack=Repack.ANYTIME)
        self.ended = None

    def plan_aside(self, budget):
        def work():
            try:
                self.ended = self.planner.plan(self.bin, self.queue, budget)
            except PackcellError as error:
                self.ended = error
        thread = threading.Thread(target=work)
        thread.start()
        return thread

    def test_a_second_thread_is_told_that_the_handle_is_busy(self):
        busy = None
        for _ in range(20):  # until the calls of both threads have met
            thread = self.plan_aside(Budget(0, 20000))
            while busy is None and thread.is_alive():
                try:
                    self.planner.step(1)
                except BusyError as error:
                    busy = error
                except packcell.StateError:
                    pass  # nothing was begun yet
            while thread.is_alive():
                self.planner.cancel()
            thread.join()
            if busy is None and isinstance(self.ended, BusyError):
                busy = self.ended  # the planning thread came second
            if busy is not None:
                break
        self.assertIsNotNone(busy)
        self.assertEqual(busy.status, Status.BUSY)
        self.assertTrue(busy.message)

    def test_a_plan_that_another_thread_replaced_is_not_given_out(self):
        bin, queue, other, planner = Bin(10, 10), Queue(), Queue(), Planner("contact")
        queue.push(Item(1, 2, 2))
        other.push(Item(2, 3, 3))
        result = planner.result

        def replaced():  # as a thread does that comes between the plan and its reading
            planner.begin(bin, other)
            while not planner.step(1000):
                pass
            return result()
        planner.result = replaced
        with self.assertRaises(BusyError):
            planner.plan(bin, queue)
        planner.result = result
        self.assertEqual(planner.plan(bin, queue).actions[0].item, 1)

    def test_closing_what_another_thread_uses_waits_for_it(self):
        thread = self.plan_aside(Budget(0, 200))
        while thread.is_alive():
            self.planner.close()
            self.bin.close()
            self.queue.close()
        thread.join()
        self.assertIsInstance(self.ended, (ClosedError, packcell.Plan))

    def test_a_batch_outlives_the_bins_that_are_closed_meanwhile(self):
        policy, bins = Policy("contact"), [Bin(10, 10) for _ in range(4)]
        wrong = []

        def work():
            for _ in range(50):
                try:
                    policy.evaluate_batch(list(bins) * 50, [(2, 3)] * 200)
                except ClosedError:
                    pass
                except BaseException as error:  # noqa: BLE001: any other is a fault
                    wrong.append(error)
        thread = threading.Thread(target=work)
        thread.start()
        at = 0
        while thread.is_alive():
            at = (at + 1) % len(bins)
            bins[at].close()
            bins[at] = Bin(10, 10)
        thread.join()
        self.assertEqual(wrong, [])

    def test_a_training_is_cancelled_from_another_thread(self):
        trainer = Trainer(bin_w=4, bin_h=4, most_side=2, workers=1, environments=1, steps=1,
                          channels=1, features=2, hidden=2)

        def work():
            while True:
                try:
                    return trainer.run(1 << 48)
                except BusyError:  # it came while the other thread asked for the info
                    pass
        thread = threading.Thread(target=work)
        thread.start()
        busy = None
        while thread.is_alive():
            try:
                trainer.info
            except BusyError as error:
                busy = error
                trainer.cancel()
        thread.join()
        self.assertIn("trainer", busy.message)
        self.assertGreater(trainer.info.updates, 0)

    def test_many_threads_on_one_bin(self):
        bin = Bin(10, 10)
        wrong = []

        def work(first):
            for id in range(first, first + 300):
                try:
                    bin.pack(Item(id, 1, 1), id % 10, id // 10 % 10)
                    bin.unpack(id)
                except (BusyError, packcell.StateError):
                    pass
                except BaseException as error:  # noqa: BLE001: any other is a fault
                    wrong.append(error)
        threads = [threading.Thread(target=work, args=(1000 * n,)) for n in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])
        self.assertEqual(bin.info.fixed_cells, 0)


if __name__ == "__main__":
    unittest.main()
