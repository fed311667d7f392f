#pragma once

#include <optional>
#include <vector>

#include "firmware/app/arm_node.h"
#include "hil/emulated_arm.h"
#include "hil/tracking_record.h"
#include "host/sim/board_process.h"
#include "host/sim/simulation_watch.h"
#include "host/sim/trace_writer.h"
#include "host/sim/virtual_network.h"
#include "host/sim/virtual_operator.h"
#include "host/subtask_record.h"

namespace armada {

/// A scenario in virtual time and in one thread: every arm's whole ArmNode with its drive and message codecs,
/// its emulated bench, and the network between, with the scenario's faults in all of them. The same scenario
/// and seed give the same bytes.
class Simulation {
 public:
  /// `watch` (may be null) outlives the object.
  Simulation(const ScenarioConfig& scenario, uint64_t seed, SimulationWatch* watch = nullptr);

  /// Runs to the end. `trace` may be null.
  RunMetrics Run(TraceWriter* trace);

  /// What each arm without a fault has learnt of its dynamics, into `folder`/arm_<id>.toml: the start.learned
  /// of another run. False with *error set.
  bool WriteLearned(const std::string& folder, std::string* error) const;

  /// One bit for each of kTransitions: taken by some board so far.
  uint32_t TransitionsTaken() const;

 private:
  struct Arm {
    ArmNode node;
    EmulatedArm bench;
    BoardProcess process;
    TrackingRecord record;
    SubtaskRecord subtask_record;
    ParameterVector theta;  ///< true parameters
    EstimatorRms estimator_squares{};
    EstimatorMax estimator_max{};
    double joint_speed_max_rad_s = 0.0;
    int64_t window_ticks = 0;
    double torque_max_Nm = 0.0;
    JointVector floor_posture_rad{};
  };

  void BringUp();
  void Exchange(int64_t k);
  void SendLeader(int64_t k, double t_s);
  void Control(Arm& arm, size_t index, int64_t k);
  ArmNode MakeNode(size_t index, int64_t epoch_ns, uint64_t starts) const;
  /// The torques of the tick that has begun, if they come now.
  void Answer(Arm& arm, double t_s);
  /// Frames from the drives to the board, and what it sends to the drives.
  void ToBoard(Arm& arm, int64_t t_ns);
  void ToDrives(Arm& arm, double t_s);
  size_t IndexOf(const Arm& arm) const { return static_cast<size_t>(&arm - arms_.data()); }
  void Observe(int64_t k);
  void Trace(int64_t k, TraceWriter* trace);
  void AdvancePlants(int64_t k);
  /// Where the end effectors should be: the leader, or without one the mean of the estimates.
  TaskVector Target(double t_s) const;
  RunMetrics Result() const;

  double TimeOf(int64_t k) const { return static_cast<double>(k) * period_s_; }
  int64_t NanosecondsOf(int64_t k) const { return epoch_ns_ + k * period_ns_; }

  ScenarioConfig scenario_;
  uint64_t seed_;
  double period_s_;
  int64_t period_ns_;
  int64_t epoch_ns_;
  int64_t fleet_digest_;
  std::optional<LeaderPath> leader_;
  VirtualNetwork network_;
  SimulationWatch* watch_;
  std::optional<LinkIdentity> identity_;  ///< of the leader; each arm's has its own epoch
  std::optional<VirtualOperator> operator_;
  std::optional<Sealer> leader_sealer_;
  std::vector<Arm> arms_;
  FrameList to_board_;
  FrameList to_drives_;
  int64_t leader_sequence_ = 0;
  double leader_sent_s_ = 0.0;
  double estimate_spread_m_ = 0.0;
  uint32_t transitions_before_ = 0;  ///< taken by boards that were started anew since
};

}  // namespace armada
