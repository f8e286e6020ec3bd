// Clients of the Modbus server that drip, flood, lie or never read, and what the others notice.
#include <ifaddrs.h>

#include <atomic>
#include <cstdio>
#include <random>

#include "gateway/modbus_test.hpp"

namespace packcell_programs {
namespace {

bool is_served(const Served &served) {
    try {
        const ModbusClient client(served.port());
        return reads_status(client.get());
    } catch (const std::runtime_error &) {
        return false;
    }
}

void test_doubtful_framing_ends_the_connection(void **) {
    const Bytes sound = frame_of(read_pdu(200, 1));
    const auto with = [&](size_t place, uint8_t value) {
        Bytes frame = sound;
        frame[place] = value;
        return frame;
    };
    const std::vector<Bytes> doubtful{
        // The protocol id.
        with(2, 1),
        with(3, 1),
        // Lengths 262, 65286, 0, 1, 255; the last whole too.
        with(4, 1),
        with(4, 0xFF),
        with(5, 0),
        with(5, 1),
        with(5, 255),
        frame_of(Bytes(254, 43)),
        // Function codes of answers.
        with(7, 0x80),
        with(7, 0x83),
        with(7, 0xFF),
        // A byte too few and too many for function code 3, and no room for the fields of others.
        with(5, 5),
        frame_of({3, 0, 200, 0, 1, 0}),
        frame_of({3}),
        frame_of({6, 0, 96}),
        frame_of({16}),
        frame_of({23, 0, 0}),
        // More or fewer values than the byte count says.
        frame_of({16, 0, 96, 0, 1, 2, 0}),
        frame_of({16, 0, 96, 0, 1, 2, 0, 7, 0}),
        frame_of({16, 0, 96, 0, 1, 255, 0, 7}),
        frame_of({23, 0, 200, 0, 1, 0, 96, 0, 1, 2, 0}),
        frame_of({23, 0, 200, 0, 1, 0, 96, 0, 1, 255, 0, 7}),
        frame_of({23, 0, 200, 0, 1, 0, 96, 0, 1, 0, 0, 7}),
    };
    Served served(Served::patient());
    for (const Bytes &frame : doubtful) {
        const RawClient client(served.port());
        // What is sound and came before is answered still.
        assert_int_equal(exception_of(client, read_pdu(200, 1)), 0);
        assert_true(client.send(frame));
        assert_true(client.is_closed());
    }
    assert_int_equal(served.registers().writes().size(), 0);
    assert_true(served.logged("closed: protocol id is not 0"));
}

void test_a_ninth_connection_is_refused(void **) {
    Served served;
    std::vector<RawClient> clients;
    for (int i = 0; i < 8; ++i) {
        clients.emplace_back(served.port());
        assert_int_equal(exception_of(clients.back(), read_pdu(200, 1)), 0);
    }
    for (int i = 0; i < 20; ++i) assert_true(RawClient(served.port()).is_closed());
    assert_true(served.logged("connection refused: all 8 places are taken"));
    for (const RawClient &client : clients) {
        assert_int_equal(exception_of(client, read_pdu(200, 1)), 0);
    }
    // A place is free as soon as the server has noticed that a client left.
    for (size_t i = 0; i < 8; ++i) {
        clients[i].leave();
        assert_true(eventually([&] {
            RawClient again(served.port());
            if (exception_of(again, read_pdu(200, 1)) != 0) return false;
            clients[i] = std::move(again);
            return true;
        }));
    }
    // At once, when it was the server that ended the connection.
    assert_true(clients[0].send({0, 1, 9, 9, 9, 9}));
    assert_true(clients[0].is_closed());
    assert_int_equal(exception_of(RawClient(served.port()), read_pdu(200, 1)), 0);
}

void test_a_frame_has_its_time(void **) {
    ModbusOptions options;
    options.frame_ms = 100;
    Served served(options);
    const Bytes frame = frame_of(read_pdu(200, 1));
    for (const size_t sent : {size_t{1}, size_t{6}, frame.size() - 1}) {
        const RawClient client(served.port());
        const auto start = TestClock::now();
        assert_true(client.send(Bytes(frame.begin(), frame.begin() + static_cast<long>(sent))));
        assert_true(client.is_closed());
        assert_true(TestClock::now() - start >= std::chrono::milliseconds(95));
    }
    // The rest of a frame behind a whole one has its time too.
    const RawClient client(served.port());
    Bytes both = frame;
    both.insert(both.end(), {0, 2, 0});
    assert_true(client.send(both));
    assert_true(client.answer() == Bytes({1, 3, 2, 0, 200}));
    assert_true(client.is_closed());
    assert_true(eventually([&] { return served.logged("closed: a frame took too long"); }));
}

void test_silence_has_its_time(void **) {
    ModbusOptions options;
    options.idle_s = 1;
    options.frame_ms = kPatienceMs;
    Served served(options);
    const RawClient silent(served.port());
    const RawClient talker(served.port());
    const auto start = TestClock::now();
    assert_int_equal(exception_of(talker, read_pdu(200, 1)), 0);
    assert_true(silent.is_closed());
    assert_true(TestClock::now() - start >= std::chrono::milliseconds(900));
    assert_true(talker.is_closed());
    assert_true(eventually([&] { return served.logged("closed: nothing came for too long"); }));
}

// Keeps `count` connections busy that send a request one byte every `pause_ms` each, and connects
// anew what the server closes.
class Drippers {
public:
    Drippers(int port, size_t count, int pause_ms)
        : thread_([this, port, count, pause_ms] {
              const Bytes frame = frame_of(read_pdu(200, 32));
              std::vector<std::unique_ptr<RawClient>> clients(count);
              for (size_t next = 0; !stopping_; ++next) {
                  for (std::unique_ptr<RawClient> &client : clients) {
                      if (client && client->waits(POLLIN, 0)) {
                          client.reset();
                          ++closed_;
                      }
                      if (!client) client = std::make_unique<RawClient>(port);
                      client->send({frame[next % frame.size()]});
                  }
                  std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
              }
          }) {}
    ~Drippers() {
        stopping_ = true;
        thread_.join();
    }

