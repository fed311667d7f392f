#pragma once

#include <string>
#include <vector>

#include "hil/scenario.h"
#include "host/run/run_command.h"

namespace armada {

/// Command lines of a run's programs, without what says whose time they take.
class RunLines {
 public:
  /// Both are to outlive this object.
  RunLines(const RunOptions& options, const ScenarioConfig& scenario)
      : options_(options), scenario_(scenario) {}

  std::vector<std::string> Emulation(int64_t epoch_ns) const;
  std::vector<std::string> Leader(int64_t epoch_ns) const;
  /// `anew`: the board has been killed before. It comes up as one does that an operator has switched on: in
  /// MONITOR, drives off.
  std::vector<std::string> Board(int arm_id, bool anew, int64_t epoch_ns) const;
  std::vector<std::string> LcmLogger() const;

  /// A path in the run's folder.
  std::string In(const std::string& name) const;

 private:
  std::string Program(const char* name) const;
  std::string Seconds() const { return std::to_string(scenario_.seconds); }

  const RunOptions& options_;
  const ScenarioConfig& scenario_;
};

}  // namespace armada
