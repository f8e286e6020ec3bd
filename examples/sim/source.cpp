#include "sim/source.hpp"

#include <utility>
#include <vector>

#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

// A stream's bin is offered items of this many times its area, of which it takes what fits.
constexpr int kOffered = 2;

std::string size_text(int32_t w, int32_t h) { return std::to_string(w) + "x" + std::to_string(h); }

GeneratorHandle generator_of(const SourceOptions &options) {
    auto wanted = initialised(pkc_generator_options_init);
    check(pkc_generator_preset(&wanted, options.preset.c_str()));
    wanted.kind = options.kind == "full" ? PKC_GENERATE_FULL : PKC_GENERATE_RANDOM;
    wanted.w = options.w;
    wanted.h = options.h;
    wanted.seed = options.seed;
    return make_generator(wanted);
}

}  // namespace

InstanceSource::InstanceSource(const SourceOptions &options) : options_(options) {
    if (options.in.empty()) {
        generator_ = generator_of(options);
        return;
    }
    ReadOptions reading;
    reading.format = options.format;
    reading.usual_bin = parse_number_pair(size_text(options.w, options.h));
    reading.rotation = options.rotation;
    reader_ = std::make_unique<InstanceReader>(options.in, reading);
}

Instance InstanceSource::generate() {
    Instance instance;
    instance.w = options_.w;
    instance.h = options_.h;
    instance.is_set = options_.kind == "full";
    instance.bins = instance.is_set ? 0 : 1;
    instance.id = (instance.is_set ? "s" : "r") + std::to_string(made_ + 1);
    const auto cells = static_cast<size_t>(options_.w) * static_cast<size_t>(options_.h);
    size_t count = 0;
    if (instance.is_set) {
        instance.items.resize(cells);
        check(pkc_generator_next(generator_.get(), instance.items.data(), cells, &count));
        instance.items.resize(count);
        return instance;
    }
    for (size_t area = 0; area < kOffered * cells;) {
        pkc_item item{};
        check(pkc_generator_next(generator_.get(), &item, 1, &count));
        item.id = static_cast<int32_t>(instance.items.size());
        area += static_cast<size_t>(item.w) * static_cast<size_t>(item.h);
        instance.items.push_back(item);
    }
    return instance;
}

std::optional<Instance> InstanceSource::make() {
    if (interrupt_signal() != 0) return std::nullopt;
    if (!reader_) {
        if (made_ >= options_.count) return std::nullopt;
        Instance instance = generate();
        ++made_;
        return instance;
    }
    std::optional<Instance> instance = reader_->next();
    if (instance && (instance->w != options_.w || instance->h != options_.h)) {
        throw Failure(reader_->name() + ":" + std::to_string(instance->line) + ": instance '" +
                      instance->id + "': bin " + size_text(instance->w, instance->h) +
                      ": must be the cell's, " + size_text(options_.w, options_.h));
    }
    return instance;
}

std::optional<Instance> InstanceSource::next() {
    if (!std::exchange(looked_ahead_, false)) return make();
    if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
    return std::exchange(ahead_, std::nullopt);
}

bool InstanceSource::at_end() {
    if (!reader_) return made_ >= options_.count;
    if (!std::exchange(looked_ahead_, true)) {
        try {
            ahead_ = make();
        } catch (...) {
            fault_ = std::current_exception();
        }
    }
    return !ahead_ && !fault_;
}

}  // namespace packcell_programs
