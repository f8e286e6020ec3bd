// Other programs that a bench starts and ends: the broker and the planners.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace packcell_programs {

// A program that runs until its owner goes; it does not outlive this process.
class ChildProcess {
public:
    // Searches PATH and the folders of system programs unless the name has a '/'. Throws Failure
    // where there is no such program. Its output goes to `log` (emptied first).
    ChildProcess(const std::vector<std::string> &arguments, const std::string &log);
    ~ChildProcess();  // asks it to end, then ends it
    ChildProcess(const ChildProcess &) = delete;
    ChildProcess &operator=(const ChildProcess &) = delete;

    bool running();
    void kill_now();  // SIGKILL, as a fault would; returns when it is gone
    pid_t id() const { return id_; }

private:
    pid_t id_ = -1;
};

// A folder that goes with its owner.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder &) = delete;
    TemporaryFolder &operator=(const TemporaryFolder &) = delete;

    std::string file(const std::string &name) const { return path_ + "/" + name; }

private:
    std::string path_;
};

// mosquitto on a free port of 127.0.0.1, without password and storage, ready when made.
class OwnBroker {
public:
    explicit OwnBroker(const TemporaryFolder &folder);
    uint16_t port() const { return port_; }

private:
    uint16_t port_ = 0;
    std::unique_ptr<ChildProcess> process_;
};

// A program of ours, beside the one that runs.
std::string program_beside(const std::string &name);

}  // namespace packcell_programs
