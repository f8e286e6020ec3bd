// The low level: where an item goes.
using System;
using System.Collections.Generic;

namespace Packcell
{
    /// <summary>What a policy is made of; heuristics are not learned.</summary>
    public enum Architecture
    {
        Heuristic = Raw.PKC_ARCH_HEURISTIC,
        ActorCritic = Raw.PKC_ARCH_ACTOR_CRITIC,
        FullyConvolutional = Raw.PKC_ARCH_FULLY_CONVOLUTIONAL,
        Afterstate = Raw.PKC_ARCH_AFTERSTATE
    }

    /// <summary>Where a policy comes from; zeros for a heuristic.</summary>
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
        /// <summary>Numbers learned.</summary>
        public ulong Parameters => raw.parameters;
        public ulong Seed => raw.seed;
        /// <summary>Items placed while learning.</summary>
        public ulong Steps => raw.steps;
        /// <summary>Share of filled cells in the reward, 0..1; the rest is contact.</summary>
        public double RewardFill => raw.reward_fill;
        /// <summary>0..1; -1: not measured.</summary>
        public double Utilization => raw.utilization;
        /// <summary>How it learned; empty for a heuristic.</summary>
        public string Learner => raw.learner.ToString();
    }

    /// <summary>What actor and critic say: W*H + 1 logits and probabilities by position, the last
    /// for "no position", those without room with probability 0; and the value of the bin.
    /// </summary>
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

    /// <summary>The same for many pairs, one after another: W*H + 1 probabilities for each.
    /// </summary>
    public sealed class BatchEvaluation
    {
        internal BatchEvaluation(int[] positions, float[] probabilities, float[] values)
        {
            Positions = positions;
            Probabilities = probabilities;
            Values = values;
        }

        public int[] Positions { get; }
        public float[] Probabilities { get; }
        public float[] Values { get; }
    }

    /// <summary>Where an item goes. Immutable; may be shared by threads.</summary>
    public sealed class Policy : Handle<Raw.pkc_policy>
    {
        /// <summary>By one of the Builtins.</summary>
        public Policy(string name) : base(Create(name)) { }

        private Policy(Raw.pkc_policy raw) : base(raw) { }

        /// <summary>The names that the constructor knows, "default" first.</summary>
        public static string[] Builtins => Native.Listed(Raw.pkc_policy_builtin);

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

        /// <summary>The same from a file. Status.IO if it cannot be read, Format with the first
        /// offset that is wrong.</summary>
        public static Policy LoadFile(string path)
        {
            Raw.pkc_policy raw;
            Native.Check(Raw.pkc_policy_load_file(Native.Text(path), out raw));
            return new Policy(raw);
        }

        /// <summary>The weight blob. Status.Unsupported for a heuristic: it has none.</summary>
        public byte[] Save()
        {
            return Native.Filled((byte[] a, ulong n, out ulong size) =>
                Raw.pkc_policy_save(Native.Of(this), a, n, out size));
        }

        /// <summary>The same into a file, all or nothing.</summary>
        public void SaveFile(string path)
        {
            Native.Check(Raw.pkc_policy_save_file(Native.Of(this), Native.Text(path)));
        }

        /// <summary>Empty for one that was disposed of.</summary>
        public string Name
        {
            get
            {
                // The name lives as long as the handle, which another thread may dispose of.
                Raw.pkc_policy policy = Native.Of(this);
                bool added = false;
                try
                {
                    policy.DangerousAddRef(ref added);
                    return Raw.Text(Raw.pkc_policy_name(policy));
                }
                finally
                {
                    if (added)
                        policy.DangerousRelease();
                }
            }
        }

        /// <summary>Where the policy comes from.</summary>
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

        /// <summary>What a learned policy says of such an item; Status.Unsupported if it gives
        /// positions alone.</summary>
        public Evaluation Evaluate(Bin bin, int w, int h)
        {
            int positions = Positions(Native.Of(bin));
            var logits = new float[positions];
            var probabilities = new float[positions];
            ulong count;
            float value;
            Native.Check(Raw.pkc_policy_evaluate(Native.Of(this), Native.Of(bin), w, h, logits,
                                                 probabilities, (ulong)positions, out count,
                                                 out value));
            return new Evaluation(logits, probabilities, value);
        }

        /// <summary>The positions for 1..2^20 pairs of a bin and an item of sizes[2*i] x
        /// sizes[2*i + 1] cells, faster than one by one. All bins have the same sides; the same bin
        /// may stand in many pairs.</summary>
        public int[] SelectBatch(IReadOnlyList<Bin> bins, int[] sizes)
        {
            Raw.pkc_bin[] handles = Handles(bins);
            var positions = new int[handles.Length];
            Batch(handles, sizes, positions, null, null);
            return positions;
        }

        /// <summary>The same with what a learned policy says; Status.Unsupported if it gives
        /// positions alone.</summary>
        public BatchEvaluation EvaluateBatch(IReadOnlyList<Bin> bins, int[] sizes)
        {
            Raw.pkc_bin[] handles = Handles(bins);
            int pairs = handles.Length;
            long probabilities = pairs == 0 ? 0 : (long)Positions(handles[0]) * pairs;
            var evaluation = new BatchEvaluation(new int[pairs], new float[probabilities],
                                                 new float[pairs]);
            Batch(handles, sizes, evaluation.Positions, evaluation.Probabilities,
                  evaluation.Values);
            return evaluation;
        }

        /// <summary>Packs so many bins, 1..2^32, of a held-out stream, always at the most probable
        /// position. Without a protocol, the default one.</summary>
        public Measurement Measure(Protocol protocol = null, ulong seed = 1, ulong bins = 1000)
        {
            Raw.pkc_trainer_options of = (protocol ?? new Protocol()).raw;
            double mean, halfWidth;
            Native.Check(Raw.pkc_policy_measure(Native.Of(this), ref of, seed, bins, out mean,
                                                out halfWidth));
            return new Measurement { Mean = mean, HalfWidth = halfWidth };
        }

        // Read once: the list may change while C uses what it held.
        private static Raw.pkc_bin[] Handles(IReadOnlyList<Bin> bins)
        {
            return Native.Map(bins, bin => Native.Of(bin)) ?? new Raw.pkc_bin[0];
        }

        // What is asked for is not null, and has room for all pairs.
        private void Batch(Raw.pkc_bin[] bins, int[] sizes, int[] positions, float[] probabilities,
                           float[] values)
        {
            if (sizes == null || sizes.Length != 2L * bins.Length)
                throw Native.Wrong((sizes == null ? 0 : sizes.Length) + " sizes for "
                                   + bins.Length + " bins: must be two a bin");
            var raw = new IntPtr[bins.Length];
            int held = 0;
            try
            {
                for (; held < bins.Length; ++held)
                {
                    bool added = false;
                    bins[held].DangerousAddRef(ref added);
                    raw[held] = bins[held].DangerousGetHandle();
                }
                // A copy: C checks the sizes first, and they must not change after that.
                Native.Check(Raw.pkc_policy_evaluate_batch(Native.Of(this), raw,
                                                           (int[])sizes.Clone(),
                                                           (ulong)raw.Length, positions,
                                                           probabilities, values));
            }
            finally
            {
                while (held > 0)
                    bins[--held].DangerousRelease();
            }
        }

        private static int Positions(Raw.pkc_bin bin)
        {
            var info = new BinInfo();
            Native.Check(Raw.pkc_bin_get_info(bin, ref info.raw));
            return info.W * info.H + 1;
        }
    }
}
