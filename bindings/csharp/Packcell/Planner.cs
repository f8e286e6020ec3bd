// Plans the next step; packs exactly; bounds what can be packed.
using System.Collections.Generic;

namespace Packcell
{
    /// <summary>How a step is planned.</summary>
    public enum Method
    {
        /// <summary>Algorithms 1-3 of the paper as written.</summary>
        Paper = Raw.PKC_METHOD_PAPER,
        /// <summary>The same tree, equal states once; repacking by an exact packer.</summary>
        Exact = Raw.PKC_METHOD_EXACT
    }

    /// <summary>Whether packed items may be moved.</summary>
    public enum Repack
    {
        Off = Raw.PKC_REPACK_OFF,
        /// <summary>Raises the utilisation as far as the budget allows.</summary>
        Anytime = Raw.PKC_REPACK_ANYTIME,
        /// <summary>Only for a plan that places every known item or fills the bin.</summary>
        Full = Raw.PKC_REPACK_FULL
    }

    /// <summary>What a plan is known to be.</summary>
    public enum Proof
    {
        /// <summary>Nothing was to be proved: no repacking was needed or allowed.</summary>
        None = Raw.PKC_PROOF_NONE,
        /// <summary>No plan over the known items does better in this mode.</summary>
        Optimal = Raw.PKC_PROOF_OPTIMAL,
        /// <summary>Repack.Full: the known items cannot all be placed, nor the bin filled.
        /// </summary>
        Impossible = Raw.PKC_PROOF_IMPOSSIBLE,
        /// <summary>The budget ended first, or what is looked at was too little to decide.
        /// </summary>
        Budget = Raw.PKC_PROOF_BUDGET
    }

    /// <summary>A new one has the library's defaults.</summary>
    public sealed class PlannerOptions
    {
        /// <summary>Two candidates in Method.Paper with repacking, else all.</summary>
        public const int SelectAuto = Raw.PKC_SELECT_AUTO;
        /// <summary>No pruning.</summary>
        public const int SelectAll = Raw.PKC_SELECT_ALL;
        public const int Unlimited = Raw.PKC_UNLIMITED;

        internal Raw.pkc_planner_options raw;

        public PlannerOptions()
        {
            Native.Check(Raw.pkc_planner_options_init(ref raw,
                                                      Native.Size<Raw.pkc_planner_options>()));
        }

        public Method Method { get => (Method)raw.method; set => raw.method = (int)value; }
        /// <summary>Items may be turned.</summary>
        public bool Rotation { get => raw.rotation != 0; set => raw.rotation = value ? 1 : 0; }
        public Repack Repack { get => (Repack)raw.repack; set => raw.repack = (int)value; }
        /// <summary>SelectAuto, SelectAll, or candidates kept a node, 1..128.</summary>
        public int Select { get => raw.select; set => raw.select = value; }
        /// <summary>Items that an arm's buffer holds at any moment of a step, 0..4096, or
        /// Unlimited.</summary>
        public int BufferCapacity
        {
            get => raw.buffer_capacity;
            set => raw.buffer_capacity = value;
        }
        /// <summary>An accessible item that cannot be placed is skipped for good.</summary>
        public bool Skip { get => raw.skip != 0; set => raw.skip = value ? 1 : 0; }
        /// <summary>Largest bin side planned for, 1..128 (128).</summary>
        public int MaxSide { get => raw.max_side; set => raw.max_side = value; }
        /// <summary>Most items in the bin at once, 1..16384 (256).</summary>
        public int MaxItems { get => raw.max_items; set => raw.max_items = value; }
        /// <summary>Most recognised and buffered items together, 1..128 (128).</summary>
        public int MaxKnown { get => raw.max_known; set => raw.max_known = value; }
        /// <summary>Bytes for tables, 64 KiB..4 GiB.</summary>
        public ulong Memory { get => raw.memory; set => raw.memory = value; }
    }

    /// <summary>How much a plan may cost; a new one is 200000 nodes, no time limit. In nodes alone
    /// it gives the same plan on every machine.</summary>
    public sealed class Budget
    {
        internal Raw.pkc_budget raw;

