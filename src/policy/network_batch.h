// A network read for many pairs of a bin and an item, some at once.
#pragma once

#include <cstddef>

#include "policy/network.h"
#include "policy/policy.h"

namespace packcell {

// Policy::evaluate_batch() of a network that serves these bins. What it needs beside the answers
// does not grow with the number of questions.
void evaluate_network_batch(const Network &network, const Question *questions, size_t count,
                            const Answers &answers);

}  // namespace packcell
