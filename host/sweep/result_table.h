#pragma once

#include <limits>
#include <span>
#include <vector>

#include "host/sweep/seed_result.h"

namespace armada {

/// In place of a figure that there is not.
inline constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

/// Results of a sweep, a row a seed. They lie in a temporary file without a name, mapped into memory: the
/// kernel keeps of it what there is room for, and a sweep of any number of seeds needs no more of the heap
/// than one of ten.
class ResultTable {
 public:
  /// Room for `rows` seeds of a fleet of these arms. Throws std::system_error when the disk has none.
  ResultTable(size_t rows, std::vector<int> arm_ids);
  ResultTable(ResultTable&& other) noexcept;
  ResultTable& operator=(ResultTable&& other) noexcept;
  ~ResultTable();

  size_t rows() const { return rows_; }
  const std::vector<int>& arm_ids() const { return arm_ids_; }

  /// @pre `result` is of these arms. Different rows may be set at the same time.
  void Set(size_t row, const SeedResult& result);
  SeedResult At(size_t row) const;

  /// The seeds were measured against their floors.
  bool has_floors() const;
  uint64_t seed(size_t row) const;
  bool ok(size_t row) const { return Column(kOk)[row] != 0.0; }

  /// Figures by row.
  std::span<const double> fleet_rms_mm() const { return Column(kFleetRms); }
  std::span<const double> fleet_floor_rms_mm() const { return Column(kFleetFloor); }  ///< NaN: not asked for
  std::span<const double> rms_mm(size_t arm) const { return ArmColumn(arm, kRms); }
  std::span<const double> max_mm(size_t arm) const { return ArmColumn(arm, kMax); }
  std::span<const double> estimator_x_m(size_t arm) const { return ArmColumn(arm, kEstimator); }
  std::span<const double> diverged(size_t arm) const { return ArmColumn(arm, kDiverged); }  ///< 0 or 1
  std::span<const double> floor_rms_mm(size_t arm) const {  ///< NaN: not asked for
    return ArmColumn(arm, kFloor);
  }
  std::span<const double> settled_s(size_t arm) const { return ArmColumn(arm, kSettled); }  ///< NaN: never

 private:
  enum { kSeed, kOk, kFleetRms, kFleetFloor, kFleetColumns };
  enum { kDiverged, kSettled, kRms, kMax, kEstimator, kFloor, kArmColumns };
  std::span<const double> Column(size_t column) const { return {values_ + column * rows_, rows_}; }
  std::span<const double> ArmColumn(size_t arm, size_t column) const {
    return Column(kFleetColumns + arm * kArmColumns + column);
  }
  size_t bytes() const { return (kFleetColumns + arm_ids_.size() * kArmColumns) * rows_ * sizeof(double); }

  size_t rows_;
  std::vector<int> arm_ids_;
  double* values_ = nullptr;  ///< column after column
};

}  // namespace armada
