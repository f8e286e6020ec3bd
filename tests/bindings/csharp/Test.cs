// What the C# classes do beyond the raw layer: the golden plan, and bad input as exceptions.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Threading;
using Packcell;

public static partial class Test
{
    private static readonly int[] Sides = {
        2, 1, 4, 3, 2, 2, 4, 4, 2, 4, 3, 4, 3, 2, 3, 1, 3, 5, 2, 2, 2, 2, 2, 3, 5, 5, 2, 4
    };

    private static readonly PlanAction[] NoSuch = { new PlanAction { Op = Op.Pack, Item = 99 } };

    private static int failures;

    private static void Check(bool holds, string what)
    {
        if (holds)
            return;
        Console.WriteLine("FAILED: " + what);
        ++failures;
    }

    private static void Throws(Status status, string part, string what, Action call)
    {
        try
        {
            call();
            Check(false, what + ": no exception");
        }
        catch (PackcellException error)
        {
            Check(error.Status == status, what + ": " + error.StatusName);
            Check(error.Message != "" && error.Message.Contains(part),
                  what + ": says '" + error.Message + "'");
        }
        catch (Exception error)
        {
            Check(false, what + ": " + error);
        }
    }

    private static Queue Golden()
    {
        var queue = new Queue("D-R5A3O1");
        for (int id = 0; 2 * id < Sides.Length; ++id)
            queue.Push(new Item(id, Sides[2 * id], Sides[2 * id + 1]));
        return queue;
    }

    private static Planner GoldenPlanner(Policy policy)
    {
        return new Planner(new PlannerOptions { Repack = Repack.Full }, policy);
    }

    // In slices, through snapshots, and with a schedule and a run of all steps.
    private static void SlicesSnapshotsAndCell(string expected)
    {
        var all = new List<PlanAction>();
        var bin = new Bin(10, 10);
        Queue queue = Golden();
        var budget = new Budget { Nodes = 20000 };
        using (var policy = new Policy("contact"))
        using (var planner = GoldenPlanner(policy))
        {
            Plan plan;
            do
            {
                planner.Begin(bin, queue, budget);
                while (!planner.Step(500)) { }
                plan = planner.Result();
                Check(plan.Info.Hash == Step.Hash(plan.Actions), "the plan's hash");
                Check(plan.Info.Actions == plan.Actions.Length, "the plan's length");
                byte[] bytes = Snapshot.Save(bin, queue);
                bin.Dispose();
                queue.Dispose();
                Snapshot.Load(bytes, out bin, out queue);
                Step.Apply(bin, queue, plan.Actions);
                all.AddRange(plan.Actions);
            } while (!plan.Info.Terminate);
        }
        Check(Step.Hash(all).ToString("x16") == expected, "golden hash in slices");
        Check(all.Count == 22 && bin.Items().Length == 13, "golden actions and items");
        Check(Array.IndexOf(bin.Cells(), Bin.FreeCell) < 0, "golden bin is full");
        bin.Dispose();
        queue.Dispose();
    }

