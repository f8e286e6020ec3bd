// The low level: where an item goes.
using System;
using System.Collections.Generic;

namespace Packcell
{
    public enum Architecture
    {
        Heuristic = Raw.PKC_ARCH_HEURISTIC,
        ActorCritic = Raw.PKC_ARCH_ACTOR_CRITIC,
        FullyConvolutional = Raw.PKC_ARCH_FULLY_CONVOLUTIONAL,
        Afterstate = Raw.PKC_ARCH_AFTERSTATE
    }

    public sealed class PolicyInfo
    {
        internal Raw.pkc_policy_info raw;

        internal PolicyInfo()
        {
            Native.Check(Raw.pkc_policy_info_init(ref raw, Native.Size<Raw.pkc_policy_info>()));
        }

        public Architecture Architecture => (Architecture)raw.architecture;
        /// <summary>Sides of the bins that it serves; 0: any.</summary>
        public int BinW => raw.bin_w;
        public int BinH => raw.bin_h;
        public ulong Parameters => raw.parameters;
        public ulong Seed => raw.seed;
        public ulong Steps => raw.steps;
        public double RewardFill => raw.reward_fill;
        /// <summary>0..1; -1: not measured.</summary>
        public double Utilization => raw.utilization;
        public string Learner => raw.learner.ToString();
    }

    /// <summary>By position, the last for "no position"; and the value of the bin.</summary>
    public sealed class Evaluation
    {
        internal Evaluation(float[] logits, float[] probabilities, float value)
        {
            Logits = logits;
            Probabilities = probabilities;
            Value = value;
        }

        public float[] Logits { get; }
        public float[] Probabilities { get; }
        public float Value { get; }
    }

    /// <summary>Immutable; may be shared by threads.</summary>
    public sealed class Policy : Handle<Raw.pkc_policy>
    {
        /// <summary>By one of the Builtin names.</summary>
        public Policy(string name) : base(Create(name)) { }

        private Policy(Raw.pkc_policy raw) : base(raw) { }

        public static string[] Builtin => Native.Listed(Raw.pkc_policy_builtin);

        private static Raw.pkc_policy Create(string name)
        {
            Raw.pkc_policy raw;
            Native.Check(Raw.pkc_policy_create(Native.Text(name), out raw));
            return raw;
        }

        /// <summary>From a weight blob (.pkw).</summary>
        public static Policy Load(byte[] blob)
        {
            Raw.pkc_policy raw;
            Native.Check(Raw.pkc_policy_load(blob, Native.Count(blob), out raw));
            return new Policy(raw);
        }

        public static Policy LoadFile(string path)
        {
            Raw.pkc_policy raw;
            Native.Check(Raw.pkc_policy_load_file(Native.Text(path), out raw));
            return new Policy(raw);
        }

        /// <summary>The weight blob; heuristics have none.</summary>
        public byte[] Save()
        {
            return Native.Filled((byte[] a, ulong n, out ulong size) =>
                Raw.pkc_policy_save(Native.Of(this), a, n, out size));
        }

        public void SaveFile(string path)
        {
            Native.Check(Raw.pkc_policy_save_file(Native.Of(this), Native.Text(path)));
        }

        public string Name
        {
            get
            {
                string name = Raw.Text(Raw.pkc_policy_name(Native.Of(this)));
                GC.KeepAlive(this);
                return name;
            }
        }

        public PolicyInfo Info
        {
            get
            {
                var info = new PolicyInfo();
                Native.Check(Raw.pkc_policy_get_info(Native.Of(this), ref info.raw));
                return info;
            }
        }

        /// <summary>The position x + y * W for an item that covers w x h cells as it is turned;
        /// W * H is "no position".</summary>
        public int Select(Bin bin, int w, int h)
        {
            int position;
            Native.Check(Raw.pkc_policy_select(Native.Of(this), Native.Of(bin), w, h,
                                               out position));
            return position;
        }

        /// <summary>What actor and critic say; heuristics say nothing.</summary>
        public Evaluation Evaluate(Bin bin, int w, int h)
        {
            int positions = Positions(bin);
            var logits = new float[positions];
            var probabilities = new float[positions];
            ulong count;
            float value;
            Native.Check(Raw.pkc_policy_evaluate(Native.Of(this), Native.Of(bin), w, h, logits,
                                                 probabilities, (ulong)positions, out count,
                                                 out value));
            return new Evaluation(logits, probabilities, value);
        }

        /// <summary>The positions for many pairs of a bin and an item of sizes[2*i] x
        /// sizes[2*i + 1] cells, faster than one by one. All bins have the same sides.</summary>
        public int[] SelectBatch(IReadOnlyList<Bin> bins, int[] sizes)
        {
            if (bins == null || sizes == null || sizes.Length != 2L * bins.Count)
                throw Native.Wrong((sizes == null ? 0 : sizes.Length) + " sizes for "
                                   + (bins == null ? 0 : bins.Count) + " bins: must be two a bin");
            var raw = new IntPtr[bins.Count];
            var positions = new int[bins.Count];
            var held = new List<Raw.pkc_bin>();
            try
            {
                for (int i = 0; i < raw.Length; ++i)
                {
                    Raw.pkc_bin bin = Native.Of(bins[i]);
                    bool added = false;
                    bin.DangerousAddRef(ref added);
                    if (added)
                        held.Add(bin);
                    raw[i] = bin.DangerousGetHandle();
                }
                Native.Check(Raw.pkc_policy_evaluate_batch(Native.Of(this), raw, sizes,
                                                           (ulong)raw.Length, positions, null,
                                                           null));
            }
            finally
            {
                foreach (Raw.pkc_bin bin in held)
                    bin.DangerousRelease();
            }
            return positions;
        }

        private static int Positions(Bin bin)
        {
            var info = new BinInfo();
            Native.Check(Raw.pkc_bin_get_info(Native.Of(bin), ref info.raw));
            return info.W * info.H + 1;
        }
    }
}
