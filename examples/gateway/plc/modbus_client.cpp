#include "gateway/plc/modbus_client.hpp"

#include <cerrno>

#include "common/errors.hpp"
#include "common/numbers.hpp"
#include "common/options.hpp"

namespace packcell_programs {

namespace {

constexpr auto kPause = std::chrono::milliseconds(100);
constexpr uint32_t kAnswerMicroseconds = 500'000;  // half of what the gateway calls a lost PLC

}  // namespace

Address read_address(const std::string &flag, const std::string &value) {
    const size_t colon = value.rfind(':');
    const auto port =
        colon == std::string::npos ? std::nullopt : parse_unsigned(value.substr(colon + 1));
    if (!port || *port < 1 || *port > UINT16_MAX || colon == 0)
        refuse_value(flag, value, "HOST:PORT with a port of 1..65535");
    return {value.substr(0, colon), static_cast<uint16_t>(*port)};
}

std::string address_text(const Address &address) {
    return address.host + ":" + std::to_string(address.port);
}

void ModbusClient::Close::operator()(modbus_t *context) const {
    modbus_close(context);
    modbus_free(context);
}

bool ModbusClient::connect() {
    if (context_) return true;
    const Clock::time_point now = Clock::now();
    if (now < next_try_) return false;
    next_try_ = now + kPause;
    std::unique_ptr<modbus_t, Close> context(
        modbus_new_tcp_pi(address_.host.c_str(), std::to_string(address_.port).c_str()));
    if (!context) throw Failure(system_message("modbus", errno));
    modbus_set_response_timeout(context.get(), 0, kAnswerMicroseconds);
    if (modbus_connect(context.get()) != 0) {
        why_ = modbus_strerror(errno);
        return false;
    }
    context_ = std::move(context);
    ++connections_;
    return true;
}

// Whether what arrives next belongs to the next request is not known, so the connection goes.
bool ModbusClient::lose(uint16_t address, uint16_t count) {
    const int error = errno;
    why_ = modbus_strerror(error);
    context_.reset();
    if (error == EMBXILFUN || error == EMBXILADD || error == EMBXILVAL) {
        throw Failure(address_text(address_) + ": registers " + std::to_string(address) + ".." +
                      std::to_string(address + count - 1) + ": " + why_ +
                      ": must be allowed to this client");
    }
    return false;
}

bool ModbusClient::read(uint16_t address, uint16_t count, uint16_t *values) {
    if (!connect()) return false;
    if (modbus_read_registers(context_.get(), address, count, values) == count) return true;
    return lose(address, count);
}

bool ModbusClient::write(uint16_t address, uint16_t count, const uint16_t *values) {
    if (!connect()) return false;
    if (modbus_write_registers(context_.get(), address, count, values) == count) return true;
    return lose(address, count);
}

}  // namespace packcell_programs
