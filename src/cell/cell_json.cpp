#include "cell/cell_json.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "base/status.h"

namespace packcell {

namespace {

// Keeps the order in which fields are written.
using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

double radians(double degrees) { return degrees * kPi / 180; }

// ---- Reading ------------------------------------------------------------------------------------

// A value as an error line shows it.
std::string shown(const Json &value) {
    if (value.is_object()) return "{...}";
    if (value.is_array()) return "[...]";
    std::string text = value.dump(-1, ' ', true);
    if (text.size() > 40) text = text.substr(0, 37) + "...";
    return text;
}

[[noreturn]] void fail_at(const std::string &path, const Json &value, const char *allowed) {
    fail(Status::kFormat, "%s %s: must be %s", path.c_str(), shown(value).c_str(), allowed);
}

// A value and its path, like arms[1].base.
class Field {
public:
    Field(const Json &value, std::string path) : value_(&value), path_(std::move(path)) {}

    const Json &value() const { return *value_; }
    const std::string &path() const { return path_; }

    double number() const {
        if (!value_->is_number()) fail_at(path_, *value_, "a number");
        return value_->get<double>();
    }

    double angle() const {
        if (value_->is_number()) return radians(value_->get<double>());
        if (!value_->is_array() || value_->size() != 2)
            fail_at(path_, *value_, "a number or a list of 2");
        return radians(entry(0).number()) + radians(entry(1).number());
    }

    const std::string &text() const {
        if (!value_->is_string()) fail_at(path_, *value_, "a text");
        return value_->get_ref<const std::string &>();
    }

    size_t list(size_t least, size_t most) const {
        char allowed[64];
        if (least == most) {
            std::snprintf(allowed, sizeof allowed, "a list of %zu", least);
        } else {
            std::snprintf(allowed, sizeof allowed, "a list of %zu to %zu", least, most);
        }
        if (!value_->is_array() || value_->size() < least || value_->size() > most)
            fail_at(path_, *value_, allowed);
        return value_->size();
    }

    Field entry(size_t i) const { return {(*value_)[i], path_ + "[" + std::to_string(i) + "]"}; }

    Point point() const {
        list(2, 2);
        return {entry(0).number(), entry(1).number()};
    }

    // A name that fits; the struct's other bytes are zero.
    template <size_t size>
    void name(char (&out)[size]) const {
        const std::string &t = text();
        bool plain = t.size() < size;
        for (const char c : t) plain = plain && c >= ' ' && c <= '~';
        if (!plain) {
            char allowed[64];
            std::snprintf(allowed, sizeof allowed, "at most %zu characters of ASCII", size - 1);
            fail_at(path_, *value_, allowed);
        }
        std::memset(out, 0, size);
        std::memcpy(out, t.data(), t.size());
    }

private:
    const Json *value_;
    std::string path_;
};

// An object whose fields are asked for one by one; at the end none may be left.
class Object {
public:
    explicit Object(const Field &field) : field_(field) {
        if (!field.value().is_object()) fail_at(named(""), field.value(), "an object");
    }

    Field operator[](const char *key) {
        const auto at = field_.value().find(key);
        if (at == field_.value().end()) fail(Status::kFormat, "%s: missing", named(key).c_str());
        known_.insert(key);
        return {*at, named(key)};
    }

    void finish() const {
        for (const auto &[key, value] : field_.value().items()) {
            if (known_.count(key) != 0) continue;
            const std::string quoted = shown(Json(key));
            fail(Status::kFormat, "%s: unknown field %s", named("").c_str(), quoted.c_str());
        }
    }

private:
    std::string named(const std::string &key) const {
        if (field_.path().empty()) return key.empty() ? "cell" : key;
        return key.empty() ? field_.path() : field_.path() + "." + key;
    }

