#include "gateway/page/http_page.hpp"

#include <arpa/inet.h>
#include <microhttpd.h>
#include <netdb.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "common/clock.hpp"
#include "common/errors.hpp"
#include "common/numbers.hpp"
#include "gateway/modbus/ipv4.hpp"
#include "gateway/page/http_answer.hpp"

// The page as it is on disk.
__asm__(
    ".pushsection .rodata\n"
    "packcell_operator_page:\n"
    ".incbin \"" PACKCELL_OPERATOR_PAGE
    "\"\n"
    "packcell_operator_page_end:\n"
    ".byte 0\n"
    ".popsection\n");

extern "C" const char packcell_operator_page[] __attribute__((visibility("hidden")));
extern "C" const char packcell_operator_page_end[] __attribute__((visibility("hidden")));

namespace packcell_programs {

namespace {

constexpr unsigned kMostConnections = 16;
constexpr int kMostStreams = 12;      // the others stay free for the page itself
constexpr int kMostStreamsAPeer = 4;  // but on this machine: a proxy speaks for many
constexpr int kBacklog = 16;
constexpr size_t kConnectionMemory = 32 * 1024;   // bytes; a longer request is refused
constexpr unsigned kIdleSeconds = 8;              // of a connection on which nothing moves
constexpr std::chrono::seconds kWholeRequest{8};  // from connecting to the end of the answer
constexpr std::chrono::milliseconds kWatch{250};  // between two looks at who is late
constexpr std::chrono::seconds kPing{2};          // less than kIdleSeconds
constexpr std::chrono::seconds kOld{3};           // a state published before is no news

// ---- Where to listen ----------------------------------------------------------------------------

struct Place {
    std::string host;
    std::string port;
};

Place read_place(const std::string &bind) {
    const size_t colon = bind.rfind(':');
    if (colon != std::string::npos && colon > 0) {
        const auto port = parse_unsigned(std::string_view(bind).substr(colon + 1));
        const std::string host = bind.substr(0, colon);
        if (port && *port <= 65535 && host.find(':') == std::string::npos)
            return {host, std::to_string(*port)};
    }
    throw UsageError("--http '" + bind +
                     "': must be HOST:PORT, HOST an IPv4 address or its name, PORT 0..65535");
}

uint32_t ipv4_of(const sockaddr *address) {
    sockaddr_in inet{};
    memcpy(&inet, address, sizeof inet);
    return ntohl(inet.sin_addr.s_addr);
}

// A listening socket, owned by the caller.
int listen_at(const Place &place) {
    const std::string what = "--http " + place.host + ":" + place.port;
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_STREAM;
    addrinfo *found = nullptr;
    const int answer = getaddrinfo(place.host.c_str(), place.port.c_str(), &hints, &found);
    if (answer != 0) throw Failure(what + ": " + gai_strerror(answer));
    const std::unique_ptr<addrinfo, void (*)(addrinfo *)> owner(found, freeaddrinfo);
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd < 0) throw Failure(system_message(what, errno));
    // So that a restarted gateway has its port back at once.
    const int on = 1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (bind(fd, found->ai_addr, found->ai_addrlen) != 0 || listen(fd, kBacklog) != 0) {
        const int error = errno;
        close(fd);
        throw Failure(system_message(what, error));
    }
    return fd;
}

uint16_t bound_port(int fd) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(fd, reinterpret_cast<sockaddr *>(&address), &size);
    return ntohs(address.sin_port);
}

}  // namespace

// ---- The server ---------------------------------------------------------------------------------

class HttpPage::Server {
public:
    Server(const std::string &bind, AllowedPeer allowed);
    ~Server() { stop(); }
    Server(const Server &) = delete;
    Server &operator=(const Server &) = delete;

    void publish(const std::string &state_json);
    uint16_t port() const { return port_; }
    void stop();

private:
    // A client's stream: the message under way, and which state it was made of.
    struct Stream {
        Stream(Server *of, uint32_t from) : server(of), peer(from) {}
        Server *server;
        uint32_t peer;
        std::string message = "retry: 1000\n\n";
        size_t sent = 0;
        uint64_t number = 0;
    };

