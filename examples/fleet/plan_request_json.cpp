#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "common/packing_options.hpp"
#include "fleet/json_fields.hpp"
#include "fleet/plan_json.hpp"

namespace packcell_programs {

namespace {

using Json = nlohmann::ordered_json;
using Value = nlohmann::json;

constexpr size_t kDepth = 6;  // {"bin":{"items":[{...}]}} is four
constexpr size_t kLongestTopic = 500;
constexpr size_t kLongestScenario = 31;
constexpr int32_t kMostId = INT32_MAX;
constexpr int32_t kMostItems = 16384;
constexpr int32_t kMostKnown = 128;
constexpr int32_t kMostBuffered = 4096;
constexpr int32_t kMostSelected = 128;
constexpr int32_t kMostAlphaLeft = 64;
constexpr uint64_t kLeastMemory = 65536;

const std::vector<std::string> kRepacks{"off", "anytime", "full"};  // by PKC_REPACK_*
const std::vector<std::string> kMethods{"paper", "exact"};          // by PKC_METHOD_* - 1

// ---- Writing -----------------------------------------------------------------------------------

Json item_json(const pkc_item &item) { return Json{{"id", item.id}, {"w", item.w}, {"h", item.h}}; }

void add_flags(Json &json, const pkc_item &item) {
    if ((item.flags & PKC_ITEM_NO_ROTATE) != 0) json["no_rotate"] = true;
    if ((item.flags & PKC_ITEM_PINNED) != 0) json["pinned"] = true;
}

// The fixed cells as few rectangles, each as wide and then as high as it can be.
Json fixed_json(std::vector<int32_t> cells, int32_t w, int32_t h) {
    const auto fixed = [&](int32_t x, int32_t y) -> int32_t & {
        return cells[static_cast<size_t>(x + y * w)];
    };
    Json rectangles = Json::array();
    for (int32_t y = 0; y < h; ++y) {
        for (int32_t x = 0; x < w; ++x) {
            if (fixed(x, y) != PKC_CELL_FIXED) continue;
            int32_t right = x;
            while (right < w && fixed(right, y) == PKC_CELL_FIXED) ++right;
            int32_t below = y;
            for (bool whole = true; whole && below < h;) {
                for (int32_t i = x; i < right; ++i) whole &= fixed(i, below) == PKC_CELL_FIXED;
                if (!whole) break;
                for (int32_t i = x; i < right; ++i) fixed(i, below) = PKC_CELL_FREE;
                ++below;
            }
            rectangles.push_back(Json::array({x, y, right - x, below - y}));
        }
    }
    return rectangles;
}

Json bin_json(const pkc_bin *bin) {
    auto info = initialised(pkc_bin_info_init);
    check(pkc_bin_get_info(bin, &info));
    Json json{{"w", info.w}, {"h", info.h}};
    Json items = Json::array();
    for (const pkc_placement &placement : items_of(bin)) {
        Json item = item_json(placement.item);
        item["x"] = placement.x;
        item["y"] = placement.y;
        item["rot"] = placement.rot;
        add_flags(item, placement.item);
        items.push_back(std::move(item));
    }
    json["items"] = std::move(items);
    if (info.fixed_cells > 0) {
        json["fixed"] = fixed_json(
            all_of<std::vector<int32_t>>([bin](int32_t *out, size_t capacity, size_t *count) {
                return pkc_bin_cells(bin, out, capacity, count);
            }),
            info.w, info.h);
    }
    return json;
}

template <typename List>
std::vector<pkc_queued> queued(const pkc_queue *queue, List list) {
    return all_of<std::vector<pkc_queued>>([=](pkc_queued *out, size_t capacity, size_t *count) {
        return list(queue, out, capacity, count);
    });
}

void add_queue(Json &json, const pkc_queue *queue) {
    Json belt = Json::array();
    for (const pkc_queued &entry : queued(queue, pkc_queue_belt)) {
        Json item = item_json(entry.item);
        add_flags(item, entry.item);
        belt.push_back(std::move(item));
    }
    Json buffers = Json::array();
    for (const pkc_queued &entry : queued(queue, pkc_queue_buffer)) {
        Json item = item_json(entry.item);
        item["arm"] = entry.arms == 2 ? 1 : 0;  // a mask
        add_flags(item, entry.item);
        buffers.push_back(std::move(item));
    }
    json["belt"] = std::move(belt);
    json["buffers"] = std::move(buffers);
    json["alpha_left"] = queue_info(queue).alpha_left;
}

void add_settings(Json &json, const PlanSettings &settings) {
    const pkc_planner_options &planner = settings.planner;
    const auto defaults = initialised(pkc_planner_options_init);
    json["scenario"] = name_of(settings.scenario);
    json["rotation"] = planner.rotation != 0;
    json["repack"] = kRepacks.at(static_cast<size_t>(planner.repack));
    json["method"] = kMethods.at(static_cast<size_t>(planner.method - 1));
    json["buffer"] = planner.buffer_capacity;
    json["policy"] = settings.policy;
    const auto add_unless_default = [&](const char *name, auto value, auto usual) {
        if (value != usual) json[name] = value;
    };
    add_unless_default("select", planner.select, defaults.select);
    add_unless_default("skip", planner.skip != 0, defaults.skip != 0);
    add_unless_default("max_side", planner.max_side, defaults.max_side);
    add_unless_default("max_items", planner.max_items, defaults.max_items);
    add_unless_default("max_known", planner.max_known, defaults.max_known);
    add_unless_default("memory", planner.memory, defaults.memory);
}

// ---- Reading -----------------------------------------------------------------------------------

// The library says which rule was broken, the path where.
void check_at(const std::string &path, pkc_status status) {
    if (status != PKC_OK) throw FieldFault("field '" + path + "': " + pkc_last_error());
}

pkc_item read_item(const Fields &fields, std::set<int32_t> &ids) {
    pkc_item item{};
    item.id = fields.small("id", 0, kMostId);
    item.w = fields.small("w", 1, PKC_MAX_SIDE);
    item.h = fields.small("h", 1, PKC_MAX_SIDE);
    if (fields.flag("no_rotate", false)) item.flags |= PKC_ITEM_NO_ROTATE;
    if (fields.flag("pinned", false)) item.flags |= PKC_ITEM_PINNED;
    if (!ids.insert(item.id).second) {
        throw FieldFault("field '" + fields.path("id") + "' " + std::to_string(item.id) +
                         ": must be in the request once");
    }
    return item;
}

BinHandle read_bin(const Fields &fields, std::set<int32_t> &ids) {
    const int32_t w = fields.small("w", 1, PKC_MAX_SIDE);
    const int32_t h = fields.small("h", 1, PKC_MAX_SIDE);
    BinHandle bin = make_bin(w, h);
    const Value &fixed = fields.list("fixed");
    for (size_t i = 0; i < fixed.size(); ++i) {
        const std::string path = fields.element("fixed", i);
        if (!fixed[i].is_array() || fixed[i].size() != 4) {
            refuse_field(path, fixed[i], "[x,y,w,h]");
        }
        int32_t rectangle[4];
        for (size_t k = 0; k < 4; ++k) {
            rectangle[k] =
                static_cast<int32_t>(whole_value(fixed[i][k], path, k < 2 ? 0 : 1, PKC_MAX_SIDE));
        }
        check_at(path,
                 pkc_bin_block(bin.get(), rectangle[0], rectangle[1], rectangle[2], rectangle[3]));
    }
    const Value &items = fields.list("items");
    for (size_t i = 0; i < items.size(); ++i) {
        const std::string path = fields.element("items", i);
        const Fields placed(items[i], path);
        const pkc_item item = read_item(placed, ids);
        const int32_t x = placed.small("x", 0, PKC_MAX_SIDE - 1);
        const int32_t y = placed.small("y", 0, PKC_MAX_SIDE - 1);
        const auto rot = static_cast<int32_t>(placed.whole("rot", 0, 1, 0));
        check_at(path, pkc_bin_pack(bin.get(), &item, x, y, rot));
    }
    return bin;
}

QueueHandle read_queue(const Fields &fields, const pkc_scenario &scenario, std::set<int32_t> &ids) {
    QueueHandle queue = make_queue(scenario);
    const Value &belt = fields.list("belt");
    for (size_t i = 0; i < belt.size(); ++i) {
        const std::string path = fields.element("belt", i);
        const pkc_item item = read_item(Fields(belt[i], path), ids);
        check_at(path, pkc_queue_push(queue.get(), &item));
    }
    const Value &buffers = fields.list("buffers");
    for (size_t i = 0; i < buffers.size(); ++i) {
        const std::string path = fields.element("buffers", i);
        const Fields buffered(buffers[i], path);
        const pkc_item item = read_item(buffered, ids);
        const int32_t arm = buffered.small("arm", 0, scenario.robots - 1);
        check_at(path, pkc_queue_put_in_buffer(queue.get(), &item, arm));
    }
    const auto alpha_left = static_cast<int32_t>(fields.whole("alpha_left", 0, kMostAlphaLeft, 0));
    check_at("alpha_left", pkc_queue_set_alpha_left(queue.get(), alpha_left));
    return queue;
}

void read_settings(const Fields &fields, PlanSettings &settings) {
    const std::string scenario = fields.text("scenario", kLongestScenario);
    check_at("scenario", pkc_scenario_parse(scenario.c_str(), &settings.scenario));
    pkc_planner_options &planner = settings.planner;
    const auto defaulted = [&](const char *name, int32_t least, int32_t most, int32_t &value) {
        value = static_cast<int32_t>(fields.whole(name, least, most, value));
    };
    planner.rotation = fields.flag("rotation", planner.rotation != 0) ? 1 : 0;
    planner.repack = static_cast<int32_t>(
        fields.choice("repack", kRepacks, static_cast<size_t>(planner.repack)));
    planner.method = static_cast<int32_t>(fields.choice("method", kMethods,
                                                        static_cast<size_t>(planner.method - 1))) +
                     1;
    defaulted("select", PKC_SELECT_AUTO, kMostSelected, planner.select);
    defaulted("buffer", PKC_UNLIMITED, kMostBuffered, planner.buffer_capacity);
    planner.skip = fields.flag("skip", planner.skip != 0) ? 1 : 0;
    defaulted("max_side", 1, PKC_MAX_SIDE, planner.max_side);
    defaulted("max_items", 1, kMostItems, planner.max_items);
    defaulted("max_known", 1, kMostKnown, planner.max_known);
    planner.memory = static_cast<uint64_t>(fields.whole("memory", kLeastMemory, kMostPlanMemory,
                                                        static_cast<int64_t>(planner.memory)));
    // Never a file's name: a request from elsewhere opens nothing here.
    if (fields.has("policy")) {
        const std::vector<std::string> names = policy_names();
        settings.policy = names[fields.choice("policy", names)];
    }
}

PlanJob read_job(const Fields &fields, const std::string &id) {
    PlanJob job;
    job.id = id;
    job.reply_to = fields.text("reply_to", kLongestTopic, "");
    read_settings(fields, job.settings);
    job.request.milliseconds = fields.real("deadline_ms", 0, kMostPlanMilliseconds);
    job.nodes = fields.count("nodes", 0);
    std::set<int32_t> ids;
    job.request.bin = read_bin(Fields(fields.need("bin"), "bin"), ids);
    job.request.queue = read_queue(fields, job.settings.scenario, ids);
    return job;
}

}  // namespace

std::string write_plan_request(const PlanJob &job, const PlanRequest &request,
                               double milliseconds) {
    Json json{{"version", kPlanVersion}, {"id", job.id}};
    if (!job.reply_to.empty()) json["reply_to"] = job.reply_to;
    add_settings(json, job.settings);
    json["deadline_ms"] = milliseconds;
    json["nodes"] = job.nodes;
    json["bin"] = bin_json(request.bin.get());
    add_queue(json, request.queue.get());
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

PlanJob read_plan_request(std::string_view text) {
    std::string id;
    try {
        const Value object = parse_object(text, kMostPlanBytes, kDepth);
        const Fields fields(object, "");
        id = fields.text("id", kLongestPlanId);
        fields.whole("version", kPlanVersion, kPlanVersion);
        return read_job(fields, id);
    } catch (const FieldFault &fault) {
        throw PlanFault(id, fault.what());
    } catch (const LibraryError &error) {
        throw PlanFault(id, error.what());
    }
}

uint64_t plan_fingerprint(const PlanJob &job) {
    Json json;
    add_settings(json, job.settings);
    json["nodes"] = job.nodes;
    json["bin"] = bin_json(job.request.bin.get());
    add_queue(json, job.request.queue.get());
    uint64_t hash = 14695981039346656037u;  // FNV-1a 64
    for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
        hash = (hash ^ static_cast<uint8_t>(c)) * 1099511628211u;
    }
    return hash;
}

}  // namespace packcell_programs
