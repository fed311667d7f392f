#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/ablate/ablation_rows.h"
#include "host/sweep/seed_range.h"
#include "host/sweep/sweep_summary.h"

namespace armada {

/// The fleet with one component taken out, or whole, over the seeds.
struct AblationResult {
  const AblationRow* row = nullptr;  ///< null: nothing is taken out
  std::string refused;               ///< why the scenario does not allow this row; the rest is then nothing
  SweepSummary summary;
  double diverged_share = 0.0;  ///< of all arms of all seeds
  std::optional<double> ratio;  ///< of the RMS to the whole law's, over the seeds in which both are ok
};

struct Ablation {
  std::string scenario;
  std::string scenario_file;
  std::vector<std::string> overrides;  ///< of every row
  SeedRange seeds;
  std::vector<AblationResult> rows;  ///< the whole law first
};

/// What the seeds say of one row. `whole` is the whole law's table, of the same seeds.
AblationResult Compare(const AblationRow* row, const ResultTable& results, const ResultTable& whole);

/// "3 % of the fleets, RMS 2.5 times smaller": what the component earns in the whole law, `with` it; or
/// costs.
std::string Earnings(const AblationResult& with, const AblationResult& without);

void PrintAblation(const Ablation& ablation, std::ostream& out);
/// The schema of docs/metrics.md.
nlohmann::ordered_json ToJson(const Ablation& ablation);

}  // namespace armada
