// packcell.hpp: the golden scenario gives in C++ what it gives in C, and mistakes are exceptions.
#include <packcell.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

extern "C" {
#include <cmocka.h>
}

using packcell::Action;
using packcell::Item;

namespace {

constexpr std::int32_t kSides[][2] = {{2, 1}, {4, 3}, {2, 2}, {4, 4}, {2, 4}, {3, 4}, {3, 2},
                                      {3, 1}, {3, 5}, {2, 2}, {2, 2}, {2, 3}, {5, 5}, {2, 4}};

// As std::span: const or not, it gives the elements.
struct View {
    std::int32_t *data() const { return nullptr; }
    std::size_t size() const { return 0; }
};

// An assertion that fails leaves by longjmp and runs no destructor: a failed test may leak.
template <class Call>
void expect_error(Call call, pkc_status status, const char *part) {
    std::string found = "no exception";
    pkc_status thrown = PKC_OK;
    try {
        call();
    } catch (const packcell::Error &error) {
        found = error.what();
        thrown = error.status();
    }
    if (found.find(part) == std::string::npos) fail_msg("'%s' lacks '%s'", found.c_str(), part);
    if (thrown != status) fail_msg("'%s': status %d", found.c_str(), static_cast<int>(thrown));
}

std::string hexadecimal(std::uint64_t hash) {
    std::ostringstream text;
    text << std::hex << std::setfill('0') << std::setw(16) << hash;
    return text.str();
}

std::string golden_hash() {
    std::ifstream file(PACKCELL_GOLDEN "/binding-plan.txt");
    std::string line;
    while (std::getline(file, line))
        if (!line.empty() && line[0] != '#') return line;
    return "nothing in tests/golden/binding-plan.txt";
}

std::uint64_t planned_in_cpp() {
    packcell::PlannerOptions options;
    options.method = PKC_METHOD_EXACT;
    options.rotation = 1;
    options.repack = PKC_REPACK_FULL;
    packcell::Planner planner(options, packcell::Policy("contact"));
    packcell::Bin bin(10, 10);
    packcell::Queue queue("D-R5A3O1");
    std::int32_t id = 0;
    for (const auto &side : kSides) queue.push({id++, side[0], side[1], 0});
    packcell::Budget budget;
    budget.nodes = 20000;
    std::vector<Action> all;
    for (bool done = false; !done;) {
        done = planner.plan(bin, queue, budget).terminate != 0;
        std::vector<Action> actions = planner.actions();
        packcell::apply(bin, queue, actions);
        all.insert(all.end(), actions.begin(), actions.end());
    }
    return packcell::plan_hash(all);
}

// The same by the C interface alone, without a check that the first one could hide behind.
std::uint64_t planned_in_c() {
    pkc_planner_options options;
    assert_int_equal(pkc_planner_options_init(&options, sizeof options), PKC_OK);
    options.method = PKC_METHOD_EXACT;
    options.rotation = 1;
    options.repack = PKC_REPACK_FULL;
    pkc_policy *policy = nullptr;
    pkc_planner *planner = nullptr;
    assert_int_equal(pkc_policy_create("contact", &policy), PKC_OK);
    assert_int_equal(pkc_planner_create(&options, policy, &planner), PKC_OK);
    pkc_scenario scenario;
    assert_int_equal(pkc_scenario_init(&scenario, sizeof scenario), PKC_OK);
    assert_int_equal(pkc_scenario_parse("D-R5A3O1", &scenario), PKC_OK);
    pkc_bin *bin = nullptr;
    pkc_queue *queue = nullptr;
    assert_int_equal(pkc_bin_create(10, 10, &bin), PKC_OK);
    assert_int_equal(pkc_queue_create(&scenario, &queue), PKC_OK);
    pkc_item item = {0, 0, 0, 0};
    for (const auto &side : kSides) {
        item.w = side[0];
        item.h = side[1];
        assert_int_equal(pkc_queue_push(queue, &item), PKC_OK);
        ++item.id;
    }
    pkc_budget budget;
    assert_int_equal(pkc_budget_init(&budget, sizeof budget), PKC_OK);
    budget.nodes = 20000;
    pkc_plan_info info;
    assert_int_equal(pkc_plan_info_init(&info, sizeof info), PKC_OK);
    static pkc_action all[8 * PKC_MAX_ACTIONS];
    size_t count = 0;
    do {
        size_t added = 0;
        assert_true(count + PKC_MAX_ACTIONS <= sizeof all / sizeof *all);
        assert_int_equal(pkc_planner_plan(planner, bin, queue, &budget, &info), PKC_OK);
        assert_int_equal(pkc_planner_result(planner, &info, all + count, PKC_MAX_ACTIONS, &added),
                         PKC_OK);
        assert_int_equal(pkc_step_apply(bin, queue, all + count, added), PKC_OK);
        count += added;
    } while (info.terminate == 0);
    uint64_t hash = 0;
    assert_int_equal(pkc_plan_hash(all, count, &hash), PKC_OK);
    pkc_queue_free(queue);
    pkc_bin_free(bin);
    pkc_planner_free(planner);
    pkc_policy_free(policy);
    return hash;
}

void the_golden_scenario_is_planned_as_in_c(void **) {
    assert_string_equal(hexadecimal(planned_in_c()).c_str(), golden_hash().c_str());
    assert_string_equal(hexadecimal(planned_in_cpp()).c_str(), golden_hash().c_str());
}

void errors_carry_status_and_line(void **) {
    expect_error([] { packcell::Bin(0, 5); }, PKC_E_ARGUMENT, "bin width 0: must be 1..128");
    expect_error([] { packcell::Policy("nobody"); }, PKC_E_ARGUMENT, "nobody");
    expect_error([] { packcell::Queue("D-R1"); }, PKC_E_ARGUMENT, "D-R1");
    expect_error([] { packcell::Policy(std::string("contact\0x", 9)); }, PKC_E_ARGUMENT, "zero");
    expect_error([] { packcell::Policy::load_file("/nowhere"); }, PKC_E_IO, "/nowhere");
    expect_error([] { packcell::Planner().result(); }, PKC_E_STATE, "");
    expect_error(
        [] {
            packcell::Bin bin(4, 4);
            bin.pack({1, 3, 3, 0}, 0, 0);
            bin.pack({2, 3, 3, 0}, 0, 0);
        },
        PKC_E_STATE, "");
    expect_error(
        [] {
            packcell::Bin bin(4, 4);
            std::int32_t cells[15];
            bin.cells(cells);
        },
        PKC_E_CAPACITY, "16");
    packcell::Budget budget;
    budget.struct_size = 7;
    expect_error(
        [&] { packcell::Planner().plan(packcell::Bin(4, 4), packcell::Queue("S-R1A1"), budget); },
        PKC_E_STRUCT, "");
    assert_string_equal(packcell::Error(PKC_E_BUSY, "").status_name(), "PKC_E_BUSY");
}

// Every member of an object that was moved from says so.
void moved_from_objects_throw(void **) {
    packcell::Bin bin(4, 4);
    packcell::Queue queue("S-R1A1");
    packcell::Policy policy("contact");
    packcell::Planner planner;
    packcell::Generator generator;
    packcell::Trainer trainer;
    packcell::Bin bin2(std::move(bin));
    packcell::Queue queue2(std::move(queue));
    packcell::Policy policy2(std::move(policy));
    packcell::Planner planner2(std::move(planner));
    packcell::Generator generator2(std::move(generator));
    packcell::Trainer trainer2(std::move(trainer));
    assert_true(!bin && !queue && !policy && !planner && !generator && !trainer);
    assert_true(bin2 && queue2 && policy2 && planner2 && generator2 && trainer2);

    Item item = {1, 1, 1, 0};
    std::vector<Action> none;
    expect_error([&] { bin.clear(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.clone(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.block(0, 0, 1, 1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.pack(item, 0, 0); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.unpack(1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.info(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.items(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.cells(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.feasible(1, 1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { bin.contact(0, 0, 1, 1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { queue.clone(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { queue.push(item); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { queue.remove(1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { queue.scenario(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { queue.info(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { queue.belt(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { queue.buffer(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { packcell::apply(bin, queue2, none); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { packcell::apply(bin2, queue, none); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { packcell::save_snapshot(bin, queue2); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { packcell::exact_pack(bin, {&item, 1}); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { packcell::bound_in_order(bin, {&item, 1}); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { policy.select(bin2, 1, 1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { policy2.select(bin, 1, 1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { policy.info(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { policy.save(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { planner.plan(bin2, queue2); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { planner2.plan(bin, queue2); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { planner2.plan(bin2, queue); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { planner.begin(bin2, queue2); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { planner.step(1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { planner.cancel(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { planner.result(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { generator.next(1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { trainer.run(1); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { trainer.cancel(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { trainer.policy(); }, PKC_E_ARGUMENT, "NULL");
    // C would take NULL for the default policy, which is not what was meant.
    expect_error([&] { packcell::Planner(packcell::PlannerOptions(), policy); }, PKC_E_ARGUMENT,
                 "moved from");
    expect_error([&] { policy.name(); }, PKC_E_ARGUMENT, "moved from");

    bin = packcell::Bin(3, 3);
    assert_int_equal(bin.info().w, 3);
    bin = std::move(bin2);
    assert_int_equal(bin.info().w, 4);
}

void handles_change_hands(void **) {
    packcell::Bin bin(5, 4);
    pkc_bin *raw = bin.release();
    assert_non_null(raw);
    assert_false(static_cast<bool>(bin));
    packcell::Bin taken(raw);
    assert_ptr_equal(taken.get(), raw);
    packcell::Bin copy = taken.clone();
    copy.block(0, 0, 1, 1);
    assert_int_equal(taken.info().fixed_cells, 0);
    assert_int_equal(copy.info().fixed_cells, 1);
    static_assert(!std::is_copy_constructible_v<packcell::Bin>);
    static_assert(std::is_nothrow_move_constructible_v<packcell::Bin>);
    static_assert(sizeof(packcell::Bin) == sizeof(pkc_bin *));
    static_assert(sizeof(packcell::PlanInfo) == sizeof(pkc_plan_info));
}

void arrays_go_into_vectors_and_into_the_callers_memory(void **) {
    packcell::Bin bin(4, 3);
    bin.block(3, 2, 1, 1);
    bin.pack({7, 2, 1, 0}, 0, 0);
    std::vector<std::int32_t> cells = bin.cells();
    assert_int_equal(cells.size(), 12);
    assert_int_equal(cells[1], 7);
    assert_int_equal(cells[11], PKC_CELL_FIXED);
    std::array<std::int32_t, 12> into{};
    assert_int_equal(bin.cells(into), 12);
    assert_memory_equal(into.data(), cells.data(), sizeof into);
    into.fill(0);
    assert_int_equal(bin.cells(packcell::Span<std::int32_t>(into)), 12);
    assert_memory_equal(into.data(), cells.data(), sizeof into);
    using Reader = packcell::Span<const std::int32_t>;
    using Writer = packcell::Span<std::int32_t>;
    static_assert(std::is_constructible_v<Reader, std::vector<std::int32_t>>);
    static_assert(!std::is_constructible_v<Writer, std::vector<std::int32_t>>);
    static_assert(!std::is_constructible_v<Writer, const std::vector<std::int32_t> &>);
    static_assert(std::is_constructible_v<Writer, View>);
    assert_int_equal(bin.items().size(), 1);
    assert_int_equal(bin.items()[0].item.id, 7);
    assert_int_equal(bin.feasible(2, 2).size(), 13);
    assert_int_equal(bin.contact(0, 1, 2, 1), 3);
    assert_int_equal(bin.unpack(7).item.w, 2);
    assert_true(bin.items().empty());

    packcell::Queue queue("S-R2A1");
    queue.push({1, 2, 2, 0});
    queue.push({2, 1, 1, PKC_ITEM_NO_ROTATE});
    queue.push({3, 1, 1, 0});
    const std::int32_t ids[] = {1, 3};
    queue.remove(ids);
    queue.push({0, 1, 1, 0});
    queue.push({3, 1, 1, 0});
    queue.remove({0, 3});
    queue.push({0, 1, 1, 0});
    queue.remove({0});
    queue.remove({});
    assert_int_equal(queue.belt().size(), 1);
    assert_int_equal(queue.belt()[0].item.flags, PKC_ITEM_NO_ROTATE);
    assert_string_equal(queue.scenario().name().c_str(), "S-R2A1");

    std::vector<std::uint8_t> bytes = packcell::save_snapshot(bin, queue);
    auto [bin2, queue2] = packcell::load_snapshot(bytes);
    assert_int_equal(bin2.info().hash, bin.info().hash);
    assert_int_equal(queue2.info().belt, 1);
    bytes[0] ^= 1;
    expect_error([&] { packcell::load_snapshot(bytes); }, PKC_E_FORMAT, "");
}

void the_exact_packer_and_the_bound_answer(void **) {
    packcell::Bin bin(4, 4);
    const std::vector<Item> items = {{0, 4, 2, 0}, {1, 2, 2, 0}, {2, 2, 2, 0}, {3, 1, 1, 0}};
    packcell::Packing all = packcell::exact_pack(bin, items);
    assert_int_equal(all.answer, PKC_PACKING_IMPOSSIBLE);
    assert_true(all.placements.empty());
    packcell::Packing three = packcell::exact_pack(bin, {items.data(), 3});
    assert_int_equal(three.answer, PKC_PACKING_FOUND);
    assert_int_equal(three.placements.size(), 3);
    packcell::Bound bound = packcell::bound_in_order(bin, items);
    assert_int_equal(bound.count, 3);
    assert_int_equal(bound.answer, PKC_PACKING_FOUND);
    assert_int_equal(packcell::exact_pack(bin, {}).answer, PKC_PACKING_FOUND);
}

void policies_are_saved_loaded_and_asked_in_batches(void **) {
    assert_true(packcell::Policy::builtins().size() > 3);
    packcell::Policy policy("default");
    std::vector<std::uint8_t> blob = policy.save();
    packcell::Policy loaded = packcell::Policy::load(blob);
    assert_int_equal(loaded.info().parameters, policy.info().parameters);
    packcell::Bin bin(10, 10);
    const pkc_bin *bins[] = {bin.get(), bin.get()};
    const std::int32_t sizes[] = {2, 3, 5, 1};
    std::int32_t positions[2] = {-1, -1};
    loaded.evaluate_batch(bins, sizes, positions);
    assert_int_equal(positions[0], policy.select(bin, 2, 3));
    assert_int_equal(positions[1], policy.select(bin, 5, 1));
    packcell::Span<std::int32_t> one(positions, 1);
    expect_error([&] { loaded.evaluate_batch(bins, sizes, one); }, PKC_E_CAPACITY, "2 bins");
    packcell::Span<const std::int32_t> three(sizes, 3);
    expect_error([&] { loaded.evaluate_batch(bins, three, positions); }, PKC_E_ARGUMENT, "3 sizes");
    std::vector<float> few(100);
    expect_error([&] { loaded.evaluate_batch(bins, sizes, positions, few); }, PKC_E_CAPACITY,
                 "2 bins");
    expect_error([&] { packcell::Policy("contact").save(); }, PKC_E_UNSUPPORTED, "");
    expect_error([&] { packcell::Policy("contact").evaluate(bin, 1, 1); }, PKC_E_UNSUPPORTED, "");
    packcell::Policy network =
        packcell::Policy::load_file(PACKCELL_GOLDEN "/fully-convolutional.pkw");
    packcell::Evaluation evaluation = network.evaluate(bin, 2, 2);
    assert_int_equal(evaluation.probabilities.size(), 101);
    float sum = 0;
    for (float probability : evaluation.probabilities) sum += probability;
    assert_true(sum > 0.99F && sum < 1.01F);
    assert_true(network.evaluate(bin, 2, 2, {}, {}) == evaluation.value);
    std::vector<float> logits(101);
    assert_true(network.evaluate(bin, 2, 2, logits, {}) == evaluation.value);
    assert_true(logits == evaluation.logits);
    expect_error(
        [&] {
            network.evaluate(bin, 2, 2, logits, {few.data(), few.size()});
        },
        PKC_E_CAPACITY, "101");
    expect_error([] { packcell::Policy::load({}); }, PKC_E_FORMAT, "0");
    expect_error([] { packcell::load_snapshot({}); }, PKC_E_FORMAT, "0");
}

void a_plan_in_slices_is_the_same(void **) {
    packcell::Planner planner;
    packcell::Bin bin(10, 10);
    packcell::Queue queue("S-R5A3");
    std::int32_t id = 0;
    for (const auto &side : kSides) queue.push({id++, side[0], side[1], 0});
    std::uint64_t hash = planner.plan(bin, queue).hash;
    planner.begin(bin, queue);
    while (!planner.step(10)) continue;
    packcell::Plan plan = planner.result();
    assert_int_equal(plan.info.hash, hash);
    assert_int_equal(packcell::plan_hash(plan.actions), hash);
    Action actions[PKC_MAX_ACTIONS];
    assert_int_equal(planner.actions(actions), plan.actions.size());
}

void generators_and_millimetres(void **) {
    packcell::GeneratorOptions options;
    options.seed = 5;
    assert_int_equal(packcell::Generator(options).next(7).size(), 7);
    options.kind = PKC_GENERATE_FULL;
    packcell::preset(options, "text");
    assert_true(options.mean == 0.5);
    std::int32_t area = 0;
    for (const Item &item : packcell::Generator(options).next(100)) area += item.w * item.h;
    assert_int_equal(area, 100);
    packcell::Grid grid;
    assert_int_equal(packcell::bin_cells(grid).w, 10);
    assert_int_equal(packcell::item_cells(grid, 31, 30).w, 2);
    assert_true(packcell::centre(grid, 0, 0, 1, 1).x > 0);
}

// In a build without the cell every one of its calls says so.
bool without_the_cell() {
    try {
        packcell::Cell("ur5e");
        return false;
    } catch (const packcell::Error &error) {
        return error.status() == PKC_E_UNSUPPORTED;
    }
}

void a_step_is_scheduled_and_simulated(void **) {
    if (without_the_cell()) skip();
    packcell::Cell cell("ur5e");
    packcell::Cell again = packcell::Cell::load(cell.save());
    assert_string_equal(again.info().name, cell.info().name);
    packcell::Scenario scenario("D-R5A3O1");
    cell.check_reach(scenario);
    packcell::Planner planner(packcell::PlannerOptions(), packcell::Policy("contact"));
    packcell::Bin bin(10, 10);
    packcell::Queue queue(scenario);
    std::int32_t id = 0;
    for (const auto &side : kSides) queue.push({id++, side[0], side[1], 0});
    planner.plan(bin, queue);
    std::vector<Action> actions = planner.actions();
    packcell::allocate(cell, queue, actions);
    packcell::Schedule schedule(cell, scenario, PKC_MODE_COORDINATED);
    schedule.add_step(bin, queue, actions);
    assert_true(schedule.info().makespan > 0);
    packcell::ArmSample sample = schedule.sample(0, schedule.info().makespan / 2);
    packcell::Joints joints{};
    std::copy(std::begin(sample.position), std::end(sample.position), joints.begin());
    packcell::Pose pose = cell.forward(0, joints);
    assert_true(std::abs(pose[0] - sample.tool[0]) < 1e-6);
    packcell::Simulation run(schedule);
    assert_int_equal(run.places().size(), static_cast<std::size_t>(run.info().places));
    packcell::Simulation gone(std::move(run));
    expect_error([&] { run.info(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { packcell::write_trace(schedule, run, PKC_TRACE_GANTT, "/nowhere/x"); },
                 PKC_E_ARGUMENT, "moved from");
    expect_error([&] { packcell::write_trace(schedule, gone, PKC_TRACE_GANTT, "/nowhere/x"); },
                 PKC_E_IO, "/nowhere/x");
    packcell::Schedule taken(std::move(schedule));
    expect_error([&] { schedule.add_step(bin, queue, actions); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { packcell::Simulation simulation(schedule); }, PKC_E_ARGUMENT, "NULL");
    packcell::Cell moved(std::move(cell));
    expect_error([&] { cell.save(); }, PKC_E_ARGUMENT, "NULL");
    expect_error([&] { packcell::allocate(cell, queue, actions); }, PKC_E_ARGUMENT, "NULL");
}

// One handle in two threads: the loser of a race gets an Error, whichever it is, and nothing
// breaks.
void a_handle_in_two_threads_is_busy_for_one(void **) {
    packcell::Bin bin(100, 100);
    int others = 0;
    auto work = [&bin](int *wrong) {
        for (int i = 0; i < 2000; ++i) {
            try {
                bin.feasible(5, 5);
            } catch (const packcell::Error &error) {
                if (error.status() != PKC_E_BUSY) ++*wrong;
            }
        }
    };
    int wrong = 0;
    std::thread other(work, &others);
    work(&wrong);
    other.join();
    assert_int_equal(wrong + others, 0);
    assert_int_equal(bin.info().items, 0);
}

// A plan that takes long enough to be met, and is cancelled from the thread that met it.
void a_planner_that_plans_is_busy_and_can_be_cancelled(void **) {
    packcell::GeneratorOptions big;
    big.w = big.h = 40;
    packcell::Bin bin(40, 40);
    packcell::Queue queue("S-R12A3");
    for (const Item &item : packcell::Generator(big).next(30)) queue.push(item);
    packcell::PlannerOptions options;
    options.repack = PKC_REPACK_ANYTIME;
    packcell::Planner planner(options);
    packcell::Budget budget;
    budget.nodes = 0;
    budget.milliseconds = 20000;
    bool busy = false;
    bool planned = false;
    for (int round = 0; round < 20 && !busy; ++round) {  // until both threads' calls have met
        std::atomic<bool> ended{false};
        bool second = false;
        planned = false;
        std::thread other([&] {
            try {
                planner.plan(bin, queue, budget);
                planned = true;
            } catch (const packcell::Error &error) {
                second = error.status() == PKC_E_BUSY;
            }
            ended = true;
        });
        while (!busy && !ended) {
            try {
                planner.step(1);
            } catch (const packcell::Error &error) {
                busy = error.status() == PKC_E_BUSY && *error.what() != 0;
            }
        }
        while (!ended) planner.cancel();
        other.join();
        busy = busy || second;
    }
    assert_true(busy);
    if (planned) assert_false(planner.actions().empty());
}

void environments_are_stepped_and_seen(void **) {
    packcell::EnvironmentOptions options;
    options.count = 3;
    options.rotation = PKC_ROTATION_ON;
    packcell::Environment environment(options);
    const auto actions = static_cast<std::size_t>(environment.info().actions);
    assert_int_equal(actions, 201);
    environment.reset(7);
    std::vector<std::uint8_t> cells(300), mask(3 * actions), closed(3), one_mask(actions);
    std::vector<std::int32_t> sizes(6), occupied(3), chosen(3), contacts(3), which = {1};
    std::vector<double> rewards(3);
    for (int steps = 0; steps < 50; ++steps) {
        environment.observe(cells, sizes, mask, occupied);
        environment.observe(which, {}, {}, one_mask, {});
        assert_memory_equal(one_mask.data(), mask.data() + actions, actions);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto row = mask.begin() + static_cast<std::ptrdiff_t>(i * actions);
            chosen[i] = static_cast<std::int32_t>(std::find(row, row + 201, 1) - row);
        }
        environment.step(chosen, rewards, contacts, closed);
        for (std::size_t i = 0; i < 3; ++i)
            assert_true(std::abs(rewards[i] - contacts[i] / 20.0) < 1e-12);
        environment.open();
    }
    assert_int_equal(environment.info().steps, 150);
    assert_true(environment.info().bins > 0);
    environment.reset();
    const std::vector<std::uint64_t> seeds = {1, 2, 3};
    environment.reset(seeds);
    std::vector<double> few(2);
    chosen.assign(3, 0);
    expect_error([&] { environment.step(chosen, few); }, PKC_E_CAPACITY, "must hold 3");
    expect_error([&] { environment.observe(cells, {}, one_mask); }, PKC_E_CAPACITY, "must hold");
    expect_error([&] { environment.reset(packcell::Span<const std::uint64_t>()); }, PKC_E_ARGUMENT,
                 "no seeds");
    assert_int_equal(environment.info().steps, 150);
    environment.step(chosen, rewards);
    expect_error([&] { environment.step(chosen, rewards); }, PKC_E_ARGUMENT, "action 0 of bin 0");
}

}  // namespace

int main() {
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_golden_scenario_is_planned_as_in_c),
        cmocka_unit_test(errors_carry_status_and_line),
        cmocka_unit_test(moved_from_objects_throw),
        cmocka_unit_test(handles_change_hands),
        cmocka_unit_test(arrays_go_into_vectors_and_into_the_callers_memory),
        cmocka_unit_test(the_exact_packer_and_the_bound_answer),
        cmocka_unit_test(policies_are_saved_loaded_and_asked_in_batches),
        cmocka_unit_test(a_plan_in_slices_is_the_same),
        cmocka_unit_test(generators_and_millimetres),
        cmocka_unit_test(environments_are_stepped_and_seen),
        cmocka_unit_test(a_step_is_scheduled_and_simulated),
        cmocka_unit_test(a_handle_in_two_threads_is_busy_for_one),
        cmocka_unit_test(a_planner_that_plans_is_busy_and_can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
