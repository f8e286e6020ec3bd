// Plain records and the numbers that the library counts things by. Lengths are in cells.
using System;
using System.Collections.Generic;

namespace Packcell
{
    /// <summary>What must not be done to an item.</summary>
    [Flags]
    public enum ItemFlags : uint
    {
        None = 0,
        /// <summary>May only be packed with rot 0.</summary>
        NoRotate = Raw.PKC_ITEM_NO_ROTATE,
        /// <summary>Is never unpacked.</summary>
        Pinned = Raw.PKC_ITEM_PINNED
    }

    /// <summary>An item: its id, >= 0, is the caller's and unique in bin and queue.</summary>
    public struct Item
    {
        public int Id, W, H;
        public ItemFlags Flags;

        public Item(int id, int w, int h, ItemFlags flags = ItemFlags.None)
        {
            Id = id;
            W = w;
            H = h;
            Flags = flags;
        }

        public override string ToString() => FormattableString.Invariant($"{Id}: {W}x{H}");

        internal static Raw.pkc_item ToRaw(Item item) => new Raw.pkc_item {
            id = item.Id, w = item.W, h = item.H, flags = (uint)item.Flags
        };

        internal static Item From(Raw.pkc_item raw)
            => new Item(raw.id, raw.w, raw.h, (ItemFlags)raw.flags);
    }

    /// <summary>An item in a bin, its top-left corner at (X, Y).</summary>
    public struct Placement
    {
        public Item Item;
        public int X, Y, Rot;

        internal static Placement From(Raw.pkc_placement raw) => new Placement {
            Item = Item.From(raw.item), X = raw.x, Y = raw.y, Rot = raw.rot
        };
    }

    /// <summary>An item on the conveyor or in a buffer.</summary>
    public struct Queued
    {
        public Item Item;
        /// <summary>Bit 0 and bit 1: which arms can take it now.</summary>
        public int Arms;
        /// <summary>The planner sees its size.</summary>
        public bool Recognized;

        internal static Queued From(Raw.pkc_queued raw) => new Queued {
            Item = Item.From(raw.item), Arms = raw.arms, Recognized = raw.recognized != 0
        };
    }

    /// <summary>What an action does, and the fields that it uses.</summary>
    public enum Op
    {
        /// <summary>Item, Arm: from the bin into the arm's buffer.</summary>
        Unpack = Raw.PKC_OP_UNPACK,
        /// <summary>All: off the conveyor or the arm's buffer into the bin.</summary>
        Pack = Raw.PKC_OP_PACK,
        /// <summary>Item: taken off the conveyor for good.</summary>
        Skip = Raw.PKC_OP_SKIP,
        /// <summary>None: the bin is closed.</summary>
        Terminate = Raw.PKC_OP_TERMINATE
    }

    /// <summary>A task primitive. Fields that its Op does not use are 0.</summary>
    public struct PlanAction
    {
        public Op Op;
        public int Item, X, Y, Rot, Arm;

        public override string ToString()
        {
            switch (Op)
            {
                case Op.Pack:
                    return FormattableString.Invariant(
                        $"PACK {Item} at {X},{Y} rot {Rot} arm {Arm}");
                case Op.Unpack: return FormattableString.Invariant($"UNPACK {Item} arm {Arm}");
                case Op.Skip: return FormattableString.Invariant($"SKIP {Item}");
                case Op.Terminate: return "TERMINATE";
                default: return FormattableString.Invariant($"op {(int)Op}");
            }
        }

        internal static Raw.pkc_action ToRaw(PlanAction a) => new Raw.pkc_action {
            op = (int)a.Op, item = a.Item, x = a.X, y = a.Y, rot = a.Rot, arm = a.Arm
        };

        internal static PlanAction From(Raw.pkc_action raw) => new PlanAction {
            Op = (Op)raw.op, Item = raw.item, X = raw.x, Y = raw.y, Rot = raw.rot, Arm = raw.arm
        };
    }

    /// <summary>What is done with, or asked of, a list of actions.</summary>
    public static class Step
    {
        /// <summary>The hash that is equal for equal plans on every machine.</summary>
        public static ulong Hash(IReadOnlyList<PlanAction> actions)
        {
            Raw.pkc_action[] raw = Native.Map(actions, PlanAction.ToRaw);
            ulong hash;
            Native.Check(Raw.pkc_plan_hash(raw, Native.Count(raw), out hash));
            return hash;
        }

        /// <summary>Carries out one step's actions on bin and queue, all or nothing.</summary>
        public static void Apply(Bin bin, Queue queue, IReadOnlyList<PlanAction> actions)
        {
            Raw.pkc_action[] raw = Native.Map(actions, PlanAction.ToRaw);
            Native.Check(Raw.pkc_step_apply(Native.Of(bin), Native.Of(queue), raw,
                                            Native.Count(raw)));
        }

        /// <summary>The actions with each pack from the belt given to the nearest arm that reaches
        /// it; the queue is the one before the step.</summary>
        public static PlanAction[] Allocate(Cell cell, Queue queue,
                                            IReadOnlyList<PlanAction> actions)
        {
            Raw.pkc_action[] raw = Native.Map(actions, PlanAction.ToRaw);
            Native.Check(Raw.pkc_allocate(Native.Of(cell), Native.Of(queue), raw,
                                          Native.Count(raw)));
            return Native.Map(raw, PlanAction.From);
        }
    }
}
