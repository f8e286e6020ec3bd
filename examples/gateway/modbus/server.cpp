#include "gateway/modbus/server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <exception>

#include "common/errors.hpp"
#include "gateway/modbus/connection.hpp"

namespace packcell_programs {

namespace {

constexpr int kLinesAKind = 4;
constexpr std::chrono::seconds kLogWindow{10};
constexpr int kTickMs = 1000;
constexpr int kNoDescriptorsPauseMs = 100;

sockaddr_in socket_address(Ipv4 address, int port) {
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_addr.s_addr = htonl(address);
    name.sin_port = htons(static_cast<uint16_t>(port));
    return name;
}

int new_listener() { return socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

template <typename T>
bool set_option(int fd, int level, int name, const T &value) {
    return setsockopt(fd, level, name, &value, sizeof value) == 0;
}

// Answers go out at once; a client that does not read them holds its thread no longer than this.
bool prepare_socket(int fd, int send_ms) {
    timeval limit{};
    limit.tv_sec = send_ms / 1000;
    limit.tv_usec = send_ms % 1000 * 1000;
    return set_option(fd, IPPROTO_TCP, TCP_NODELAY, 1) &&
           set_option(fd, SOL_SOCKET, SO_SNDTIMEO, limit);
}

}  // namespace

ModbusServer::Descriptor::~Descriptor() { close_now(); }

void ModbusServer::Descriptor::close_now() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
}

ModbusServer::ModbusServer(const ModbusOptions &options, RegisterPort &port,
                           const std::function<void(const std::string &)> &log)
    : options_(options),
      access_(options),
      registers_(port),
      events_(log, kLinesAKind, kLogWindow),
      listener_(new_listener()),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (wake_.get() < 0) throw Failure(system_message("eventfd", errno));
    listen_at(options);
    accepting_ = std::thread([this] { accept_until_stopped(); });
}

ModbusServer::~ModbusServer() { stop(); }

void ModbusServer::listen_at(const ModbusOptions &options) {
    const std::string where = "Modbus at " + options.bind + ":" + std::to_string(options.port);
    sockaddr_in name = socket_address(access_.bind_address(), options.port);
    auto *const generic = reinterpret_cast<sockaddr *>(&name);
    socklen_t size = sizeof name;
    const int fd = listener_.get();
    // A restarted gateway need not wait until its old connections are forgotten.
    if (fd < 0 || !set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1) || bind(fd, generic, size) != 0 ||
        listen(fd, SOMAXCONN) != 0 || getsockname(fd, generic, &size) != 0) {
        throw Failure(system_message(where, errno));
    }
    bound_port_ = ntohs(name.sin_port);
}

void ModbusServer::stop() {
    std::call_once(stopped_, [this] {
        stopping_ = true;
        const uint64_t one = 1;
        const ssize_t written = write(wake_.get(), &one, sizeof one);
        static_cast<void>(written);  // it can only fail when it is readable already
        accepting_.join();
        listener_.close_now();  // else clients would connect still, and wait for an answer
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            for (const Client &client : clients_) {
                if (client.fd >= 0) shutdown(client.fd, SHUT_RDWR);
            }
        }
        for (Client &client : clients_) client.thread.join();
        clients_.clear();
        events_.finish();
    });
}

void ModbusServer::accept_until_stopped() {
    pollfd waited[] = {{listener_.get(), POLLIN, 0}, {wake_.get(), POLLIN, 0}};
    while (!stopping_) {
        poll(waited, 2, kTickMs);
        join_done();
        events_.flush();
        if (waited[0].revents != 0 && !stopping_) accept_one();
        waited[0].revents = 0;
    }
}

void ModbusServer::accept_one() {
    sockaddr_in name{};
    socklen_t size = sizeof name;
    const int fd =
        accept4(listener_.get(), reinterpret_cast<sockaddr *>(&name), &size, SOCK_CLOEXEC);
    if (fd < 0) {
        // Such a connection stays in the queue, and would be tried again without a pause.
        if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
            events_.report("failed accepts", system_message("connection not accepted", errno));
            pollfd woken{wake_.get(), POLLIN, 0};
            poll(&woken, 1, kNoDescriptorsPauseMs);
        }
        return;
    }
    const ModbusPeer peer{ntohl(name.sin_addr.s_addr), ntohs(name.sin_port)};
    std::string refusal;
    if (!access_.may_connect(peer.address)) {
        refusal = "not in the networks of --allow";
    } else if (!has_place()) {
        refusal = "all " + std::to_string(options_.most_connections) + " places are taken";
    } else if (!prepare_socket(fd, options_.frame_ms)) {
        refusal = system_message("setsockopt", errno);
    } else {
        return start(fd, peer);
    }
    close(fd);
    events_.report("refused connections", peer.text() + ": connection refused: " + refusal);
}

void ModbusServer::start(int fd, ModbusPeer peer) {
    clients_.emplace_back();
    Client &client = clients_.back();
    client.fd = fd;
    try {
        client.thread = std::thread([this, &client, fd, peer] { serve(client, fd, peer); });
    } catch (const std::exception &error) {
        clients_.pop_back();
        close(fd);
        events_.report("refused connections",
                       peer.text() + ": connection refused: " + error.what());
    }
}

void ModbusServer::serve(Client &client, int fd, ModbusPeer peer) {
    try {
        ModbusConnection(fd, peer, options_, access_, registers_, events_).serve(stopping_);
    } catch (const std::exception &error) {
        events_.report("failed connections", peer.text() + ": closed: " + error.what());
    }
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        client.fd = -1;
    }
    // Only now: whoever sees the end finds a free place.
    close(fd);
}

bool ModbusServer::has_place() {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto taken = std::count_if(clients_.begin(), clients_.end(),
                                     [](const Client &client) { return client.fd >= 0; });
    return taken < options_.most_connections;
}

// Done threads are about to return, if they have not yet: joining does not wait.
void ModbusServer::join_done() {
    const std::lock_guard<std::mutex> lock(mutex_);
    clients_.remove_if([](Client &client) {
        if (client.fd >= 0) return false;
        client.thread.join();
        return true;
    });
}

}  // namespace packcell_programs
