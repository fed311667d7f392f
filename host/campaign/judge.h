#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/campaign/consent_judge.h"
#include "host/campaign/following_judge.h"
#include "host/campaign/torque_judge.h"
#include "host/sim/simulation_watch.h"

namespace armada {

/// Watches a trial and judges it by what can be seen from outside: frames, messages, motion. It shares no
/// code with the supervisor that it judges.
class Judge final : public SimulationWatch {
 public:
  explicit Judge(const ScenarioConfig& trial);

  void Enter(size_t arm) override;
  void Leave(size_t arm) override;
  void OnFrame(size_t arm, double t_s, const CanFrame& frame) override;
  void OnEstimate(size_t arm, double t_s, std::span<const uint8_t> payload) override;
  void OnMoment(size_t arm, double t_s, const EmulatedArm& bench, double error_m) override;

  const Violations& violations() const { return violations_; }
  /// The state that the arm of each fault told of last before the fault came; none where there is no such
  /// arm.
  const std::vector<std::optional<int>>& met() const { return met_; }

 private:
  /// Faults that have come meet their arms in the state that these tell of now.
  void NoteMeetings(double t_s);

  Violations violations_;
  TorqueJudge torques_;
  ConsentJudge consent_;
  FollowingJudge following_;
  std::vector<FaultConfig> faults_;
  std::vector<int> ids_;
  std::vector<int> told_;
  std::vector<std::optional<int>> met_;
  uint64_t allocations_ = 0;  ///< at Enter()
  double now_s_ = 0.0;
  bool allocated_ = false;
};

}  // namespace armada
