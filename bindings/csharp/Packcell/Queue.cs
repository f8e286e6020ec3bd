// Who sees and reaches what, the conveyor with the arms' buffers, and snapshots.
using System.Collections.Generic;
using System.Text;

namespace Packcell
{
    /// <summary>Robots, and the items they recognise, reach, and both reach.</summary>
    public struct Scenario
    {
        public int Robots, Recognized, Accessible, Overlap;

        public Scenario(int robots, int recognized, int accessible, int overlap = 0)
        {
            Robots = robots;
            Recognized = recognized;
            Accessible = accessible;
            Overlap = overlap;
        }

        /// <summary>"S-R5A3" or "D-R5A3O1".</summary>
        public static Scenario Parse(string name)
        {
            Raw.pkc_scenario raw = New();
            Native.Check(Raw.pkc_scenario_parse(Native.Text(name), ref raw));
            return From(raw);
        }

        /// <summary>"S-R5A3" or "D-R5A3O1".</summary>
        public string Name
        {
            get
            {
                Raw.pkc_scenario raw = ToRaw();
                byte[] name = new byte[32];
                Native.Check(Raw.pkc_scenario_name(ref raw, name, (ulong)name.Length));
                int length = System.Array.IndexOf(name, (byte)0);
                return Encoding.ASCII.GetString(name, 0, length);
            }
        }

        public override string ToString() => Name;

        internal static Raw.pkc_scenario New()
        {
            var raw = new Raw.pkc_scenario();
            Native.Check(Raw.pkc_scenario_init(ref raw, Native.Size<Raw.pkc_scenario>()));
            return raw;
        }

        internal static Scenario From(Raw.pkc_scenario raw)
            => new Scenario(raw.robots, raw.recognized, raw.accessible, raw.overlap);

        internal Raw.pkc_scenario ToRaw()
        {
            Raw.pkc_scenario raw = New();
            raw.robots = Robots;
            raw.recognized = Recognized;
            raw.accessible = Accessible;
            raw.overlap = Overlap;
            return raw;
        }
    }

    /// <summary>How many items are where.</summary>
    public sealed class QueueInfo
    {
        internal Raw.pkc_queue_info raw;

        internal QueueInfo()
        {
            Native.Check(Raw.pkc_queue_info_init(ref raw, Native.Size<Raw.pkc_queue_info>()));
        }

        /// <summary>Items on the conveyor.</summary>
        public int Belt => raw.belt;
        /// <summary>Items in the arms' buffers.</summary>
        public int Buffered => raw.buffered;
        /// <summary>Items that only arm 0 reaches.</summary>
        public int KAlpha => raw.k_alpha;
        /// <summary>Items that both arms reach, or the one there is.</summary>
        public int KShared => raw.k_shared;
        /// <summary>Items that only arm 1 reaches.</summary>
        public int KBeta => raw.k_beta;
        /// <summary>Items that stayed in arm 0's region when the conveyor last moved, for
        /// SetAlphaLeft.</summary>
        public int AlphaLeft => raw.alpha_left;
    }

    /// <summary>The conveyor and one buffer an arm.</summary>
    public sealed class Queue : Handle<Raw.pkc_queue>
    {
        /// <summary>An empty one.</summary>
        public Queue(Scenario scenario) : base(Create(scenario)) { }

        /// <summary>By the scenario's name.</summary>
        public Queue(string scenario) : this(Scenario.Parse(scenario)) { }

        internal Queue(Raw.pkc_queue raw) : base(raw) { }

        private static Raw.pkc_queue Create(Scenario scenario)
        {
            Raw.pkc_scenario of = scenario.ToRaw();
            Raw.pkc_queue raw;
            Native.Check(Raw.pkc_queue_create(ref of, out raw));
            return raw;
        }

        /// <summary>A queue of its own with the same items.</summary>
        public Queue Clone()
        {
            Raw.pkc_queue raw;
            Native.Check(Raw.pkc_queue_clone(Native.Of(this), out raw));
            return new Queue(raw);
        }

