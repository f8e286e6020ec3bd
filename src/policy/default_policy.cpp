#include "policy/default_policy.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "policy/contact.h"
#include "policy/weights.h"

// The blob as it is on disk.
__asm__(
    ".pushsection .rodata\n"
    ".balign 8\n"
    "packcell_default_weights:\n"
    ".incbin \"" PACKCELL_DEFAULT_WEIGHTS
    "\"\n"
    "packcell_default_weights_end:\n"
    ".byte 0\n"
    ".popsection\n");

extern "C" const uint8_t packcell_default_weights[] __attribute__((visibility("hidden")));
extern "C" const uint8_t packcell_default_weights_end[] __attribute__((visibility("hidden")));

namespace packcell {

namespace {

// Asks the learned policy, or a session of it, about bins that it was trained for, and the contact
// reward about all others.
template <class Base, class Pointer>
class ByBin : public Base {
public:
    template <class... BaseArguments>
    ByBin(Pointer learned, int w, int h, BaseArguments &&...base)
        : Base(std::forward<BaseArguments>(base)...), learned_(std::move(learned)), w_(w), h_(h) {}

    int select(const Bin &bin, Size size) const override { return for_bin(bin).select(bin, size); }
    int select(const Bin &bin, Size size, Effort effort) const override {
        return for_bin(bin).select(bin, size, effort);
    }
    void evaluate(const Bin &bin, Size size, Evaluation &out) const override {
        for_bin(bin).evaluate(bin, size, out);
    }
    bool has_value(const Bin &bin) const override { return for_bin(bin).has_value(bin); }
    float value(const Bin &bin, Effort effort) const override {
        return for_bin(bin).value(bin, effort);
    }
    void check_bin(int, int) const override {}
    const char *name() const override { return "default"; }

protected:
    const Policy &learned() const { return *learned_; }

private:
    const Policy &for_bin(const Bin &bin) const {
        if (bin.w() == w_ && bin.h() == h_) return *learned_;
        return contact_;
    }

    Pointer learned_;
    ContactPolicy contact_;
    int w_;
    int h_;
};

using DefaultSession = ByBin<Policy, std::unique_ptr<const Policy>>;

class DefaultPolicy : public ByBin<LearnedPolicy, std::shared_ptr<const Policy>> {
public:
    explicit DefaultPolicy(const Weights &weights)
        : ByBin(make_learned_policy(weights), weights.bin_w, weights.bin_h, weights) {}

    std::unique_ptr<const Policy> session(const SessionOptions &options) const override {
        return std::make_unique<const DefaultSession>(learned().session(options), weights().bin_w,
                                                      weights().bin_h);
    }
};

}  // namespace

std::shared_ptr<const Policy> make_default_policy() {
    // Read once: it never changes and any number of planners share it.
    static const std::shared_ptr<const Policy> policy = std::make_shared<const DefaultPolicy>(
        read_weights(packcell_default_weights,
                     static_cast<size_t>(packcell_default_weights_end - packcell_default_weights)));
    return policy;
}

}  // namespace packcell
