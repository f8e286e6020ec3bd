#include "base/status.h"

#include <cstdarg>
#include <cstdio>

namespace packcell {

Error::Error(Status status, const char *text) noexcept : status_(status), text_() {
    std::snprintf(text_, sizeof text_, "%s", text);
}

void fail(Status status, const char *format, ...) {
    char text[Error::kTextSize];
    va_list args;
    va_start(args, format);
    std::vsnprintf(text, sizeof text, format, args);
    va_end(args);
    throw Error(status, text);
}

}  // namespace packcell
