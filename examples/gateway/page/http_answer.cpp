#include "gateway/page/http_answer.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <strings.h>
#include <sys/random.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include "common/errors.hpp"
#include "common/numbers.hpp"

namespace packcell_programs {

namespace {

constexpr const char kPlaceholder[] = "@PACKCELL_NONCE@";

bool is_address(int family, const std::string &text) {
    in6_addr address{};
    return inet_pton(family, text.c_str(), &address) == 1;
}

}  // namespace

std::string random_text() {
    unsigned char bytes[16];
    if (getrandom(bytes, sizeof bytes, 0) != static_cast<ssize_t>(sizeof bytes))
        throw Failure(system_message("random bytes", errno));
    std::string text;
    for (const unsigned char byte : bytes) {
        text += "0123456789abcdef"[byte / 16];
        text += "0123456789abcdef"[byte % 16];
    }
    return text;
}

bool is_own_host(const std::string &header, const std::string &name) {
    std::string host = header;
    std::string rest;
    if (!host.empty() && host[0] == '[') {
        const size_t end = host.find(']');
        if (end == std::string::npos || !is_address(AF_INET6, host.substr(1, end - 1)))
            return false;
        rest = host.substr(end + 1);
        host = "localhost";
    } else if (const size_t colon = host.find(':'); colon != std::string::npos) {
        rest = host.substr(colon);
        host.resize(colon);
    }
    if (!rest.empty() && (rest[0] != ':' || !parse_unsigned(std::string_view(rest).substr(1))))
        return false;
    return is_address(AF_INET, host) || strcasecmp(host.c_str(), "localhost") == 0 ||
           strcasecmp(host.c_str(), name.c_str()) == 0;
}

void add_header(MHD_Response *response, const char *name, const std::string &value) {
    if (MHD_add_response_header(response, name, value.c_str()) != MHD_YES)
        throw Failure(std::string("header ") + name + ": could not be set");
}

Response with_headers(MHD_Response *made, const char *type, const std::string &sources) {
    if (made == nullptr) throw Failure("an answer could not be made");
    Response response(made);
    add_header(made, "Content-Type", type);
    add_header(made, "Cache-Control", "no-store");
    add_header(made, "X-Content-Type-Options", "nosniff");
    add_header(made, "X-Frame-Options", "DENY");
    add_header(made, "Referrer-Policy", "no-referrer");
    add_header(made, "Cross-Origin-Resource-Policy", "same-origin");
    add_header(made, "Content-Security-Policy",
               "default-src 'none'; " + sources +
                   "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    // One request a connection: an idle browser keeps none of the few.
    add_header(made, "Connection", "close");
    return response;
}

Response text_response(const char *type, const std::string &text, const std::string &sources) {
    // The library copies the bytes; its parameter lacks the const.
    return with_headers(MHD_create_response_from_buffer(
                            text.size(), const_cast<char *>(text.data()), MHD_RESPMEM_MUST_COPY),
                        type, sources);
}

Answer plain_answer(unsigned status, const std::string &line) {
    return {status, text_response("text/plain; charset=utf-8", line + "\n")};
}

Answer page_answer(std::string page) {
    const std::string nonce = random_text();
    for (size_t at = 0; (at = page.find(kPlaceholder, at)) != std::string::npos;)
        page.replace(at, strlen(kPlaceholder), nonce);
    return {MHD_HTTP_OK, text_response("text/html; charset=utf-8", page,
                                       "script-src 'nonce-" + nonce + "'; style-src 'nonce-" +
                                           nonce + "'; connect-src 'self'; img-src data:; ")};
}

}  // namespace packcell_programs
