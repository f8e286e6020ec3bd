#include "fleet/mqtt_client.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <memory>
#include <random>

#include "common/errors.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFirstPause{250};
constexpr milliseconds kLongestPause{8000};
constexpr int kLoopMilliseconds = 100;  // so that stop() is heard in any state
constexpr milliseconds kFarewell{500};  // for the broker to take the last packet
constexpr size_t kLongestPassword = 65535;
constexpr int kRefusedSubscription = 0x80;  // reason codes from here on are errors
constexpr const char *kShare = "$share/";

struct Library {
    Library() { mosquitto_lib_init(); }
    ~Library() { mosquitto_lib_cleanup(); }
};

void open_library() { static const Library library; }

std::string unique_client_id() {
    char host[64] = "";
    gethostname(host, sizeof host - 1);
    std::random_device random;
    char digits[16];
    std::snprintf(digits, sizeof digits, "%08x", static_cast<unsigned>(random()));
    return "packcell-" + file_name_part(host, sizeof host) + "-" + std::to_string(getpid()) + "-" +
           digits;
}

void need(int code, const std::string &what) {
    if (code != MOSQ_ERR_SUCCESS) throw Failure(what + ": " + mosquitto_strerror(code));
}

void need_readable(const std::string &flag, const std::string &path) {
    if (path.empty()) return;
    std::ifstream file(path);
    if (!file || file.peek() == std::ifstream::traits_type::eof()) {
        throw Failure(flag + " '" + one_line(path) + "': must be a file that can be read");
    }
}

std::string read_password(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    std::string line;
    if (!file || !std::getline(file, line)) {
        throw Failure("--mqtt-password-file '" + one_line(path) +
                      "': must be a file whose first line is the password");
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.size() > kLongestPassword || line.find('\0') != std::string::npos) {
        throw Failure("--mqtt-password-file '" + one_line(path) + "': must begin with a line of " +
                      "at most 65535 bytes without NUL");
    }
    return line;
}

// What a subscription's messages are matched against.
std::string plain_filter(const std::string &filter) {
    if (filter.rfind(kShare, 0) != 0) return filter;
    const size_t slash = filter.find('/', std::string(kShare).size());
    return slash == std::string::npos ? filter : filter.substr(slash + 1);
}

struct PropertiesFree {
    void operator()(mosquitto_property *list) const { mosquitto_property_free_all(&list); }
};
using Properties = std::unique_ptr<mosquitto_property, PropertiesFree>;

Properties make_properties(const MqttMessage &message) {
    mosquitto_property *list = nullptr;
    int code = MOSQ_ERR_SUCCESS;
    if (!message.response_topic.empty()) {
        code = mosquitto_property_add_string(&list, MQTT_PROP_RESPONSE_TOPIC,
                                             message.response_topic.c_str());
    }
    if (code == MOSQ_ERR_SUCCESS && !message.correlation.empty()) {
        code = mosquitto_property_add_binary(
            &list, MQTT_PROP_CORRELATION_DATA, message.correlation.data(),
            static_cast<uint16_t>(std::min<size_t>(message.correlation.size(), UINT16_MAX)));
    }
    if (code == MOSQ_ERR_SUCCESS && message.expiry_seconds > 0) {
        code = mosquitto_property_add_int32(&list, MQTT_PROP_MESSAGE_EXPIRY_INTERVAL,
                                            message.expiry_seconds);
    }
    Properties owner(list);
    need(code, "MQTT properties");
    return owner;
}

void read_properties(const mosquitto_property *list, MqttMessage &message) {
    char *text = nullptr;
    if (mosquitto_property_read_string(list, MQTT_PROP_RESPONSE_TOPIC, &text, false) != nullptr) {
        message.response_topic = text;
        free(text);
    }
    void *bytes = nullptr;
    uint16_t size = 0;
    if (mosquitto_property_read_binary(list, MQTT_PROP_CORRELATION_DATA, &bytes, &size, false) !=
        nullptr) {
        message.correlation.assign(static_cast<const char *>(bytes), size);
        free(bytes);
    }
    uint32_t seconds = 0;
    if (mosquitto_property_read_int32(list, MQTT_PROP_MESSAGE_EXPIRY_INTERVAL, &seconds, false) !=
        nullptr) {
        message.expiry_seconds = seconds;
    }
}

}  // namespace

