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
        public int KAlpha => raw.k_alpha;
        public int KShared => raw.k_shared;
        public int KBeta => raw.k_beta;
        /// <summary>For SetAlphaLeft of a queue that is rebuilt.</summary>
        public int AlphaLeft => raw.alpha_left;
    }

    /// <summary>The conveyor and one buffer an arm.</summary>
    public sealed class Queue : Handle<Raw.pkc_queue>
    {
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

        public Queue Clone()
        {
            Raw.pkc_queue raw;
            Native.Check(Raw.pkc_queue_clone(Native.Of(this), out raw));
            return new Queue(raw);
        }

        /// <summary>An item arrives at the conveyor's end.</summary>
        public void Push(Item item)
        {
            Raw.pkc_item raw = Item.ToRaw(item);
            Native.Check(Raw.pkc_queue_push(Native.Of(this), ref raw));
        }

        /// <summary>An item leaves without being packed; the conveyor advances.</summary>
        public void Remove(int id)
        {
            Native.Check(Raw.pkc_queue_remove(Native.Of(this), id));
        }

        /// <summary>Several leave at once, all or none.</summary>
        public void Remove(IReadOnlyList<int> ids)
        {
            int[] raw = Native.Map(ids, id => id);
            Native.Check(Raw.pkc_queue_remove_items(Native.Of(this), raw, Native.Count(raw)));
        }

        public void PutInBuffer(Item item, int arm)
        {
            Raw.pkc_item raw = Item.ToRaw(item);
            Native.Check(Raw.pkc_queue_put_in_buffer(Native.Of(this), ref raw, arm));
        }

        public void SetAlphaLeft(int items)
        {
            Native.Check(Raw.pkc_queue_set_alpha_left(Native.Of(this), items));
        }

        public Scenario Scenario
        {
            get
            {
                Raw.pkc_scenario raw = Scenario.New();
                Native.Check(Raw.pkc_queue_get_scenario(Native.Of(this), ref raw));
                return Scenario.From(raw);
            }
        }

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
        public static byte[] Save(Bin bin, Queue queue)
        {
            return Native.Filled((byte[] a, ulong n, out ulong size) =>
                Raw.pkc_snapshot_save(Native.Of(bin), Native.Of(queue), a, n, out size));
        }

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
