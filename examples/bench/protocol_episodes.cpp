#include "bench/protocol_episodes.hpp"

#include "bench/one_item_planner.hpp"

namespace packcell_programs {

namespace {

// The generator's sides go up to half its bin's.
GeneratorHandle item_generator(const Protocol &protocol, uint64_t seed) {
    auto options = initialised(pkc_generator_options_init);
    options.kind = PKC_GENERATE_RANDOM;
    options.w = 2 * protocol.largest;
    options.h = 2 * protocol.largest;
    options.seed = seed;
    return make_generator(options);
}

class Player {
public:
    Player(const Protocol &protocol, bool rotation, const pkc_policy *policy, uint64_t seed)
        : protocol_(protocol),
          generator_(item_generator(protocol, seed)),
          planner_(policy, protocol.game(rotation)) {}

    // Plays one bin and returns the cells taken.
    int play() {
        planner_.clear();
        return protocol_.misfit == Misfit::kSkipped ? play_skipping() : play_closing();
    }

private:
    pkc_item next_item() {
        pkc_item item{};
        size_t count = 0;
        check(pkc_generator_next(generator_.get(), &item, 1, &count));
        return item;
    }

    // Draws all its items, full or not, so that bins begin alike for every policy.
    int play_skipping() {
        const int cells = protocol_.side * protocol_.side;
        int taken = 0;
        for (int i = 0; i < protocol_.items; ++i) {
            const pkc_item item = next_item();
            if (taken < cells && planner_.pack(item.w, item.h)) taken += item.w * item.h;
        }
        return taken;
    }

    int play_closing() {
        pkc_item item = carried_ ? *carried_ : next_item();
        int taken = 0;
        for (; planner_.pack(item.w, item.h); item = next_item()) taken += item.w * item.h;
        if (protocol_.misfit == Misfit::kOpensNext) carried_ = item;
        return taken;
    }

    const Protocol &protocol_;
    GeneratorHandle generator_;
    OneItemPlanner planner_;
    std::optional<pkc_item> carried_;
};

}  // namespace

Sample play_episodes(const Protocol &protocol, bool rotation, const pkc_policy *policy,
                     int64_t bins, uint64_t seed, const PartDone &part_done) {
    Player player(protocol, rotation, policy, seed);
    const double cells = protocol.side * protocol.side;
    Sample shares;
    for (int64_t i = 1; i <= bins; ++i) {
        shares.add(player.play() / cells);
        if ((i % kEpisodesOfPart == 0 || i == bins) && !part_done()) break;
    }
    return shares;
}

}  // namespace packcell_programs
