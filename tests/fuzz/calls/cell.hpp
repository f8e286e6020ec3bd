// Plays with cells, schedules, their runs and traces.
#pragma once

#include <string>

#include "fuzz/calls/steps.hpp"

namespace packcell_fuzz {

// ---- Cells -------------------------------------------------------------------------------------

inline std::string text_of(const pkc_cell *cell) {
    const auto bytes = all<char>("cell_save", [&](char *to, size_t capacity, size_t *size) {
        return pkc_cell_save(cell, to, capacity, size);
    });
    return std::string(bytes.begin(), bytes.end());
}

// Another number, or other bytes, somewhere in the text.
inline void change_text(Choices &in, std::string &text) {
    static const char *const odd[] = {"0",     "-1",   "1",     "2",        "0.001", "1e-9",
                                      "1e9",   "1e99", "1e400", "-1e-300",  "null",  "true",
                                      "\"x\"", "[]",   "{}",    "99999999", "NaN",   "64"};
    if (text.empty()) return;
    size_t at = in.word() % text.size();
    if (in.seldom(6)) {
        text[at] = static_cast<char>(in.byte());
        return;
    }
    const char *const digits = "0123456789.eE+-";
    at = text.find_first_of("0123456789", at);
    if (at == std::string::npos) return;
    while (at > 0 && std::strchr(digits, text[at - 1]) != nullptr) --at;
    const size_t end = std::min(text.find_first_not_of(digits, at), text.size());
    const std::string old = text.substr(at, end - at);
    std::string value = odd[in.byte() % std::size(odd)];
    if (!in.seldom(3)) {
        const double near = std::strtod(old.c_str(), nullptr) * (0.5 + in.byte() / 170.0);
        value = std::to_string(near);
    }
    text.replace(at, end - at, value);
}

inline void new_cell(World &world) {
    Choices &in = world.in;
    Cell &cell = world.cells[in.below(2)];
    if (!cell || in.seldom(3)) {
        const char *name = pkc_cell_preset(static_cast<size_t>(in.below(4)));
        if (name == nullptr || in.seldom(20)) name = "no such cell";
        make("cell_create", cell, [&](auto **to) { return pkc_cell_create(name, to); });
        return;
    }
    std::string text = text_of(cell.get());
    const bool changed = !in.seldom(4);
    for (int n = changed ? in.from(1, 3) : 0; n > 0; --n) change_text(in, text);
    Cell loaded;
    const pkc_status status = make("cell_load", loaded, [&](auto **to) {
        return pkc_cell_load(text.data(), text.size(), to);
    });
    check(status == PKC_OK || status == PKC_E_FORMAT || status == PKC_E_ARGUMENT,
          "a cell fails by another status");
    check(changed || status == PKC_OK, "a cell cannot be loaded");
    if (status != PKC_OK) return;
    const std::string saved = text_of(loaded.get());
    Cell again;
    make("cell_load", again,
         [&](auto **to) { return pkc_cell_load(saved.data(), saved.size(), to); });
    check(again != nullptr, "a cell that was saved cannot be loaded");
    check(text_of(again.get()) == saved, "a cell is saved in another way the second time");
    cell = std::move(loaded);
}

inline void ask_cell(World &world) {
    Choices &in = world.in;
    const Cell &cell = world.cells[in.below(2)];
    if (!cell) return;
    auto info = initialised<pkc_cell_info, pkc_cell_info_init>();
    must("cell_get_info", pkc_cell_get_info(cell.get(), &info));
    check(info.arms >= 1 && info.arms <= 2 && std::isfinite(info.cycle), "a cell's info");
    const pkc_scenario scenario = draw_scenario(in);
    told("cell_check", pkc_cell_check(cell.get(), &scenario));
    const int32_t arm = in.number(0, 1);
    double pose[4], joints[PKC_MAX_JOINTS] = {}, back[4] = {};
    for (double &p : pose) p = in.real(-1, 1);
    const pkc_status status = call(
        "cell_inverse", [&] { return pkc_cell_inverse(cell.get(), arm, pose, joints); }, joints);
    if (status != PKC_OK) {
        for (double &j : joints) j = in.real(-3, 3);
    }
    const pkc_status forward = call(
        "cell_forward", [&] { return pkc_cell_forward(cell.get(), arm, joints, back); }, back);
    if (status != PKC_OK || forward != PKC_OK) return;
    for (int i = 0; i < 3; ++i)
        check(std::fabs(back[i] - pose[i]) < 1e-6, "a pose is not that of its joints");
}

// ---- Schedules ---------------------------------------------------------------------------------

inline void new_schedule(World &world) {
    Choices &in = world.in;
    Scene &scene = world.scene();
    const Cell &cell = world.cells[in.below(2)];
    if (!cell) return;
    pkc_scenario scenario = draw_scenario(in);
    if (scene.queue && !in.seldom(8)) scenario = scenario_of(scene.queue.get());
    const int32_t mode = in.number(1, 3);
    if (!scene.bin || !in.seldom(12)) new_bin_of(cell.get(), scene);
    const pkc_status status = make("schedule_create", scene.schedule, [&](auto **to) {
        return pkc_schedule_create(cell.get(), &scenario, mode, to);
    });
    if (status == PKC_OK) scene.steps = scene.releases = 0;
}

inline std::vector<pkc_place> places_of(const pkc_simulation *simulation) {
    return all<pkc_place>("simulation_places", [&](auto *to, size_t capacity, size_t *count) {
        return pkc_simulation_places(simulation, to, capacity, count);
    });
}

inline void sample(World &world) {
    Choices &in = world.in;
    Scene &scene = world.scene();
    if (!scene.schedule) return;
    const pkc_schedule_info info = info_of(scene.schedule.get());
    for (int n = in.from(1, 8); n > 0; --n) {
        const int32_t arm = in.number(0, 1);
        const double time = in.seldom(8) ? info.makespan : in.real(0, info.makespan);
        pkc_arm_sample now;
        std::memset(&now, 0x5a, sizeof now);
        const pkc_status status = call(
            "schedule_sample",
            [&] { return pkc_schedule_sample(scene.schedule.get(), arm, time, &now); }, now);
        if (status != PKC_OK) continue;
        for (const double p : now.position) check(std::isfinite(p), "a sample is not finite");
        for (const double v : now.velocity) check(std::isfinite(v), "a sample is not finite");
        for (const double a : now.acceleration) check(std::isfinite(a), "a sample is not finite");
        check(now.activity >= PKC_ACTIVITY_TRAVEL && now.activity <= PKC_ACTIVITY_WAIT &&
                  (now.reason != 0) == (now.activity == PKC_ACTIVITY_WAIT),
              "a sample's activity");
    }
}

inline void put_aside(World &world) {
    Choices &in = world.in;
    Scene &scene = world.scene();
    if (!scene.schedule) return;
    int32_t item = in.number(0, 20);
    double time = in.real(0, 60);
    const Simulation &simulation = world.simulations[in.below(2)];
    const auto places = simulation ? places_of(simulation.get()) : std::vector<pkc_place>();
    if (!places.empty() && !in.seldom(8)) {
        const pkc_place &place = in.of(places);
        item = place.item;
        time = place.time;
    }
    const pkc_schedule_info before = info_of(scene.schedule.get());
    const pkc_status status =
        told("schedule_put_aside", pkc_schedule_put_aside(scene.schedule.get(), item, time));
    const pkc_schedule_info info = info_of(scene.schedule.get());
    world.see(info.hash);
    if (status != PKC_OK) {
        check(info.hash == before.hash && info.makespan == before.makespan,
              "a call that fails changes the schedule");
        return;
    }
    check_times(info);
    // To what follows the item is an unpacked one, as a rule.
    if (scene.bin && scene.queue && !in.seldom(4)) {
        pkc_placement was{};
        if (told("bin_unpack", pkc_bin_unpack(scene.bin.get(), item, &was)) == PKC_OK) {
            told("queue_put_in_buffer",
                 pkc_queue_put_in_buffer(scene.queue.get(), &was.item, in.below(2)));
        }
    }
}

// ---- Runs and traces ---------------------------------------------------------------------------

inline void simulate(World &world) {
    Choices &in = world.in;
    Scene &scene = world.scene();
    if (!scene.schedule) return;
    const pkc_schedule_info schedule = info_of(scene.schedule.get());
    auto options = initialised<pkc_simulation_options, pkc_simulation_options_init>();
    options.hertz = in.seldom(4) ? in.number(60, 240) : 60;
    options.sigma = in.seldom(2) ? in.real(0, 0.05) : 0;
    options.sigma_yaw = in.seldom(2) ? in.real(0, 0.5) : 0;
    options.seed = in.byte();
    options.frames = in.number(0, 1);
    if (schedule.makespan > 600) return;  // slow arms: a run of many steps
    Simulation &simulation = world.simulations[in.below(2)];
    const pkc_status status = make("simulate", simulation, [&](auto **to) {
        return pkc_simulate(scene.schedule.get(), &options, to);
    });
    world.see(static_cast<uint64_t>(status));
    if (status != PKC_OK) return;
    auto info = initialised<pkc_simulation_info, pkc_simulation_info_init>();
    must("simulation_get_info", pkc_simulation_get_info(simulation.get(), &info));
    world.see(info.hash);
    check(std::isfinite(info.worst_error) && std::isfinite(info.worst_overlap), "a run's numbers");
    const auto places = places_of(simulation.get());
    check(static_cast<size_t>(info.places) == places.size(), "a run's places are not counted");
    check(info.places >= scene.releases, "a run's places are not the packs");
    double last = 0;
    int jams = 0;
    for (const pkc_place &p : places) {
        check(p.time >= last && p.time <= schedule.makespan + 1e-6, "a place's time");
        check(std::isfinite(p.error) && std::isfinite(p.turn), "a place's numbers");
        check(p.outcome >= PKC_PLACE_OK && p.outcome <= PKC_PLACE_ABSENT, "a place's outcome");
        jams += p.outcome == PKC_PLACE_JAMMED;
        last = p.time;
    }
    check(jams == info.jams, "jams are not counted");
}

// A folder of its own, that goes with the program.
class Folder {
public:
    Folder() {
        if (mkdtemp(path_) == nullptr) broken("there is no place for files");
    }
    ~Folder() {
        std::remove(file().c_str());
        std::remove(path_);
    }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;
    std::string file() const { return std::string(path_) + "/file"; }

private:
    char path_[32] = "/tmp/fuzz_calls-XXXXXX";
};

inline const std::string &scratch_file() {
    static const Folder folder;
    static const std::string path = folder.file();
    return path;
}

inline Bytes read_file(const std::string &path) {
    Bytes bytes;
    std::FILE *const file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) return bytes;
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file))
        bytes.push_back(static_cast<uint8_t>(c));
    std::fclose(file);
    return bytes;
}

inline void write_file(const std::string &path, const Bytes &bytes) {
    std::FILE *const file = std::fopen(path.c_str(), "wb");
    check(file != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size(),
          "a file cannot be written");
    std::fclose(file);
}

// Also with the run of another schedule, which is the caller's mistake alone.
inline void trace(World &world) {
    Choices &in = world.in;
    Scene &scene = world.scene();
    if (!scene.schedule) return;
    const Simulation &simulation = world.simulations[in.below(2)];
    const int32_t kind = in.number(1, 6);
    const double period = in.real(0.05, 2);
    const pkc_schedule_info info = info_of(scene.schedule.get());
    if (period > 0 && info.makespan / period > 20000) return;
    std::remove(scratch_file().c_str());
    const pkc_status status =
        told("trace_write_file", pkc_trace_write_file(scene.schedule.get(), simulation.get(), kind,
                                                      period, scratch_file().c_str()));
    const Bytes bytes = read_file(scratch_file());
    check((status == PKC_OK) == !bytes.empty(), "a trace is written by halves");
    world.see(checksum(bytes.data(), bytes.size()));
}

}  // namespace packcell_fuzz
