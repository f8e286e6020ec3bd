import io.packcell.Action;
import io.packcell.Bin;
import io.packcell.Budget;
import io.packcell.Item;
import io.packcell.Plan;
import io.packcell.Planner;
import io.packcell.Policy;
import io.packcell.Queue;
import io.packcell.Step;
import java.util.ArrayList;
import java.util.List;

/** Plans a bin to its end: two arms, 14 items, repacking. Prints the steps and the plan's hash. */
public final class PlanGolden {
    private static final int[][] SIDES = {{2, 1}, {4, 3}, {2, 2}, {4, 4}, {2, 4}, {3, 4}, {3, 2},
            {3, 1}, {3, 5}, {2, 2}, {2, 2}, {2, 3}, {5, 5}, {2, 4}};

    private PlanGolden() {}

    public static void main(String[] arguments) {
        Planner.Options options = new Planner.Options()
                .method(Planner.Method.EXACT).rotation(true).repack(Planner.Repack.FULL);
        try (Bin bin = new Bin(10, 10);
                Queue queue = new Queue("D-R5A3O1");
                Policy policy = new Policy("contact");
                Planner planner = new Planner(options, policy)) {
            for (int id = 0; id < SIDES.length; ++id)
                queue.push(new Item(id, SIDES[id][0], SIDES[id][1]));

            List<Action> all = new ArrayList<>();
            Plan plan;
            do {
                plan = planner.plan(bin, queue, Budget.ofNodes(20000));
                Step.apply(bin, queue, plan.actions());
                all.addAll(plan.actions());
                System.out.println(plan.info().packs() + " packed, " + plan.info().unpacks()
                        + " unpacked");
            } while (!plan.info().terminate());

            System.out.println(bin.info().items() + " items fill " + bin.info().occupiedCells()
                    + " cells");
            System.out.println(String.format("%016x", Step.hash(all)));
        }
    }
}
