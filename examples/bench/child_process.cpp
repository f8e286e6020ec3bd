#include "bench/child_process.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/clock.hpp"
#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

using std::chrono::milliseconds;
constexpr milliseconds kPolled{10};
constexpr milliseconds kEndLimit{5000};
constexpr milliseconds kBrokerLimit{10'000};
constexpr int kBrokerAttempts = 5;  // a free port may be taken before the broker has it
constexpr const char *kSystemFolders = ":/usr/sbin:/usr/local/sbin:/sbin";

std::string find_program(const std::string &name) {
    if (name.find('/') != std::string::npos) return name;
    const char *path = std::getenv("PATH");
    std::string folders = std::string(path == nullptr ? "" : path) + kSystemFolders + ":";
    for (size_t colon = folders.find(':'); colon != std::string::npos; colon = folders.find(':')) {
        std::string file = folders.substr(0, colon) + "/" + name;
        if (access(file.c_str(), X_OK) == 0) return file;
        folders.erase(0, colon + 1);
    }
    throw Failure(name + ": no such program; must be installed");
}

sockaddr_in loopback(uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

uint16_t free_port() {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0) throw Failure(system_message("socket", errno));
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    auto *const generic = reinterpret_cast<sockaddr *>(&address);
    const bool bound = bind(fd, generic, size) == 0 && getsockname(fd, generic, &size) == 0;
    const int error_number = errno;
    close(fd);
    if (!bound) throw Failure(system_message("a free port", error_number));
    return ntohs(address.sin_port);
}

bool accepts(uint16_t port) {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0) return false;
    const sockaddr_in address = loopback(port);
    const bool connected =
        connect(fd, reinterpret_cast<const sockaddr *>(&address), sizeof address) == 0;
    close(fd);
    return connected;
}

// Between fork and exec: nothing here may take memory or a lock.
[[noreturn]] void become(const char *file, char *const *arguments, int log, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);
    setpgid(0, 0);  // Ctrl-C is for us, who then end it
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    execv(file, arguments);
    _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string> &arguments, const std::string &log) {
    const std::string file = find_program(arguments.at(0));
    std::vector<char *> pointers;
    pointers.reserve(arguments.size() + 1);
    for (const std::string &argument : arguments) {
        pointers.push_back(const_cast<char *>(argument.c_str()));
    }
    pointers.push_back(nullptr);
    const int fd = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (fd < 0) throw Failure(system_message(log, errno));
    const pid_t parent = getpid();
    id_ = fork();
    if (id_ == 0) become(file.c_str(), pointers.data(), fd, parent);
    const int error_number = errno;
    close(fd);
    if (id_ < 0) throw Failure(system_message("fork", error_number));
}

ChildProcess::~ChildProcess() {
    if (!running()) return;
    kill(id_, SIGTERM);
    for (const Clock::time_point end = Clock::now() + kEndLimit; Clock::now() < end;) {
        if (!running()) return;
        std::this_thread::sleep_for(kPolled);
    }
    kill_now();
}

bool ChildProcess::running() {
    if (id_ < 0) return false;
    if (waitpid(id_, nullptr, WNOHANG) == 0) return true;
    id_ = -1;
    return false;
}

void ChildProcess::kill_now() {
    if (!running()) return;
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
    id_ = -1;
}

TemporaryFolder::TemporaryFolder() {
    path_ = (std::filesystem::temp_directory_path() / "packcell-bench-XXXXXX").string();
    if (mkdtemp(path_.data()) == nullptr) throw Failure(system_message(path_, errno));
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

OwnBroker::OwnBroker(const TemporaryFolder &folder) {
    for (int attempt = 0; attempt < kBrokerAttempts; ++attempt) {
        port_ = free_port();
        const std::string configuration = folder.file("mosquitto.conf");
        std::ofstream(configuration) << "listener " << port_ << " 127.0.0.1\n"
                                     << "allow_anonymous true\n"
                                     << "persistence false\n"
                                     << "set_tcp_nodelay true\n"
                                     << "log_type error\n";
        process_ = std::make_unique<ChildProcess>(
            std::vector<std::string>{"mosquitto", "-c", configuration}, folder.file("broker.log"));
        const Clock::time_point end = Clock::now() + kBrokerLimit;
        while (process_->running() && Clock::now() < end && interrupt_signal() == 0) {
            if (accepts(port_)) return;
            std::this_thread::sleep_for(kPolled);
        }
    }
    throw Failure("mosquitto: does not start on a free port of 127.0.0.1");
}

std::string program_beside(const std::string &name) {
    std::string file =
        (std::filesystem::read_symlink("/proc/self/exe").parent_path() / name).string();
    if (access(file.c_str(), X_OK) != 0) throw Failure(system_message(file, errno));
    return file;
}

}  // namespace packcell_programs
