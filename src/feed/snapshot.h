// Bin, conveyor and buffers as bytes, for restarts and for workers without state of their own.
#pragma once

#include "base/bytes.h"
#include "bin/bin.h"
#include "feed/queue.h"

namespace packcell {

void save_snapshot(const Bin &bin, const Queue &queue, ByteWriter &out);

// Throws kFormat at the first byte that is wrong.
void load_snapshot(ByteReader &in, Bin &bin, Queue &queue);

}  // namespace packcell