        public Budget()
        {
            Native.Check(Raw.pkc_budget_init(ref raw, Native.Size<Raw.pkc_budget>()));
        }

        /// <summary>Placements tried; 0: no limit.</summary>
        public ulong Nodes { get => raw.nodes; set => raw.nodes = value; }
        /// <summary>Wall time, 0..1e12; 0: no limit.</summary>
        public double Milliseconds { get => raw.milliseconds; set => raw.milliseconds = value; }

        // A copy: the caller may change the object while a call runs.
        internal static Raw.pkc_budget Of(Budget budget) => (budget ?? new Budget()).raw;
    }

    /// <summary>What is known about a plan.</summary>
    public sealed class PlanInfo
    {
        internal Raw.pkc_plan_info raw;

        internal PlanInfo()
        {
            Native.Check(Raw.pkc_plan_info_init(ref raw, Native.Size<Raw.pkc_plan_info>()));
        }

        /// <summary>Of this step; packs and unpacks are among them.</summary>
        public int Actions => raw.actions;
        public int Packs => raw.packs;
        public int Unpacks => raw.unpacks;
        /// <summary>The plan came from repacking.</summary>
        public bool Repacked => raw.repacked != 0;
        /// <summary>The bin is closed by this step.</summary>
        public bool Terminate => raw.terminate != 0;
        public Proof Proof => (Proof)raw.proof;
        /// <summary>Planner.Cancel ended the search.</summary>
        public bool Cancelled => raw.cancelled != 0;
        /// <summary>Of the bin once all that was planned ahead is packed, 0..1.</summary>
        public double Utilization => raw.utilization;
        /// <summary>Contact rewards summed over the forward simulation; 0 after repacking.
        /// </summary>
        public long Score => raw.score;
        /// <summary>Placements tried, and other work of that size.</summary>
        public ulong Nodes => raw.nodes;
        /// <summary>Of them in the first tree search, the rest in repacking.</summary>
        public ulong TreeNodes => raw.tree_nodes;
        /// <summary>Step.Hash of the actions.</summary>
        public ulong Hash => raw.hash;
        /// <summary>Of the thread's CPU.</summary>
        public double Milliseconds => raw.milliseconds;
        /// <summary>Of them in repacking.</summary>
        public double RepackMilliseconds => raw.repack_milliseconds;
    }

    /// <summary>One step: what is done, and what is known about it.</summary>
    public sealed class Plan
    {
        internal Plan(PlanInfo info, PlanAction[] actions)
        {
            Info = info;
            Actions = actions;
        }

        public PlanInfo Info { get; }
        public PlanAction[] Actions { get; }
    }

    /// <summary>Plans the next step.</summary>
    public sealed class Planner : Handle<Raw.pkc_planner>
    {
        /// <summary>Without options, the defaults; without a policy, the default one.</summary>
        public Planner(PlannerOptions options = null, Policy policy = null)
            : base(Create(options, policy)) { }

        private static Raw.pkc_planner Create(PlannerOptions options, Policy policy)
        {
            Raw.pkc_planner_options of = (options ?? new PlannerOptions()).raw;
            Raw.pkc_planner raw;
            Native.Check(Raw.pkc_planner_create(ref of, Native.OrNone(policy, "policy"), out raw));
            return raw;
        }

        /// <summary>Plans the next step for what bin and queue hold; changes neither. Always legal
        /// for Step.Apply. With nothing on the conveyor and in the buffers that is
        /// Op.Terminate.</summary>
        public Plan Plan(Bin bin, Queue queue, Budget budget = null)
        {
            Raw.pkc_budget of = Budget.Of(budget);
            var info = new PlanInfo();
            Native.Check(Raw.pkc_planner_plan(Native.Of(this), Native.Of(bin), Native.Of(queue),
                                              ref of, ref info.raw));
            return Result();
        }