    int closed() const { return closed_; }

private:
    std::atomic<bool> stopping_{false};
    std::atomic<int> closed_{0};
    std::thread thread_;
};

// A server that serves one client after the other would stall for whole seconds.
void test_dripping_clients_hold_up_nobody(void **) {
    for (const int pause_ms : {50, 400}) {
        Served served;
        const ModbusClient client(served.port());
        assert_true(reads_status(client.get()));
        const Drippers drippers(served.port(), 7, pause_ms);
        std::vector<double> took;
        // Until each of them has been thrown out twice on average.
        while (took.size() < 1000 || drippers.closed() < 14) {
            const auto start = TestClock::now();
            assert_true(reads_status(client.get()));
            took.push_back(
                std::chrono::duration<double, std::milli>(TestClock::now() - start).count());
        }
        std::sort(took.begin(), took.end());
        const double p99 = took[took.size() * 99 / 100];
        std::printf("7 clients drip a byte per %d ms: p99 of %zu reads %.3f ms, worst %.3f ms\n",
                    pause_ms, took.size(), p99, took.back());
        // 50 ms is the aim; the bound leaves room for a loaded machine.
        assert_true(p99 < 250);
        assert_true(served.logged("closed: a frame took too long"));
    }
}

Bytes random_bytes(std::mt19937_64 &random, size_t most) {
    Bytes bytes(random() % (most + 1));
    for (uint8_t &byte : bytes) byte = static_cast<uint8_t>(random());
    return bytes;
}

// Bytes of one of several kinds of nonsense; none of them may write.
Bytes garbage(std::mt19937_64 &random) {
    switch (random() % 6) {
        case 0:
            return random_bytes(random, 600);
        case 1: {
            const std::string http = "GET / HTTP/1.1\r\nHost: packcell\r\n\r\n";
            return Bytes(http.begin(), http.end());
        }
        case 2: {  // truncated
            Bytes frame = frame_of(write_pdu(96, 4, 8));
            frame.resize(random() % frame.size());
            return frame;
        }
        case 3: {  // a length that is not the frame's
            Bytes frame = frame_of(read_pdu(200, 32));
            frame[4] = static_cast<uint8_t>(random());
            frame[5] = static_cast<uint8_t>(random());
            return frame;
        }
        case 4: {  // sound frames around random reads
            Bytes bytes;
            for (uint64_t n = random() % 5; n > 0; --n) {
                Bytes pdu = random_bytes(random, 20);
                pdu.insert(pdu.begin(), random() % 2 == 0 ? 3 : 4);
                const Bytes frame = frame_of(pdu);
                bytes.insert(bytes.end(), frame.begin(), frame.end());
            }
            return bytes;
        }
        default: {  // a random tail behind function code 23, outside what may be written
            Bytes frame = frame_of(write_read_pdu(200, 32, 0xFFF0, 16, 32));
            for (size_t i = 16; i < frame.size(); ++i) frame[i] = static_cast<uint8_t>(random());
            return frame;
        }
    }
}

void test_garbage_is_survived(void **) {
    const uint64_t seed = 20240611;
    std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
    std::mt19937_64 random(seed);
    ModbusOptions options;
    options.frame_ms = 50;
    Served served(options);
    for (int i = 0; i < 2000; ++i) {
        RawClient client(served.port());
        client.send(garbage(random));
        if (random() % 4 == 0) {
            client.reset();
        } else {
            // Until the server has dealt with all of it and closed: it would refuse the next ones
            // while all places are taken.
            shutdown(client.fd(), SHUT_WR);
            client.receive(1 << 16);
        }
    }
    assert_true(eventually([&] { return is_served(served); }));
    assert_int_equal(served.registers().writes().size(), 0);
    assert_true(served.lines().size() < 200);
}

// With the signal's default action: a write to a closed connection would end the test.
void test_clients_that_vanish_raise_no_signal(void **) {
    Served served(Served::patient());
    Bytes requests;
    for (unsigned i = 0; i < 200; ++i) {
        const Bytes frame = frame_of(read_pdu(0, 104), i);
        requests.insert(requests.end(), frame.begin(), frame.end());
    }
    for (int i = 0; i < 200; ++i) {
        RawClient client(served.port());
        client.send(requests);
        client.reset();
    }
    assert_true(eventually([&] { return is_served(served); }));
}

void test_a_client_that_never_reads_is_closed(void **) {
    ModbusOptions options;
    options.frame_ms = 100;
    Served served(options);
    const RawClient client(served.port());
    Bytes requests;
    for (unsigned i = 0; i < 1000; ++i) {
        const Bytes frame = frame_of(read_pdu(0, 104), i);
        requests.insert(requests.end(), frame.begin(), frame.end());
    }
    // Sends until the answers fill all buffers and the server has had enough.
    size_t sent = 0;
    assert_true(eventually([&] {
        const size_t place = sent % requests.size();
        const ssize_t n = send(client.fd(), requests.data() + place, requests.size() - place,
                               MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n > 0) sent += static_cast<size_t>(n);
        return served.logged("closed: answer not sent");
    }));
    assert_true(is_served(served));
}

// An address of this machine beside the loopback's, or nothing.
std::string other_own_address() {
    ifaddrs *first = nullptr;
    if (getifaddrs(&first) != 0) return "";
    std::string found;
    for (const ifaddrs *at = first; at != nullptr; at = at->ifa_next) {
        if (at->ifa_addr == nullptr || at->ifa_addr->sa_family != AF_INET) continue;
        const auto *name = reinterpret_cast<const sockaddr_in *>(at->ifa_addr);
        const Ipv4 address = ntohl(name->sin_addr.s_addr);
        if (!is_loopback(address)) found = ipv4_text(address);
    }
    freeifaddrs(first);
    return found;
}

void test_peers_outside_the_list_are_closed(void **) {
    const std::string own = other_own_address();
    if (own.empty()) skip();
    for (const bool allowed : {false, true}) {
        ModbusOptions options;
        options.bind = "0.0.0.0";
        const Ipv4 neighbour = *parse_ipv4(own) ^ 1U;
        options.allow = {(allowed ? own : ipv4_text(neighbour)) + "/32"};
        Served served(options);
        const RawClient client(served.port(), own.c_str(), own.c_str());
        if (allowed) {
            assert_int_equal(exception_of(client, read_pdu(200, 1)), 0);
            assert_int_equal(exception_of(client, write_pdu(96, 1, 2)), 2);
        } else {
            assert_true(client.is_closed());
            assert_true(eventually([&] {
                return served.logged("connection refused: not in the networks of --allow");
            }));
        }
        assert_true(is_served(served));
    }
}

void test_stop_under_load(void **) {
    Served served;
    const RawClient silent(served.port());
    const RawClient half(served.port());
    assert_true(half.send({0, 1, 0}));
    std::atomic<int> answered{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 6; ++i) {
        threads.emplace_back([&] {
            const ModbusClient client(served.port());
            const uint16_t beat = 1;
            while (modbus_write_registers(client.get(), 96, 1, &beat) == 1 &&
                   reads_status(client.get())) {
                ++answered;
            }
        });
    }
    const bool under_load = eventually([&] { return answered > 100; });
    const auto start = TestClock::now();
    std::thread also([&] { served.server().stop(); });
    served.server().stop();
    const auto took = TestClock::now() - start;
    also.join();
    for (std::thread &thread : threads) thread.join();
    std::printf("stopped within %.1f ms\n",
                std::chrono::duration<double, std::milli>(took).count());
    assert_true(under_load);
    // 1 s is the aim.
    assert_true(took < std::chrono::seconds(5));
    assert_true(silent.is_closed());
    // Nobody is left waiting in a queue that is no longer served.
    bool is_refused = false;
    try {
        const RawClient late(served.port());
    } catch (const std::runtime_error &) {
        is_refused = true;
    }
    assert_true(is_refused);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_doubtful_framing_ends_the_connection),
        cmocka_unit_test(test_a_ninth_connection_is_refused),
        cmocka_unit_test(test_a_frame_has_its_time),
        cmocka_unit_test(test_silence_has_its_time),
        cmocka_unit_test(test_dripping_clients_hold_up_nobody),
        cmocka_unit_test(test_garbage_is_survived),
        cmocka_unit_test(test_clients_that_vanish_raise_no_signal),
        cmocka_unit_test(test_a_client_that_never_reads_is_closed),
        cmocka_unit_test(test_peers_outside_the_list_are_closed),
        cmocka_unit_test(test_stop_under_load),
    };
    return cmocka_run_group_tests_name("modbus hostile", tests, nullptr, nullptr);
}
