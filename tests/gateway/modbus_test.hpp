// What the tests of the Modbus server share: a register port in memory, raw and libmodbus clients.
#pragma once

#include <arpa/inet.h>
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "gateway/modbus/server.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {

using Bytes = std::vector<uint8_t>;
using TestClock = std::chrono::steady_clock;

// For what must happen soon; a loaded machine may need long for it.
constexpr int kPatienceMs = 20'000;

inline bool eventually(const std::function<bool()> &is_true) {
    const auto until = TestClock::now() + std::chrono::milliseconds(kPatienceMs);
    while (!is_true()) {
        if (TestClock::now() > until) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

// Registers in memory: register i holds i at first.
class FakePort : public RegisterPort {
public:
    struct Write {
        uint16_t address;
        std::vector<uint16_t> values;
    };

    FakePort() {
        for (uint16_t i = 0; i < kRegisters; ++i) registers_[i] = i;
    }

    void read(Registers &out) override {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (fails_) throw std::runtime_error("made to fail");
        out = registers_;
    }

    void write(uint16_t address, const uint16_t *values, uint16_t count) override {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (fails_) throw std::runtime_error("made to fail");
        writes_.push_back({address, std::vector<uint16_t>(values, values + count)});
        if (keeps_) std::copy(values, values + count, registers_.begin() + address);
    }

    void set_fails(bool fails) { set(fails_, fails); }
    // Whether writes change the registers.
    void set_keeps(bool keeps) { set(keeps_, keeps); }

    std::vector<Write> writes() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return writes_;
    }

private:
    void set(bool &flag, bool value) {
        const std::lock_guard<std::mutex> lock(mutex_);
        flag = value;
    }

    std::mutex mutex_;
    Registers registers_{};
    std::vector<Write> writes_;
    bool fails_ = false;
    bool keeps_ = true;
};

// A server on a free port of 127.0.0.1 and what it logged.
class Served {
public:
    explicit Served(ModbusOptions options = {}) {
        options.port = 0;
        server_ = std::make_unique<ModbusServer>(options, port_, [this](const std::string &line) {
            const std::lock_guard<std::mutex> lock(mutex_);
            lines_.push_back(line);
        });
    }

    // With a time limit for frames that no load of the test's machine makes too short.
    static ModbusOptions patient() {
        ModbusOptions options;
        options.frame_ms = kPatienceMs;
        return options;
    }

    FakePort &registers() { return port_; }
    ModbusServer &server() { return *server_; }
    int port() const { return server_->port(); }

    std::vector<std::string> lines() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return lines_;
    }
    bool logged(const std::string &part) {
        for (const std::string &line : lines()) {
            if (line.find(part) != std::string::npos) return true;
        }
        return false;
    }

private:
    FakePort port_;
    std::mutex mutex_;
    std::vector<std::string> lines_;
    std::unique_ptr<ModbusServer> server_;
};

inline sockaddr_in test_address(const char *address, int port) {
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(static_cast<uint16_t>(port));
    inet_pton(AF_INET, address, &name.sin_addr);
    return name;
}

