#include "pack/parallel_packer.hpp"

#include <thread>
#include <utility>
#include <vector>

#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

// How far a thread may run ahead of the first instance that is not done, so that memory stays
// bounded. The first one itself never waits: there is no deadlock.
constexpr size_t kInstancesAhead = 64;  // for each thread
constexpr size_t kBinsAhead = 1024;     // in one instance

}  // namespace

ParallelPacker::ParallelPacker(InstanceReader &reader, const PackOptions &options,
                               const pkc_policy *policy, BinSink &sink)
    : reader_(reader), options_(options), policy_(policy), sink_(sink) {}

void ParallelPacker::run(unsigned threads) {
    threads_ = threads;
    std::vector<std::thread> others;
    try {
        while (others.size() + 1 < threads) others.emplace_back([this] { work(); });
    } catch (...) {
        const std::lock_guard<std::mutex> lock(state_);
        fail(std::current_exception());
    }
    work();
    for (std::thread &other : others) other.join();
    if (failure_) std::rethrow_exception(failure_);
}

void ParallelPacker::work() {
    try {
        EpisodeRunner runner(options_, policy_);
        while (const std::shared_ptr<Job> job = next_job()) pack(runner, *job);
    } catch (...) {
        const std::lock_guard<std::mutex> lock(state_);
        fail(std::current_exception());
    }
}

std::shared_ptr<ParallelPacker::Job> ParallelPacker::next_job() {
    const std::lock_guard<std::mutex> reading(reading_);
    {
        std::unique_lock<std::mutex> lock(state_);
        changed_.wait(
            lock, [this] { return stopped_ || next_number_ - head_ < kInstancesAhead * threads_; });
        if (stopped_) return nullptr;
    }
    if (at_end_ || interrupt_signal() != 0) return nullptr;
    auto job = std::make_shared<Job>();
    std::exception_ptr error;
    try {
        std::optional<Instance> instance = reader_.next();
        at_end_ = !instance;
        if (at_end_) return nullptr;
        job->instance = std::move(*instance);
    } catch (...) {
        // Takes its place behind the instances before it, which are still being packed.
        at_end_ = true;
        error = std::current_exception();
    }
    {
        const std::lock_guard<std::mutex> lock(state_);
        job->number = next_number_++;
        jobs_.emplace(job->number, job);
    }
    if (!error) return job;
    finish(*job, error);
    return nullptr;
}

void ParallelPacker::pack(EpisodeRunner &runner, Job &job) {
    std::exception_ptr error;
    try {
        runner.run(job.instance, [&](Bin &&bin) { return deliver(job, std::move(bin)); });
    } catch (const std::exception &caught) {
        const Instance &instance = job.instance;
        error =
            std::make_exception_ptr(Failure(reader_.name() + ":" + std::to_string(instance.line) +
                                            ": instance '" + instance.id + "': " + caught.what()));
    }
    finish(job, error);
}

// Whether the instance should go on.
bool ParallelPacker::deliver(Job &job, Bin &&bin) {
    std::unique_lock<std::mutex> lock(state_);
    changed_.wait(lock,
                  [&] { return stopped_ || job.number == head_ || job.bins.size() < kBinsAhead; });
    if (stopped_) return false;
    if (job.number == head_) {
        hand_on(job, bin);
    } else {
        job.bins.push_back(std::move(bin));
    }
    return !stopped_ && interrupt_signal() == 0;
}

void ParallelPacker::finish(Job &job, std::exception_ptr error) {
    const std::lock_guard<std::mutex> lock(state_);
    job.finished = true;
    job.error = std::move(error);
    advance();
    changed_.notify_all();
}

// Hands on what the first jobs have ready, up to one that is still being packed. Holds state_.
void ParallelPacker::advance() {
    while (!stopped_) {
        const auto first = jobs_.find(head_);
        if (first == jobs_.end()) return;
        Job &job = *first->second;
        for (; !stopped_ && !job.bins.empty(); job.bins.pop_front()) {
            hand_on(job, job.bins.front());
        }
        if (!job.finished || stopped_) return;
        if (job.error) {
            fail(job.error);
            return;
        }
        try {
            sink_.instance_done(job.instance);
        } catch (...) {
            fail(std::current_exception());
            return;
        }
        jobs_.erase(first);
        ++head_;
    }
}

// Holds state_.
void ParallelPacker::hand_on(const Job &job, const Bin &bin) {
    try {
        sink_.bin_closed(job.instance, bin);
    } catch (...) {
        fail(std::current_exception());
    }
}

// Holds state_.
void ParallelPacker::fail(std::exception_ptr error) {
    if (!failure_) failure_ = std::move(error);
    stopped_ = true;
    changed_.notify_all();
}

}  // namespace packcell_programs
