#include "host/ablate/ablation.h"

#include <cmath>

#include "host/json.h"

namespace armada {
namespace {

// Less than this is within what other seeds would give.
constexpr double kNoticeable = 0.02;

double Share(int64_t part, int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

std::string Short(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

AblationResult Compare(const AblationRow* row, const ResultTable& results, const ResultTable& whole) {
  AblationResult result{row, "", Summarize(results), 0.0, std::nullopt};
  int64_t diverged = 0;
  for (const SweepArmSummary& arm : result.summary.arms) diverged += arm.diverged;
  const auto arms = static_cast<int64_t>(result.summary.arms.size());
  result.diverged_share = Share(diverged, arms * result.summary.count);

  double squares = 0.0;
  double whole_squares = 0.0;
  for (size_t i = 0; i < results.rows(); ++i) {
    if (!results.ok(i) || !whole.ok(i)) continue;
    squares += std::pow(results.fleet_rms_mm()[i], 2);
    whole_squares += std::pow(whole.fleet_rms_mm()[i], 2);
  }
  if (whole_squares > 0.0) result.ratio = std::sqrt(squares / whole_squares);
  return result;
}

std::string Earnings(const AblationResult& with, const AblationResult& without) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  const SweepSummary& a = with.summary;
  const SweepSummary& b = without.summary;
  const double fleets = Share(a.ok_count, a.count) - Share(b.ok_count, b.count);
  if (fleets != 0.0) add(Short(100.0 * fleets) + " % of the fleets");
  if (without.ratio && *without.ratio > 1.0 + kNoticeable)
    add("RMS " + Short(*without.ratio) + " times smaller");
  if (without.ratio && *without.ratio < 1.0 - kNoticeable)
    add("RMS " + Short(1.0 / *without.ratio) + " times larger");
  const Distribution& settled = a.fleet_settled_s;
  const Distribution& settled_without = b.fleet_settled_s;
  // Of fewer fleets it would be another sample: the easy ones.
  if (settled.count > 0 && settled_without.count == settled.count) {
    const auto compare = [&](const char* what, double mine, double other) {
      if (std::abs(other / mine - 1.0) > kNoticeable)
        add(std::string(what) + " settling " + Short(mine) + " s instead of " + Short(other) + " s");
    };
    compare("median", settled.median, settled_without.median);
    compare("worst", settled.max, settled_without.max);
  }
  return text.empty() ? "nothing here" : text;
}

nlohmann::ordered_json ToJson(const Ablation& ablation) {
  Json rows = Json::array();
  for (const AblationResult& result : ablation.rows) {
    Json row = {{"without", result.row != nullptr ? Json(result.row->component) : Json(nullptr)},
                {"set", result.row != nullptr ? Json(result.row->overrides) : Json::array()},
                {"refused", result.refused.empty() ? Json(nullptr) : Json(result.refused)}};
    if (result.refused.empty()) {
      const SweepSummary& summary = result.summary;
      row["count"] = summary.count;
      row["ok_count"] = summary.ok_count;
      row["diverged_share"] = result.diverged_share;
      row["fleet_settled_s"] = ToJson(summary.fleet_settled_s);
      row["fleet_rms_mm"] = summary.fleet_rms_mm ? Json(*summary.fleet_rms_mm) : Json(nullptr);
      row["fleet_rms_all_mm"] = ToJson(summary.fleet_rms_all_mm);
      row["ratio"] = result.ratio ? Json(*result.ratio) : Json(nullptr);
      row["failed_seeds"] = summary.failed_seeds;
      if (result.row != nullptr) {
        row["purpose"] = result.row->purpose;
        row["earns"] = Earnings(ablation.rows.front(), result);
      }
    }
    rows.push_back(row);
  }
  return {{"schema", 1},
          {"mode", "ablation"},
          {"scenario", ablation.scenario},
          {"scenario_file", ablation.scenario_file},
          {"set", ablation.overrides},
          {"first_seed", ablation.seeds.first},
          {"last_seed", ablation.seeds.last},
          {"rows", rows}};
}

}  // namespace armada
