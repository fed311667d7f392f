#include "tests/fuzz/config_world.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>

#include "firmware/app/arm_node.h"
#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/toml_parser.h"
#include "firmware/app/initial_state.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

constexpr int kTicks = 5;

std::string Written(const FleetConfig& fleet) {
  std::ostringstream text;
  WriteFleet(fleet, text);
  return text.str();
}

void RequireReadsBack(const FleetConfig& fleet) {
  const std::string written = Written(fleet);
  std::vector<ConfigError> errors;
  auto tree = ParseToml(written, fleet.file, &errors);
  const auto again = tree ? FleetFromTree(std::move(*tree), fleet.file, &errors) : std::nullopt;
  Require(again && errors.empty(), "what is written of a fleet is accepted");
  Require(Written(again->fleet) == written, "and means the same");
}

void RequireOrdered(const FleetConfig& fleet) {
  const TimingConfig& timing = fleet.timing;
  Require(timing.period_s > 0.0 && timing.feedback_timeout_s < timing.period_s &&
              timing.sample_to_torque_s < timing.period_s && timing.feedback_stale_s > timing.period_s,
          "times of a tick are in order");
  Require(!fleet.arms.empty() && fleet.arms.size() <= size_t{kMaxArms}, "there are arms, and not too many");
  for (const Topology& topology : fleet.topologies) {
    for (const Edge& edge : topology.edges)
      Require(fleet.IndexOf(edge.from) >= 0 && fleet.IndexOf(edge.to) >= 0, "edges join arms");
    for (const Pin& pin : topology.pins) Require(fleet.IndexOf(pin.arm) >= 0, "pins are of arms");
  }
  for (const ArmEntry& arm : fleet.arms) {
    Require(arm.arm.dof >= 1 && arm.arm.dof <= kMaxDof, "an arm has 1 to 7 joints");
    Require(arm.joints.size() == static_cast<size_t>(arm.arm.dof), "each with a drive");
    for (const JointDriveConfig& joint : arm.joints) {
      Require(std::isfinite(joint.torque_limit_Nm) && joint.torque_limit_Nm > 0.0, "torques are limited");
      Require(joint.watchdog_s > 0.0, "drives have watchdogs");
    }
  }
}

/// The leader, in reach and at rest.
Neighbours LeaderAt(const TaskVector& x_m) {
  Neighbours neighbours;
  neighbours.count = 1;
  Neighbour& leader = neighbours.list[0];
  leader.weight = 1.0;
  leader.zeta = Zeta::Zero(PlanarArm::kTaskDim);
  leader.zeta.x_m = x_m;
  leader.agreement = Estimator::kMaxAgreement;
  leader.heard = true;
  return neighbours;
}

void RequireLimitedTorques(const FleetConfig& fleet, size_t index) {
  const ArmControllerConfig config = fleet.ControllerConfig(index);
  ArmController controller(config, NominalInitialState(fleet.arms[index]), StartMode::kRunning);
  ArmInput input;
  input.q_rad = JointVector::Constant(config.arm.dof, 0.3);
  input.dq_rad_s = JointVector::Constant(config.arm.dof, 0.1);
  const PlanarArm arm(config.arm);
  input.neighbours = LeaderAt(arm.Position(arm.At(input.q_rad)));
  for (int tick = 0; tick < kTicks; ++tick) {
    input.tick_s = input.sample_s = tick * config.timing.period_s;
    const JointVector tau_Nm = controller.Step(input);
    Require(tau_Nm.allFinite() && (tau_Nm.cwiseAbs() - config.torque_limit_Nm).maxCoeff() <= 0.0,
            "torques are finite and limited");
    Require(controller.supervisor().cause() != Cause::kNonFiniteTorque, "so is what the law wants");
  }
}

void RequireStartsUp(const FleetConfig& fleet, size_t index) {
  constexpr int64_t kEpochNs = 1'000'000'000;
  const auto period_ns = std::llround(fleet.timing.period_s * 1e9);
  const auto node =
      std::make_unique<ArmNode>(fleet, index, NominalInitialState(fleet.arms[index]), kEpochNs, BoardStart());
  MessageBuffer buffer;
  FrameList frames;
  for (int64_t tick = 0; tick < kTicks; ++tick) {
    const int64_t tick_ns = kEpochNs + tick * period_ns;
    estimate_t estimate;
    Require(Decode(node->EncodeEstimate(tick_ns, &buffer), &estimate), "a board's estimate is valid");
    frames.Clear();
    node->RequestSamples(tick_ns, &frames);
    node->Step(tick_ns, &frames);
    Require(!GivesTorque(node->state()), "without drives there is no torque");
  }
}

}  // namespace

std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Require(file.is_open(), ("read " + path).c_str());
  return {std::istreambuf_iterator<char>(file), {}};
}

void RequireExplained(const std::vector<ConfigError>& errors, const std::string& file,
                      const std::string& text) {
  Require(!errors.empty(), "a refusal has a reason");
  const auto lines = std::count(text.begin(), text.end(), '\n') + 1;
  for (const ConfigError& error : errors) {
    Require(!error.message.empty(), "a reason is told");
    Require(error.file != file || (error.line >= 1 && error.line <= lines),
            "a reason has a line of the file");
  }
}

void RequireSound(const FleetConfig& fleet) {
  RequireOrdered(fleet);
  RequireReadsBack(fleet);
  for (size_t index = 0; index < fleet.arms.size(); ++index) {
    RequireLimitedTorques(fleet, index);
    RequireStartsUp(fleet, index);
  }
}

}  // namespace armada