// A TCP connection whose own address may be chosen.
class RawClient {
public:
    explicit RawClient(int port, const char *own = "127.0.0.1", const char *server = "127.0.0.1") {
        fd_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const int one = 1;
        // The kernel picks the port when it connects: many more connections fit.
        setsockopt(fd_, IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &one, sizeof one);
        setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
        sockaddr_in from = test_address(own, 0);
        sockaddr_in to = test_address(server, port);
        if (bind(fd_, reinterpret_cast<sockaddr *>(&from), sizeof from) != 0 ||
            connect(fd_, reinterpret_cast<sockaddr *>(&to), sizeof to) != 0) {
            close(fd_);
            throw std::runtime_error("no connection");
        }
    }
    ~RawClient() { leave(); }
    RawClient(RawClient &&other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
    RawClient &operator=(RawClient &&other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }

    int fd() const { return fd_; }

    void leave() {
        if (fd_ >= 0) close(fd_);
        fd_ = -1;
    }
    // Closes so that the server meets an error, not an orderly end.
    void reset() {
        const linger hard{1, 0};
        setsockopt(fd_, SOL_SOCKET, SO_LINGER, &hard, sizeof hard);
        leave();
    }

    bool send(const Bytes &bytes) const {
        size_t sent = 0;
        while (sent < bytes.size()) {
            const ssize_t n = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
            if (n <= 0) return false;
            sent += static_cast<size_t>(n);
        }
        return true;
    }

    // Up to `most` bytes; fewer when the server closes, or stays silent for kPatienceMs.
    Bytes receive(size_t most) const {
        Bytes bytes(most);
        size_t got = 0;
        while (got < most && waits(POLLIN, kPatienceMs)) {
            const ssize_t n = recv(fd_, bytes.data() + got, most - got, 0);
            if (n <= 0) break;
            got += static_cast<size_t>(n);
        }
        bytes.resize(got);
        return bytes;
    }

    // One answer without its header of six bytes: unit id, function code, data. Empty at the end.
    Bytes answer(unsigned *transaction = nullptr) const {
        const Bytes header = receive(6);
        if (header.size() < 6) return {};
        if (transaction != nullptr)
            *transaction = static_cast<unsigned>(header[0] << 8 | header[1]);
        return receive(static_cast<size_t>(header[4] << 8 | header[5]));
    }

    // Whether the server has closed, or does so soon, without another byte.
    bool is_closed() const {
        uint8_t byte = 0;
        return waits(POLLIN, kPatienceMs) && recv(fd_, &byte, 1, 0) <= 0;
    }

    bool waits(short events, int limit_ms) const {
        pollfd waited{fd_, events, 0};
        return poll(&waited, 1, limit_ms) > 0;
    }

private:
    int fd_ = -1;
};

inline void put_word(Bytes &bytes, unsigned word) {
    bytes.push_back(static_cast<uint8_t>(word >> 8 & 0xFFU));
    bytes.push_back(static_cast<uint8_t>(word & 0xFFU));
}

// A frame around function code and data.
inline Bytes frame_of(const Bytes &pdu, unsigned transaction = 1, uint8_t unit = 1) {
    Bytes bytes;
    put_word(bytes, transaction);
    put_word(bytes, 0);
    put_word(bytes, static_cast<unsigned>(pdu.size() + 1));
    bytes.push_back(unit);
    bytes.insert(bytes.end(), pdu.begin(), pdu.end());
    return bytes;
}

inline Bytes pdu_of(uint8_t function, const std::vector<unsigned> &words) {
    Bytes pdu{function};
    for (const unsigned word : words) put_word(pdu, word);
    return pdu;
}

inline Bytes read_pdu(unsigned address, unsigned count, uint8_t function = 3) {
    return pdu_of(function, {address, count});
}

// Function code 16 with `bytes / 2` values, whatever `count` says.
inline Bytes write_pdu(unsigned address, unsigned count, unsigned bytes, unsigned value = 7) {
    Bytes pdu = pdu_of(16, {address, count});
    pdu.push_back(static_cast<uint8_t>(bytes));
    for (unsigned i = 0; i < bytes; ++i) pdu.push_back(static_cast<uint8_t>(i % 2 ? value : 0));
    return pdu;
}

// Function code 23 in the same manner.
inline Bytes write_read_pdu(unsigned read_address, unsigned read_count, unsigned address,
                            unsigned count, unsigned bytes, unsigned value = 7) {
    Bytes pdu = pdu_of(23, {read_address, read_count, address, count});
    pdu.push_back(static_cast<uint8_t>(bytes));
    for (unsigned i = 0; i < bytes; ++i) pdu.push_back(static_cast<uint8_t>(i % 2 ? value : 0));
    return pdu;
}

// Sends a request and returns its exception, 0 for none, -1 for a closed connection.
inline int exception_of(const RawClient &client, const Bytes &pdu) {
    if (!client.send(frame_of(pdu))) return -1;
    const Bytes answer = client.answer();
    if (answer.size() < 2) return -1;
    assert_int_equal(answer[1] & 0x7F, pdu[0]);
    if ((answer[1] & 0x80) == 0) return 0;
    assert_int_equal(answer.size(), 3);
    return answer[2];
}

// libmodbus' own client over such a connection.
class ModbusClient {
public:
    explicit ModbusClient(int port, const char *own = "127.0.0.1")
        : raw_(port, own), context_(modbus_new_tcp("127.0.0.1", port), modbus_free) {
        modbus_set_socket(context_.get(), raw_.fd());
        modbus_set_response_timeout(context_.get(), kPatienceMs / 1000, 0);
        modbus_set_byte_timeout(context_.get(), kPatienceMs / 1000, 0);
    }

    modbus_t *get() const { return context_.get(); }
    const RawClient &raw() const { return raw_; }

private:
    RawClient raw_;
    std::unique_ptr<modbus_t, void (*)(modbus_t *)> context_;
};

// The status, checked value by value, as a client reads it that does nothing else.
inline bool reads_status(modbus_t *context) {
    uint16_t words[kStatusSize] = {};
    if (modbus_read_registers(context, kStatus, kStatusSize, words) != kStatusSize) return false;
    for (uint16_t i = 0; i < kStatusSize; ++i) {
        if (words[i] != kStatus + i) return false;
    }
    return true;
}

}  // namespace packcell_programs