// No exception may pass through libmosquitto: what they call is guarded.
struct MqttClient::Callbacks {
    static MqttClient &client(void *self) { return *static_cast<MqttClient *>(self); }

    static void connect(mosquitto *, void *self, int reason, int, const mosquitto_property *) {
        client(self).connected(reason);
    }

    static void subscribe(mosquitto *, void *self, int mid, int count, const int *granted,
                          const mosquitto_property *) {
        client(self).subscribed(mid, count, granted);
    }

    static void unsubscribe(mosquitto *, void *self, int mid, const mosquitto_property *) {
        client(self).unsubscribed(mid);
    }

    static void publish(mosquitto *, void *self, int mid, int, const mosquitto_property *) {
        client(self).published(mid);
    }

    static void message(mosquitto *, void *self, const mosquitto_message *got,
                        const mosquitto_property *properties) {
        client(self).guarded([&] {
            MqttMessage message;
            message.topic = got->topic;
            message.payload.assign(static_cast<const char *>(got->payload),
                                   static_cast<size_t>(got->payloadlen));
            message.qos = got->qos;
            message.retain = got->retain;
            read_properties(properties, message);
            client(self).received(message);
        });
    }
};

MqttClient::MqttClient(const MqttOptions &options)
    : options_(options),
      client_id_(options.client_id.empty() ? unique_client_id() : options.client_id) {
    open_library();
    handle_ = mosquitto_new(client_id_.c_str(), true, this);
    if (handle_ == nullptr) throw Failure(system_message("MQTT client", errno));
    try {
        need(mosquitto_threaded_set(handle_, true), "MQTT client");
        need(mosquitto_int_option(handle_, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5),
             "MQTT version 5");
        need(mosquitto_int_option(handle_, MOSQ_OPT_TCP_NODELAY, 1), "TCP_NODELAY");
        configure_password();
        configure_tls();
    } catch (...) {
        mosquitto_destroy(handle_);
        throw;
    }
    mosquitto_connect_v5_callback_set(handle_, Callbacks::connect);
    mosquitto_subscribe_v5_callback_set(handle_, Callbacks::subscribe);
    mosquitto_unsubscribe_v5_callback_set(handle_, Callbacks::unsubscribe);
    mosquitto_publish_v5_callback_set(handle_, Callbacks::publish);
    mosquitto_message_v5_callback_set(handle_, Callbacks::message);
}

MqttClient::~MqttClient() {
    stop();
    mosquitto_destroy(handle_);
}

void MqttClient::configure_password() {
    if (options_.user.empty()) return;
    const std::string password =
        options_.password_file.empty() ? "" : read_password(options_.password_file);
    need(mosquitto_username_pw_set(handle_, options_.user.c_str(),
                                   options_.password_file.empty() ? nullptr : password.c_str()),
         "--mqtt-user '" + one_line(options_.user) + "'");
}

void MqttClient::configure_tls() {
    if (options_.tls_ca.empty()) return;
    need_readable("--mqtt-tls-ca", options_.tls_ca);
    need_readable("--mqtt-tls-cert", options_.tls_cert);
    need_readable("--mqtt-tls-key", options_.tls_key);
    const auto or_none = [](const std::string &path) {
        return path.empty() ? nullptr : path.c_str();
    };
    // Without it a key with a password would ask for it on the terminal.
    const auto no_password = [](char *, int, int, void *) { return 0; };
    need(mosquitto_tls_set(handle_, options_.tls_ca.c_str(), nullptr, or_none(options_.tls_cert),
                           or_none(options_.tls_key), no_password),
         "TLS");
    need(mosquitto_tls_insecure_set(handle_, options_.tls_insecure), "--mqtt-tls-insecure");
}

void MqttClient::set_will(const MqttWill &will) {
    need(mosquitto_will_set_v5(handle_, will.topic.c_str(), static_cast<int>(will.payload.size()),
                               will.payload.data(), will.qos, will.retain, nullptr),
         "last will on topic '" + one_line(will.topic) + "'");
}

std::string MqttClient::broker() const {
    return "broker " + options_.host + ":" + std::to_string(options_.port);
}

