// The gateway's Modbus/TCP server: one thread and one libmodbus context a connection.
#pragma once

#include <atomic>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <thread>

#include "gateway/modbus/access.hpp"
#include "gateway/modbus/event_limiter.hpp"
#include "gateway/modbus/register_port.hpp"

namespace packcell_programs {

// Function codes 3, 4 (the same registers), 6, 16 and 23 over IPv4; the unit id is ignored. A
// request is judged whole before libmodbus sees it: exception 1 for any other function code, 3 for
// a quantity beyond the standard's, 2 for registers that may not be read, or not be written by this
// peer. Where the framing is in doubt, or a frame, an answer or the next request takes too long,
// the connection is closed.
class ModbusServer {
public:
    // Listens and serves from now on. The port must outlive the server. The log takes one line an
    // event; it is called by one of the server's threads at a time, must not call the server and
    // must not throw.
    // Throws UsageError as check_modbus_options() does, and Failure when it cannot listen.
    ModbusServer(const ModbusOptions &options, RegisterPort &port,
                 const std::function<void(const std::string &)> &log);
    ~ModbusServer();
    ModbusServer(const ModbusServer &) = delete;
    ModbusServer &operator=(const ModbusServer &) = delete;

    // The TCP port that it listens on.
    int port() const { return bound_port_; }

    // Ends all connections and threads; a write under way is finished first. May be called again,
    // and by several threads.
    void stop();

private:
    // A descriptor that is closed at the end; -1 for none.
    class Descriptor {
    public:
        explicit Descriptor(int fd = -1) : fd_(fd) {}
        ~Descriptor();
        Descriptor(const Descriptor &) = delete;
        Descriptor &operator=(const Descriptor &) = delete;
        int get() const { return fd_; }
        void close_now();

    private:
        int fd_;
    };

    // The thread closes the socket, and has then nothing left to do.
    struct Client {
        std::thread thread;
        int fd = -1;  // -1: done
    };

    void listen_at(const ModbusOptions &options);
    void accept_until_stopped();
    void accept_one();
    void start(int fd, ModbusPeer peer);
    void serve(Client &client, int fd, ModbusPeer peer);
    bool has_place();
    void join_done();

    const ModbusOptions options_;
    const ModbusAccess access_;
    RegisterPort &registers_;
    EventLimiter events_;
    Descriptor listener_;
    Descriptor wake_;  // readable when stopping
    int bound_port_ = 0;
    std::atomic<bool> stopping_{false};
    std::once_flag stopped_;
    std::mutex mutex_;           // for the descriptors in clients_
    std::list<Client> clients_;  // changed by the accepting thread alone
    std::thread accepting_;
};

}  // namespace packcell_programs
