// Answers of the operator page's server: each with the headers that keep browsers from misusing it.
#pragma once

#include <microhttpd.h>

#include <memory>
#include <string>

namespace packcell_programs {

struct ResponseFree {
    void operator()(MHD_Response *response) const noexcept { MHD_destroy_response(response); }
};
using Response = std::unique_ptr<MHD_Response, ResponseFree>;

// A response and its HTTP status.
struct Answer {
    unsigned status;
    Response response;
};

// 128 random bits as hexadecimal digits. Throws Failure.
std::string random_text();

// Whether a Host header, "HOST" or "HOST:PORT", is an address, localhost or `name`.
bool is_own_host(const std::string &header, const std::string &name);

// Those below throw Failure where there is no memory.

void add_header(MHD_Response *response, const char *name, const std::string &value);

// Takes over what the library made, with the headers that every answer has. `sources` are
// directives of the content security policy that allow something, each with its semicolon.
Response with_headers(MHD_Response *made, const char *type, const std::string &sources = "");

Response text_response(const char *type, const std::string &text, const std::string &sources = "");

Answer plain_answer(unsigned status, const std::string &line);

// The page, with a nonce of its own in place of each @PACKCELL_NONCE@: only the script and the
// style that carry it run.
Answer page_answer(std::string page);

}  // namespace packcell_programs
