#include "softplc/plc.hpp"

#include <algorithm>
#include <iterator>
#include <thread>

#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr uint16_t kCommandAt[] = {0, 48};
constexpr uint16_t kLinkAt = 96;
constexpr uint16_t kStatusAt = 200;
constexpr uint16_t kResultAt[] = {300, 400};
constexpr uint16_t kScenarioAt = 1008;  // from map 1.2

double milliseconds(std::chrono::steady_clock::duration span) {
    return std::chrono::duration<double, std::milli>(span).count();
}

template <typename Array>
bool equal(const Array &kept, const uint16_t *image) {
    return std::equal(kept.begin(), kept.end(), image);
}

}  // namespace

PlcCommand::PlcCommand(uint16_t code_, std::initializer_list<uint16_t> words) : code(code_) {
    std::copy(words.begin(), words.end(), payload.begin());
}

PlcCommand PlcCommand::about(uint16_t code, uint32_t id, std::initializer_list<uint16_t> rest) {
    PlcCommand command(code, {static_cast<uint16_t>(id >> 16), static_cast<uint16_t>(id & 0xFFFF)});
    std::copy(rest.begin(), rest.end(), command.payload.begin() + 2);
    return command;
}

const char *command_name(uint16_t code) {
    static const char *const names[] = {"no command",   "ITEM_ARRIVED", "PLAN_NEXT",   "PLACED",
                                        "PLACE_FAILED", "UNPACKED",     "BIN_CHANGED", "JOB_START",
                                        "JOB_END",      "RESOLVE",      "ITEM_GONE"};
    return code < std::size(names) ? names[code] : "unknown command";
}

const char *reject_name(uint16_t code) {
    static const char *const names[] = {"none",        "CONFLICT",    "SEQ_GAP",    "UNKNOWN_CODE",
                                        "BAD_PAYLOAD", "WRONG_STATE", "UNRESOLVED", "JOURNAL"};
    return code < std::size(names) ? names[code] : "unknown reject code";
}

Plc::Plc(const PlcOptions &options) : options_(options), client_(options.gateway) {
    packcell_link_init(&link_);
    for (int i = 0; i < options.channels; ++i) {
        auto channel = std::make_unique<Channel>();
        packcell_arm_init(&channel->fb, i);
        channels_[static_cast<size_t>(i)] = std::move(channel);
    }
    next_scan_ = last_scan_ = last_alive_ = Clock::now();
}

void Plc::read_images() {
    link_.status_read = client_.read(kStatusAt, 32, status_.data());
    if (link_.status_read) std::copy(status_.begin(), status_.end(), link_.status_image);
    link_.link_written = link_written_on_ != 0 && link_written_on_ == client_.connections() &&
                         equal(link_written_, link_.link_image);
    for (size_t i = 0; i < channels_.size(); ++i) {
        if (!channels_[i]) continue;
        Channel &channel = *channels_[i];
        packcell_arm &fb = channel.fb;
        fb.status_read = link_.status_read;
        std::copy(std::begin(link_.status_image), std::end(link_.status_image), fb.status_image);
        fb.command_written =
            channel.written_on == client_.connections() && equal(channel.written, fb.command_image);
        fb.result_read =
            fb.state == PACKCELL_READ_PAGES && client_.read(kResultAt[i], 64, fb.result_image);
    }
}

void Plc::observe(Channel &channel, bool was_acked, bool was_done) {
    const packcell_arm &fb = channel.fb;
    const double waited = milliseconds(Clock::now() - channel.put_out);
    if (fb.acked && !was_acked) {
        ++counts_.commands;
        counts_.ack_ms.add(waited);
    }
    if (fb.done && !was_done && fb.action_count > 0) counts_.plan_ms.add(waited);
}

void Plc::run_blocks(uint32_t elapsed_ms) {
    link_.elapsed_ms = elapsed_ms;
    link_.cancel_seq = 0;
    link_.page_a = channels_[0]->fb.page;
    link_.page_b = channels_[1] ? channels_[1]->fb.page : 0;
    packcell_link_scan(&link_);
    if (link_.map_wrong)
        throw Failure(address_text(options_.gateway) + ": register 200 is " +
                      std::to_string(status_[0]) + " and 201 is " + std::to_string(status_[1]) +
                      ": must be 20555 and 1, a packcell-gateway's");
    if (link_.restarted) {
        restarted_ = true;
        scenario_known_ = false;
        ++counts_.restarts;
    }
    for (const std::unique_ptr<Channel> &channel : channels_) {
        if (!channel) continue;
        packcell_arm &fb = channel->fb;
        const bool was_acked = fb.acked;
        const bool was_done = fb.done;
        fb.link_ok = link_.link_ok;
        fb.elapsed_ms = elapsed_ms;
        packcell_arm_scan(&fb);
        observe(*channel, was_acked, was_done);
    }
}