    // A connection that owes its request, or takes long to read the answer.
    struct Guest {
        int fd;
        Clock::time_point until;
    };

    bool admits(const sockaddr *address) const;
    Answer answer(MHD_Connection *connection, const std::string &url, const std::string &method);
    Answer stream_of(MHD_Connection *connection);
    bool asks_for_us(MHD_Connection *connection) const;
    void next_message(Stream &stream);
    unsigned open_stream(MHD_Connection *connection, uint32_t peer);
    void close_stream(uint32_t peer);
    void come(MHD_Connection *connection);
    void leave(MHD_Connection *connection);
    void watch();

    static MHD_Result on_accept(void *self, const sockaddr *address, socklen_t size);
    static MHD_Result on_request(void *self, MHD_Connection *connection, const char *url,
                                 const char *method, const char *version, const char *data,
                                 size_t *size, void **own);
    static ssize_t on_read(void *stream, uint64_t position, char *out, size_t capacity);
    static void on_stream_end(void *stream);
    static void on_connection(void *self, MHD_Connection *connection, void **own,
                              MHD_ConnectionNotificationCode code);

    const AllowedPeer allowed_;
    const std::string run_ = random_text();  // states are numbered anew by each run
    std::string host_;
    uint16_t port_ = 0;

    std::mutex mutex_;
    std::condition_variable changed_;  // a new state, or the end
    std::condition_variable ended_;
    bool stopping_ = false;
    std::string state_ = "{}";
    uint64_t number_ = 0;  // of the state; 0: none was published
    Clock::time_point published_;
    int streams_ = 0;
    std::map<uint32_t, int> streams_of_;  // by the peer's address; none that has none
    std::map<MHD_Connection *, Guest> guests_;

    MHD_Daemon *daemon_ = nullptr;
    std::thread watcher_;
};

HttpPage::Server::Server(const std::string &bind, AllowedPeer allowed)
    : allowed_(std::move(allowed)) {
    const Place place = read_place(bind);
    host_ = place.host;
    const int fd = listen_at(place);
    port_ = bound_port(fd);

    // Signals are for the threads of the program.
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    daemon_ = MHD_start_daemon(
        MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_THREAD_PER_CONNECTION | MHD_USE_POLL |
            MHD_USE_ITC,
        port_, &Server::on_accept, this, &Server::on_request, this, MHD_OPTION_LISTEN_SOCKET, fd,
        MHD_OPTION_CONNECTION_LIMIT, kMostConnections, MHD_OPTION_CONNECTION_TIMEOUT, kIdleSeconds,
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionMemory, MHD_OPTION_NOTIFY_CONNECTION,
        &Server::on_connection, this,
        // Paths are compared as they came: none of ours has anything to unescape.
        MHD_OPTION_UNESCAPE_CALLBACK,
        +[](void *, MHD_Connection *, char *text) -> size_t { return strlen(text); }, nullptr,
        MHD_OPTION_END);
    if (daemon_ != nullptr) watcher_ = std::thread(&Server::watch, this);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (daemon_ == nullptr) throw Failure("--http " + bind + ": the server does not start");
}

void HttpPage::Server::publish(const std::string &state_json) {
    std::string line = state_json;
    // An event's data is one line; JSON has line breaks between its tokens only.
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        state_.swap(line);
        ++number_;
        published_ = Clock::now();
    }
    changed_.notify_all();
}

void HttpPage::Server::stop() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    ended_.notify_all();
    if (watcher_.joinable()) watcher_.join();
    if (daemon_ != nullptr) MHD_stop_daemon(daemon_);
    daemon_ = nullptr;
}

// ---- Who may come, and for how long -------------------------------------------------------------

