#include "host/sim/simulation.h"

#include <algorithm>
#include <cmath>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/initial_state.h"
#include "hil/random.h"
#include "host/floor/floor.h"
#include "host/sim/link_faults.h"

namespace armada {
namespace {

void Copy(const TaskVector& from, double (&to)[3]) {
  std::copy(from.data(), from.data() + from.size(), to);
}

TaskVector TipPosition(const EmulatedArm& bench) {
  const PlanarPlant::Tip tip = bench.plant().EndEffector();
  TaskVector x(PlanarArm::kTaskDim);
  x << tip.x_m[0], tip.x_m[1];
  return x;
}

JointVector JointsOf(const PlanarPlant& plant) {
  return Eigen::Map<const Eigen::VectorXd>(plant.q_rad.data(), plant.dof());
}

/// While one lives, a board's own code runs.
class BoardTime {
 public:
  BoardTime(SimulationWatch* watch, size_t arm) : watch_(watch), arm_(arm) {
    if (watch_ != nullptr) watch_->Enter(arm_);
  }
  BoardTime(const BoardTime&) = delete;
  BoardTime& operator=(const BoardTime&) = delete;
  ~BoardTime() {
    if (watch_ != nullptr) watch_->Leave(arm_);
  }

 private:
  SimulationWatch* watch_;
  size_t arm_;
};

/// A key as secret as the seed: what is tried here is the check of the seals, not the key.
LinkIdentity IdentityOf(uint64_t seed) {
  LinkIdentity identity{.key = {}, .epoch = 1};
  for (size_t i = 0; i < identity.key.size(); ++i) {
    identity.key[i] = static_cast<uint8_t>(RandomBits(seed, kFaultStream, i));
  }
  return identity;
}

double Rms(double sum_squares, int64_t count) {
  return count > 0 ? std::sqrt(sum_squares / static_cast<double>(count)) : 0.0;
}

}  // namespace

Simulation::Simulation(const ScenarioConfig& scenario, uint64_t seed, SimulationWatch* watch)
    : scenario_(scenario),
      seed_(seed),
      period_s_(scenario.fleet.timing.period_s),
      period_ns_(static_cast<int64_t>(std::llround(period_s_ * 1e9))),
      epoch_ns_(1'000'000'000),
      fleet_digest_(FleetDigest(scenario_.fleet)),
      network_(scenario_, seed),
      watch_(watch) {
  if (scenario_.leader.kind != LeaderKind::kNone) leader_.emplace(scenario_.leader);
  if (NeedsSeals(scenario_.faults)) {
    identity_ = IdentityOf(seed);
    leader_sealer_.emplace(*identity_, kLeaderSender);
  }
  if (!scenario_.operations.empty()) operator_.emplace(scenario_, fleet_digest_, identity_);
  const LeaderPath* leader = leader_ ? &*leader_ : nullptr;
  arms_.reserve(scenario_.fleet.arms.size());
  for (size_t i = 0; i < scenario_.fleet.arms.size(); ++i) {
    const ArmStart start = DrawStart(scenario_, i, seed, leader);
    arms_.push_back(
        Arm{.node = MakeNode(i, epoch_ns_, 1),
            .bench = EmulatedArm(scenario_, i, seed, start, leader, -scenario_.fleet.timing.bring_up_s),
            .process = BoardProcess(scenario_, scenario_.fleet.arms[i].id),
            .record = TrackingRecord(scenario_),
            .subtask_record = SubtaskRecord(scenario_.fleet.arms[i]),
            .theta = PlanarArm(scenario_.fleet.arms[i].arm).Theta()});
  }
}

// Started anew, a controller has forgotten all, and nobody but the operator lets it move the arm.
ArmNode Simulation::MakeNode(size_t index, int64_t epoch_ns, uint64_t starts) const {
  const LeaderPath* leader = leader_ ? &*leader_ : nullptr;
  BoardStart board{starts == 1 ? scenario_.start.mode : StartMode::kMonitor, fleet_digest_, identity_};
  if (board.identity) board.identity->epoch = starts;
  return {scenario_.fleet, index, DrawStart(scenario_, index, seed_, leader).controller, epoch_ns, board};
}

RunMetrics Simulation::Run(TraceWriter* trace) {
  BringUp();
  const int64_t ticks = std::llround(scenario_.seconds / period_s_);
  for (int64_t k = 0; k < ticks; ++k) {
    Exchange(k);
    for (size_t i = 0; i < arms_.size(); ++i) Control(arms_[i], i, k);
    Observe(k);
    if (trace != nullptr) Trace(k, trace);
    AdvancePlants(k);
  }
  return Result();
}

void Simulation::BringUp() {
  for (int64_t k = -std::llround(scenario_.fleet.timing.bring_up_s / period_s_); k < 0; ++k) {
    for (Arm& arm : arms_) {
      to_drives_.Clear();
      if (scenario_.start.mode == StartMode::kRunning) arm.node.BringUp(NanosecondsOf(k), &to_drives_);
      ToDrives(arm, TimeOf(k));
      ToBoard(arm, NanosecondsOf(k));
      arm.bench.AdvanceTo(TimeOf(k + 1), &to_board_);
      ToBoard(arm, NanosecondsOf(k + 1));
    }
  }
}

void Simulation::ToDrives(Arm& arm, double t_s) {
  for (const CanFrame& frame : to_drives_) {
    if (watch_ != nullptr) watch_->OnFrame(IndexOf(arm), t_s, frame);
    arm.bench.OnFrame(t_s, frame, &to_board_);
  }
  to_drives_.Clear();
}

void Simulation::ToBoard(Arm& arm, int64_t t_ns) {
  for (CanFrame frame : to_board_) {
    frame.stamp_ns = t_ns;
    const BoardTime board(watch_, IndexOf(arm));
    arm.node.OnFrame(frame);
  }
  to_board_.Clear();
}

// Everybody sends what is valid at this tick.
void Simulation::Exchange(int64_t k) {
  if (leader_) {
    // The newest state on the leader's own grid.
    const double rate_hz = scenario_.leader.rate_hz;
    const double t_s = std::floor(TimeOf(k) * rate_hz + 1e-6) / rate_hz;
    const bool silent = FindActive(scenario_.faults, FaultKind::kLeaderDies, 0, TimeOf(k)) != nullptr ||
                        FindActive(scenario_.faults, FaultKind::kLeaderStops, 0, TimeOf(k)) != nullptr;
    if (silent || (leader_sequence_ > 0 && t_s == leader_sent_s_)) {
      network_.Send(0, k, {});  // nothing new from a leader slower than the ticks
    } else {
      SendLeader(k, t_s);
    }
  }
  for (size_t i = 0; i < arms_.size(); ++i) {
    std::span<const uint8_t> payload;
    if (arms_[i].process.IsOnTime(k)) {
      const BoardTime board(watch_, i);
      payload = arms_[i].node.EncodeEstimate(NanosecondsOf(k), network_.BufferFor(i + 1, k));
    }
    network_.Send(i + 1, k, payload);
    if (watch_ != nullptr && !payload.empty()) watch_->OnEstimate(i, TimeOf(k), payload);
  }
}

void Simulation::SendLeader(int64_t k, double t_s) {
  leader_sent_s_ = t_s;
  Zeta zeta = leader_->At(t_s);
  if (const auto* const jump = FindActive(scenario_.faults, FaultKind::kLeaderJumps, 0, TimeOf(k))) {
    zeta.x_m.array() += jump->value;
  }
  if (FindActive(scenario_.faults, FaultKind::kLeaderNonfinite, 0, TimeOf(k)) != nullptr) {
    zeta.x_m.setConstant(std::nan(""));
  }
  leader_t message{};
  message.stamp_ns = epoch_ns_ + std::llround(t_s * 1e9);
  message.sequence = ++leader_sequence_;
  message.path_time_s = t_s;
  message.task_dim = PlanarArm::kTaskDim;
  Copy(zeta.x_m, message.x_m);
  Copy(zeta.v_m_s, message.v_m_s);
  Copy(zeta.a_m_s2, message.a_m_s2);
  Copy(leader_->Jerk(t_s), message.jerk_m_s3);
  MessageBuffer* const buffer = network_.BufferFor(0, k);
  network_.Send(0, k, SealIfKeyed(leader_sealer_, kLeaderChannel, Encode(message, buffer), buffer));
}

// One tick of one board, in the order of the real process.
void Simulation::Control(Arm& arm, size_t index, int64_t k) {
  const int64_t tick_ns = NanosecondsOf(k);
  const BoardProcess::Turn turn = arm.process.Begin(k);
  if (turn == BoardProcess::Turn::kNone) return;
  if (turn == BoardProcess::Turn::kStart) {
    // As a restarted service: its time 0 comes timing.bring_up_s later.
    transitions_before_ |= arm.node.controller().supervisor().transitions_taken();
    arm.node = MakeNode(index, NanosecondsOf(arm.process.first_tick()), arm.process.starts());
  }
  if (turn == BoardProcess::Turn::kTick) {
    const BoardTime board(watch_, index);
    arm.node.RequestSamples(tick_ns, &to_drives_);
  }
  ToDrives(arm, TimeOf(k));
  ToBoard(arm, tick_ns);
  network_.Deliver(index, k, tick_ns, &arm.node);  // a socket keeps messages for a process that gets no time
  if (operator_) operator_->Deliver(TimeOf(k), tick_ns, &arm.node);
  Answer(arm, TimeOf(k));
}

void Simulation::Answer(Arm& arm, double t_s) {
  if (!arm.process.Answers(t_s, arm.node.SamplesComplete())) return;
  const int64_t k = arm.process.tick();
  const BoardFaults& faults = arm.process.faults();
  {
    const BoardTime board(watch_, IndexOf(arm));
    arm.node.Step(NanosecondsOf(k), &to_drives_);
  }
  const BusStatus bus = faults.BusAt(TimeOf(k), period_s_);
  const bool sent = !faults.RefusesTorques(t_s) && bus != BusStatus::kBusOff && bus != BusStatus::kDown;
  if (!sent) to_drives_.Clear();
  arm.node.bus_watch().OnBus(bus);
  arm.node.bus_watch().OnSent(sent);
  arm.node.bus_watch().OnTick(NanosecondsOf(k), t_s - TimeOf(k), arm.process.missed_ticks());
  ToDrives(arm, t_s);
  ToBoard(arm, NanosecondsOf(k) + std::llround((t_s - TimeOf(k)) * 1e9));
  for (const double tau_Nm : arm.node.controller().status().tau_Nm) {
    arm.torque_max_Nm = std::max(arm.torque_max_Nm, std::abs(tau_Nm));
  }
}

TaskVector Simulation::Target(double t_s) const {
  if (leader_) return leader_->At(t_s).x_m;
  TaskVector mean = TaskVector::Zero(PlanarArm::kTaskDim);
  for (const Arm& arm : arms_) mean += arm.node.controller().zeta().x_m;
  return mean / static_cast<double>(arms_.size());
}

void Simulation::Observe(int64_t k) {
  const double t_s = TimeOf(k);
  if (k == FloorStartTick(scenario_)) {
    for (Arm& arm : arms_) arm.floor_posture_rad = JointsOf(arm.bench.plant());
  }
  if (t_s < scenario_.window_start_s) return;
  // After Step the estimates are valid at the end of the tick.
  const Zeta truth = leader_ ? leader_->At(TimeOf(k + 1))
                             : Zeta{Target(t_s), TaskVector::Zero(PlanarArm::kTaskDim),
                                    TaskVector::Zero(PlanarArm::kTaskDim)};
  for (size_t i = 0; i < arms_.size(); ++i) {
    Arm& arm = arms_[i];
    const PlanarPlant& plant = arm.bench.plant();
    for (int joint = 0; joint < plant.dof(); ++joint) {
      arm.joint_speed_max_rad_s =
          std::max(arm.joint_speed_max_rad_s, std::abs(plant.dq_rad_s[static_cast<size_t>(joint)]));
    }
    if (arm.process.tick() != k || arm.process.busy()) continue;  // what it knows is of an earlier tick
    const Zeta& zeta = arm.node.controller().zeta();
    arm.estimator_squares.x_m += (zeta.x_m - truth.x_m).squaredNorm();
    arm.estimator_squares.v_m_s += (zeta.v_m_s - truth.v_m_s).squaredNorm();
    arm.estimator_squares.a_m_s2 += (zeta.a_m_s2 - truth.a_m_s2).squaredNorm();
    arm.estimator_max.Update(zeta, truth);
    for (size_t j = 0; j < i; ++j) {
      estimate_spread_m_ =
          std::max(estimate_spread_m_, (zeta.x_m - arms_[j].node.controller().zeta().x_m).norm());
    }
    arm.subtask_record.Update(JointsOf(arm.bench.plant()),
                              arm.node.controller().status().subtask_error_rad_s);
    ++arm.window_ticks;
  }
}

void Simulation::Trace(int64_t k, TraceWriter* trace) {
  const double t_s = TimeOf(k);
  const TaskVector target = Target(t_s);
  if (leader_) trace->Leader(t_s, leader_->At(t_s));
  for (size_t i = 0; i < arms_.size(); ++i) {
    const Arm& arm = arms_[i];
    const ArmStatus& status = arm.node.controller().status();
    const PlanarPlant& plant = arm.bench.plant();
    const PlanarPlant::Tip tip = plant.EndEffector();
    TraceRow row;
    row.t_s = t_s;
    row.q_rad = JointsOf(plant);
    row.dq_rad_s = Eigen::Map<const Eigen::VectorXd>(plant.dq_rad_s.data(), plant.dof());
    row.tau_Nm = status.tau_Nm;
    row.x_m = TipPosition(arm.bench);
    row.v_m_s = Eigen::Map<const Eigen::Vector2d>(tip.v_m_s.data());
    row.zeta = status.zeta;
    row.error_m = (row.x_m - target).norm();
    row.sigma_min = status.sigma_min;
    row.manipulability = status.manipulability;
    row.subtask_error_rad_s = status.subtask_error_rad_s;
    row.clearance_m = ClearanceOf(arm.node.controller().arm(), row.q_rad);
    row.synced = arm.node.controller().estimator().synced();
    trace->Arm(i, row);
  }
}

void Simulation::AdvancePlants(int64_t k) {
  const int samples = std::max(1, static_cast<int>(std::lround(period_s_ / TrackingRecord::kSamplePeriod_s)));
  for (int sample = 1; sample <= samples; ++sample) {
    const double t_s = TimeOf(k) + period_s_ * sample / samples;
    const TaskVector target = Target(t_s);
    for (Arm& arm : arms_) {
      arm.bench.AdvanceTo(t_s, &to_board_);
      ToBoard(arm, epoch_ns_ + std::llround(t_s * 1e9));
      Answer(arm, t_s);
      const double error_m = (TipPosition(arm.bench) - target).norm();
      arm.record.Update(t_s, error_m);
      if (watch_ != nullptr) watch_->OnMoment(IndexOf(arm), t_s, arm.bench, error_m);
    }
  }
}

bool Simulation::WriteLearned(const std::string& folder, std::string* error) const {
  for (size_t i = 0; i < arms_.size(); ++i) {
    const ArmNode& node = arms_[i].node;
    const ArmEntry& entry = scenario_.fleet.arms[i];
    if (arms_[i].process.running() && GivesTorque(node.state()) &&
        !WriteInitialState(WarmStart(entry, node.controller()), entry, LearnedFile(folder, entry.id),
                           error)) {
      return false;
    }
  }
  return true;
}

uint32_t Simulation::TransitionsTaken() const {
  uint32_t taken = transitions_before_;
  for (const Arm& arm : arms_) taken |= arm.node.controller().supervisor().transitions_taken();
  return taken;
}

RunMetrics Simulation::Result() const {
  RunMetrics metrics;
  metrics.scenario = scenario_.name;
  metrics.scenario_file = scenario_.file;
  metrics.mode = "sim";
  metrics.law = scenario_.fleet.arms.front().control.law;
  metrics.estimator = scenario_.fleet.estimator.kind;
  metrics.seed = seed_;
  metrics.seconds = scenario_.seconds;
  metrics.window_start_s = scenario_.window_start_s;
  metrics.estimate_spread_m = estimate_spread_m_;
  for (size_t i = 0; i < arms_.size(); ++i) {
    const Arm& arm = arms_[i];
    const ArmEntry& entry = scenario_.fleet.arms[i];
    ArmMetrics result;
    result.id = entry.id;
    result.dof = entry.arm.dof;
    result.subtask = entry.control.subtask.kind;
    result.diverged = arm.bench.diverged();
    result.settled_s = arm.record.settled_s();
    result.rms_m = arm.record.rms_m();
    result.max_m = arm.record.max_m();
    result.estimator_rms = {Rms(arm.estimator_squares.x_m, arm.window_ticks),
                            Rms(arm.estimator_squares.v_m_s, arm.window_ticks),
                            Rms(arm.estimator_squares.a_m_s2, arm.window_ticks)};
    result.estimator_max = arm.estimator_max;
    result.joint_speed_max_rad_s = arm.joint_speed_max_rad_s;
    result.torque_max_Nm = arm.torque_max_Nm;
    result.saturated_ticks = arm.node.controller().saturated_ticks();
    result.parameter_error = (arm.node.controller().theta_hat() - arm.theta).norm() / arm.theta.norm();
    result.floor_posture_rad = arm.floor_posture_rad;
    arm.subtask_record.WriteTo(&result);
    result.state = NameOf(arm.node.state());
    if (HasStopped(arm.node.state()) && arm.node.cause() != Cause::kNone)
      result.faults.emplace_back(NameOf(arm.node.cause()));
    metrics.arms.push_back(std::move(result));
  }
  metrics.Judge(scenario_.criterion);
  return metrics;
}

}  // namespace armada
