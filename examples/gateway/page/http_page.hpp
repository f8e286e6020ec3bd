// The operator page: a small HTTP server that shows the latest state of the cell and takes nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace packcell_programs {

// Serves `/` (the page), `/state` (the latest state as JSON, once) and `/events` (states as
// server-sent events) to GET and HEAD. Nothing that a client sends changes anything; clients are
// 16 at most, 12 of them with a stream, and one that is slow or silent holds up no other. An
// address that is not of this machine has 4 streams at most (429 for more; 503 where all 12 are
// taken).
//
// Requests are answered only if their Host is an address, localhost or the name bound to: a page of
// somebody else's, whose name was made to point here, gets nothing.
//
// All functions may be called by any thread.
class HttpPage {
public:
    // Whether a client from this IPv4 address, in the host's byte order, may connect.
    using AllowedPeer = std::function<bool(uint32_t address)>;

    // Binds "HOST:PORT", an IPv4 address or a name of one; port 0 takes a free one. Loopback
    // clients may always connect, others if `allowed` is there and says so; it is called by the
    // server's thread. Throws UsageError for what is not HOST:PORT, Failure if the port cannot be
    // had.
    explicit HttpPage(const std::string &bind, AllowedPeer allowed = nullptr);
    // As stop().
    ~HttpPage();
    HttpPage(const HttpPage &) = delete;
    HttpPage &operator=(const HttpPage &) = delete;

    // The state from now on, a JSON object; never waits for a client. A client that is slower than
    // the states gets the latest one when it is ready for it. To be called at least once a second,
    // changed or not: pages mark a state as old 3 s after it was published.
    void publish(const std::string &state_json);

    uint16_t port() const;

    // Ends all streams, closes the port and joins every thread, well within a second. May be called
    // twice.
    void stop();

private:
    class Server;
    std::unique_ptr<Server> server_;
};

}  // namespace packcell_programs
