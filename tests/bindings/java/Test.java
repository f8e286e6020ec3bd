import io.packcell.Action;
import io.packcell.Bin;
import io.packcell.Budget;
import io.packcell.Cell;
import io.packcell.ExactPacker;
import io.packcell.Generator;
import io.packcell.Grid;
import io.packcell.Item;
import io.packcell.Packcell;
import io.packcell.PackcellException;
import io.packcell.Placement;
import io.packcell.Plan;
import io.packcell.Planner;
import io.packcell.Policy;
import io.packcell.Protocol;
import io.packcell.Queue;
import io.packcell.Scenario;
import io.packcell.Schedule;
import io.packcell.Simulation;
import io.packcell.Snapshot;
import io.packcell.Status;
import io.packcell.Step;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.concurrent.atomic.AtomicInteger;
import java.util.concurrent.atomic.AtomicReference;

/** What the Java classes do beyond the raw layer: the golden plan, and bad input as exceptions. */
public final class Test {
    private static final int[] SIDES = {2, 1, 4, 3, 2, 2, 4, 4, 2, 4, 3, 4, 3, 2, 3, 1, 3, 5, 2, 2,
            2, 2, 2, 3, 5, 5, 2, 4};
    private static final Action NO_SUCH = new Action(Action.Op.PACK, 99, 0, 0, 0, 0);

    private static int failures;

    private Test() {}

    static void check(boolean holds, String what) {
        if (holds) return;
        System.out.println("FAILED: " + what);
        ++failures;
    }

    static void fails(Status status, String part, String what, Runnable call) {
        try {
            call.run();
            check(false, what + ": no exception");
        } catch (PackcellException error) {
            check(error.status() == status, what + ": " + error.status());
            check(!error.getMessage().isEmpty() && error.getMessage().contains(part),
                    what + ": says '" + error.getMessage() + "'");
        } catch (RuntimeException error) {
            check(false, what + ": " + error);
        }
    }

    static Queue golden() {
        Queue queue = new Queue("D-R5A3O1");
        for (int id = 0; 2 * id < SIDES.length; ++id)
            queue.push(new Item(id, SIDES[2 * id], SIDES[2 * id + 1]));
        return queue;
    }

    /** In slices, and through snapshots. */
    private static void slicesAndSnapshots(String expected) {
        List<Action> all = new ArrayList<>();
        Bin bin = new Bin(10, 10);
        Queue queue = golden();
        try (Policy policy = new Policy("contact");
                Planner planner = new Planner(
                        new Planner.Options().repack(Planner.Repack.FULL), policy)) {
            Plan plan;
            do {
                planner.begin(bin, queue, Budget.ofNodes(20000));
                boolean done = false;
                while (!done) done = planner.step(500);
                plan = planner.result();
                check(plan.info().hash() == Step.hash(plan.actions()), "the plan's hash");
                check(plan.info().actions() == plan.actions().size(), "the plan's length");
                check(plan.info().proof() != null, "the plan's proof");
                byte[] bytes = Snapshot.save(bin, queue);
                bin.close();
                queue.close();
                Snapshot snapshot = Snapshot.load(bytes);
                bin = snapshot.bin();
                queue = snapshot.queue();
                Step.apply(bin, queue, plan.actions());
                all.addAll(plan.actions());
            } while (!plan.info().terminate());
        }
        check(String.format("%016x", Step.hash(all)).equals(expected), "golden hash in slices");
        check(all.size() == 22 && bin.items().size() == 13, "golden actions and items");
        check(bin.info().occupiedCells() == 100, "golden bin is full");
        bin.close();
        queue.close();
    }