    private static void BinAndQueue()
    {
        using (var bin = new Bin(6, 4))
        {
            bin.Block(0, 0, 1, 1);
            bin.Pack(new Item(7, 2, 3, ItemFlags.NoRotate), 1, 0);
            Check(bin.Info.OccupiedCells == 7 && bin.Info.FixedCells == 1, "cells counted");
            Check(bin.Cells()[1] == 7 && bin.Cells()[0] == Bin.FixedCell, "cells named");
            bool[] mask = bin.Feasible(3, 4);
            Check(mask.Length == 25 && mask[3] && !mask[0] && !mask[24], "feasibility mask");
            Check(bin.Contact(3, 0, 3, 4) > 0, "contact");
            Throws(Status.State, "", "packed over an item",
                   () => bin.Pack(new Item(8, 1, 1), 1, 0));
            Throws(Status.Argument, "", "item of 0 cells", () => bin.Pack(new Item(8, 0, 1), 5, 0));
            using (Bin copy = bin.Clone())
                Check(copy.Info.Hash == bin.Info.Hash, "clone");
            Placement was = bin.Unpack(7);
            Check(was.X == 1 && was.Item.Flags == ItemFlags.NoRotate, "unpacked");
            Check(bin.Items().Length == 0, "no items");
            bin.Clear();
        }
        Scenario scenario = Scenario.Parse("D-R5A3O1");
        Check(scenario.Robots == 2 && scenario.Overlap == 1, "scenario parsed");
        Check(scenario.Name == "D-R5A3O1", "scenario named");
        Throws(Status.Argument, "", "unknown scenario", () => Scenario.Parse("X"));
        Throws(Status.Argument, "", "no scenario", () => Scenario.Parse(null));
        Throws(Status.Argument, "", "scenario out of range",
               () => new Queue(new Scenario(3, 1, 1)));
        Throws(Status.Argument, "", "scenario without numbers", () => new Queue(new Scenario()));
        using (Queue queue = Golden())
        {
            Check(queue.Info.Belt == 14 && queue.Belt()[0].Recognized, "belt");
            Check(queue.Scenario.Name == "D-R5A3O1", "scenario of a queue");
            queue.Remove(0);
            queue.RemoveItems(new[] { 1, 2 });
            queue.PutInBuffer(new Item(50, 1, 1), 1);
            Check(queue.Info.Belt == 11 && queue.Buffer()[0].Item.Id == 50, "removed, buffered");
            queue.SetAlphaLeft(0);
            Throws(Status.State, "", "id twice", () => queue.Push(new Item(3, 1, 1)));
            Throws(Status.State, "", "removed twice", () => queue.RemoveItems(new[] { 3, 3 }));
            Throws(Status.Argument, "", "no ids", () => queue.RemoveItems(null));
            queue.RemoveItems(new int[0]);
            using (Queue copy = queue.Clone())
                Check(copy.Info.Belt == 11, "clone of a queue");
        }
    }

    private static void Load(byte[] bytes)
    {
        Bin bin;
        Queue queue;
        Snapshot.Load(bytes, out bin, out queue);
    }

    private static void BadHandles()
    {
        Throws(Status.Argument, "width 0", "bin of no width", () => new Bin(0, 5));
        var bin = new Bin(4, 4);
        Queue queue = Golden();
        var planner = new Planner();
        var policy = new Policy("contact");
        Throws(Status.State, "", "no plan begun", () => planner.Result());
        Throws(Status.Argument, "", "no bin", () => planner.Plan(null, queue));
        Throws(Status.Argument, "", "no queue", () => planner.Plan(bin, null));
        Throws(Status.Argument, "", "no actions", () => Step.Apply(bin, queue, null));
        Throws(Status.Argument, "", "no actions to hash", () => Step.Hash(null));
        Throws(Status.State, "", "unknown item",
               () => Step.Apply(bin, queue, NoSuch));
        Throws(Status.Argument, "", "no bytes", () => Load(null));
        Throws(Status.Format, "", "bytes of nothing", () => Load(new byte[40]));
        Throws(Status.Format, "", "no byte", () => Load(new byte[0]));
        Throws(Status.Argument, "", "unknown policy", () => new Policy("nosuch"));
        Throws(Status.Argument, "", "no policy name", () => new Policy(null));
        Throws(Status.Argument, "zero", "zero in a name", () => new Policy("contact\0x"));
        Throws(Status.Argument, "surrogate", "half a character", () => new Policy("\ud800"));
        Throws(Status.Unsupported, "", "a heuristic's weights", () => policy.Save());
        Throws(Status.Unsupported, "", "a heuristic's values", () => policy.Evaluate(bin, 1, 1));
        Throws(Status.Argument, "must be two a bin", "sizes of a batch",
               () => policy.SelectBatch(new[] { bin }, new int[3]));
        Throws(Status.Argument, "", "a bin of a batch is null",
               () => policy.SelectBatch(new Bin[1], new[] { 1, 1 }));
        Throws(Status.IO, "/nonexistent", "no such file", () => Policy.LoadFile("/nonexistent"));
        Check(policy.SelectBatch(new[] { bin, bin }, new[] { 1, 1, 2, 2 }).Length == 2, "batch");
        Check(policy.Select(bin, 2, 2) == 0 && policy.Name == "contact", "select");
        Throws(Status.Argument, "", "planner options",
               () => new Planner(new PlannerOptions { MaxSide = 0 }));
        Throws(Status.Argument, "", "budget",
               () => planner.Plan(bin, queue, new Budget { Milliseconds = double.NaN }));

        bin.Dispose();
        bin.Dispose();
        Check(bin.IsDisposed, "disposed of");
        Throws(Status.Argument, "", "bin disposed of", () => bin.Clear());
        Throws(Status.Argument, "", "cells of a bin disposed of", () => bin.Cells());
        Throws(Status.Argument, "", "plan in a bin disposed of", () => planner.Plan(bin, queue));
        Throws(Status.Argument, "", "batch of a bin disposed of",
               () => policy.SelectBatch(new[] { bin }, new[] { 1, 1 }));
        policy.Dispose();
        Check(policy.Name == "", "name of a policy disposed of");
        Throws(Status.Argument, "disposed", "policy disposed of", () => new Planner(null, policy));
        planner.Dispose();
        Throws(Status.Argument, "", "planner disposed of", () => planner.Cancel());
        queue.Dispose();
        Throws(Status.Argument, "", "queue disposed of", () => queue.Push(new Item(1, 1, 1)));
    }

