#include "policy/policy.h"

#include <cstring>

#include "base/status.h"
#include "policy/bottom_left.h"
#include "policy/contact.h"
#include "policy/default_policy.h"
#include "policy/maxrects.h"
#include "policy/shelf_next_fit.h"
#include "policy/skyline.h"

namespace packcell {

namespace {

struct Builtin {
    const char *name;
    std::shared_ptr<const Policy> (*make)();
};

template <class P>
std::shared_ptr<const Policy> make() {
    return std::make_shared<const P>();
}

constexpr Builtin kBuiltins[] = {
    {"default", make_default_policy},
    {"contact", make<ContactPolicy>},
    {"bottom-left", make<BottomLeftPolicy>},
    {"skyline", make<SkylinePolicy>},
    {"shelf-next-fit", make<ShelfNextFitPolicy>},
    {"maxrects-cp", make<MaxRectsContactPolicy>},
    {"maxrects-bssf", make<MaxRectsShortSidePolicy>},
};

}  // namespace

void Policy::evaluate(const Bin &, Size, Evaluation &) const {
    fail(Status::kUnsupported, "policy '%s' gives positions alone, no probabilities", name());
}

float Policy::value(const Bin &bin, Effort) const { return static_cast<float>(bin.occupied()); }

void Policy::check_bin(int, int) const {}

std::unique_ptr<const Policy> Policy::session(const SessionOptions &) const { return nullptr; }

std::shared_ptr<const Policy> make_builtin_policy(const char *name) {
    for (const Builtin &builtin : kBuiltins) {
        if (std::strcmp(builtin.name, name) == 0) return builtin.make();
    }
    return nullptr;
}

const char *builtin_policy_name(size_t index) {
    return index < sizeof kBuiltins / sizeof kBuiltins[0] ? kBuiltins[index].name : nullptr;
}

}  // namespace packcell