    private static void binAndQueue() {
        try (Bin bin = new Bin(6, 4)) {
            bin.block(0, 0, 1, 1);
            bin.pack(new Item(7, 2, 3, Item.NO_ROTATE), 1, 0);
            check(bin.info().occupiedCells() == 7 && bin.info().fixedCells() == 1, "counted");
            int[] cells = bin.cells();
            check(cells[1] == 7 && cells[0] == Bin.FIXED_CELL && cells[5] == Bin.FREE_CELL,
                    "cells");
            boolean[] mask = bin.feasible(3, 4);
            check(mask.length == 25 && mask[3] && !mask[0] && !mask[24], "feasibility mask");
            check(bin.contact(3, 0, 3, 4) > 0, "contact");
            fails(Status.STATE, "", "packed over an item", () -> bin.pack(new Item(8, 1, 1), 1, 0));
            fails(Status.ARGUMENT, "", "item of 0 cells", () -> bin.pack(new Item(8, 0, 1), 5, 0));
            fails(Status.ARGUMENT, "", "no item", () -> bin.pack(null, 5, 0));
            try (Bin copy = bin.copy()) {
                check(copy.info().hash() == bin.info().hash(), "copy");
            }
            Placement was = bin.unpack(7);
            check(was.x() == 1 && was.item().flags() == Item.NO_ROTATE, "unpacked");
            check(bin.items().isEmpty(), "no items");
            bin.clear();
        }
        Scenario scenario = Scenario.parse("D-R5A3O1");
        check(scenario.equals(new Scenario(2, 5, 3, 1)), "scenario parsed");
        check(scenario.name().equals("D-R5A3O1"), "scenario named");
        fails(Status.ARGUMENT, "", "unknown scenario", () -> Scenario.parse("X"));
        fails(Status.ARGUMENT, "", "no scenario name", () -> Scenario.parse(null));
        fails(Status.ARGUMENT, "", "no scenario", () -> new Queue((Scenario) null));
        fails(Status.ARGUMENT, "", "scenario out of range",
                () -> new Queue(new Scenario(3, 1, 1, 0)));
        try (Queue queue = golden()) {
            check(queue.info().belt() == 14 && queue.belt().get(0).recognized(), "belt");
            check(queue.scenario().equals(scenario), "scenario of a queue");
            queue.remove(0);
            queue.removeItems(1, 2);
            queue.removeItems();
            queue.putInBuffer(new Item(50, 1, 1), 1);
            check(queue.info().belt() == 11 && queue.buffer().get(0).item().id() == 50, "buffer");
            queue.setAlphaLeft(0);
            fails(Status.STATE, "", "id twice", () -> queue.push(new Item(3, 1, 1)));
            fails(Status.STATE, "", "removed twice", () -> queue.removeItems(3, 3));
            fails(Status.ARGUMENT, "", "no ids", () -> queue.removeItems((int[]) null));
            fails(Status.ARGUMENT, "", "no item to push", () -> queue.push(null));
            try (Queue copy = queue.copy()) {
                check(copy.info().equals(queue.info()), "copy of a queue");
            }
        }
    }

