#include "gateway/modbus/connection.hpp"

#include <cerrno>
#include <chrono>
#include <exception>
#include <new>
#include <optional>
#include <string>

#include "common/errors.hpp"

namespace packcell_programs {

namespace {

std::string range_text(unsigned address, unsigned count) {
    return std::to_string(address) + ".." + std::to_string(address + count - 1);
}

}  // namespace

void ModbusConnection::FreeContext::operator()(modbus_t *context) const noexcept {
    modbus_free(context);
}

ModbusConnection::ModbusConnection(int fd, ModbusPeer peer, const ModbusOptions &options,
                                   const ModbusAccess &access, RegisterPort &port,
                                   EventLimiter &events)
    : peer_(peer),
      access_(access),
      port_(port),
      events_(events),
      reader_(fd, std::chrono::milliseconds(options.frame_ms),
              std::chrono::seconds(options.idle_s)),
      context_(modbus_new_tcp("127.0.0.1", MODBUS_TCP_DEFAULT_PORT)) {  // neither is used
    if (!context_) throw std::bad_alloc();
    modbus_set_socket(context_.get(), fd);
}

void ModbusConnection::serve(const std::atomic<bool> &stopping) {
    events_.report("connected", peer_.text() + ": connected");
    for (;;) {
        const FrameReader::End end = reader_.next();
        if (stopping) return;
        if (end != FrameReader::End::kFrame) return report_end(end);
        if (!answer()) {
            if (stopping) return;
            const int error = errno;
            events_.report("unsent answers",
                           peer_.text() + ": closed: " + system_message("answer not sent", error));
            return;
        }
    }
}

// False when the answer could not be sent whole; errno says why.
bool ModbusConnection::answer() {
    uint8_t *frame = reader_.frame();
    ModbusRequest request;
    unsigned exception = parse_request(frame, reader_.size(), request);
    if (exception == 0) exception = carry_out(request);
    if (exception != 0) return modbus_reply_exception(context_.get(), frame, exception) > 0;

    // The mapping is this connection's own copy; what modbus_reply() writes to it goes nowhere.
    // With function code 23 it would answer what was asked to be written, where the two ranges
    // overlap, and not what is there.
    if (request.read_count > 0 && request.write_count > 0) {
        put_written_values(frame, image_.data() + request.write_address, request.write_count);
    }
    modbus_mapping_t mapping{};
    mapping.nb_registers = mapping.nb_input_registers = kRegisters;
    mapping.tab_registers = mapping.tab_input_registers = image_.data();
    const int size = static_cast<int>(reader_.size());
    return modbus_reply(context_.get(), frame, size, &mapping) > 0;
}

// Returns 0 or the exception by which the request is refused; then nothing has been written.
unsigned ModbusConnection::carry_out(const ModbusRequest &request) {
    const bool reads = request.read_count > 0;
    const bool writes = request.write_count > 0;
    if (reads && !is_readable(request.read_address, request.read_count)) {
        return MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS;
    }
    if (writes && !may_write(request)) return MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS;
    try {
        if (writes) {
            port_.write(static_cast<uint16_t>(request.write_address), request.values.data(),
                        static_cast<uint16_t>(request.write_count));
        }
        if (reads) port_.read(image_);
    } catch (const std::exception &error) {
        events_.report("failed requests",
                       peer_.text() + ": request answered by exception 4: " + error.what());
        return MODBUS_EXCEPTION_SLAVE_OR_SERVER_FAILURE;
    }
    return 0;
}

bool ModbusConnection::may_write(const ModbusRequest &request) {
    std::optional<std::string> refusal;
    if (!is_writable(request.write_address, request.write_count)) {
        refusal = "not all of them are commands or link";
    } else {
        refusal = access_.write_refusal(peer_.address, request.write_address, request.write_count);
    }
    if (!refusal) return true;
    events_.report("refused writes", peer_.text() + ": write to registers " +
                                         range_text(request.write_address, request.write_count) +
                                         " refused: " + *refusal);
    return false;
}

void ModbusConnection::report_end(FrameReader::End end) {
    const std::string closed = peer_.text() + ": closed: ";
    switch (end) {
        case FrameReader::End::kIdle:
            return events_.report("idle connections", closed + "nothing came for too long");
        case FrameReader::End::kSlow:
            return events_.report("slow frames", closed + "a frame took too long");
        case FrameReader::End::kDoubt:
            return events_.report("doubtful frames", closed + reader_.doubt());
        case FrameReader::End::kFrame:
        case FrameReader::End::kClosed:
            return events_.report("disconnected", peer_.text() + ": disconnected");
    }
}

}  // namespace packcell_programs
