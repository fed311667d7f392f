#include "host/run/run_recorder.h"

#include <Eigen/LU>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

#include "firmware/link/channels.h"
#include "host/sim/trace_writer.h"
#include "host/subtask_record.h"

namespace armada {
namespace {

constexpr int64_t kNever = -1;

TaskVector ToTask(const double (&from)[3]) {
  return Eigen::Map<const Eigen::Vector3d>(from).head(PlanarArm::kTaskDim);
}

JointVector ToJoints(const double (&from)[7], int dof) {
  return Eigen::Map<const Eigen::Matrix<double, 7, 1>>(from).head(dof);
}

double Rms(double sum_squares, size_t count) {
  return count > 0 ? std::sqrt(sum_squares / static_cast<double>(count)) : 0.0;
}

Zeta ZetaOf(const estimate_t& estimate) {
  return {ToTask(estimate.x_m), ToTask(estimate.v_m_s), ToTask(estimate.a_m_s2)};
}

}  // namespace

RunRecorder::RunRecorder(const ScenarioConfig& scenario, int64_t epoch_ns, const FleetKey& key)
    : scenario_(scenario), epoch_ns_(epoch_ns), leader_seal_(key, kLeaderSender), leader_heard_ns_(epoch_ns) {
  if (scenario.leader.kind != LeaderKind::kNone) leader_.emplace(scenario.leader);
  const auto ticks = static_cast<size_t>(scenario.seconds / scenario.fleet.timing.period_s) + 100;
  for (const ArmEntry& entry : scenario.fleet.arms) {
    ArmRecord& arm = arms_.emplace_back(key, entry.id);
    arm.telemetry.reserve(ticks);
    arm.estimates.reserve(ticks);
  }
}

void RunRecorder::OnMessage(const LcmMessage& message) {
  const auto index_of = [&](std::optional<int> arm_id) {
    return arm_id ? scenario_.fleet.IndexOf(*arm_id) : -1;
  };
  heard_ns_ = message.arrival_ns;
  std::span<const uint8_t> payload = message.payload;
  const auto opens = [&](SealCheck& seal) {
    return seal.Open(message.channel, &payload) == SealVerdict::kGenuine;
  };
  if (const int i = index_of(ParseArmChannel(kTelemetryPrefix, message.channel)); i >= 0) {
    ArmRecord& arm = arms_[static_cast<size_t>(i)];
    telemetry_t telemetry;
    if (!opens(arm.telemetry_seal) || !Decode(payload, &telemetry)) return;
    arm.telemetry.push_back(telemetry);
    arm.latest = telemetry;
  } else if (const int j = index_of(ParseArmChannel(kEstimatePrefix, message.channel)); j >= 0) {
    ArmRecord& arm = arms_[static_cast<size_t>(j)];
    estimate_t estimate;
    if (opens(arm.estimate_seal) && Decode(payload, &estimate)) arm.estimates.push_back(estimate);
  } else if (message.channel == kLeaderChannel) {
    leader_t leader;
    if (opens(leader_seal_) && Decode(payload, &leader)) OnLeader(leader, message.arrival_ns);
  }
}

void RunRecorder::OnLeader(const leader_t& message, int64_t arrival_ns) {
  const int64_t lost = std::max<int64_t>(0, message.sequence - leader_sequence_ - 1);
  if (const auto silence = LeaderSilenceUntil(arrival_ns, lost)) leader_silences_.push_back(*silence);
  leader_sequence_ = message.sequence;
  leader_heard_ns_ = std::max(arrival_ns, epoch_ns_);
}

std::optional<Silence> RunRecorder::LeaderSilenceUntil(int64_t until_ns, int64_t lost) const {
  until_ns = std::min<int64_t>(until_ns, epoch_ns_ + std::llround(1e9 * scenario_.seconds));
  const double period_s = 1.0 / scenario_.leader.rate_hz;
  const double silent_s =
      1e-9 * static_cast<double>(until_ns - leader_heard_ns_) - period_s * static_cast<double>(lost);
  if (silent_s < 3.0 * std::max(period_s, scenario_.fleet.timing.period_s)) return std::nullopt;
  return Silence{TimeOf(until_ns) - silent_s, TimeOf(until_ns)};
}

std::vector<Silence> RunRecorder::LeaderSilences() const {
  if (!leader_) return {};
  std::vector<Silence> silences = leader_silences_;
  if (const auto silence = LeaderSilenceUntil(heard_ns_, 0)) silences.push_back(*silence);
  return silences;
}

bool RunRecorder::EveryArmHeard() const {
  return std::all_of(arms_.begin(), arms_.end(), [](const ArmRecord& arm) { return arm.latest.has_value(); });
}

bool RunRecorder::InWindow(int64_t stamp_ns) const {
  const double t_s = TimeOf(stamp_ns);
  return t_s >= scenario_.window_start_s && t_s <= scenario_.seconds;
}

Zeta RunRecorder::TruthAt(int64_t stamp_ns) const {
  if (leader_) return leader_->At(TimeOf(stamp_ns));
  // Without a leader: where the arms agree, the mean of their estimates at that time.
  Zeta mean = Zeta::Zero(PlanarArm::kTaskDim);
  int count = 0;
  for (const ArmRecord& arm : arms_) {
    const auto next = std::lower_bound(arm.estimates.begin(), arm.estimates.end(), stamp_ns,
                                       [](const estimate_t& e, int64_t at_ns) { return e.stamp_ns < at_ns; });
    if (next == arm.estimates.end()) continue;
    mean.x_m += ToTask(next->x_m);
    ++count;
  }
  if (count > 0) mean.x_m /= count;
  return mean;
}

ArmMetrics RunRecorder::Metrics(size_t index) const {
  const ArmRecord& record = arms_[index];
  const ArmEntry& entry = scenario_.fleet.arms[index];
  ArmMetrics metrics;
  metrics.id = entry.id;
  metrics.dof = entry.arm.dof;
  metrics.subtask = entry.control.subtask.kind;
  if (!record.latest) return metrics;

  EstimatorRms squares;
  size_t estimates = 0;
  for (const estimate_t& estimate : record.estimates) {
    if (!InWindow(estimate.stamp_ns)) continue;
    const Zeta truth = TruthAt(estimate.stamp_ns);
    const Zeta zeta = ZetaOf(estimate);
    squares.x_m += (zeta.x_m - truth.x_m).squaredNorm();
    squares.v_m_s += (zeta.v_m_s - truth.v_m_s).squaredNorm();
    squares.a_m_s2 += (zeta.a_m_s2 - truth.a_m_s2).squaredNorm();
    metrics.estimator_max.Update(zeta, truth);
    ++estimates;
  }
  metrics.estimator_rms = {Rms(squares.x_m, estimates), Rms(squares.v_m_s, estimates),
                           Rms(squares.a_m_s2, estimates)};

  SubtaskRecord subtask(entry);
  for (const telemetry_t& tick : record.telemetry) {
    for (const double tau_Nm : tick.tau_Nm)
      metrics.torque_max_Nm = std::max(metrics.torque_max_Nm, std::abs(tau_Nm));
    if (!InWindow(tick.stamp_ns)) continue;
    for (const double dq_rad_s : tick.dq_rad_s)
      metrics.joint_speed_max_rad_s = std::max(metrics.joint_speed_max_rad_s, std::abs(dq_rad_s));
    subtask.Update(ToJoints(tick.q_rad, entry.arm.dof), tick.subtask_error_rad_s);
  }
  subtask.WriteTo(&metrics);
  metrics.saturated_ticks = record.latest->saturated_ticks;
  metrics.state = NameOf(static_cast<ControllerState>(record.latest->state));
  const ParameterVector theta = PlanarArm(entry.arm).Theta();
  const auto theta_hat =
      Eigen::Map<const Eigen::Matrix<double, kMaxParameters, 1>>(record.latest->theta_hat).head(theta.size());
  metrics.parameter_error = (theta_hat - theta).norm() / theta.norm();
  return metrics;
}

TrackingRecord RunRecorder::Tracking(size_t index) const {
  TrackingRecord record(scenario_);
  for (const telemetry_t& tick : arms_[index].telemetry) {
    record.Update(TimeOf(tick.stamp_ns), (ToTask(tick.x_m) - TruthAt(tick.stamp_ns).x_m).norm());
  }
  return record;
}

double RunRecorder::EstimateSpread() const {
  // Compared where stamps agree: all arms tick on one grid.
  double spread_m = 0.0;
  for (const estimate_t& estimate : arms_.front().estimates) {
    if (!InWindow(estimate.stamp_ns)) continue;
    std::vector<TaskVector> points;
    for (const ArmRecord& arm : arms_) {
      const auto same =
          std::lower_bound(arm.estimates.begin(), arm.estimates.end(), estimate.stamp_ns,
                           [](const estimate_t& e, int64_t at_ns) { return e.stamp_ns < at_ns; });
      if (same != arm.estimates.end() && same->stamp_ns == estimate.stamp_ns)
        points.push_back(ToTask(same->x_m));
    }
    for (size_t i = 0; i < points.size(); ++i) {
      for (size_t j = 0; j < i; ++j) spread_m = std::max(spread_m, (points[i] - points[j]).norm());
    }
  }
  return spread_m;
}

bool RunRecorder::WriteTraces(const std::string& directory, bool with_timing, std::string* error) const {
  TraceWriter trace(directory, scenario_.fleet);
  if (!trace.ok()) {
    *error = trace.error();
    return false;
  }
  const double period_s = scenario_.fleet.timing.period_s;
  const auto ticks = static_cast<int64_t>(std::llround(scenario_.seconds / period_s));
  for (int64_t k = 0; leader_ && k < ticks; ++k) {
    trace.Leader(static_cast<double>(k) * period_s, leader_->At(static_cast<double>(k) * period_s));
  }

  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> timing(
      with_timing ? std::fopen((directory + "/timing.csv").c_str(), "w") : nullptr, std::fclose);
  if (with_timing && !timing) {
    *error = "cannot write " + directory + "/timing.csv: " + std::strerror(errno);
    return false;
  }
  if (timing) std::fputs("arm,t_s,wakeup_lateness_us,compute_us,sample_to_torque_us\n", timing.get());

  for (size_t i = 0; i < arms_.size(); ++i) {
    const PlanarArm arm(scenario_.fleet.arms[i].arm);
    int64_t estimate_at_ns = kNever;
    auto estimate = arms_[i].estimates.begin();
    for (const telemetry_t& tick : arms_[i].telemetry) {
      // The estimate that this tick published: the newest not after its sample.
      while (estimate != arms_[i].estimates.end() && estimate->stamp_ns <= tick.stamp_ns)
        estimate_at_ns = (estimate++)->stamp_ns;
      if (estimate_at_ns == kNever) continue;
      const double t_s = TimeOf(tick.stamp_ns);
      const JointVector q = ToJoints(tick.q_rad, tick.dof);
      const PlanarArm::Posture at = arm.At(q);
      const JacobianMatrix J = arm.Jacobian(at);
      TraceRow row;
      row.t_s = t_s;
      row.q_rad = q;
      row.dq_rad_s = ToJoints(tick.dq_rad_s, tick.dof);
      row.tau_Nm = ToJoints(tick.tau_Nm, tick.dof);
      row.x_m = ToTask(tick.x_m);
      row.v_m_s = J * row.dq_rad_s;
      row.zeta = ZetaOf(*(estimate - 1));
      row.error_m = (row.x_m - TruthAt(tick.stamp_ns).x_m).norm();
      row.sigma_min = tick.sigma_min;
      row.manipulability = (J * J.transpose()).determinant();
      row.subtask_error_rad_s = tick.subtask_error_rad_s;
      row.clearance_m = ClearanceOf(arm, q);
      row.synced = tick.synced != 0;
      trace.Arm(i, row);
      if (!timing) continue;
      std::fprintf(timing.get(), "%d,%.6f,%d,%d,%d\n", static_cast<int>(tick.arm_id), t_s,
                   tick.wakeup_lateness_us, tick.compute_us, tick.sample_to_torque_us);
    }
  }
  if (!trace.Close()) {
    *error = trace.error();
    return false;
  }
  if (!timing || (std::fflush(timing.get()) == 0 && std::ferror(timing.get()) == 0)) return true;
  *error = "cannot write " + directory + "/timing.csv: " + std::strerror(errno);
  return false;
}

}  // namespace armada
