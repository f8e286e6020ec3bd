#include "policy/default_policy.h"

#include <cstddef>
#include <cstdint>

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

// Asks the learned policy, or its session, about bins that it was trained for.
class DefaultSession : public Policy {
public:
    DefaultSession(std::unique_ptr<const Policy> learned, int w, int h)
        : learned_(std::move(learned)), w_(w), h_(h) {}

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
    const char *name() const override { return "default"; }

private:
    const Policy &for_bin(const Bin &bin) const {
        if (bin.w() == w_ && bin.h() == h_) return *learned_;
        return contact_;
    }

    std::unique_ptr<const Policy> learned_;
    ContactPolicy contact_;
    int w_;
    int h_;
};

class DefaultPolicy : public LearnedPolicy {
public:
    explicit DefaultPolicy(const Weights &weights)
        : LearnedPolicy(weights), learned_(make_learned_policy(weights)) {}

    int select(const Bin &bin, Size size) const override { return for_bin(bin).select(bin, size); }
    void evaluate(const Bin &bin, Size size, Evaluation &out) const override {
        for_bin(bin).evaluate(bin, size, out);
    }
    bool has_value(const Bin &bin) const override { return for_bin(bin).has_value(bin); }
    float value(const Bin &bin, Effort effort) const override {
        return for_bin(bin).value(bin, effort);
    }
    void check_bin(int, int) const override {}

    std::unique_ptr<const Policy> session(const SessionOptions &options) const override {
        return std::make_unique<const DefaultSession>(learned_->session(options), weights().bin_w,
                                                      weights().bin_h);
    }

private:
    const Policy &for_bin(const Bin &bin) const {
        if (bin.w() == weights().bin_w && bin.h() == weights().bin_h) return *learned_;
        return contact_;
    }

    std::shared_ptr<const Policy> learned_;
    ContactPolicy contact_;
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
