// Plans a bin to its end: two arms, 14 items, repacking. Prints the steps and the plan's hash.
using System;
using System.Collections.Generic;
using Packcell;

public static class PlanGolden
{
    private static readonly int[,] Sides = {
        { 2, 1 }, { 4, 3 }, { 2, 2 }, { 4, 4 }, { 2, 4 }, { 3, 4 }, { 3, 2 },
        { 3, 1 }, { 3, 5 }, { 2, 2 }, { 2, 2 }, { 2, 3 }, { 5, 5 }, { 2, 4 }
    };

    public static void Main()
    {
        var options = new PlannerOptions {
            Method = Method.Exact, Rotation = true, Repack = Repack.Full
        };
        var budget = new Budget { Nodes = 20000 };
        using (var bin = new Bin(10, 10))
        using (var queue = new Queue("D-R5A3O1"))
        using (var policy = new Policy("contact"))
        using (var planner = new Planner(options, policy))
        {
            for (int id = 0; id < Sides.GetLength(0); ++id)
                queue.Push(new Item(id, Sides[id, 0], Sides[id, 1]));

            var all = new List<PlanAction>();
            Plan plan;
            do
            {
                plan = planner.Plan(bin, queue, budget);
                Step.Apply(bin, queue, plan.Actions);
                all.AddRange(plan.Actions);
                Console.WriteLine(string.Join("; ", plan.Actions));
            } while (!plan.Info.Terminate);

            Console.WriteLine("{0} items fill {1} cells", bin.Info.Items, bin.Info.OccupiedCells);
            Console.WriteLine("{0:x16}", Step.Hash(all));
        }
    }
}
