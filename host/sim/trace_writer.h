#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "firmware/core/zeta.h"
#include "hil/scenario.h"

namespace armada {

/// One row of arm_<id>.csv: an arm at one tick.
struct TraceRow {
  double t_s = 0.0;
  JointVector q_rad, dq_rad_s, tau_Nm;
  TaskVector x_m, v_m_s;
  Zeta zeta;
  double error_m = 0.0;  ///< |x - x_0|
  double sigma_min = 0.0;
  double manipulability = 0.0;
  double subtask_error_rad_s = 0.0;
  bool synced = false;
  double clearance_m = 0.0;  ///< written for an arm with obstacles only
};

/// Writes the CSV files of a run: leader.csv and arm_<id>.csv, one row a tick (docs/metrics.md lists the
/// columns).
class TraceWriter {
 public:
  /// Creates the files in `directory`. On failure ok() is false and error() says why.
  TraceWriter(const std::string& directory, const FleetConfig& fleet);

  void Leader(double t_s, const Zeta& zeta);
  void Arm(size_t index, const TraceRow& row);
  /// Flushes everything; false when something could not be written.
  bool Close();

  bool ok() const { return error_.empty(); }
  const std::string& error() const { return error_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, CloseFile>;
  File Create(const std::string& path);
  /// Keeps the first thing that went wrong with a file.
  void Note(std::FILE* file, const std::string& path);
  std::string PathOf(size_t index) const;

  std::string directory_;
  std::string error_;
  File leader_;
  std::vector<int> ids_;  ///< of the arms
  std::vector<File> arms_;
  std::vector<bool> has_obstacles_;  ///< by arm
};

}  // namespace armada
