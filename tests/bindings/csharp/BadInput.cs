// What callers do wrong by accident: every number, text and list that they pass ends in an answer
// or in an exception with the library's message.
using System;
using System.Collections.Generic;
using System.IO;
using System.Threading;
using Packcell;

public static partial class Test
{
    // Another thread changes it: its length is another one each time.
    private sealed class Changing<T> : IReadOnlyList<T>
    {
        private readonly T element;
        private readonly int[] lengths;
        private int asked;

        public Changing(T element, params int[] lengths)
        {
            this.element = element;
            this.lengths = lengths;
        }

        public int Count => lengths[Math.Min(asked++, lengths.Length - 1)];

        public T this[int index] => element;

        public IEnumerator<T> GetEnumerator()
        {
            throw new NotSupportedException();
        }

        System.Collections.IEnumerator System.Collections.IEnumerable.GetEnumerator()
        {
            throw new NotSupportedException();
        }
    }

    // Nothing is expected but that it returns, or throws a PackcellException with a message.
    private static void Survives(string what, Action call)
    {
        try
        {
            call();
        }
        catch (PackcellException error)
        {
            Check(error.Message != "", what + ": no message");
        }
        catch (Exception error)
        {
            Check(false, what + ": " + error);
        }
    }

    private static void Numbers(string folder)
    {
        Scenario scenario = Scenario.Parse("D-R5A3O1");
        string path = Path.Combine(folder, "numbers");
        using (var bin = new Bin(10, 10))
        using (Queue queue = Golden())
        using (var planner = new Planner())
        using (var policy = new Policy("default"))
        using (var cell = new Cell("ur5e"))
        using (var schedule = new Schedule(cell, scenario, Mode.Coordinated))
        {
            foreach (double x in new[] { double.NaN, double.PositiveInfinity, 1e300 })
            {
                var grid = new Grid { BinW = x };
                Throws(Status.Argument, "must be", "bin in mm", () => grid.BinCells());
                Throws(Status.Argument, "must be", "item in mm", () => new Grid().ItemCells(x, 1));
                Throws(Status.Argument, "must be", "time", () => schedule.Sample(0, x));
                Throws(Status.Argument, "must be", "time aside", () => schedule.PutAside(0, x));
                Throws(Status.Argument, "must be", "period",
                       () => schedule.WriteTrace(Trace.Timeline, path, null, x));
                Throws(Status.Argument, "must be", "milliseconds",
                       () => planner.Plan(bin, queue, new Budget { Milliseconds = x }));
                Throws(Status.Argument, "must be", "sigma",
                       () => new Simulation(schedule, new SimulationOptions { Sigma = x }));
                Throws(Status.Argument, "must be", "range", () =>
                       cell.OptimizeLayout(scenario, new LayoutOptions { Range = x }, out _));
                var sides = new GeneratorOptions { Kind = GeneratorKind.Full, Mean = x };
                Throws(Status.Argument, "must be", "mean", () => new Generator(sides));
                Survives("pose", () => cell.Inverse(0, new[] { x, 0, 0, 0 }));
                Survives("joints", () => cell.Forward(0, new[] { x, 0, 0, 0, 0, 0 }));
            }
            foreach (int n in new[] { int.MinValue, -1, 129, int.MaxValue })
            {
                var item = new Item(n, n, n, (ItemFlags)n);
                var action = new PlanAction {
                    Op = (Op)n, Item = n, X = n, Y = n, Rot = n, Arm = n
                };
                Throws(Status.Argument, "must be", "bin", () => new Bin(n, n));
                Throws(Status.Argument, "must be", "scenario", () => new Scenario(n, n, n, n)
                       .ToString());
                Throws(Status.Argument, "must be", "block", () => bin.Block(n, n, n, n));
                Throws(Status.Argument, "must be", "pack", () => bin.Pack(item, n, n, n));
                Throws(Status.Argument, "must be", "mask", () => bin.Feasible(n, n));
                Throws(Status.Argument, "must be", "contact", () => bin.Contact(n, n, n, n));
                Survives("unpack", () => bin.Unpack(n));
                Throws(Status.Argument, "must be", "push", () => queue.Push(item));
                Throws(Status.Argument, "must be", "alpha", () => queue.SetAlphaLeft(n));
                Throws(Status.Argument, "must be", "buffer",
                       () => queue.PutInBuffer(new Item(90, 1, 1), n));
                Throws(Status.Argument, "must be", "select", () => policy.Select(bin, n, n));
                Throws(Status.Argument, "must be", "evaluate", () => policy.Evaluate(bin, n, n));
                Throws(Status.Argument, "must be", "batch",
                       () => policy.SelectBatch(new[] { bin }, new[] { n, n }));
                Throws(Status.Argument, "must be", "protocol",
                       () => policy.Measure(new Protocol { LeastSide = n }, 1, 1));
                Throws(Status.State, "actions[0]", "action",
                       () => Step.Apply(bin, queue, new[] { action }));
                Throws(Status.Argument, "must be", "exact packer",
                       () => ExactPacker.Pack(bin, new[] { item }));
                Throws(Status.Argument, "must be", "mode",
                       () => new Schedule(cell, scenario, (Mode)n));
                Throws(Status.Argument, "must be", "arm", () => schedule.Sample(n, 0));
                Throws(Status.Argument, "must be", "trace",
                       () => schedule.WriteTrace((Trace)n, path));
                Throws(Status.Argument, "must be", "method",
                       () => new Planner(new PlannerOptions { Method = (Method)n }));
                Throws(Status.Argument, "must be", "centre", () => new Grid().Centre(n, n, n, n));
                Throws(Status.Argument, "must be", "generator",
                       () => new Generator(new GeneratorOptions { W = n }));
            }
            Throws(Status.Argument, "must be", "no nodes", () => planner.Step(0));
            Survives("all nodes", () => planner.Plan(bin, queue, new Budget { Nodes = 1 }));
        }
    }

