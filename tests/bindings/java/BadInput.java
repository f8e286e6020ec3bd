import io.packcell.Action;
import io.packcell.Bin;
import io.packcell.Budget;
import io.packcell.Cell;
import io.packcell.ExactPacker;
import io.packcell.Generator;
import io.packcell.Grid;
import io.packcell.Item;
import io.packcell.PackcellException;
import io.packcell.Planner;
import io.packcell.Policy;
import io.packcell.Protocol;
import io.packcell.Queue;
import io.packcell.Scenario;
import io.packcell.Schedule;
import io.packcell.Simulation;
import io.packcell.Status;
import io.packcell.Step;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.AbstractList;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.concurrent.atomic.AtomicInteger;
import java.util.stream.Stream;

/**
 * What callers do wrong by accident: every number, text and list that they pass ends in an answer
 * or in an exception with the library's message.
 */
final class BadInput {
    private BadInput() {}

    /** Another thread changes it: its length is another one each time. */
    private static final class Changing<T> extends AbstractList<T> {
        private final T element;
        private final int[] lengths;
        private int asked;

        Changing(T element, int... lengths) {
            this.element = element;
            this.lengths = lengths;
        }

        @Override
        public int size() {
            return lengths[Math.min(asked++, lengths.length - 1)];
        }

        @Override
        public T get(int index) {
            return element;
        }

        @Override
        public Object[] toArray() {
            Object[] all = new Object[size()];
            Arrays.fill(all, element);
            return all;
        }
    }

    /** Nothing is expected but that it returns, or throws a PackcellException with a message. */
    private static void survives(String what, Runnable call) {
        try {
            call.run();
        } catch (PackcellException error) {
            Test.check(!error.getMessage().isEmpty(), what + ": no message");
        } catch (RuntimeException error) {
            Test.check(false, what + ": " + error);
        }
    }

    private static void refused(String what, Runnable call) {
        Test.fails(Status.ARGUMENT, "must be", what, call);
    }

