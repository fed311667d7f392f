#include "host/sweep/sweep_command.h"

#include <unistd.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <mutex>
#include <thread>

#include "firmware/app/exit_codes.h"
#include "host/sim/simulation.h"
#include "host/sweep/sweep_result.h"

namespace armada {
namespace {

// "<first><separator><second>" as two numbers.
bool ParsePair(const std::string& text, char separator, uint64_t* first, uint64_t* second) {
  const char* end = text.data() + text.size();
  auto [middle, code] = std::from_chars(text.data(), end, *first);
  if (code != std::errc() || middle == end || *middle != separator) return false;
  auto [rest, second_code] = std::from_chars(middle + 1, end, *second);
  return second_code == std::errc() && rest == end;
}

/// Seeds of a sweep in turn to threads; results in the seeds' order, whoever computed them.
class Runner {
 public:
  Runner(const ScenarioConfig& scenario, std::vector<uint64_t> seeds)
      : scenario_(scenario), seeds_(std::move(seeds)), results_(seeds_.size()) {}

  std::vector<SeedResult> Run(int jobs, bool progress) {
    std::vector<std::thread> threads;
    threads.reserve(static_cast<size_t>(jobs));
    for (int i = 0; i < jobs; ++i) threads.emplace_back([this] { Work(); });
    if (progress) ShowProgress();
    for (std::thread& thread : threads) thread.join();
    return std::move(results_);
  }

 private:
  void Work() {
    for (size_t i = next_++; i < seeds_.size(); i = next_++) {
      results_[i] = SeedResult::Of(Simulation(scenario_, seeds_[i]).Run(nullptr));
      const std::lock_guard<std::mutex> lock(mutex_);
      ++done_;
      if (results_[i].ok) ++ok_;
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
      std::fprintf(stderr, "\r[%s%s] %zu/%zu seeds, %zu ok, %.0f s left ",
                   std::string(static_cast<size_t>(filled), '#').c_str(),
                   std::string(static_cast<size_t>(kWidth - filled), '.').c_str(), done_, seeds_.size(), ok_,
                   rest_s);
    }
    std::fputc('\n', stderr);
  }

  const ScenarioConfig& scenario_;
  std::vector<uint64_t> seeds_;
  std::vector<SeedResult> results_;
  std::atomic<size_t> next_{0};
  std::mutex mutex_;
  std::condition_variable changed_;
  size_t done_ = 0;
  size_t ok_ = 0;
};

int Usage(const std::string& message) {
  std::cerr << "armada sweep: " << message << '\n';
  return kExitUsage;
}

std::string Fixed(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

void PrintSummary(const SweepSummary& summary) {
  std::printf(
      "arm  diverged  unsettled  rms_mm: median      95%%    99.9%%  settled_s: median      95%%      max  "
      "worst seed\n");
  for (const SweepArmSummary& arm : summary.arms) {
    std::printf("%3d  %8lld  %9lld  %14.3f  %7.3f  %7.3f  %17.2f  %7.2f  %7.2f  %10llu\n", arm.id,
                static_cast<long long>(arm.diverged), static_cast<long long>(arm.never_settled),
                arm.rms_mm.median, arm.rms_mm.p95, arm.rms_mm.p999, arm.settled_s.median, arm.settled_s.p95,
                arm.settled_s.max, static_cast<unsigned long long>(arm.rms_mm.worst_seed));
  }
  std::printf("fleet RMS of all: median %.3f mm, 95%% %.3f mm, max %.3f mm (seed %llu)\n",
              summary.fleet_rms_all_mm.median, summary.fleet_rms_all_mm.p95, summary.fleet_rms_all_mm.max,
              static_cast<unsigned long long>(summary.fleet_rms_all_mm.worst_seed));
  const std::string fleet_rms =
      summary.fleet_rms_mm ? ", their RMS " + Fixed(*summary.fleet_rms_mm) + " mm" : std::string();
  std::printf("%lld of %lld fleets ok%s, estimator RMS %.3g mm\n", static_cast<long long>(summary.ok_count),
              static_cast<long long>(summary.count), fleet_rms.c_str(), summary.estimator_rms_x_m * 1e3);
  if (!summary.failed_seeds.empty()) {
    std::printf("not ok:");
    for (size_t i = 0; i < summary.failed_seeds.size() && i < 10; ++i) {
      std::printf(" %llu", static_cast<unsigned long long>(summary.failed_seeds[i]));
    }
    std::printf("%s\n", summary.failed_seeds.size() > 10 ? " .." : "");
  }
}

int Finish(const Sweep& sweep, const std::string& json) {
  const SweepSummary summary = Summarize(sweep.runs);
  PrintSummary(summary);
  std::string error;
  if (!json.empty() && !WriteJson(ToJson(sweep), json, &error)) {
    std::cerr << "armada sweep: " << error << '\n';
    return kExitFailed;
  }
  return summary.ok_count == summary.count ? kExitOk : kExitFailed;
}

}  // namespace

int RunSweepCommand(const SweepOptions& options) {
  uint64_t first = 0, last = 0, shard = 0, shards = 0;
  if (!ParsePair(options.seeds, ':', &first, &last) || last < first) {
    return Usage("--seeds " + options.seeds + ": allowed is A:B with A <= B");
  }
  if (!ParsePair(options.shard, '/', &shard, &shards) || shard < 1 || shard > shards) {
    return Usage("--shard " + options.shard + ": allowed is I/N with 1 <= I <= N");
  }
  const auto scenario = options.scenario.Load();
  if (!scenario) return kExitBadConfig;
  std::vector<uint64_t> seeds;
  for (uint64_t seed = first + shard - 1; seed <= last; seed += shards) seeds.push_back(seed);
  const int jobs =
      options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const bool progress = isatty(STDERR_FILENO) != 0;
  return Finish(
      {scenario->name, options.scenario.Overrides(), Runner(*scenario, std::move(seeds)).Run(jobs, progress)},
      options.json);
}

int RunSweepMergeCommand(const std::vector<std::string>& files, const std::string& json) {
  std::vector<Sweep> shards;
  for (const std::string& path : files) {
    std::ifstream file(path);
    if (!file) return Usage("cannot read " + path);
    std::string error;
    const auto parsed = nlohmann::ordered_json::parse(file, nullptr, false);
    const auto shard =
        parsed.is_discarded() ? (error = "not JSON", std::nullopt) : SweepFromJson(parsed, &error);
    if (!shard) return Usage(std::string(path).append(": ").append(error));
    shards.push_back(*shard);
  }
  std::string error;
  const auto merged = Merge(shards, &error);
  if (!merged) return Usage(error);
  return Finish(*merged, json);
}

}  // namespace armada