    private static void LearnedPolicy()
    {
        using (var policy = new Policy("default"))
        using (var bin = new Bin(10, 10))
        using (var other = new Bin(10, 10))
        using (var small = new Bin(4, 4))
        {
            PolicyInfo info = policy.Info;
            Check(info.Architecture != Architecture.Heuristic && info.Parameters > 0
                  && info.Learner != "", "a learned policy's info");
            other.Pack(new Item(1, 3, 2), 0, 0);
            Evaluation one = policy.Evaluate(other, 2, 2);
            float sum = 0;
            foreach (float chance in one.Probabilities)
                sum += chance;
            Check(one.Logits.Length == 101 && Math.Abs(sum - 1) < 1e-4, "probabilities");
            Bin[] bins = { bin, other, other };
            int[] sizes = { 5, 1, 2, 2, 1, 4 };
            BatchEvaluation many = policy.EvaluateBatch(bins, sizes);
            Check(many.Values.Length == 3 && many.Values[1] == one.Value, "values of a batch");
            Check(many.Probabilities.Length == 303
                  && many.Probabilities[101 + 44] == one.Probabilities[44], "chances of a batch");
            Check(many.Positions[2] == policy.Select(other, 1, 4)
                  && policy.SelectBatch(bins, sizes)[1] == many.Positions[1], "positions");
            Throws(Status.Argument, "", "bins of two sizes",
                   () => policy.EvaluateBatch(new[] { bin, small }, new[] { 1, 1, 1, 1 }));
            Throws(Status.Argument, "", "a batch of no pairs",
                   () => policy.EvaluateBatch(new Bin[0], new int[0]));
            Throws(Status.Argument, "must be two a bin", "no bins and sizes",
                   () => policy.EvaluateBatch(null, null));
            Throws(Status.Argument, "", "evaluated batch with no bin",
                   () => policy.EvaluateBatch(new Bin[1], new[] { 1, 1 }));
            Measurement measured = policy.Measure(bins: 50);
            Check(measured.Mean > 0.5 && measured.Mean < 1 && measured.HalfWidth > 0, "measured");
            Throws(Status.Argument, "bins 0", "measured on nothing", () => policy.Measure(bins: 0));
        }
        using (var policy = new Policy("contact"))
        using (var bin = new Bin(4, 4))
        {
            Throws(Status.Unsupported, "", "a heuristic's batch",
                   () => policy.EvaluateBatch(new[] { bin }, new[] { 1, 1 }));
            var large = new Protocol { BinW = 40, BinH = 40, MostSide = 20, Items = 30,
                                       Rotation = Rotation.Off };
            Check(policy.Measure(large, 7, 2).Mean > 0, "measured on large bins");
        }
    }