    private static void numbers(Path folder) {
        Scenario scenario = Scenario.parse("D-R5A3O1");
        String path = folder.resolve("numbers").toString();
        try (Bin bin = new Bin(10, 10);
                Queue queue = Test.golden();
                Planner planner = new Planner();
                Policy policy = new Policy("default");
                Cell cell = new Cell("ur5e");
                Schedule schedule = new Schedule(cell, scenario, Schedule.Mode.COORDINATED)) {
            for (double x : new double[] {Double.NaN, Double.POSITIVE_INFINITY, 1e300}) {
                refused("bin in mm", () -> new Grid(x, 1, 0, 1, 0).binCells());
                refused("item in mm", () -> Grid.defaults().itemCells(x, 1));
                refused("time", () -> schedule.sample(0, x));
                refused("time aside", () -> schedule.putAside(0, x));
                refused("period",
                        () -> schedule.writeTrace(Schedule.Trace.TIMELINE, path, null, x));
                refused("milliseconds",
                        () -> planner.plan(bin, queue, Budget.ofMilliseconds(x)));
                refused("sigma",
                        () -> new Simulation(schedule, new Simulation.Options().sigma(x, 0)));
                refused("range",
                        () -> cell.optimizeLayout(scenario, new Cell.LayoutOptions(10, x)));
                refused("mean", () -> new Generator(
                        new Generator.Options().kind(Generator.Kind.FULL).sides(x, 1)));
                survives("pose", () -> cell.inverse(0, x, 0, 0, 0));
                survives("joints", () -> cell.forward(0, x, 0, 0, 0, 0, 0));
            }
            for (int n : new int[] {Integer.MIN_VALUE, -1, 129, Integer.MAX_VALUE}) {
                Item item = new Item(n, n, n, n);
                Action action = new Action(Action.Op.PACK, n, n, n, n, n);
                refused("bin", () -> new Bin(n, n));
                refused("scenario", () -> new Scenario(n, n, n, n).name());
                refused("block", () -> bin.block(n, n, n, n));
                refused("pack", () -> bin.pack(item, n, n, n));
                refused("mask", () -> bin.feasible(n, n));
                refused("contact", () -> bin.contact(n, n, n, n));
                survives("unpack", () -> bin.unpack(n));
                refused("push", () -> queue.push(item));
                refused("alpha", () -> queue.setAlphaLeft(n));
                refused("buffer", () -> queue.putInBuffer(new Item(90, 1, 1), n));
                refused("select", () -> policy.select(bin, n, n));
                refused("evaluate", () -> policy.evaluate(bin, n, n));
                refused("batch", () -> policy.selectBatch(List.of(bin), new int[] {n, n}));
                refused("protocol", () -> policy.measure(
                        new Protocol(10, 10, n, 5, 0, Protocol.Rotation.ON), 1, 1));
                Test.fails(Status.STATE, "actions[0]", "action",
                        () -> Step.apply(bin, queue, List.of(action)));
                refused("exact packer", () -> ExactPacker.pack(bin, List.of(item), true, null));
                refused("arm", () -> schedule.sample(n, 0));
                refused("select", () -> new Planner(
                        new Planner.Options().select(n == -1 ? -2 : n), null));
                refused("centre", () -> Grid.defaults().centre(n, n, n, n));
                refused("generator", () -> new Generator(new Generator.Options().bin(n, n)));
            }
            refused("no nodes", () -> planner.step(0));
            refused("no trace", () -> schedule.writeTrace(null, path, null, 1));
            refused("no repacking", () -> new Planner(new Planner.Options().repack(null), null));
            refused("no kind", () -> new Generator(new Generator.Options().kind(null)));
            refused("no rotation",
                    () -> policy.measure(new Protocol(10, 10, 1, 5, 0, null), 1, 1));
            Test.fails(Status.STATE, "op must be", "no op",
                    () -> Step.apply(bin, queue, List.of(new Action(null, 0, 0, 0, 0, 0))));
        }
        try (Generator generator = new Generator()) {
            refused("more items than JNA can count", () -> generator.next(Integer.MAX_VALUE));
        }
    }

    /** C is never told another length than that of the array it gets. */
    private static void changingLists() {
        try (Bin bin = new Bin(4, 4); Policy policy = new Policy("contact")) {
            int[] sizes = {1, 1};
            Test.check(policy.selectBatch(new Changing<>(bin, 1, 100000), sizes).length == 1,
                    "bins that grow");
            Test.check(policy.selectBatch(new Changing<>(bin, 1, 0), sizes).length == 1,
                    "bins that shrink");
            Item item = new Item(0, 2, 2);
            for (int later : new int[] {0, 100000}) {
                ExactPacker.Packing packing =
                        ExactPacker.pack(bin, new Changing<>(item, 1, later), true, null);
                Test.check(packing.placements().size() == 1, "items that change");
                Test.check(ExactPacker.boundInOrder(bin, new Changing<>(item, 1, later), true, null)
                        .count() == 1, "bounded items that change");
                Action end = new Action(Action.Op.TERMINATE, 0, 0, 0, 0, 0);
                Test.check(Step.hash(new Changing<>(end, 1, later)) == Step.hash(List.of(end)),
                        "actions that change");
            }
        }
    }

    private static int files(Path folder) throws Exception {
        try (Stream<Path> files = Files.list(folder)) {
            return (int) files.count();
        }
    }

