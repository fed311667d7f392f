#include "host/campaign/campaign.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "host/campaign/isolated.h"
#include "host/campaign/shrink.h"
#include "host/campaign/trial.h"
#include "host/campaign/trial_script.h"

namespace armada {
namespace {

TrialResult ResultOf(const IsolatedResult& isolated) {
  if (isolated.crash.empty()) return TrialResultOf(isolated.output);
  return {.violations = {{Invariant::kNoCrash, 0.0, 0, isolated.crash}}, .transitions = 0, .met = {}};
}

TrialResult RunAlone(const ScenarioConfig& trial, uint64_t seed) {
  TrialResult result;
  RunIsolated(
      1, 1, [&](size_t) { return ToText(RunTrial(trial, seed)); },
      [&](size_t, const IsolatedResult& isolated) { result = ResultOf(isolated); });
  return result;
}

/// The smallest trial that breaks the same invariant.
std::string WriteSmallest(const ScenarioConfig& trial, const FailedTrial& failed,
                          const std::string& directory) {
  const ScenarioConfig smallest = Shrink(trial, [&](const ScenarioConfig& simpler) {
    const Violations violations = RunAlone(simpler, failed.seed).violations;
    return std::any_of(violations.begin(), violations.end(), [&](const Violation& violation) {
      return violation.invariant == failed.violation.invariant;
    });
  });
  const std::string name = "seed_" + std::to_string(failed.seed);
  std::filesystem::create_directories(directory);
  std::string path = (std::filesystem::path(directory) / (name + ".toml")).string();
  std::ofstream file(path);
  file << ScriptOf(smallest, name, directory,
                   std::string("# Breaks: ") + TextOf(failed.violation.invariant) + ".\n#\n" +
                       "#   armada campaign " + path + " --replay --seed " + std::to_string(failed.seed) +
                       "\n");
  file.flush();
  if (!file) throw std::system_error(errno, std::generic_category(), path);
  return path;
}

}  // namespace

CampaignResult RunCampaign(const ScenarioConfig& base, const CampaignOptions& options,
                           const std::function<void(size_t, size_t)>& progress) {
  CampaignResult campaign;
  const auto seed_of = [&](size_t piece) { return options.first_seed + piece; };
  const auto trial_of = [&](size_t piece) { return options.replay ? base : DrawTrial(base, seed_of(piece)); };
  size_t done = 0;
  RunIsolated(
      options.trials, options.jobs,
      [&](size_t piece) { return ToText(RunTrial(trial_of(piece), seed_of(piece))); },
      [&](size_t piece, const IsolatedResult& isolated) {
        const TrialResult result = ResultOf(isolated);
        campaign.coverage.Add(trial_of(piece), result);
        if (!result.violations.empty()) {
          campaign.failed.push_back(
              {seed_of(piece), result.violations.front(), result.violations.size(), {}});
        }
        progress(++done, campaign.failed.size());
      });
  std::sort(campaign.failed.begin(), campaign.failed.end(),
            [](const FailedTrial& a, const FailedTrial& b) { return a.seed < b.seed; });
  for (FailedTrial& failed : campaign.failed) {
    if (!options.replay) {
      failed.script = WriteSmallest(DrawTrial(base, failed.seed), failed, options.directory);
    }
  }
  return campaign;
}

}  // namespace armada