    private static void badHandles() {
        fails(Status.ARGUMENT, "width 0", "bin of no width", () -> new Bin(0, 5));
        Bin bin = new Bin(4, 4);
        Queue queue = golden();
        Planner planner = new Planner();
        Policy policy = new Policy("contact");
        fails(Status.STATE, "", "no plan begun", planner::result);
        fails(Status.ARGUMENT, "", "no bin", () -> planner.plan(null, queue));
        fails(Status.ARGUMENT, "", "no queue", () -> planner.plan(bin, null));
        fails(Status.ARGUMENT, "", "no actions", () -> Step.apply(bin, queue, null));
        fails(Status.ARGUMENT, "", "no actions to hash", () -> Step.hash(null));
        fails(Status.ARGUMENT, "element 1", "no action",
                () -> Step.apply(bin, queue, Arrays.asList(NO_SUCH, null)));
        fails(Status.STATE, "", "unknown item", () -> Step.apply(bin, queue, List.of(NO_SUCH)));
        Step.apply(bin, queue, List.of());
        fails(Status.ARGUMENT, "", "no bytes", () -> Snapshot.load(null));
        fails(Status.FORMAT, "", "no byte", () -> Snapshot.load(new byte[0]));
        fails(Status.FORMAT, "", "bytes of nothing", () -> Snapshot.load(new byte[40]));
        fails(Status.ARGUMENT, "", "unknown policy", () -> new Policy("nosuch"));
        fails(Status.ARGUMENT, "", "no policy name", () -> new Policy(null));
        fails(Status.ARGUMENT, "zero", "zero in a name", () -> new Policy("contact\0x"));
        fails(Status.ARGUMENT, "", "half a character", () -> new Policy("\ud800"));
        fails(Status.UNSUPPORTED, "", "a heuristic's weights", policy::save);
        fails(Status.UNSUPPORTED, "", "a heuristic's values", () -> policy.evaluate(bin, 1, 1));
        fails(Status.ARGUMENT, "must be two a bin", "sizes of a batch",
                () -> policy.selectBatch(List.of(bin), new int[3]));
        fails(Status.ARGUMENT, "", "a bin of a batch is null",
                () -> policy.selectBatch(Arrays.asList(bin, null), new int[] {1, 1, 1, 1}));
        fails(Status.ARGUMENT, "", "a batch of nothing",
                () -> policy.selectBatch(List.of(), new int[0]));
        fails(Status.IO, "/nonexistent", "no such file", () -> Policy.loadFile("/nonexistent"));
        check(policy.selectBatch(List.of(bin, bin), new int[] {1, 1, 2, 2}).length == 2, "batch");
        check(policy.select(bin, 2, 2) == 0 && policy.name().equals("contact"), "select");
        check(policy.info().learner().isEmpty(), "a heuristic's info");
        fails(Status.ARGUMENT, "", "planner options",
                () -> new Planner(new Planner.Options().limits(0, 1, 1), null));
        fails(Status.ARGUMENT, "", "no method",
                () -> new Planner(new Planner.Options().method(null), null));
        fails(Status.ARGUMENT, "", "budget",
                () -> planner.plan(bin, queue, Budget.ofMilliseconds(Double.NaN)));

        bin.close();
        bin.close();
        check(bin.isClosed(), "closed");
        fails(Status.ARGUMENT, "", "closed bin", bin::clear);
        fails(Status.ARGUMENT, "", "cells of a closed bin", bin::cells);
        fails(Status.ARGUMENT, "", "plan in a closed bin", () -> planner.plan(bin, queue));
        fails(Status.ARGUMENT, "", "batch of a closed bin",
                () -> policy.selectBatch(List.of(bin), new int[] {1, 1}));
        policy.close();
        check(policy.name().isEmpty(), "name of a closed policy");
        fails(Status.ARGUMENT, "closed", "closed policy", () -> new Planner(null, policy));
        planner.close();
        fails(Status.ARGUMENT, "", "closed planner", planner::cancel);
        queue.close();
        fails(Status.ARGUMENT, "", "closed queue", () -> queue.push(new Item(1, 1, 1)));
    }

    private static void learnedPolicy() {
        try (Policy policy = new Policy("default");
                Bin bin = new Bin(10, 10);
                Bin other = new Bin(10, 10);
                Bin small = new Bin(4, 4)) {
            Policy.Info info = policy.info();
            check(info.architecture() != Policy.Architecture.HEURISTIC && info.parameters() > 0
                    && !info.learner().isEmpty(), "a learned policy's info");
            other.pack(new Item(1, 3, 2), 0, 0);
            Policy.Evaluation one = policy.evaluate(other, 2, 2);
            float sum = 0;
            for (float chance : one.probabilities()) sum += chance;
            check(one.logits().length == 101 && Math.abs(sum - 1) < 1e-4, "probabilities");
            List<Bin> bins = List.of(bin, other, other);
            int[] sizes = {5, 1, 2, 2, 1, 4};
            Policy.BatchEvaluation many = policy.evaluateBatch(bins, sizes);
            check(many.values().length == 3 && many.values()[1] == one.value(), "values");
            check(many.probabilities().length == 303
                    && many.probabilities()[101 + 44] == one.probabilities()[44], "chances");
            check(many.positions()[2] == policy.select(other, 1, 4)
                    && policy.selectBatch(bins, sizes)[1] == many.positions()[1], "positions");
            fails(Status.ARGUMENT, "", "bins of two sizes",
                    () -> policy.evaluateBatch(List.of(bin, small), new int[] {1, 1, 1, 1}));
            fails(Status.ARGUMENT, "", "evaluated batch of nothing",
                    () -> policy.evaluateBatch(List.of(), new int[0]));
            fails(Status.ARGUMENT, "must be two a bin", "no bins and sizes",
                    () -> policy.evaluateBatch(null, null));
            fails(Status.ARGUMENT, "", "evaluated batch with no bin",
                    () -> policy.evaluateBatch(Arrays.asList((Bin) null), new int[] {1, 1}));
            Policy.Measurement measured = policy.measure(null, 1, 50);
            check(measured.mean() > 0.5 && measured.mean() < 1 && measured.halfWidth() > 0,
                    "measured");
            fails(Status.ARGUMENT, "bins 0", "measured on nothing",
                    () -> policy.measure(Protocol.defaults(), 1, 0));
        }
        try (Policy policy = new Policy("contact"); Bin bin = new Bin(4, 4)) {
            check(policy.info().architecture() == Policy.Architecture.HEURISTIC, "a heuristic");
            fails(Status.UNSUPPORTED, "", "a heuristic's batch",
                    () -> policy.evaluateBatch(List.of(bin), new int[] {1, 1}));
            Protocol large = new Protocol(40, 40, 1, 20, 30, Protocol.Rotation.OFF);
            check(policy.measure(large, 7, 2).mean() > 0, "measured on large bins");
        }
        check(Protocol.defaults().equals(
                new Protocol(10, 10, 1, 5, 0, Protocol.Rotation.MIXED)), "default protocol");
    }