        /// <summary>The same work in slices: the state is copied, Step does the work.</summary>
        public void Begin(Bin bin, Queue queue, Budget budget = null)
        {
            Raw.pkc_budget of = Budget.Of(budget);
            Native.Check(Raw.pkc_planner_begin(Native.Of(this), Native.Of(bin), Native.Of(queue),
                                               ref of));
        }

        /// <summary>Spends up to so many nodes, at least 1; true when nothing is left to do.
        /// </summary>
        public bool Step(ulong nodes)
        {
            int done;
            Native.Check(Raw.pkc_planner_step(Native.Of(this), nodes, out done));
            return done != 0;
        }

        /// <summary>The plan, or before it is done the best so far. Status.State if nothing was
        /// begun.</summary>
        public Plan Result()
        {
            var info = new PlanInfo();
            Raw.pkc_action[] actions = Native.Filled(
                (Raw.pkc_action[] a, ulong n, out ulong count) =>
                    Raw.pkc_planner_result(Native.Of(this), ref info.raw, a, n, out count));
            return new Plan(info, Native.Map(actions, PlanAction.From));
        }

        /// <summary>From any thread: the plan being made ends at once with the best so far.
        /// </summary>
        public void Cancel()
        {
            Native.Check(Raw.pkc_planner_cancel(Native.Of(this)));
        }
    }

    /// <summary>What is known.</summary>
    public enum PackingAnswer
    {
        /// <summary>All items fit, or the count is exact.</summary>
        Found = Raw.PKC_PACKING_FOUND,
        /// <summary>They do not all fit.</summary>
        Impossible = Raw.PKC_PACKING_IMPOSSIBLE,
        /// <summary>Not decided within the budget.</summary>
        Budget = Raw.PKC_PACKING_BUDGET
    }

    /// <summary>How items fit, if they do.</summary>
    public sealed class Packing
    {
        internal Packing(PackingAnswer answer, ulong nodes, Placement[] placements)
        {
            Answer = answer;
            Nodes = nodes;
            Placements = placements;
        }

        public PackingAnswer Answer { get; }
        public ulong Nodes { get; }
        /// <summary>In the items' order if Found, else none.</summary>
        public Placement[] Placements { get; }
    }

    /// <summary>How many fit.</summary>
    public struct Bound
    {
        public int Count;
        /// <summary>With Budget the count is an upper bound only.</summary>
        public PackingAnswer Answer;
    }

    /// <summary>Packs exactly; bounds what can be packed.</summary>
    public static class ExactPacker
    {
        /// <summary>Can all items, 16384 at most, be placed on the bin's free cells without moving
        /// what is there?</summary>
        public static Packing Pack(Bin bin, IReadOnlyList<Item> items, bool rotation = true,
                                   Budget budget = null)
        {
            Raw.pkc_budget of = Budget.Of(budget);
            Raw.pkc_item[] raw = Native.Map(items, Item.ToRaw);
            var placements = new Raw.pkc_placement[Native.Count(raw)];
            int answer;
            ulong nodes;
            Native.Check(Raw.pkc_exact_pack(Native.Of(bin), raw, Native.Count(raw),
                                            rotation ? 1 : 0, ref of, placements, out answer,
                                            out nodes));
            if (answer != Raw.PKC_PACKING_FOUND)
                placements = new Raw.pkc_placement[0];
            return new Packing((PackingAnswer)answer, nodes,
                               Native.Map(placements, Placement.From));
        }

        /// <summary>How many of the next items, in order and without one left out, fit: no planner
        /// without a buffer packs more of them into this bin.</summary>
        public static Bound BoundInOrder(Bin bin, IReadOnlyList<Item> items, bool rotation = true,
                                         Budget budget = null)
        {
            Raw.pkc_budget of = Budget.Of(budget);
            Raw.pkc_item[] raw = Native.Map(items, Item.ToRaw);
            ulong count;
            int answer;
            Native.Check(Raw.pkc_bound_in_order(Native.Of(bin), raw, Native.Count(raw),
                                                rotation ? 1 : 0, ref of, out count, out answer));
            return new Bound { Count = (int)count, Answer = (PackingAnswer)answer };
        }
    }
}