bool HttpPage::Server::admits(const sockaddr *address) const {
    if (address == nullptr || address->sa_family != AF_INET) return false;
    const uint32_t ipv4 = ipv4_of(address);
    return is_loopback(ipv4) || (allowed_ && allowed_(ipv4));
}

void HttpPage::Server::come(MHD_Connection *connection) {
    const auto *info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    if (info == nullptr) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    guests_[connection] = {info->connect_fd, Clock::now() + kWholeRequest};
}

// The descriptor is closed after this.
void HttpPage::Server::leave(MHD_Connection *connection) {
    const std::lock_guard<std::mutex> lock(mutex_);
    guests_.erase(connection);
}

// The library's own time limit begins anew with every byte; a client that drips would stay for
// ever.
void HttpPage::Server::watch() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ended_.wait_for(lock, kWatch, [this] { return stopping_; })) {
        const auto now = Clock::now();
        for (auto &[connection, guest] : guests_) {
            if (now >= guest.until) shutdown(guest.fd, SHUT_RDWR);
        }
    }
}

bool HttpPage::Server::asks_for_us(MHD_Connection *connection) const {
    struct Hosts {
        const std::string *name;
        int good = 0, bad = 0;
    } hosts{&host_};
    MHD_get_connection_values(
        connection, MHD_HEADER_KIND,
        [](void *found, MHD_ValueKind, const char *key, const char *value) {
            auto *list = static_cast<Hosts *>(found);
            if (strcasecmp(key, "Host") == 0)
                ++(is_own_host(value != nullptr ? value : "", *list->name) ? list->good
                                                                           : list->bad);
            return MHD_YES;
        },
        &hosts);
    return hosts.good == 1 && hosts.bad == 0;
}

// ---- Answers ------------------------------------------------------------------------------------

Answer HttpPage::Server::answer(MHD_Connection *connection, const std::string &url,
                                const std::string &method) {
    if (!asks_for_us(connection))
        return plain_answer(MHD_HTTP_FORBIDDEN,
                            "Host: must be an address of this machine, localhost or " + host_);
    if (method != "GET" && method != "HEAD") {
        Answer refused = plain_answer(MHD_HTTP_METHOD_NOT_ALLOWED, "must be GET or HEAD");
        add_header(refused.response.get(), "Allow", "GET, HEAD");
        return refused;
    }
    if (url == "/") return page_answer({packcell_operator_page, packcell_operator_page_end});
    if (url == "/state") {
        std::unique_lock<std::mutex> lock(mutex_);
        const std::string state = state_;
        lock.unlock();
        return {MHD_HTTP_OK, text_response("application/json", state)};
    }
    if (url == "/events") {
        if (method == "HEAD") return {MHD_HTTP_OK, text_response("text/event-stream", "")};
        return stream_of(connection);
    }
    return plain_answer(MHD_HTTP_NOT_FOUND, "must be /, /state or /events");
}

Answer HttpPage::Server::stream_of(MHD_Connection *connection) {
    const auto *info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    if (info == nullptr) throw Failure("a client without an address");
    const uint32_t peer = ipv4_of(info->client_addr);
    if (const unsigned refusal = open_stream(connection, peer)) {
        Answer full = plain_answer(refusal, refusal == MHD_HTTP_TOO_MANY_REQUESTS
                                                ? "too many streams are open from this address"
                                                : "too many streams are open");
        add_header(full.response.get(), "Retry-After", "5");
        return full;
    }
    MHD_Response *made = nullptr;
    try {
        auto stream = std::make_unique<Stream>(this, peer);
        made = MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, kConnectionMemory / 2,
                                                 &Server::on_read, stream.get(),
                                                 &Server::on_stream_end);
        // From now on the response's own, with its place among the streams.
        if (made != nullptr) static_cast<void>(stream.release());
    } catch (...) {
        // As where the library has no memory for it.
    }
    if (made == nullptr) close_stream(peer);
    return {MHD_HTTP_OK, with_headers(made, "text/event-stream")};
}