    private static void packer() {
        try (Bin bin = new Bin(4, 4)) {
            List<Item> fits = List.of(new Item(0, 4, 2), new Item(1, 2, 2), new Item(2, 2, 2));
            ExactPacker.Packing packing = ExactPacker.pack(bin, fits, true, null);
            check(packing.answer() == ExactPacker.Answer.FOUND
                    && packing.placements().get(2).item().id() == 2, "packed exactly");
            List<Item> large = List.of(new Item(0, 3, 3), new Item(1, 3, 3));
            packing = ExactPacker.pack(bin, large, true, null);
            check(packing.answer() == ExactPacker.Answer.IMPOSSIBLE
                    && packing.placements().isEmpty(), "not to be packed");
            ExactPacker.Bound bound = ExactPacker.boundInOrder(bin, large, true, null);
            check(bound.count() == 1 && bound.answer() != ExactPacker.Answer.BUDGET, "bound");
            fails(Status.ARGUMENT, "", "no items", () -> ExactPacker.pack(bin, null, true, null));
            fails(Status.ARGUMENT, "", "item too large",
                    () -> ExactPacker.pack(bin, List.of(new Item(0, 200, 1)), true, null));
            ExactPacker.pack(bin, List.of(), true, null);
        }
    }

    private static void cellAndRun(Path folder) throws Exception {
        Scenario scenario = Scenario.parse("D-R5A3O1");
        fails(Status.ARGUMENT, "", "unknown cell", () -> new Cell("nosuch"));
        fails(Status.FORMAT, "", "not a cell", () -> Cell.load("{}"));
        fails(Status.ARGUMENT, "", "no text", () -> Cell.load(null));
        check(Cell.presets().contains("ur5e") && Policy.builtins().contains("contact"), "names");
        try (Cell cell = new Cell("ur5e");
                Cell same = Cell.load(cell.save());
                Schedule schedule = new Schedule(same, scenario, Schedule.Mode.COORDINATED);
                Bin bin = new Bin(10, 10);
                Queue queue = golden();
                Planner planner = new Planner()) {
            check(cell.info().arms() == 2 && cell.info().joints()[0] == 6, "cell's info");
            cell.checkReach(scenario);
            fails(Status.ARGUMENT, "must have 4", "pose too short", () -> cell.inverse(0, 0, 0));
            fails(Status.ARGUMENT, "", "no pose", () -> cell.inverse(0, (double[]) null));
            fails(Status.ARGUMENT, "must have 6", "joints", () -> cell.forward(0, new double[4]));
            fails(Status.ARGUMENT, "", "third arm", () -> cell.forward(2, new double[6]));
            fails(Status.ARGUMENT, "", "no scenario", () -> cell.checkReach(null));
            fails(Status.ARGUMENT, "", "no mode", () -> new Schedule(cell, scenario, null));
            Plan plan = planner.plan(bin, queue, Budget.ofNodes(500));
            schedule.addStep(bin, queue, Step.allocate(cell, queue, plan.actions()));
            fails(Status.STATE, "", "not a legal step",
                    () -> schedule.addStep(bin, queue, List.of(NO_SUCH)));
            fails(Status.STATE, "", "put aside at no release", () -> schedule.putAside(0, 0));
            Cell.Layout layout = cell.optimizeLayout(scenario,
                    new Cell.LayoutOptions(10, Cell.LayoutOptions.defaults().range()));
            check(layout.cell().info().arms() == 2 && layout.after() <= layout.before(), "layout");
            layout.cell().close();
            Schedule.Info info = schedule.info();
            Schedule.ArmTimes times = info.arms().get(0);
            double sum = times.travel() + times.strokes() + times.grips();
            for (Schedule.Wait wait : Schedule.Wait.values()) sum += times.waiting(wait);
            check(info.makespan() > 0 && Math.abs(sum - info.makespan()) < 1e-6, "makespan");
            Schedule.Sample sample = schedule.sample(0, info.makespan() / 2);
            double[] tool = cell.forward(0, sample.position());
            check(Math.abs(tool[0] - sample.tool()[0]) < 1e-6, "the tool is where joints say");
            check(Math.abs(cell.forward(0, cell.inverse(0, tool))[1] - tool[1]) < 1e-6, "inverse");
            fails(Status.ARGUMENT, "", "after the end", () -> schedule.sample(0, 1e9));
            Simulation run = new Simulation(schedule, new Simulation.Options().seed(3));
            check(run.places().size() == run.info().places() && run.places().size() > 0, "places");
            check(run.places().get(0).outcome() == Simulation.Outcome.OK, "placed");
            Path path = folder.resolve("trace.json");
            schedule.writeTrace(Schedule.Trace.CHROME, path.toString(), run, 0.01);
            check(Files.size(path) > 0, "trace");
            run.close();
            fails(Status.ARGUMENT, "closed", "closed simulation",
                    () -> schedule.writeTrace(Schedule.Trace.CHROME, path.toString(), run, 0.01));
            fails(Status.ARGUMENT, "", "options of a run",
                    () -> new Simulation(schedule, new Simulation.Options().hertz(1)));
            fails(Status.ARGUMENT, "", "no schedule", () -> new Simulation(null));
        }
    }

