// Ctrl-C and its kin: the first asks the program to finish the bin at hand, the second ends it.
#pragma once

namespace packcell_programs {

// Catches SIGINT and SIGTERM (unless the parent had them ignored) and ignores SIGPIPE, so that a
// closed pipe is a failed write. To be called once, before any thread is started.
void catch_interrupts();

// The signal that asked for an end, or 0.
int interrupt_signal();

// Waits until `fd` has something to read or an interrupt came; false for the interrupt.
bool wait_readable(int fd);

}  // namespace packcell_programs