void Plc::write_command(size_t index) {
    Channel &channel = *channels_[index];
    const uint16_t *image = channel.fb.command_image;
    // After a rejection the next command may look the same, and has to be written all the same.
    if (image[0] == 0) channel.written_on = 0;
    const bool is_there =
        channel.written_on == client_.connections() && equal(channel.written, image);
    if (image[0] == 0 || (is_there && !options_.cyclic)) return;
    const Clock::time_point begin = Clock::now();
    if (!channel.counted) channel.put_out = begin;
    if (!client_.write(kCommandAt[index], 48, image)) return;
    if (!channel.counted) counts_.write_ms.add(milliseconds(Clock::now() - begin));
    channel.counted = true;
    std::copy(image, image + channel.written.size(), channel.written.begin());
    channel.written_on = client_.connections();
}

void Plc::write_images() {
    for (size_t i = 0; i < channels_.size(); ++i) {
        if (channels_[i]) write_command(i);
    }
    const bool is_there =
        link_written_on_ == client_.connections() && equal(link_written_, link_.link_image);
    if (is_there && !options_.cyclic) return;
    if (!client_.write(kLinkAt, 8, link_.link_image)) return;
    std::copy(std::begin(link_.link_image), std::end(link_.link_image), link_written_.begin());
    link_written_on_ = client_.connections();
}

// A cell that is set up otherwise would be noticed by a plan that breaks a rule, with items on the
// belt.
void Plc::check_scenario() {
    if (!link_.link_ok || scenario_known_) return;
    const bool told = status_[1] > 1 || status_[2] >= 2;
    uint16_t words[4];
    if (told && !client_.read(kScenarioAt, 4, words)) return;
    scenario_known_ = true;
    if (!told) return;
    auto there = initialised(pkc_scenario_init);
    there.robots = words[0];
    there.recognized = words[1];
    there.accessible = words[2];
    there.overlap = words[3];
    const std::string found = name_of(there);
    const std::string wanted = name_of(options_.scenario);
    if (found != wanted)
        throw Failure(address_text(options_.gateway) + ": scenario " + found + ": must be " +
                      wanted);
}

void Plc::judge_patience(Clock::time_point now) {
    if (link_.link_ok) {
        last_alive_ = now;
        for (const std::unique_ptr<Channel> &channel : channels_) {
            if (!channel || !channel->fb.busy) continue;
            if (channel->fb.waited_ms > 1000 * options_.patience)
                throw Failure(std::string(command_name(channel->fb.code)) + ", number " +
                              std::to_string(channel->fb.seq) + ": no " +
                              (channel->fb.acked ? "end" : "acknowledgement") + " within " +
                              std::to_string(static_cast<int>(options_.patience)) + " s");
        }
        return;
    }
    const bool over = milliseconds(now - last_alive_) > 1000 * options_.patience;
    if (over || interrupt_signal() != 0)
        throw Failure(address_text(options_.gateway) + ": no living gateway for " +
                      std::to_string(static_cast<int>(milliseconds(now - last_alive_) / 1000)) +
                      " s (" + client_.why() + ")");
}

void Plc::scan() {
    std::this_thread::sleep_until(next_scan_);
    const Clock::time_point now = Clock::now();
    // After a scan that took too long the next ones do not hurry.
    const auto period =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.scan));
    next_scan_ = std::max(next_scan_ + period, now);
    const auto elapsed = std::chrono::duration_cast<std::chrono::milliseconds>(now - last_scan_);
    last_scan_ += elapsed;  // what is less than a millisecond counts next time
    read_images();
    run_blocks(static_cast<uint32_t>(elapsed.count()));
    check_scenario();
    write_images();
    ++counts_.scans;
    judge_patience(Clock::now());
}

void Plc::wait(double seconds) {
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(seconds));
    while (Clock::now() < end) scan();
}

void Plc::wait_for_link() {
    do scan();
    while (!link_.link_ok);
}

void Plc::start(int channel, const PlcCommand &command) {
    Channel &c = *channels_[static_cast<size_t>(channel)];
    // The last command's outputs stand until execute was seen low.
    while (c.fb.state != PACKCELL_READY) scan();
    c.fb.code = command.code;
    c.fb.flags = command.flags;
    std::copy(command.payload.begin(), command.payload.end(), c.fb.payload);
    c.fb.execute = true;
    c.counted = false;
}

const packcell_arm &Plc::finish(int channel) {
    packcell_arm &fb = channels_[static_cast<size_t>(channel)]->fb;
    while (!fb.done && !fb.rejected) scan();
    if (fb.rejected) ++counts_.rejects;
    fb.execute = false;
    return fb;
}

void Plc::control(uint16_t packml_command) {
    link_.control = packml_command;
    link_.control_request = true;
    while (!link_.control_done) scan();
    link_.control_request = false;
    scan();
}

bool Plc::take_restart() {
    const bool restarted = restarted_;
    restarted_ = false;
    return restarted;
}

}  // namespace packcell_programs