// ---- Connection --------------------------------------------------------------------------------

void MqttClient::start() {
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
}

void MqttClient::stop() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    mosquitto_disconnect_v5(handle_, MQTT_RC_NORMAL_DISCONNECTION, nullptr);
    thread_.join();
}

// Not mosquitto_loop_start(): its thread ends for good where a host name is not known for a while
// or TLS fails once.
void MqttClient::run() {
    milliseconds pause = kFirstPause;
    std::unique_lock<std::mutex> lock(mutex_);
    while (!stopping_) {
        was_connected_ = false;
        refusal_.clear();
        lock.unlock();
        errno = 0;
        const int code = attempt();
        const int error_number = errno;
        lock.lock();
        if (stopping_) break;
        std::string reason = refusal_;
        if (reason.empty()) {
            reason = code == MOSQ_ERR_ERRNO && error_number != 0 && error_number != EPROTO
                         ? system_message("connection", error_number)
                         : mosquitto_strerror(code);
        }
        if (was_connected_) pause = kFirstPause;
        lock.unlock();
        set_state(MqttState::kAway, broker() + ": " + one_line(reason, 200));
        lock.lock();
        changed_.wait_for(lock, pause, [this] { return stopping_; });
        pause = std::min(2 * pause, kLongestPause);
    }
    state_ = MqttState::kAway;
}

// One connection from its beginning to its end; the code says how it ended.
int MqttClient::attempt() {
    int code =
        mosquitto_connect_async(handle_, options_.host.c_str(), options_.port, options_.keepalive);
    const auto stopping = [this] {
        const std::lock_guard<std::mutex> lock(mutex_);
        return stopping_;
    };
    while (code == MOSQ_ERR_SUCCESS && !stopping()) {
        code = mosquitto_loop(handle_, kLoopMilliseconds, 1);
    }
    const auto end = std::chrono::steady_clock::now() + kFarewell;
    while (code == MOSQ_ERR_SUCCESS && std::chrono::steady_clock::now() < end) {
        code = mosquitto_loop(handle_, kLoopMilliseconds, 1);
    }
    return code;
}

void MqttClient::connected(int reason) {
    if (reason != 0) {
        const std::lock_guard<std::mutex> lock(mutex_);
        refusal_ = std::string("refused: ") + mosquitto_reason_string(reason);
        return;
    }
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        was_connected_ = true;
    }
    set_state(MqttState::kConnected, broker());
    guarded([this] { renew_subscriptions(); });
    set_ready_if_granted();
}

void MqttClient::set_state(MqttState state, const std::string &detail) {
    bool known = false;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        const std::string news = std::to_string(static_cast<int>(state)) + detail;
        known = news == told_;
        state_ = state;
        told_ = news;
    }
    changed_.notify_all();
    if (known || !on_state_) return;
    try {
        on_state_(state, detail);
    } catch (const std::exception &) {
        // Nobody is left who could be told.
    }
}

void MqttClient::guarded(const std::function<void()> &handler) {
    try {
        handler();
    } catch (const std::exception &error) {
        set_state(state(), std::string("a handler failed: ") + one_line(error.what(), 200));
    }
}

MqttState MqttClient::state() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return state_;
}

bool MqttClient::wait_ready(milliseconds limit) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, limit, [this] { return state_ == MqttState::kReady; });
}

// ---- Subscriptions -----------------------------------------------------------------------------

void MqttClient::subscribe(const std::string &filter, int qos, OnMessage handler) {
    need(mosquitto_sub_topic_check(filter.c_str()), "subscription '" + one_line(filter) + "'");
    const std::lock_guard<std::mutex> dispatch(dispatch_mutex_);
    const std::lock_guard<std::mutex> lock(mutex_);
    Subscription &subscription = subscriptions_[filter];
    subscription = Subscription{qos, std::move(handler), 0, false};
    if (state_ == MqttState::kAway) return;
    state_ = MqttState::kConnected;
    request_subscription(filter, subscription);
}

// The acknowledgement waits for mutex_, so that it finds the mid.
void MqttClient::request_subscription(const std::string &filter, Subscription &subscription) {
    subscription.granted = false;
    mosquitto_subscribe(handle_, &subscription.mid, filter.c_str(), subscription.qos);
}