    // C is never told another length than that of the array it gets.
    private static void ChangingLists()
    {
        using (var bin = new Bin(4, 4))
        using (var policy = new Policy("contact"))
        {
            var bins = new Changing<Bin>(bin, 1, 1000000);
            Check(policy.SelectBatch(bins, new[] { 1, 1 }).Length == 1, "bins that grow");
            var fewer = new Changing<Bin>(bin, 1, 0);
            Check(policy.SelectBatch(fewer, new[] { 1, 1 }).Length == 1, "bins that shrink");
            var items = new Changing<Item>(new Item(0, 2, 2), 1, 1000000);
            Check(ExactPacker.Pack(bin, items).Placements.Length == 1, "items that grow");
            var one = new[] { new PlanAction { Op = Op.Terminate } };
            Check(Step.Hash(new Changing<PlanAction>(one[0], 1, 1000000)) == Step.Hash(one),
                  "actions that grow");
        }
    }

    private static void Texts(string folder)
    {
        string named = Path.Combine(folder, "größe-日本-\U0001d11e");
        using (var policy = new Policy("default"))
        using (var cell = new Cell("scara"))
        {
            policy.SaveFile(named);
            Check(File.Exists(named), "a path beyond ASCII");
            using (Policy same = Policy.LoadFile(named))
                Check(same.Save().Length == new FileInfo(named).Length, "policy from a file");
            cell.SaveFile(named);
            using (Cell same = Cell.LoadFile(named))
                Check(same.Info.Name == cell.Info.Name, "cell from a file");
            Throws(Status.IO, "/nö/\U0001d11e", "message beyond ASCII",
                   () => Policy.LoadFile("/nö/\U0001d11e"));
            string half = Path.Combine(folder, "\ud800");
            int files = Directory.GetFiles(folder).Length;
            Throws(Status.Argument, "surrogate", "path with half a character",
                   () => policy.SaveFile(half));
            Throws(Status.Argument, "surrogate", "cell with half a character",
                   () => Cell.Load("\"\udc00\""));
            Throws(Status.Argument, "zero", "path with a zero", () => cell.SaveFile(named + "\0"));
            Check(Directory.GetFiles(folder).Length == files, "nothing is written");
            Throws(Status.Argument, "path", "no path", () => cell.SaveFile(null));
            Throws(Status.IO, "", "a folder", () => Policy.LoadFile(folder));
            Throws(Status.Argument, "", "a long name", () => new Policy(new string('x', 100000)));
        }
    }

    // The text of an error is one a thread: each gets its own, whatever the collector frees.
    private static void MessagesOfThreads()
    {
        int strange = 0;
        var threads = new List<Thread>();
        for (int t = 0; t < 4; ++t)
        {
            int width = 1000 + t;
            threads.Add(new Thread(() =>
            {
                for (int i = 0; i < 500; ++i)
                {
                    new Bin(3, 3).Clear();  // forgotten
                    try
                    {
                        new Bin(width, 1);
                    }
                    catch (PackcellException error)
                    {
                        if (!error.Message.Contains("width " + width + ":"))
                            Interlocked.Increment(ref strange);
                    }
                    if (i % 100 == 0)
                        GC.Collect();
                }
            }));
        }
        threads.ForEach(thread => thread.Start());
        threads.ForEach(thread => thread.Join());
        Check(strange == 0, "each thread has its own message");
    }

    // A policy's name is its own memory: it is not read after another thread has freed that.
    private static void NamesInUse()
    {
        int strange = 0;
        for (int round = 0; round < 100; ++round)
        {
            var policy = new Policy("contact");
            var thread = new Thread(() =>
            {
                for (int i = 0; i < 20; ++i)
                {
                    try
                    {
                        string name = policy.Name;
                        if (name != "contact" && name != "")
                            Interlocked.Increment(ref strange);
                    }
                    catch (ObjectDisposedException) { }
                }
            });
            thread.Start();
            policy.Dispose();
            thread.Join();
        }
        Check(strange == 0, "names of policies that are disposed of");
    }

    // A policy and a cell may be shared: no thread finds them busy.
    private static void SharedPolicyAndCell()
    {
        int strange = 0;
        using (var policy = new Policy("default"))
        using (var cell = new Cell("ur5e"))
        {
            var threads = new List<Thread>();
            for (int t = 0; t < 3; ++t)
            {
                threads.Add(new Thread(() =>
                {
                    try
                    {
                        using (var bin = new Bin(10, 10))
                        {
                            for (int i = 0; i < 100; ++i)
                            {
                                policy.Select(bin, 1 + i % 5, 2);
                                cell.Forward(i % 2, new double[6]);
                            }
                        }
                    }
                    catch (Exception)
                    {
                        Interlocked.Increment(ref strange);
                    }
                }));
            }
            threads.ForEach(thread => thread.Start());
            threads.ForEach(thread => thread.Join());
        }
        Check(strange == 0, "a policy and a cell that threads share");
    }

    private static void BadInput(string folder)
    {
        Numbers(folder);
        ChangingLists();
        Texts(folder);
        MessagesOfThreads();
        NamesInUse();
        SharedPolicyAndCell();
    }
}