    Field field_;
    std::set<std::string> known_;
};

ArmModel read_figures(const Field &field) {
    ArmModel arm{};
    Object o(field);
    o["name"].name(arm.name);
    const Field kind = o["kind"];
    if (kind.text() == "polar") {
        arm.kind = ArmKind::kPolar;
    } else if (kind.text() == "scara") {
        arm.kind = ArmKind::kScara;
    } else {
        fail_at(kind.path(), kind.value(), "\"polar\" or \"scara\"");
    }
    const bool polar = arm.kind == ArmKind::kPolar;
    arm.joints = polar ? 6 : 4;
    const Field joints = o["joints"];
    const size_t count = static_cast<size_t>(arm.joints);
    joints.list(count, count);
    for (size_t i = 0; i < count; ++i) {
        Object joint(joints.entry(i));
        JointLimit &limit = arm.limits[i];
        JointMap &map = arm.map[i];
        if (!polar && i == 2) {  // the vertical axis
            limit = {joint["least"].number(), joint["most"].number(), joint["velocity"].number(),
                     joint["acceleration"].number()};
            map = {joint["sign"].number(), joint["zero"].number()};
        } else {
            limit = {joint["least_deg"].angle(), joint["most_deg"].angle(),
                     joint["velocity_deg"].angle(), joint["acceleration_deg"].angle()};
            map = {joint["sign"].number(), joint["zero_deg"].angle()};
        }
        if (polar) {
            Object dh(joint["dh"]);
            arm.dh[i] = {dh["a"].number(), dh["alpha_deg"].angle(), dh["d"].number(),
                         dh["offset_deg"].angle()};
            dh.finish();
        }
        joint.finish();
    }
    arm.shoulder = o["shoulder"].number();
    arm.upper = o["upper"].number();
    arm.fore = o["fore"].number();
    arm.wrist = o["wrist"].number();
    arm.lateral = o["lateral"].number();
    arm.drop = o["drop"].number();
    arm.tool = o["tool"].number();
    arm.least_reach = o["least_reach"].number();
    arm.most_reach = o["most_reach"].number();
    arm.body_radius = o["body_radius"].number();
    arm.tool_radius = o["tool_radius"].number();
    o.finish();
    return arm;
}

ArmModel read_model(const Field &field) {
    if (field.value().is_object()) return read_figures(field);
    std::string names;
    for (int i = 0; arm_model_name(i) != nullptr; ++i) {
        if (field.value() == arm_model_name(i)) return arm_model(arm_model_name(i));
        names += std::string(arm_model_name(i)) + ", ";
    }
    fail_at(field.path(), field.value(), (names + "or an object").c_str());
}

ArmPlace read_arm(const Field &field) {
    ArmPlace arm;
    Object o(field);
    arm.model = read_model(o["model"]);
    Object base(o["base"]);
    arm.base = {base["x"].number(), base["y"].number(), base["z"].number(),
                base["yaw_deg"].angle()};
    base.finish();
    arm.home = o["home"].point();
    const Field buffer = o["buffer"];
    const size_t slots = buffer.list(0, kMaxBufferSlots);
    for (size_t i = 0; i < slots; ++i) arm.buffer.push_back(buffer.entry(i).point());
    o.finish();
    return arm;
}

BeltPlace read_belt(const Field &field) {
    BeltPlace belt;
    Object o(field);
    belt.centre = o["centre"].point();
    belt.direction = o["direction_deg"].angle();
    belt.pitch = o["pitch"].number();
    belt.speed = o["speed"].number();
    belt.acceleration = o["acceleration"].number();
    o.finish();
    return belt;
}

BinPlace read_bin(const Field &field) {
    BinPlace bin;
    Object o(field);
    bin.centre = o["centre"].point();
    bin.grid.bin_w = o["w_mm"].number();
    bin.grid.bin_h = o["h_mm"].number();
    bin.grid.margin = o["margin_mm"].number();
    bin.grid.cell = o["cell_mm"].number();
    bin.grid.clearance = o["clearance_mm"].number();
    bin.wall = o["wall"].number();
    bin.gap = o["gap"].number();
    bin.chamfer = o["chamfer"].number();
    o.finish();
    return bin;
}

Dwells read_dwells(const Field &field) {
    Dwells dwells;
    Object o(field);
    dwells.stroke = o["stroke"].number();
    dwells.stroke_speed = o["stroke_speed"].number();
    dwells.stroke_acceleration = o["stroke_acceleration"].number();
    dwells.grip = o["grip"].number();
    dwells.release = o["release"].number();
    dwells.scale = o["scale"].number();
    o.finish();
    return dwells;
}

void read_times(const Field &field, double (&times)[2][2]) {
    field.list(2, 2);
    for (size_t i = 0; i < 2; ++i) {
        const Field row = field.entry(i);
        row.list(2, 2);
        for (size_t j = 0; j < 2; ++j) times[i][j] = row.entry(j).number();
    }
}

LawKind read_law(const Field &field) {
    if (field.text() == "trapezoid") return LawKind::kTrapezoid;
    if (field.text() == "s-curve") return LawKind::kSCurve;
    fail_at(field.path(), field.value(), "\"trapezoid\" or \"s-curve\"");
}

// Line and column, from 1, of a byte counted from 1.
std::string position(const std::string &text, size_t byte) {
    size_t line = 1;
    size_t column = 1;
    for (size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
        ++column;
        if (text[i] != '\n') continue;
        ++line;
        column = 1;
    }
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

Json parse(const std::string &text) {
    // To the library a zero byte is the end.
    const size_t zero = text.find('\0');
    if (zero != std::string::npos)
        fail(Status::kFormat, "%s: is not JSON", position(text, zero + 1).c_str());
    // The library would let the last of two fields with one name win.
    std::vector<std::set<std::string>> keys;
    const auto watch = [&keys](int, Json::parse_event_t event, Json &parsed) {
        if (event == Json::parse_event_t::object_start) keys.emplace_back();
        if (event == Json::parse_event_t::object_end) keys.pop_back();
        if (event == Json::parse_event_t::key &&
            !keys.back().insert(parsed.get<std::string>()).second)
            fail(Status::kFormat, "field %s: given twice", shown(parsed).c_str());
        return true;
    };
    try {
        return Json::parse(text, watch);
    } catch (const Json::parse_error &e) {
        fail(Status::kFormat, "%s: is not JSON", position(text, e.byte).c_str());
    } catch (const Json::out_of_range &) {
        fail(Status::kFormat, "a number is too large");
    }
}

// ---- Writing ------------------------------------------------------------------------------------

// Degrees that angle() reads as these radians.
Json degrees(double value) {
    if (value == 0) return value;  // with its sign
    const double near = value * 180 / kPi;
    char text[32];
    std::snprintf(text, sizeof text, "%.15g", near);
    const double candidates[] = {Json::parse(text).get<double>(), near,
                                 std::nextafter(near, HUGE_VAL), std::nextafter(near, -HUGE_VAL)};
    for (const double degrees : candidates)
        if (radians(degrees) == value) return degrees;
    // Doubles lie closer to each other in radians than in degrees there.
    return {near, (value - radians(near)) * 180 / kPi};
}

Json point(Point p) { return {p.x, p.y}; }

Json figures(const ArmModel &arm) {
    const bool polar = arm.kind == ArmKind::kPolar;
    Json joints = Json::array();
    for (size_t i = 0; i < static_cast<size_t>(arm.joints); ++i) {
        const JointLimit &limit = arm.limits[i];
        const JointMap &map = arm.map[i];
        Json joint;
        if (!polar && i == 2) {
            joint = {{"least", limit.least},       {"most", limit.most},
                     {"velocity", limit.velocity}, {"acceleration", limit.acceleration},
                     {"sign", map.sign},           {"zero", map.zero}};
        } else {
            joint = {{"least_deg", degrees(limit.least)},
                     {"most_deg", degrees(limit.most)},
                     {"velocity_deg", degrees(limit.velocity)},
                     {"acceleration_deg", degrees(limit.acceleration)},
                     {"sign", map.sign},
                     {"zero_deg", degrees(map.zero)}};
        }
        if (polar) {
            const DhRow &dh = arm.dh[i];
            joint["dh"] = {{"a", dh.a},
                           {"alpha_deg", degrees(dh.alpha)},
                           {"d", dh.d},
                           {"offset_deg", degrees(dh.offset)}};
        }
        joints.push_back(joint);
    }
    return {{"name", arm.name},
            {"kind", polar ? "polar" : "scara"},
            {"joints", joints},
            {"shoulder", arm.shoulder},
            {"upper", arm.upper},
            {"fore", arm.fore},
            {"wrist", arm.wrist},
            {"lateral", arm.lateral},
            {"drop", arm.drop},
            {"tool", arm.tool},
            {"least_reach", arm.least_reach},
            {"most_reach", arm.most_reach},
            {"body_radius", arm.body_radius},
            {"tool_radius", arm.tool_radius}};
}

Json model(const ArmModel &arm) {
    Json all = figures(arm);
    for (int i = 0; arm_model_name(i) != nullptr; ++i)
        if (all == figures(arm_model(arm_model_name(i)))) return arm_model_name(i);
    return all;
}

Json arm_place(const ArmPlace &arm) {
    Json buffer = Json::array();
    for (const Point &slot : arm.buffer) buffer.push_back(point(slot));
    return {{"model", model(arm.model)},
            {"base",
             {{"x", arm.base.x},
              {"y", arm.base.y},
              {"z", arm.base.z},
              {"yaw_deg", degrees(arm.base.yaw)}}},
            {"home", point(arm.home)},
            {"buffer", buffer}};
}

Json times(const double (&t)[2][2]) {
    return Json::array({Json::array({t[0][0], t[0][1]}), Json::array({t[1][0], t[1][1]})});
}

bool holds_object(const Json &value) {
    if (value.is_object()) return true;
    if (!value.is_array()) return false;
    for (const Json &entry : value)
        if (holds_object(entry)) return true;
    return false;
}

// Objects and lists of them a field a line, anything else in one line.
void print(const Json &value, size_t indent, std::string &out) {
    const bool object = value.is_object();
    const bool spread = object || holds_object(value);
    if (!object && !value.is_array()) {
        out += value.dump();
        return;
    }
    const std::string gap = spread ? "\n" + std::string(indent + 4, ' ') : "";
    out += object ? '{' : '[';
    bool first = true;
    for (const auto &[key, entry] : value.items()) {
        if (!first) out += spread ? "," : ", ";
        first = false;
        out += gap;
        if (object) out += Json(key).dump() + ": ";
        print(entry, indent + 4, out);
    }
    if (spread) out += "\n" + std::string(indent, ' ');
    out += object ? '}' : ']';
}

}  // namespace

CellLayout read_cell(const std::string &text) {
    if (text.size() > kMaxCellText) {
        fail(Status::kFormat, "cell of %zu bytes: must be at most %zu", text.size(), kMaxCellText);
    }
    const Json json = parse(text);
    CellLayout cell;
    Object o(Field(json, ""));
    const Field version = o["version"];
    if (version.number() != kVersion) fail_at("version", version.value(), "1");
    o["name"].name(cell.name);
    const Field arms = o["arms"];
    const size_t count = arms.list(1, 2);
    for (size_t i = 0; i < count; ++i) cell.arms.push_back(read_arm(arms.entry(i)));
    cell.belt = read_belt(o["belt"]);
    cell.bin = read_bin(o["bin"]);
    cell.dwells = read_dwells(o["dwells"]);
    Object planning(o["planning"]);
    read_times(planning["task"], cell.planning.task);
    read_times(planning["motion"], cell.planning.motion);
    planning.finish();
    cell.law = read_law(o["law"]);
    cell.jerk = o["jerk"].number();
    cell.work_height = o["work_height"].number();
    cell.tool_speed = o["tool_speed"].number();
    cell.margin = o["margin"].number();
    cell.tick = o["tick"].number();
    o.finish();
    check_cell(cell);
    return cell;
}

std::string write_cell(const CellLayout &cell) {
    Json arms = Json::array();
    for (const ArmPlace &arm : cell.arms) arms.push_back(arm_place(arm));
    const Json json = {
        {"version", kVersion},
        {"name", cell.name},
        {"arms", arms},
        {"belt",
         {{"centre", point(cell.belt.centre)},
          {"direction_deg", degrees(cell.belt.direction)},
          {"pitch", cell.belt.pitch},
          {"speed", cell.belt.speed},
          {"acceleration", cell.belt.acceleration}}},
        {"bin",
         {{"centre", point(cell.bin.centre)},
          {"w_mm", cell.bin.grid.bin_w},
          {"h_mm", cell.bin.grid.bin_h},
          {"margin_mm", cell.bin.grid.margin},
          {"cell_mm", cell.bin.grid.cell},
          {"clearance_mm", cell.bin.grid.clearance},
          {"wall", cell.bin.wall},
          {"gap", cell.bin.gap},
          {"chamfer", cell.bin.chamfer}}},
        {"dwells",
         {{"stroke", cell.dwells.stroke},
          {"stroke_speed", cell.dwells.stroke_speed},
          {"stroke_acceleration", cell.dwells.stroke_acceleration},
          {"grip", cell.dwells.grip},
          {"release", cell.dwells.release},
          {"scale", cell.dwells.scale}}},
        {"planning",
         {{"task", times(cell.planning.task)}, {"motion", times(cell.planning.motion)}}},
        {"law", cell.law == LawKind::kSCurve ? "s-curve" : "trapezoid"},
        {"jerk", cell.jerk},
        {"work_height", cell.work_height},
        {"tool_speed", cell.tool_speed},
        {"margin", cell.margin},
        {"tick", cell.tick}};
    std::string out;
    print(json, 0, out);
    return out + "\n";
}

}  // namespace packcell
