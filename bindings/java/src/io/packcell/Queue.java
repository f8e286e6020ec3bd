package io.packcell;

import com.sun.jna.Pointer;
import java.util.List;

/** The conveyor and one buffer an arm. */
public final class Queue extends Handle {
    private static final Raw LIBRARY = Raw.LIBRARY;

    /**
     * Items on the conveyor and in the buffers; those that only arm 0, both arms (or the one there
     * is), and only arm 1 reach; and those that stayed in arm 0's region when the conveyor last
     * moved, for setAlphaLeft.
     */
    public record Info(int belt, int buffered, int kAlpha, int kShared, int kBeta, int alphaLeft) {}

    /** An empty one. */
    public Queue(Scenario scenario) {
        this(create(Scenario.raw(scenario)));
    }

    /** By the scenario's name. */
    public Queue(String scenario) {
        this(Scenario.parse(scenario));
    }

    Queue(Pointer pointer) {
        super(pointer, LIBRARY::pkc_queue_free);
    }

    private static Pointer create(Raw.pkc_scenario scenario) {
        return Native.made(out -> LIBRARY.pkc_queue_create(scenario, out));
    }

    /** A queue of its own with the same items. */
    public Queue copy() {
        return new Queue(Native.made(this, p -> out -> LIBRARY.pkc_queue_clone(p, out)));
    }

    /** An item arrives at the conveyor's end. STATE if the queue holds its id already. */
    public void push(Item item) {
        Raw.pkc_item raw = Item.raw(item);
        Native.check(this, p -> LIBRARY.pkc_queue_push(p, raw));
    }

    /** An item leaves without being packed; the conveyor advances. STATE if it is not there. */
    public void remove(int id) {
        Native.check(this, p -> LIBRARY.pkc_queue_remove(p, id));
    }

    /** Several leave at once, all or none, and the conveyor advances as after a step. */
    public void removeItems(int... ids) {
        long count = ids == null ? 1 : ids.length;
        Native.check(this, p -> LIBRARY.pkc_queue_remove_items(p, ids, count));
    }

    /**
     * An item comes into an arm's buffer, 0 or 1, from without: a queue rebuilt from a message, or
     * an item unpacked outside a planned step. STATE if the queue holds its id already.
     */
    public void putInBuffer(Item item, int arm) {
        Raw.pkc_item raw = Item.raw(item);
        Native.check(this, p -> LIBRARY.pkc_queue_put_in_buffer(p, raw, arm));
    }

    /**
     * Arranges the regions as if so many items, 0..64, had stayed in arm 0's: for a queue rebuilt
     * from a message, with the alphaLeft of its info.
     */
    public void setAlphaLeft(int items) {
        Native.check(this, p -> LIBRARY.pkc_queue_set_alpha_left(p, items));
    }

    /** The one that it was made for. */
    public Scenario scenario() {
        Raw.pkc_scenario raw = Scenario.fresh();
        Native.check(this, p -> LIBRARY.pkc_queue_get_scenario(p, raw));
        return Scenario.from(raw);
    }

    /** How many items are where. */
    public Info info() {
        Raw.pkc_queue_info raw = new Raw.pkc_queue_info();
        Native.check(LIBRARY.pkc_queue_info_init(raw, raw.size()));
        Native.check(this, p -> LIBRARY.pkc_queue_get_info(p, raw));
        return new Info(raw.belt, raw.buffered, raw.k_alpha, raw.k_shared, raw.k_beta,
                raw.alpha_left);
    }

    /** The conveyor's items in arrival order. */
    public List<Queued> belt() {
        return Native.structsOf(this, new Raw.pkc_queued(), Queued::from,
                p -> (a, n, count) -> LIBRARY.pkc_queue_belt(p, a, n, count));
    }

    /** The buffered ones in the order they were unpacked. */
    public List<Queued> buffer() {
        return Native.structsOf(this, new Raw.pkc_queued(), Queued::from,
                p -> (a, n, count) -> LIBRARY.pkc_queue_buffer(p, a, n, count));
    }
}
