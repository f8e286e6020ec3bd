#include "gateway/journal/export.hpp"

#include <nlohmann/json.hpp>

#include "common/output.hpp"
#include "gateway/core/cell_model.hpp"
#include "gateway/status_json.hpp"

namespace packcell_programs {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kInstance = "gateway";

// Follows the cell and keeps what was done in it.
class Chronicle : public CellObserver {
public:
    void arrived(const pkc_item &item) override {
        items_.push_back({item.w, item.h});
        if ((item.flags & PKC_ITEM_NO_ROTATE) != 0) no_rotate_.push_back(item.id);
        if ((item.flags & PKC_ITEM_PINNED) != 0) pinned_.push_back(item.id);
    }

    void step_done(const std::vector<pkc_action> &actions, uint32_t plan_micros) override {
        Step step;
        step.actions = actions;
        step.milliseconds = plan_micros / 1000.0;
        steps_.push_back(std::move(step));
    }

    void bin_closed(const pkc_bin *bin) override {
        Bin closed;
        closed.index = static_cast<int64_t>(bins_.size());
        describe_bin(bin, closed);
        closed.steps = std::move(steps_);
        steps_.clear();
        if (closed.steps.empty()) closed.steps.emplace_back();
        closed.steps.back().actions.push_back({PKC_OP_TERMINATE, 0, 0, 0, 0, 0});
        bins_.push_back(std::move(closed));
    }

    std::string instance() const {
        Json line = {{"id", kInstance}, {"bins", bins_.size()}};
        line["bin"] = bins_.empty() ? Json{1, 1} : Json{bins_[0].w, bins_[0].h};
        Json stream = Json::array();
        for (const auto &[w, h] : items_) stream.push_back({w, h});
        line["stream"] = std::move(stream);
        if (!no_rotate_.empty()) line["no_rotate"] = no_rotate_;
        if (!pinned_.empty()) line["pinned"] = pinned_;
        return line.dump() + "\n";
    }

    const std::vector<Bin> &bins() const { return bins_; }

private:
    std::vector<std::pair<int32_t, int32_t>> items_;
    std::vector<int32_t> no_rotate_;
    std::vector<int32_t> pinned_;
    std::vector<Step> steps_;
    std::vector<Bin> bins_;
};

}  // namespace

void print_journal(const SqliteJournal &journal) {
    Output out("-");
    journal.replay([&out](const Record &record) { out.write(record_json(record).dump() + "\n"); });
    out.close();
}

void export_episodes(const SqliteJournal &journal, EpisodeLabel label,
                     const std::string &episodes_path, const std::string &instance_path) {
    Chronicle chronicle;
    CellModel cell;
    cell.observe(&chronicle);
    journal.replay([&](const Record &record) {
        if (record.kind == RecordKind::kBoot) label.scenario = boot_from(record.payload).scenario;
        cell.apply(record);
    });
    if (!instance_path.empty()) {
        Output out(instance_path);
        out.write(chronicle.instance());
        out.close();
    }
    if (!episodes_path.empty()) {
        Output out(episodes_path);
        for (const Bin &bin : chronicle.bins()) out.write(episode_line(kInstance, label, bin));
        out.close();
    }
}

}  // namespace packcell_programs