    private static void Packer()
    {
        using (var bin = new Bin(4, 4))
        {
            var fits = new[] { new Item(0, 4, 2), new Item(1, 2, 2), new Item(2, 2, 2) };
            Packing packing = ExactPacker.Pack(bin, fits);
            Check(packing.Answer == PackingAnswer.Found && packing.Placements.Length == 3
                  && packing.Placements[2].Item.Id == 2, "packed exactly");
            packing = ExactPacker.Pack(bin, new[] { new Item(0, 3, 3), new Item(1, 3, 3) });
            Check(packing.Answer == PackingAnswer.Impossible && packing.Placements.Length == 0,
                  "not to be packed");
            Bound bound = ExactPacker.BoundInOrder(bin, new[] { fits[0], fits[0], fits[1] });
            Check(bound.Count == 2 && bound.Answer != PackingAnswer.Budget, "bound");
            Throws(Status.Argument, "", "no items to pack", () => ExactPacker.Pack(bin, null));
            Throws(Status.Argument, "", "item too large",
                   () => ExactPacker.Pack(bin, new[] { new Item(0, 200, 1) }));
            ExactPacker.Pack(bin, new Item[0]);
        }
    }

    private static void CellAndRun(string folder)
    {
        Scenario scenario = Scenario.Parse("D-R5A3O1");
        Throws(Status.Argument, "", "unknown cell", () => new Cell("nosuch"));
        Throws(Status.Format, "", "not a cell", () => Cell.Load("{}"));
        Throws(Status.Argument, "", "no cell", () => Cell.Load(null));
        Check(Array.IndexOf(Cell.Presets, "ur5e") >= 0, "presets");
        Check(Array.IndexOf(Policy.Builtins, "contact") >= 0, "policies");
        using (var cell = new Cell("ur5e"))
        using (Cell same = Cell.Load(cell.Save()))
        using (var schedule = new Schedule(same, scenario, Mode.Coordinated))
        using (var bin = new Bin(10, 10))
        using (Queue queue = Golden())
        using (var planner = new Planner())
        {
            Check(cell.Info.Arms == 2 && cell.Info.Joints[0] == 6, "cell's info");
            cell.CheckReach(scenario);
            double[] pose = { 0, 0, 0 };
            Throws(Status.Argument, "must have 4", "pose too short", () => cell.Inverse(0, pose));
            Throws(Status.Argument, "", "no pose", () => cell.Inverse(0, null));
            Throws(Status.Argument, "must have 6", "joints", () => cell.Forward(0, new double[4]));
            Throws(Status.Argument, "", "third arm", () => cell.Forward(2, new double[6]));
            Plan plan = planner.Plan(bin, queue, new Budget { Nodes = 500 });
            PlanAction[] actions = Step.Allocate(cell, queue, plan.Actions);
            schedule.AddStep(bin, queue, actions);
            Throws(Status.State, "", "not a legal step",
                   () => schedule.AddStep(bin, queue, NoSuch));
            Throws(Status.State, "", "put aside at no release", () => schedule.PutAside(0, 0));
            LayoutInfo layout;
            var little = new LayoutOptions { Evaluations = 10 };
            using (Cell better = cell.OptimizeLayout(scenario, little, out layout))
                Check(better.Info.Arms == 2 && layout.After <= layout.Before, "layout");
            ScheduleInfo info = schedule.Info;
            ArmTimes times = info.Arms[0];
            double sum = times.Travel + times.Strokes + times.Grips;
            for (Wait wait = Wait.None; wait <= Wait.Done; ++wait)
                sum += times.Waiting(wait);
            Check(info.Makespan > 0 && Math.Abs(sum - info.Makespan) < 1e-6, "makespan adds up");
            ArmSample sample = schedule.Sample(0, info.Makespan / 2);
            double[] tool = cell.Forward(0, sample.Position);
            Check(Math.Abs(tool[0] - sample.Tool[0]) < 1e-6, "the tool is where the joints say");
            double[] joints = cell.Inverse(0, tool);
            Check(Math.Abs(cell.Forward(0, joints)[1] - tool[1]) < 1e-6, "inverse and forward");
            Throws(Status.Argument, "", "after the end", () => schedule.Sample(0, 1e9));
            using (var simulation = new Simulation(schedule, new SimulationOptions { Seed = 3 }))
            {
                Place[] places = simulation.Places();
                Check(places.Length == simulation.Info.Places && places.Length > 0, "places");
                Check(places[0].Outcome == Outcome.Ok, "placed");
                string path = Path.Combine(folder, "trace.json");
                schedule.WriteTrace(Trace.Chrome, path, simulation);
                Check(new FileInfo(path).Length > 0, "trace");
                simulation.Dispose();
                Throws(Status.Argument, "disposed", "simulation disposed of",
                       () => schedule.WriteTrace(Trace.Chrome, path, simulation));
            }
            Throws(Status.Argument, "", "options of a run",
                   () => new Simulation(schedule, new SimulationOptions { Hertz = 1 }));
            Throws(Status.Argument, "", "no schedule", () => new Simulation(null));
        }
    }