    private static void texts(Path folder) throws Exception {
        // In a locale of ASCII alone java.nio.file cannot say this name; test_java.sh looks for it.
        String named = folder + "/größe-日本-\ud834\udd1e";
        try (Policy policy = new Policy("default"); Cell cell = new Cell("scara")) {
            policy.saveFile(named);
            try (Policy same = Policy.loadFile(named)) {
                Test.check(Arrays.equals(same.save(), policy.save()), "policy from a file");
            }
            try (Policy same = Policy.load(policy.save())) {
                Test.check(same.info().equals(policy.info()), "policy from bytes");
            }
            cell.saveFile(named);
            try (Cell same = Cell.loadFile(named)) {
                Test.check(same.save().equals(cell.save()), "cell from a file");
            }
            Test.fails(Status.IO, "/nö/\ud834\udd1e", "message beyond ASCII",
                    () -> Policy.loadFile("/nö/\ud834\udd1e"));
            int files = files(folder);
            Test.fails(Status.ARGUMENT, "surrogate", "path with half a character",
                    () -> policy.saveFile(folder + "/\ud800"));
            Test.fails(Status.ARGUMENT, "surrogate", "cell with half a character",
                    () -> Cell.load("\"\udc00\""));
            Test.fails(Status.ARGUMENT, "zero", "path with a zero",
                    () -> cell.saveFile(named + "\0"));
            Test.check(files(folder) == files, "nothing is written");
            Test.fails(Status.ARGUMENT, "path", "no path", () -> cell.saveFile(null));
            Test.fails(Status.IO, "", "a folder", () -> Policy.loadFile(folder.toString()));
            Test.fails(Status.ARGUMENT, "", "a long name", () -> new Policy("x".repeat(100000)));
        }
    }

    /** The text of an error is one a thread: each gets its own, whatever the cleaner frees. */
    private static void messagesOfThreads() throws Exception {
        AtomicInteger strange = new AtomicInteger();
        List<Thread> threads = new ArrayList<>();
        for (int t = 0; t < 4; ++t) {
            int width = 1000 + t;
            threads.add(new Thread(() -> {
                for (int i = 0; i < 300; ++i) {
                    new Bin(3, 3).clear(); // forgotten
                    try {
                        new Bin(width, 1);
                    } catch (PackcellException error) {
                        if (!error.getMessage().contains("width " + width + ":"))
                            strange.incrementAndGet();
                    }
                    if (i % 100 == 0) System.gc();
                }
            }));
        }
        threads.forEach(Thread::start);
        for (Thread thread : threads) thread.join();
        Test.check(strange.get() == 0, "each thread has its own message");
    }

    /** Options are no handle, but two threads may make their planners by the same ones. */
    private static void sharedOptions() throws Exception {
        AtomicInteger strange = new AtomicInteger();
        Planner.Options options = new Planner.Options().memory(65536);
        List<Thread> threads = new ArrayList<>();
        for (int t = 0; t < 3; ++t) {
            threads.add(new Thread(() -> {
                try {
                    for (int i = 0; i < 100; ++i) new Planner(options, null).close();
                } catch (RuntimeException error) {
                    strange.incrementAndGet();
                }
            }));
        }
        threads.forEach(Thread::start);
        for (Thread thread : threads) thread.join();
        Test.check(strange.get() == 0, "options of several threads");
    }

    /** A policy and a cell may be shared: no thread finds them busy. */
    private static void sharedPolicyAndCell() throws Exception {
        AtomicInteger strange = new AtomicInteger();
        try (Policy policy = new Policy("default"); Cell cell = new Cell("ur5e")) {
            List<Thread> threads = new ArrayList<>();
            for (int t = 0; t < 3; ++t) {
                threads.add(new Thread(() -> {
                    try (Bin bin = new Bin(10, 10)) {
                        for (int i = 0; i < 100; ++i) {
                            policy.select(bin, 1 + i % 5, 2);
                            cell.forward(i % 2, 0, 0, 0, 0, 0, 0);
                        }
                    } catch (RuntimeException error) {
                        strange.incrementAndGet();
                    }
                }));
            }
            threads.forEach(Thread::start);
            for (Thread thread : threads) thread.join();
        }
        Test.check(strange.get() == 0, "a policy and a cell that threads share");
    }

    static void run(Path folder) throws Exception {
        numbers(folder);
        changingLists();
        texts(folder);
        messagesOfThreads();
        sharedOptions();
        sharedPolicyAndCell();
    }
}
