#include "host/sweep/seed_jobs.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace armada {
namespace {

class Runner {
 public:
  Runner(const SeedRange& seeds, const SeedJob& job) : seeds_(seeds), job_(job) {}

  void Run(int jobs, bool progress) {
    std::vector<std::thread> threads;
    threads.reserve(static_cast<size_t>(jobs));
    for (int i = 0; i < jobs; ++i) threads.emplace_back([this] { Work(); });
    if (progress) ShowProgress();
    for (std::thread& thread : threads) thread.join();
  }

 private:
  void Work() {
    for (size_t i = next_++; i < seeds_.size(); i = next_++) {
      const bool ok = job_(i, seeds_[i]);
      const std::lock_guard<std::mutex> lock(mutex_);
      ++done_;
      if (!ok) ++not_ok_;
      changed_.notify_one();
    }
  }

  void ShowProgress() {
    const auto start = std::chrono::steady_clock::now();
    std::unique_lock<std::mutex> lock(mutex_);
    while (done_ < seeds_.size()) {
      changed_.wait_for(lock, std::chrono::milliseconds(200));
      const double share = static_cast<double>(done_) / static_cast<double>(seeds_.size());
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      const double rest_s = share > 0.0 ? elapsed.count() * (1.0 / share - 1.0) : 0.0;
      constexpr int kWidth = 40;
      const int filled = static_cast<int>(share * kWidth);
      std::fprintf(stderr, "\r[%s%s] %zu/%zu seeds, %zu not ok, %.0f s left ",
                   std::string(static_cast<size_t>(filled), '#').c_str(),
                   std::string(static_cast<size_t>(kWidth - filled), '.').c_str(), done_, seeds_.size(),
                   not_ok_, rest_s);
    }
    std::fputc('\n', stderr);
  }

  SeedRange seeds_;
  const SeedJob& job_;
  std::atomic<size_t> next_{0};
  std::mutex mutex_;
  std::condition_variable changed_;
  size_t done_ = 0;
  size_t not_ok_ = 0;
};

}  // namespace

void RunSeedJobs(const SeedRange& seeds, int jobs, const SeedJob& job) {
  if (jobs <= 0) jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  Runner(seeds, job).Run(jobs, isatty(STDERR_FILENO) != 0);
}

}  // namespace armada
