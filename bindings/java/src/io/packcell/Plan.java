package io.packcell;

import java.util.List;

/** One step: what is done, and what is known about it. */
public record Plan(Info info, List<Action> actions) {
    /** What a plan is known to be; null for what is newer than this class. */
    public enum Proof { NONE, OPTIMAL, IMPOSSIBLE, BUDGET }

    /** Utilization is that of the bin once all that was planned ahead is packed, 0..1. */
    public record Info(int actions, int packs, int unpacks, boolean repacked, boolean terminate,
            Proof proof, boolean cancelled, double utilization, long score, long nodes,
            long treeNodes, long hash, double milliseconds, double repackMilliseconds) {
        static Raw.pkc_plan_info fresh() {
            Raw.pkc_plan_info raw = new Raw.pkc_plan_info();
            Native.check(Raw.LIBRARY.pkc_plan_info_init(raw, raw.size()));
            return raw;
        }

        static Info from(Raw.pkc_plan_info raw) {
            return new Info(raw.actions, raw.packs, raw.unpacks, raw.repacked != 0,
                    raw.terminate != 0, Native.named(Proof.values(), raw.proof + 1),
                    raw.cancelled != 0, raw.utilization, raw.score, raw.nodes, raw.tree_nodes,
                    raw.hash, raw.milliseconds, raw.repack_milliseconds);
        }
    }
}