    /** An arm of four joints is asked by six numbers as well. */
    private static void scara() {
        try (Cell cell = new Cell("scara")) {
            check(cell.info().joints()[0] == 4, "joints of a SCARA");
            double[] pose = cell.forward(0, 0.4, 0.6, -0.1, 0.1, 0, 0);
            double[] joints = cell.inverse(0, pose);
            check(joints.length == 6 && joints[4] == 0 && joints[5] == 0, "the last two are 0");
            check(Math.abs(cell.forward(0, joints)[2] - pose[2]) < 1e-6, "height of a SCARA");
        }
    }

    private static void generatorAndGrid() {
        try (Generator generator = new Generator(new Generator.Options().seed(5));
                Generator again = new Generator(new Generator.Options().seed(5))) {
            check(generator.next(20).equals(again.next(20)), "equal seeds, equal items");
            fails(Status.ARGUMENT, "-1", "fewer than none", () -> generator.next(-1));
        }
        Generator.Options options =
                new Generator.Options().kind(Generator.Kind.FULL).preset("text");
        try (Generator generator = new Generator(options)) {
            fails(Status.CAPACITY, "", "too small for a set", () -> generator.next(1));
            int cells = generator.next(100).stream().mapToInt(item -> item.w() * item.h()).sum();
            check(cells == 100, "a full set");
        }
        try (Generator generator = new Generator(null); Generator same = new Generator()) {
            check(generator.next(3).equals(same.next(3)), "default options of a generator");
        }
        fails(Status.ARGUMENT, "", "unknown preset", () -> new Generator.Options().preset("x"));
        check(Grid.defaults().binCells().equals(new Grid.Cells(10, 8)), "bin's cells");
        check(Grid.defaults().itemCells(31, 30).equals(new Grid.Cells(2, 1)), "item's cells");
        check(Grid.defaults().centre(0, 0, 2, 1).equals(new Grid.Point(40, 25)), "centre");
        fails(Status.ARGUMENT, "", "cell of 0 mm", () -> new Grid(1, 1, 0, 0, 0).binCells());
    }

