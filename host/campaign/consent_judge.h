#pragma once

#include <vector>

#include "hil/emulated_arm.h"
#include "host/campaign/violation.h"

namespace armada {

/// Judges whether an operator wanted it: that a drive comes on, and that an arm follows.
class ConsentJudge {
 public:
  ConsentJudge(const ScenarioConfig& trial, Violations* violations);

  /// `state`: as the board tells it, the number on the wire.
  void OnState(size_t arm, double t_s, int state);
  void OnMoment(size_t arm, double t_s, const EmulatedArm& bench);

 private:
  struct Arm {
    int id;
    int told = 0;
    std::vector<bool> on;
  };

  /// Whether the operator has asked this of the arm within the last `within_s`.
  bool Asked(const Arm& arm, Request request, double t_s, double within_s) const;

  std::vector<OperatorConfig> operations_;
  bool starts_running_;
  std::vector<Arm> arms_;
  Violations* violations_;
};

}  // namespace armada
