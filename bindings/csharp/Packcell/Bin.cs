// A bin of cells and what lies in it.
namespace Packcell
{
    /// <summary>What is in a bin, in cells.</summary>
    public sealed class BinInfo
    {
        internal Raw.pkc_bin_info raw;

        internal BinInfo()
        {
            Native.Check(Raw.pkc_bin_info_init(ref raw, Native.Size<Raw.pkc_bin_info>()));
        }

        public int W => raw.w;
        public int H => raw.h;
        /// <summary>Items packed.</summary>
        public int Items => raw.items;
        /// <summary>Fixed cells and items.</summary>
        public int OccupiedCells => raw.occupied_cells;
        /// <summary>Those taken by Block.</summary>
        public int FixedCells => raw.fixed_cells;
        /// <summary>Of the occupied cells.</summary>
        public ulong Hash => raw.hash;
    }

    /// <summary>A bin of cells, x to the right, y down from the top-left corner.</summary>
    public sealed class Bin : Handle<Raw.pkc_bin>
    {
        /// <summary>In Cells: no item is there.</summary>
        public const int FreeCell = Raw.PKC_CELL_FREE;
        /// <summary>In Cells: taken by Block.</summary>
        public const int FixedCell = Raw.PKC_CELL_FIXED;

        /// <summary>An empty bin of w x h cells, each 1..128.</summary>
        public Bin(int w, int h) : base(Create(w, h)) { }

        internal Bin(Raw.pkc_bin raw) : base(raw) { }

        private static Raw.pkc_bin Create(int w, int h)
        {
            Raw.pkc_bin raw;
            Native.Check(Raw.pkc_bin_create(w, h, out raw));
            return raw;
        }

        /// <summary>A bin of its own with the same items and fixed cells.</summary>
        public Bin Clone()
        {
            Raw.pkc_bin raw;
            Native.Check(Raw.pkc_bin_clone(Native.Of(this), out raw));
            return new Bin(raw);
        }

        /// <summary>Removes every item; fixed cells stay.</summary>
        public void Clear()
        {
            Native.Check(Raw.pkc_bin_clear(Native.Of(this)));
        }

        /// <summary>Marks free cells as taken from the start. Status.State if one of the w x h at
        /// (x, y) is taken.</summary>
        public void Block(int x, int y, int w, int h)
        {
            Native.Check(Raw.pkc_bin_block(Native.Of(this), x, y, w, h));
        }

        /// <summary>Puts an item, turned by a quarter if rot is 1, with its top-left corner at (x,
        /// y). Status.State if it does not lie on free cells alone, its id is in the bin already,
        /// or it must not be turned.</summary>
        public void Pack(Item item, int x, int y, int rot = 0)
        {
            Raw.pkc_item raw = Item.ToRaw(item);
            Native.Check(Raw.pkc_bin_pack(Native.Of(this), ref raw, x, y, rot));
        }

        /// <summary>Takes an item out, and says where it was. Status.State if it is not there or is
        /// pinned.</summary>
        public Placement Unpack(int id)
        {
            var raw = new Raw.pkc_placement();
            Native.Check(Raw.pkc_bin_unpack(Native.Of(this), id, ref raw));
            return Placement.From(raw);
        }

        /// <summary>What is in the bin now.</summary>
        public BinInfo Info
        {
            get
            {
                var info = new BinInfo();
                Native.Check(Raw.pkc_bin_get_info(Native.Of(this), ref info.raw));
                return info;
            }
        }

        /// <summary>In packing order.</summary>
        public Placement[] Items()
        {
            return Native.Map(Native.Filled((Raw.pkc_placement[] a, ulong n, out ulong count) =>
                Raw.pkc_bin_items(Native.Of(this), a, n, out count)), Placement.From);
        }

        /// <summary>By index x + y * W: the id of the item there, FreeCell or FixedCell.</summary>
        public int[] Cells()
        {
            return Native.Filled((int[] a, ulong n, out ulong count) =>
                Raw.pkc_bin_cells(Native.Of(this), a, n, out count));
        }

        /// <summary>W*H + 1 answers: may the corner of an item that covers w x h cells lie there?
        /// The last is "no position", true only when no other is.</summary>
        public bool[] Feasible(int w, int h)
        {
            return Native.Map(Native.Filled((byte[] a, ulong n, out ulong count) =>
                Raw.pkc_bin_feasible(Native.Of(this), w, h, a, n, out count)), b => b != 0);
        }

        /// <summary>The contact reward: occupied cells, walls included, around a w x h rectangle at
        /// (x, y), 0..2(w+h). Status.State if the rectangle is not free.</summary>
        public int Contact(int x, int y, int w, int h)
        {
            int reward;
            Native.Check(Raw.pkc_bin_contact(Native.Of(this), x, y, w, h, out reward));
            return reward;
        }
    }
}