    /**
     * A plan without limits is under way in another thread: its planner is busy, until it is
     * cancelled. A bin that is closed meanwhile is freed after it.
     */
    private static void busyAndCancel() throws Exception {
        Planner.Options options = new Planner.Options()
                .method(Planner.Method.PAPER).select(Planner.SELECT_ALL);
        Bin bin = new Bin(40, 40);
        AtomicReference<Plan> plan = new AtomicReference<>();
        AtomicReference<RuntimeException> failed = new AtomicReference<>();
        try (Queue queue = new Queue(new Scenario(2, 24, 12, 0));
                Planner planner = new Planner(options, new Policy("contact"))) {
            for (int id = 0; id < 40; ++id) queue.push(new Item(id, 2 + id % 5, 3 + id % 4));
            Thread thread = new Thread(() -> {
                while (plan.get() == null && failed.get() == null) {
                    try {
                        plan.set(planner.plan(bin, queue, Budget.ofNodes(0)));
                    } catch (PackcellException error) {
                        if (error.status() != Status.BUSY) failed.set(error);
                    } catch (RuntimeException error) {
                        failed.set(error);
                    }
                }
            });
            thread.start();
            boolean busy = false;
            while (!busy && thread.isAlive()) {
                try {
                    planner.result();
                } catch (PackcellException error) {
                    busy = error.status() == Status.BUSY && error.getMessage().contains("thread");
                }
                Thread.sleep(1);
            }
            check(busy, "a handle in use by two threads is busy");
            bin.close();
            while (thread.isAlive()) {
                planner.cancel();
                thread.join(5);
            }
        }
        check(failed.get() == null, "the cancelled plan: " + failed.get());
        check(plan.get() != null && plan.get().info().cancelled(), "cancelled");
    }

    /** A planner that is closed while it plans is freed after that plan, not under it. */
    private static void closedInUse() throws Exception {
        Planner.Options options = new Planner.Options()
                .method(Planner.Method.PAPER).select(Planner.SELECT_ALL);
        try (Bin bin = new Bin(40, 40); Queue queue = new Queue(new Scenario(2, 24, 12, 0))) {
            for (int id = 0; id < 40; ++id) queue.push(new Item(id, 2 + id % 5, 3 + id % 4));
            Planner planner = new Planner(options, null);
            AtomicReference<Status> ended = new AtomicReference<>();
            Thread thread = new Thread(() -> {
                while (ended.get() == null) {
                    try {
                        planner.plan(bin, queue, Budget.ofMilliseconds(200));
                    } catch (PackcellException error) {
                        if (error.status() != Status.BUSY) ended.set(error.status());
                    }
                }
            });
            thread.start();
            for (boolean busy = false; !busy && thread.isAlive();) {
                try {
                    planner.result();
                } catch (PackcellException error) {
                    busy = error.status() == Status.BUSY;
                }
                Thread.sleep(1);
            }
            planner.close();
            thread.join();
            check(ended.get() == Status.ARGUMENT, "closed in use: " + ended.get());
        }
    }

    /** Threads use and close the same handle: exceptions of packcell, nothing worse. */
    private static void races() throws Exception {
        AtomicInteger strange = new AtomicInteger();
        for (int round = 0; round < 60; ++round) {
            Bin bin = new Bin(8, 8);
            List<Thread> threads = new ArrayList<>();
            for (int t = 0; t < 3; ++t) {
                int id = t;
                threads.add(new Thread(() -> {
                    for (int i = 0; i < 60; ++i) {
                        try {
                            if (id == 2 && i == 30) bin.close();
                            else if (id == 1) bin.cells();
                            else bin.copy().close();
                        } catch (PackcellException expected) {
                            if (expected.status() != Status.BUSY
                                    && expected.status() != Status.ARGUMENT)
                                strange.incrementAndGet();
                        } catch (RuntimeException error) {
                            strange.incrementAndGet();
                        }
                    }
                }));
            }
            threads.forEach(Thread::start);
            for (Thread thread : threads) thread.join();
        }
        check(strange.get() == 0, "races end in exceptions of packcell");
    }

    public static void main(String[] arguments) throws Exception {
        check(Packcell.version() >= 100, "version");
        check(Status.INTERNAL.code() == -11, "status numbers");
        slicesAndSnapshots(arguments[0]);
        binAndQueue();
        badHandles();
        learnedPolicy();
        packer();
        cellAndRun(Path.of(arguments[1]));
        scara();
        generatorAndGrid();
        busyAndCancel();
        closedInUse();
        races();
        BadInput.run(Path.of(arguments[1]));
        int items = 0;
        for (int i = 0; i < 200; ++i) items += new Bin(5, 5).info().items(); // the cleaner's
        System.gc();
        System.out.println(failures + items == 0 ? "all hold" : failures + " failed");
        System.exit(failures == 0 ? 0 : 1);
    }
}
