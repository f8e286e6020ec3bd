"""Cell, allocation, schedule, simulation, traces and pictures."""
import pathlib
import tempfile
import unittest

from setting import GOLDEN_SIZES, numpy

import packcell
from packcell import (ArmTimes, Bin, Cell, Item, Mode, Outcome, Planner, Queue, Schedule, Trace,
                      Wait)

try:
    import matplotlib
except ImportError:
    matplotlib = None


def scheduled(cell):
    schedule = Schedule(cell, "D-R5A3O1", Mode.COORDINATED)
    bin, queue = Bin(10, 10), Queue("D-R5A3O1")
    queue.extend(Item(id, w, h) for id, (w, h) in enumerate(GOLDEN_SIZES[:6]))
    planner = Planner("contact")
    for _ in range(2):
        actions = packcell.allocate(cell, queue, planner.plan(bin, queue, 2000).actions)
        schedule.add_step(bin, queue, actions)
        packcell.apply_step(bin, queue, actions)
    return schedule, bin


class CellTest(unittest.TestCase):
    def test_presets_and_their_text(self):
        self.assertIn("ur5e", Cell.presets())
        cell = Cell("ur5e")
        self.assertEqual((cell.info.name, cell.info.arms, cell.info.joints), ("ur5e", 2, (6, 6)))
        self.assertEqual(Cell.load(cell.save()).save(), cell.save())
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "cell.json")
            cell.save_file(file)
            self.assertEqual(Cell.load_file(file).info, cell.info)
        cell.check("D-R5A3O1")

    def test_kinematics_there_and_back(self):
        cell = Cell("ur5e")
        schedule = scheduled(cell)[0]
        sample = schedule.sample(0, 1.0)
        pose = cell.forward(0, sample.position)
        for there, back in zip(pose, cell.forward(0, cell.inverse(0, pose))):
            self.assertAlmostEqual(there, back, places=5)
        with self.assertRaises(packcell.StateError):
            cell.inverse(0, [90, 90, 0, 0])

    def test_layout(self):
        cell, info = Cell("ur5e").optimize_layout("D-R5A3O1", evaluations=10)
        self.assertLessEqual(info.after, info.before)
        self.assertEqual(cell.info.arms, 2)


class ScheduleTest(unittest.TestCase):
    def test_a_schedule_is_simulated_and_written(self):
        schedule, bin = scheduled(Cell("ur5e"))
        info = schedule.info
        self.assertEqual((info.steps, info.mode), (2, Mode.COORDINATED))
        self.assertIsInstance(info.arms[1], ArmTimes)
        self.assertEqual(len(info.arms[0].waits), len(Wait))
        arm = info.arms[0]
        self.assertAlmostEqual(arm.travel + arm.strokes + arm.grips + sum(arm.waits),
                               info.makespan, places=3)
        with schedule.simulate(frames=True, hertz=60) as run:
            places = run.places()
            self.assertEqual(len(places), bin.info.items)
            self.assertEqual({place.outcome for place in places}, {Outcome.OK})
            self.assertEqual(run.info.places, len(places))
            with tempfile.TemporaryDirectory() as folder:
                for kind in Trace:
                    file = pathlib.Path(folder, kind.name)
                    schedule.write_trace(kind, file, simulation=run, period=0.1)
                    self.assertGreater(file.stat().st_size, 100)
        with self.assertRaises(packcell.StateError):
            schedule.put_aside(4711, 0.0)
        with self.assertRaises(packcell.ClosedError):
            run.places()


@unittest.skipIf(matplotlib is None or numpy is None, "matplotlib is not here")
class PlotTest(unittest.TestCase):
    def test_a_bin_and_a_gantt_chart(self):
        matplotlib.use("Agg")
        from matplotlib import pyplot
        from packcell import plot
        schedule, bin = scheduled(Cell("ur5e"))
        bin.block(9, 9, 1, 1)
        pictures = [plot.draw_bin(bin), plot.gantt(schedule)]
        self.assertEqual(len(pictures[0].patches), bin.info.items + 1)
        self.assertEqual([label.get_text() for label in pictures[1].get_yticklabels()],
                         ["arm 0", "arm 1"])
        pictures.append(plot.draw_bin(Bin(128, 4)))
        for picture in pictures:  # nothing is cut off
            figure = picture.figure
            figure.canvas.draw()
            for text in (picture.title, picture.xaxis.label, *picture.get_yticklabels()):
                if text.get_text():
                    box = text.get_window_extent()
                    self.assertTrue(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1, text)
                    self.assertTrue(figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1, text)
        with tempfile.TemporaryDirectory() as folder:
            for at, picture in enumerate(pictures):
                file = pathlib.Path(folder, f"{at}.png")
                picture.figure.savefig(file)
                self.assertGreater(file.stat().st_size, 1000)
        pyplot.close("all")

    def test_spans_cover_the_schedule(self):
        from packcell import plot
        schedule, _ = scheduled(Cell("ur5e"))
        spans = plot.spans(schedule, 0)
        self.assertEqual(spans[0][0], 0)
        self.assertAlmostEqual(spans[-1][1], schedule.info.makespan)
        for one, next in zip(spans, spans[1:]):
            self.assertEqual(one[1], next[0])
        for period in (0, -1.0, float("nan")):
            with self.assertRaises(packcell.ArgumentError):
                plot.spans(schedule, 0, period)


if __name__ == "__main__":
    unittest.main()
