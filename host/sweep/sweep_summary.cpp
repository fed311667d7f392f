#include "host/sweep/sweep_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace armada {
namespace {

// The arm with the largest figure, and that figure; kNoFigure where an arm has none.
template <class FigureOf>
WorstSeed WorstArm(const ResultTable& results, size_t row, const FigureOf& figure_of) {
  WorstSeed worst{results.seed(row), 0, 0.0};
  for (size_t i = 0; i < results.arm_ids().size(); ++i) {
    const double figure = figure_of(i);
    if (std::isnan(figure)) return {worst.seed, 0, kNoFigure};
    if (figure >= worst.value) worst = {worst.seed, results.arm_ids()[i], figure};
  }
  return worst;
}

bool AnyDiverged(const ResultTable& results, size_t row) {
  for (size_t i = 0; i < results.arm_ids().size(); ++i) {
    if (results.diverged(i)[row] != 0.0) return true;
  }
  return false;
}

// Unless an arm diverged, whose figures would hide all others.
WorstSeed WorstMax(const ResultTable& results, size_t row) {
  return WorstArm(results, row, [&](size_t arm) {
    return results.diverged(arm)[row] != 0.0 ? kNoFigure : results.max_mm(arm)[row];
  });
}

WorstSeed LastToSettle(const ResultTable& results, size_t row) {
  return WorstArm(results, row, [&](size_t arm) { return results.settled_s(arm)[row]; });
}

SweepArmSummary SummarizeArm(const ResultTable& results, size_t arm) {
  SweepArmSummary summary;
  summary.id = results.arm_ids()[arm];
  const auto seed_of = [&](size_t row) { return results.seed(row); };
  const auto where_it_stayed = [&](std::span<const double> figures) {
    return DistributionOf(
        results.rows(),
        [&results, arm, figures](size_t row) {
          return results.diverged(arm)[row] != 0.0 ? kNoFigure : figures[row];
        },
        seed_of);
  };
  summary.rms_mm = where_it_stayed(results.rms_mm(arm));
  summary.max_mm = where_it_stayed(results.max_mm(arm));
  summary.floor_mm = where_it_stayed(results.floor_rms_mm(arm));
  summary.over_floor = DistributionOf(
      results.rows(),
      [&](size_t row) {
        return results.diverged(arm)[row] != 0.0 ? kNoFigure
                                                 : results.rms_mm(arm)[row] / results.floor_rms_mm(arm)[row];
      },
      seed_of);
  summary.settled_s = DistributionOf(
      results.rows(), [&](size_t row) { return results.settled_s(arm)[row]; }, seed_of);
  const auto rows = static_cast<int64_t>(results.rows());
  summary.diverged = rows - summary.rms_mm.count;
  summary.never_settled = rows - summary.settled_s.count;
  return summary;
}

}  // namespace

void WorstSeeds::Add(const WorstSeed& seed) {
  const auto place = std::find_if(list_.begin(), list_.end(),
                                  [&](const WorstSeed& listed) { return seed.value >= listed.value; });
  list_.insert(place, seed);
  if (list_.size() > kCount) list_.pop_back();
}

SweepSummary Summarize(const ResultTable& results) {
  SweepSummary summary;
  const size_t rows = results.rows();
  const size_t arms = results.arm_ids().size();
  summary.count = static_cast<int64_t>(rows);
  summary.has_floors = results.has_floors();
  double ok_squares = 0.0;
  double floor_squares = 0.0;
  double estimator_squares = 0.0;
  for (size_t row = 0; row < rows; ++row) {
    const double fleet_rms_mm = results.fleet_rms_mm()[row];
    if (results.ok(row)) {
      ++summary.ok_count;
      ok_squares += fleet_rms_mm * fleet_rms_mm;
      floor_squares += std::pow(results.fleet_floor_rms_mm()[row], 2);
    } else if (summary.failed_seeds.size() < SweepSummary::kFailedSeedsListed) {
      summary.failed_seeds.push_back(results.seed(row));
    }
    for (size_t i = 0; i < arms; ++i) estimator_squares += std::pow(results.estimator_x_m(i)[row], 2);
    if (AnyDiverged(results, row)) continue;
    const WorstSeed rms = WorstArm(results, row, [&](size_t arm) { return results.rms_mm(arm)[row]; });
    summary.worst_rms_mm.Add({rms.seed, rms.arm, fleet_rms_mm});
    summary.worst_max_mm.Add(WorstMax(results, row));
    if (const WorstSeed last = LastToSettle(results, row); !std::isnan(last.value))
      summary.worst_settled_s.Add(last);
  }
  if (summary.ok_count > 0)
    summary.fleet_rms_mm = std::sqrt(ok_squares / static_cast<double>(summary.ok_count));
  if (summary.has_floors && summary.ok_count > 0)
    summary.floor_rms_mm = std::sqrt(floor_squares / static_cast<double>(summary.ok_count));
  if (rows * arms > 0)
    summary.estimator_rms_x_m = std::sqrt(estimator_squares / static_cast<double>(rows * arms));

  const auto seed_of = [&](size_t row) { return results.seed(row); };
  summary.fleet_rms_all_mm = DistributionOf(
      rows, [&](size_t row) { return results.fleet_rms_mm()[row]; }, seed_of);
  summary.fleet_over_floor = DistributionOf(
      rows,
      [&](size_t row) {
        return AnyDiverged(results, row) ? kNoFigure
                                         : results.fleet_rms_mm()[row] / results.fleet_floor_rms_mm()[row];
      },
      seed_of);
  summary.fleet_max_mm = DistributionOf(
      rows, [&](size_t row) { return WorstMax(results, row).value; }, seed_of);
  summary.fleet_settled_s = DistributionOf(
      rows, [&](size_t row) { return LastToSettle(results, row).value; }, seed_of);
  for (size_t i = 0; i < arms; ++i) summary.arms.push_back(SummarizeArm(results, i));
  return summary;
}

}  // namespace armada
