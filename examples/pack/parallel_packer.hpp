// Packs the instances of a reader on several threads and hands their bins on in input order.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "common/episode.hpp"
#include "common/instance_reader.hpp"

namespace packcell_programs {

// Receives what is done, in input order and never from two threads at once. What it throws ends
// the work.
class BinSink {
public:
    virtual ~BinSink() = default;
    virtual void bin_closed(const Instance &instance, const Bin &bin) = 0;
    virtual void instance_done(const Instance &instance) = 0;
};

class ParallelPacker {
public:
    // All must outlive the packer.
    ParallelPacker(InstanceReader &reader, const PackOptions &options, const pkc_policy *policy,
                   BinSink &sink);

    // Until the reader is at its end, an interrupt came, or something failed; then the first
    // failure in input order is thrown, after all bins before it were handed on.
    void run(unsigned threads);

private:
    // An instance from when it was read until it and all before it are done.
    struct Job {
        size_t number = 0;
        Instance instance;
        std::deque<Bin> bins;  // closed, and not handed on yet
        bool finished = false;
        std::exception_ptr error;
    };

    void work();
    std::shared_ptr<Job> next_job();
    void pack(EpisodeRunner &runner, Job &job);
    bool deliver(Job &job, Bin &&bin);
    void finish(Job &job, std::exception_ptr error);
    void advance();
    void hand_on(const Job &job, const Bin &bin);
    void fail(std::exception_ptr error);

    InstanceReader &reader_;
    const PackOptions &options_;
    const pkc_policy *policy_;
    BinSink &sink_;
    unsigned threads_ = 1;

    std::mutex reading_;  // taken before state_, never after it
    bool at_end_ = false;
    size_t next_number_ = 0;

    std::mutex state_;
    std::condition_variable changed_;
    std::map<size_t, std::shared_ptr<Job>> jobs_;
    size_t head_ = 0;  // number of the first job that is not done
    bool stopped_ = false;
    std::exception_ptr failure_;
};

}  // namespace packcell_programs
