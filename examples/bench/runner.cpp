#include "bench/runner.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/progress.hpp"

namespace packcell_programs {

namespace {

class JobRunner {
public:
    JobRunner(const std::vector<Job> &jobs, const std::string &unit)
        : jobs_(jobs), progress_(true, unit) {
        for (const Job &job : jobs) bins_ += job.bins;
    }

    void run(unsigned threads) {
        std::vector<std::thread> others;
        try {
            while (others.size() + 1 < std::min<size_t>(threads, jobs_.size())) {
                others.emplace_back([this] { work(); });
            }
        } catch (...) {
            fail(std::current_exception());
        }
        work();
        for (std::thread &other : others) other.join();
        progress_.clear();
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    void work() {
        try {
            while (!stopped()) {
                const size_t index = next_++;
                if (index >= jobs_.size()) return;
                const Job &job = jobs_[index];
                job.run([&] { return bin_done(job); });
            }
        } catch (...) {
            fail(std::current_exception());
        }
    }

    bool stopped() const { return failed_ || interrupt_signal() != 0; }

    bool bin_done(const Job &job) {
        const std::lock_guard<std::mutex> lock(mutex_);
        ++done_;
        progress_.update(static_cast<double>(done_) / static_cast<double>(bins_), done_, job.name);
        return !stopped();
    }

    void fail(std::exception_ptr error) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!failure_) failure_ = std::move(error);
        failed_ = true;
    }

    const std::vector<Job> &jobs_;
    int64_t bins_ = 0;
    std::atomic<size_t> next_{0};
    std::atomic<bool> failed_{false};
    std::mutex mutex_;
    uint64_t done_ = 0;
    Progress progress_;
    std::exception_ptr failure_;
};

void pack(Configuration &configuration, const BinDone &bin_done) {
    EpisodeRunner runner(configuration.options, configuration.policy.get());
    Figures &figures = configuration.figures;
    bool go_on = true;
    for (const Instance &instance : *configuration.work) {
        BufferReplay buffers;
        runner.run(instance, [&](Bin &&bin) {
            add_bin(figures, bin);
            buffers.replay(bin);
            go_on = bin_done();
            return go_on && figures.bins < configuration.bins;
        });
        figures.largest_buffer =
            std::max(figures.largest_buffer, static_cast<int64_t>(buffers.largest()));
        if (!go_on || figures.bins >= configuration.bins) return;
    }
    throw Failure(configuration.name + ": the items ended after " + std::to_string(figures.bins) +
                  " of " + std::to_string(configuration.bins) + " bins; please report it");
}

}  // namespace

void run_jobs(const std::vector<Job> &jobs, unsigned threads, const std::string &unit) {
    JobRunner(jobs, unit).run(threads);
}

Job packing_job(Configuration &configuration) {
    return Job{configuration.name, configuration.bins,
               [&configuration](const BinDone &bin_done) { pack(configuration, bin_done); }};
}

void run_configurations(std::vector<Configuration> &configurations, unsigned threads) {
    std::vector<Job> jobs;
    jobs.reserve(configurations.size());
    for (Configuration &configuration : configurations) jobs.push_back(packing_job(configuration));
    run_jobs(jobs, threads);
}

}  // namespace packcell_programs