void MqttClient::renew_subscriptions() {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto &[filter, subscription] : subscriptions_) request_subscription(filter, subscription);
}

void MqttClient::set_ready_if_granted() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (state_ != MqttState::kConnected) return;
        for (const auto &[filter, subscription] : subscriptions_) {
            if (!subscription.granted) return;
        }
    }
    set_state(MqttState::kReady, broker());
}

void MqttClient::subscribed(int mid, int granted_count, const int *granted) {
    std::string refused;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        for (auto &[filter, subscription] : subscriptions_) {
            if (subscription.mid != mid) continue;
            subscription.granted = granted_count > 0 && granted[0] < kRefusedSubscription;
            if (!subscription.granted) refused = filter;
        }
    }
    if (!refused.empty()) {
        set_state(
            MqttState::kConnected,
            broker() + ": refuses the subscription '" + one_line(refused) + "'" +
                (granted_count > 0 ? std::string(" (") + mosquitto_reason_string(granted[0]) + ")"
                                   : ""));
    }
    set_ready_if_granted();
}

void MqttClient::unsubscribe(const std::string &filter, milliseconds limit) {
    int mid = 0;
    std::unique_lock<std::mutex> lock(mutex_);
    if (subscriptions_.count(filter) == 0) return;
    if (state_ != MqttState::kAway &&
        mosquitto_unsubscribe(handle_, &mid, filter.c_str()) == MOSQ_ERR_SUCCESS) {
        unsubscribing_.insert(mid);
        changed_.wait_for(lock, limit, [&] {
            return unsubscribing_.count(mid) == 0 || state_ == MqttState::kAway;
        });
        unsubscribing_.erase(mid);
    }
    lock.unlock();
    const std::lock_guard<std::mutex> dispatch(dispatch_mutex_);
    lock.lock();
    subscriptions_.erase(filter);
}

void MqttClient::unsubscribed(int mid) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        unsubscribing_.erase(mid);
    }
    changed_.notify_all();
}

void MqttClient::received(const MqttMessage &message) {
    const std::lock_guard<std::mutex> dispatch(dispatch_mutex_);
    for (const auto &[filter, subscription] : subscriptions_) {
        bool matches = false;
        mosquitto_topic_matches_sub(plain_filter(filter).c_str(), message.topic.c_str(), &matches);
        if (matches) subscription.handler(message);
    }
}

// ---- Publishing --------------------------------------------------------------------------------

std::optional<int> MqttClient::publish(const MqttMessage &message) {
    const std::string where = "topic '" + one_line(message.topic) + "'";
    need(mosquitto_pub_topic_check(message.topic.c_str()), where);
    if (message.payload.size() > MQTT_MAX_PAYLOAD) {
        throw Failure(where + ": " + std::to_string(message.payload.size()) +
                      " bytes: must be at most " + std::to_string(MQTT_MAX_PAYLOAD));
    }
    const Properties properties = make_properties(message);
    const std::lock_guard<std::mutex> publishing(publish_mutex_);
    int mid = 0;
    const int code = mosquitto_publish_v5(
        handle_, &mid, message.topic.c_str(), static_cast<int>(message.payload.size()),
        message.payload.data(), message.qos, message.retain, properties.get());
    const bool away = code == MOSQ_ERR_NO_CONN || code == MOSQ_ERR_CONN_LOST;
    if (away && message.qos == 0) return std::nullopt;
    if (!away) need(code, where);
    if (message.qos > 0) {
        const std::lock_guard<std::mutex> lock(mutex_);
        unacknowledged_.insert(mid);
    }
    return mid;
}

void MqttClient::published(int mid) {
    {
        const std::lock_guard<std::mutex> publishing(publish_mutex_);
        const std::lock_guard<std::mutex> lock(mutex_);
        unacknowledged_.erase(mid);
    }
    changed_.notify_all();
    if (on_published_) guarded([&] { on_published_(mid); });
}

size_t MqttClient::unacknowledged() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return unacknowledged_.size();
}

bool MqttClient::flush(milliseconds limit) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, limit, [this] { return unacknowledged_.empty(); });
}

}  // namespace packcell_programs