        /// <summary>An item arrives at the conveyor's end. Status.State if the queue holds its id
        /// already.</summary>
        public void Push(Item item)
        {
            Raw.pkc_item raw = Item.ToRaw(item);
            Native.Check(Raw.pkc_queue_push(Native.Of(this), ref raw));
        }

        /// <summary>An item leaves without being packed; the conveyor advances. Status.State if it
        /// is not there.</summary>
        public void Remove(int id)
        {
            Native.Check(Raw.pkc_queue_remove(Native.Of(this), id));
        }

        /// <summary>Several leave at once, all or none, and the conveyor advances as after a
        /// step.</summary>
        public void RemoveItems(IReadOnlyList<int> ids)
        {
            int[] raw = Native.Map(ids, id => id);
            Native.Check(Raw.pkc_queue_remove_items(Native.Of(this), raw, Native.Count(raw)));
        }

        /// <summary>An item comes into an arm's buffer, 0 or 1, from without: a queue rebuilt from
        /// a message, or an item unpacked outside a planned step. Status.State if the queue holds
        /// its id already.</summary>
        public void PutInBuffer(Item item, int arm)
        {
            Raw.pkc_item raw = Item.ToRaw(item);
            Native.Check(Raw.pkc_queue_put_in_buffer(Native.Of(this), ref raw, arm));
        }

        /// <summary>Arranges the regions as if so many items, 0..64, had stayed in arm 0's: for a
        /// queue rebuilt from a message, with the AlphaLeft of its info.</summary>
        public void SetAlphaLeft(int items)
        {
            Native.Check(Raw.pkc_queue_set_alpha_left(Native.Of(this), items));
        }

        /// <summary>The one that it was made for.</summary>
        public Scenario Scenario
        {
            get
            {
                Raw.pkc_scenario raw = Scenario.New();
                Native.Check(Raw.pkc_queue_get_scenario(Native.Of(this), ref raw));
                return Scenario.From(raw);
            }
        }

        /// <summary>How many items are where now.</summary>
        public QueueInfo Info
        {
            get
            {
                var info = new QueueInfo();
                Native.Check(Raw.pkc_queue_get_info(Native.Of(this), ref info.raw));
                return info;
            }
        }

        /// <summary>The conveyor's items in arrival order.</summary>
        public Queued[] Belt()
        {
            return Native.Map(Native.Filled((Raw.pkc_queued[] a, ulong n, out ulong count) =>
                Raw.pkc_queue_belt(Native.Of(this), a, n, out count)), Queued.From);
        }

        /// <summary>The buffered ones in the order they were unpacked.</summary>
        public Queued[] Buffer()
        {
            return Native.Map(Native.Filled((Raw.pkc_queued[] a, ulong n, out ulong count) =>
                Raw.pkc_queue_buffer(Native.Of(this), a, n, out count)), Queued.From);
        }
    }

    /// <summary>Bin and queue as bytes that are the same on every machine.</summary>
    public static class Snapshot
    {
        /// <summary>Neither is changed.</summary>
        public static byte[] Save(Bin bin, Queue queue)
        {
            return Native.Filled((byte[] a, ulong n, out ulong size) =>
                Raw.pkc_snapshot_save(Native.Of(bin), Native.Of(queue), a, n, out size));
        }

        /// <summary>A new bin and a new queue. Status.Format names the first offset that is
        /// wrong.</summary>
        public static void Load(byte[] bytes, out Bin bin, out Queue queue)
        {
            Raw.pkc_bin rawBin;
            Raw.pkc_queue rawQueue;
            Native.Check(Raw.pkc_snapshot_load(bytes, Native.Count(bytes), out rawBin,
                                               out rawQueue));
            bin = new Bin(rawBin);
            queue = new Queue(rawQueue);
        }
    }
}