// Waits for a state that the client has not got; an empty message is the end.
void HttpPage::Server::next_message(Stream &stream) {
    stream.sent = 0;
    stream.message.clear();
    std::unique_lock<std::mutex> lock(mutex_);
    const bool woken =
        changed_.wait_for(lock, kPing, [&] { return stopping_ || number_ != stream.number; });
    if (stopping_) return;
    if (!woken) {
        stream.message = ": ping\n\n";
        return;
    }
    // A page that opens beside a gateway that hangs must not take the state for news.
    if (Clock::now() - published_ > kOld) stream.message += "event: old\n";
    stream.message += "id: " + run_ + "-" + std::to_string(number_) + "\ndata: ";
    stream.message += state_;
    stream.message += "\n\n";
    stream.number = number_;
}

// 0, or the status of the refusal.
unsigned HttpPage::Server::open_stream(MHD_Connection *connection, uint32_t peer) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto own = streams_of_.find(peer);
    if (own != streams_of_.end() && own->second >= kMostStreamsAPeer && !is_loopback(peer))
        return MHD_HTTP_TOO_MANY_REQUESTS;
    if (streams_ >= kMostStreams || stopping_) return MHD_HTTP_SERVICE_UNAVAILABLE;
    ++streams_of_[peer];
    ++streams_;
    guests_.erase(connection);  // may stay as long as it reads
    return 0;
}

void HttpPage::Server::close_stream(uint32_t peer) {
    const std::lock_guard<std::mutex> lock(mutex_);
    --streams_;
    if (--streams_of_[peer] == 0) streams_of_.erase(peer);
}

// ---- Called by the library; no exception may pass -----------------------------------------------

MHD_Result HttpPage::Server::on_accept(void *self, const sockaddr *address, socklen_t) {
    try {
        return static_cast<Server *>(self)->admits(address) ? MHD_YES : MHD_NO;
    } catch (...) {
        return MHD_NO;
    }
}

MHD_Result HttpPage::Server::on_request(void *self, MHD_Connection *connection, const char *url,
                                        const char *method, const char *, const char *, size_t *,
                                        void **) {
    try {
        const Answer answer = static_cast<Server *>(self)->answer(connection, url, method);
        return MHD_queue_response(connection, answer.status, answer.response.get());
    } catch (...) {
        return MHD_NO;  // closes the connection
    }
}

ssize_t HttpPage::Server::on_read(void *stream, uint64_t, char *out, size_t capacity) {
    auto &own = *static_cast<Stream *>(stream);
    try {
        if (own.sent == own.message.size()) own.server->next_message(own);
    } catch (...) {
        return MHD_CONTENT_READER_END_WITH_ERROR;
    }
    if (own.message.empty()) return MHD_CONTENT_READER_END_OF_STREAM;
    const size_t size = std::min(capacity, own.message.size() - own.sent);
    own.message.copy(out, size, own.sent);
    own.sent += size;
    return static_cast<ssize_t>(size);
}

void HttpPage::Server::on_stream_end(void *stream) {
    const std::unique_ptr<Stream> own(static_cast<Stream *>(stream));
    own->server->close_stream(own->peer);
}

void HttpPage::Server::on_connection(void *self, MHD_Connection *connection, void **,
                                     MHD_ConnectionNotificationCode code) {
    auto *server = static_cast<Server *>(self);
    try {
        if (code == MHD_CONNECTION_NOTIFY_STARTED)
            server->come(connection);
        else
            server->leave(connection);
    } catch (...) {
        // Not watched, then: the library's own time limit is left.
    }
}

// ---- The page -----------------------------------------------------------------------------------

HttpPage::HttpPage(const std::string &bind, AllowedPeer allowed)
    : server_(std::make_unique<Server>(bind, std::move(allowed))) {}

HttpPage::~HttpPage() = default;

void HttpPage::publish(const std::string &state_json) { server_->publish(state_json); }

uint16_t HttpPage::port() const { return server_->port(); }

void HttpPage::stop() { server_->stop(); }

}  // namespace packcell_programs