    // An arm of four joints is asked by six numbers as well.
    private static void Scara()
    {
        using (var cell = new Cell("scara"))
        {
            Check(cell.Info.Joints[0] == 4, "joints of a SCARA");
            double[] pose = cell.Forward(0, new[] { 0.4, 0.6, -0.1, 0.1, 0, 0 });
            double[] joints = cell.Inverse(0, pose);
            Check(joints.Length == 6 && joints[4] == 0 && joints[5] == 0, "the last two are 0");
            Check(Math.Abs(cell.Forward(0, joints)[2] - pose[2]) < 1e-6, "height of a SCARA");
        }
    }

    private static void GeneratorAndGrid()
    {
        using (var generator = new Generator(new GeneratorOptions { Seed = 5 }))
        using (var again = new Generator(new GeneratorOptions { Seed = 5 }))
        {
            Item[] items = generator.Next(20), same = again.Next(20);
            Check(items.Length == 20 && items[19].Id == same[19].Id && items[7].W == same[7].W,
                  "equal seeds, equal items");
            Throws(Status.Argument, "-1", "fewer than none", () => generator.Next(-1));
        }
        var options = new GeneratorOptions { Kind = GeneratorKind.Full }.Preset("text");
        using (var generator = new Generator(options))
        {
            Throws(Status.Capacity, "", "too small for a set", () => generator.Next(1));
            int cells = 0;
            foreach (Item item in generator.Next(100))
                cells += item.W * item.H;
            Check(cells == 100, "a full set");
        }
        Throws(Status.Argument, "", "unknown preset", () => new GeneratorOptions().Preset("x"));
        var grid = new Grid();
        Check(grid.BinCells().Equals((10, 8)) && grid.ItemCells(31, 30).Equals((2, 1)), "grid");
        Check(grid.Centre(0, 0, 2, 1).Equals((40.0, 25.0)), "centre of cells");
        grid.Cell = 0;
        Throws(Status.Argument, "", "cell of 0 mm", () => grid.BinCells());
    }

    // A plan without limits is under way in another thread: what it uses is busy, until it is
    // cancelled. Disposing of a bin meanwhile waits with the freeing for the plan's end.
    private static void BusyAndCancel()
    {
        var options = new PlannerOptions {
            Method = Method.Paper, Select = PlannerOptions.SelectAll
        };
        var bin = new Bin(40, 40);
        using (var queue = new Queue(new Scenario(2, 24, 12, 0)))
        using (var policy = new Policy("contact"))
        using (var planner = new Planner(options, policy))
        {
            for (int id = 0; id < 40; ++id)
                queue.Push(new Item(id, 2 + id % 5, 3 + id % 4));
            Plan plan = null;
            Exception failed = null;
            var thread = new Thread(() =>
            {
                while (plan == null && failed == null)
                {
                    try
                    {
                        plan = planner.Plan(bin, queue, new Budget { Nodes = 0 });
                    }
                    catch (PackcellException error) when (error.Status == Status.Busy)
                    {
                        Thread.Yield();
                    }
                    catch (Exception error)
                    {
                        failed = error;
                    }
                }
            });
            thread.Start();
            bool busy = false;
            while (!busy && thread.IsAlive)
            {
                try
                {
                    planner.Result();
                }
                catch (PackcellException error)
                {
                    busy = error.Status == Status.Busy && error.Message.Contains("thread");
                }
                Thread.Sleep(1);
            }
            Check(busy, "a handle in use by two threads is busy");
            if (busy)
                bin.Dispose();
            do
                planner.Cancel();
            while (!thread.Join(5));
            Check(failed == null, "the cancelled plan: " + failed);
            Check(plan != null && plan.Info.Cancelled, "cancelled");
            Check(bin.IsDisposed, "disposed of while in use");
        }
    }

