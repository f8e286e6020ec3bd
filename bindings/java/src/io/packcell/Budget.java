package io.packcell;

/**
 * How much a plan may cost: nodes (placements tried) and wall time, 0 for no limit. One in nodes
 * alone gives the same plan on every machine.
 */
public record Budget(long nodes, double milliseconds) {
    /** So many placements tried, and no time limit. */
    public static Budget ofNodes(long nodes) {
        return new Budget(nodes, 0);
    }

    /** So much wall time, 0..1e12, and any number of nodes. */
    public static Budget ofMilliseconds(double milliseconds) {
        return new Budget(0, milliseconds);
    }

    /** NULL, which is the library's default, for null. */
    static Raw.pkc_budget raw(Budget budget) {
        if (budget == null) return null;
        Raw.pkc_budget raw = new Raw.pkc_budget();
        Native.check(Raw.LIBRARY.pkc_budget_init(raw, raw.size()));
        raw.nodes = budget.nodes;
        raw.milliseconds = budget.milliseconds;
        return raw;
    }
}
