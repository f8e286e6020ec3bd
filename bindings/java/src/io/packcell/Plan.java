package io.packcell;

import java.util.List;

/** One step: what is done, and what is known about it. */
public record Plan(Info info, List<Action> actions) {
    /** What a plan is known to be; null for what is newer than this class. */
    public enum Proof {
        /** Nothing was to be proved: no repacking was needed or allowed. */
        NONE,
        /** No plan over the known items does better in this mode. */
        OPTIMAL,
        /** Repack.FULL: the known items cannot all be placed, nor the bin filled. */
        IMPOSSIBLE,
        /** The budget ended first, or what is looked at was too little to decide. */
        BUDGET
    }

    /**
     * Counts of this step's actions; terminate: it closes the bin; cancelled: Planner.cancel ended
     * the search. Utilization, 0..1, is that of the bin once all that was planned ahead is packed;
     * score the contact rewards summed until then, 0 after repacking; nodes the placements tried,
     * treeNodes those before repacking; hash that of the actions; milliseconds of thread CPU time.
     */
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