    // A planner that is disposed of while it plans is freed after that plan, not under it.
    private static void DisposedInUse()
    {
        var options = new PlannerOptions {
            Method = Method.Paper, Select = PlannerOptions.SelectAll
        };
        using (var bin = new Bin(40, 40))
        using (var queue = new Queue(new Scenario(2, 24, 12, 0)))
        {
            for (int id = 0; id < 40; ++id)
                queue.Push(new Item(id, 2 + id % 5, 3 + id % 4));
            var planner = new Planner(options);
            Exception ended = null;
            var thread = new Thread(() =>
            {
                while (ended == null)
                {
                    try
                    {
                        planner.Plan(bin, queue, new Budget { Nodes = 0, Milliseconds = 200 });
                    }
                    catch (PackcellException error) when (error.Status == Status.Busy) { }
                    catch (Exception error)
                    {
                        ended = error;
                    }
                }
            });
            thread.Start();
            for (bool busy = false; !busy && thread.IsAlive;)
            {
                try
                {
                    planner.Result();
                }
                catch (PackcellException error)
                {
                    busy = error.Status == Status.Busy;
                }
                Thread.Sleep(1);
            }
            planner.Dispose();
            thread.Join();
            var expected = ended as PackcellException;
            Check(ended is ObjectDisposedException
                  || expected != null && expected.Status == Status.Argument,
                  "disposed of in use: " + ended);
        }
    }

    // Many threads use and dispose of the same handles: exceptions, nothing worse.
    private static void Races()
    {
        int strange = 0;
        for (int round = 0; round < 60; ++round)
        {
            var bin = new Bin(8, 8);
            var threads = new List<Thread>();
            for (int t = 0; t < 3; ++t)
            {
                int id = t;
                threads.Add(new Thread(() =>
                {
                    for (int i = 0; i < 60; ++i)
                    {
                        try
                        {
                            if (id == 2 && i == 30)
                                bin.Dispose();
                            else if (id == 1)
                                bin.Cells();
                            else
                                bin.Clone().Dispose();
                        }
                        catch (PackcellException) { }
                        catch (ObjectDisposedException) { }
                        catch (Exception)
                        {
                            Interlocked.Increment(ref strange);
                        }
                    }
                }));
            }
            threads.ForEach(thread => thread.Start());
            threads.ForEach(thread => thread.Join());
        }
        Check(strange == 0, "races end in exceptions of packcell");
    }

    public static int Main(string[] arguments)
    {
        // Numbers look strange in this user's language; what packcell says does not.
        var culture = (CultureInfo)CultureInfo.InvariantCulture.Clone();
        culture.NumberFormat.NegativeSign = "minus ";
        culture.NumberFormat.NumberDecimalSeparator = ",";
        CultureInfo.DefaultThreadCurrentCulture = culture;
        Thread.CurrentThread.CurrentCulture = culture;
        Check(new Item(-1, 2, 3).ToString() == "-1: 2x3", "an item in words");
        Check(Library.Version >= 100, "version");
        SlicesSnapshotsAndCell(arguments[0]);
        BinAndQueue();
        BadHandles();
        LearnedPolicy();
        Packer();
        CellAndRun(arguments[1]);
        Scara();
        GeneratorAndGrid();
        BusyAndCancel();
        DisposedInUse();
        Races();
        BadInput(arguments[1]);
        for (int i = 0; i < 200; ++i)
            new Bin(5, 5).Info.ToString();  // forgotten: the collector frees them
        GC.Collect();
        GC.WaitForPendingFinalizers();
        Console.WriteLine(failures == 0 ? "all hold" : failures + " failed");
        return failures == 0 ? 0 : 1;
    }
}
