#pragma once

#include <cmath>
#include <functional>

#include "firmware/core/arm_controller.h"
#include "tests/support/random_arms.h"

namespace armada {

/// One arm under its controller, pinned to a leader, without buses: sampled on the tick, its torque in force
/// `latency_s` later, the plant integrated at 1 ms.
class ClosedLoop {
 public:
  ClosedLoop(const ArmControllerConfig& config, const ArmInitialState& initial,
             std::function<Zeta(double)> leader)
      : period_s_(config.timing.period_s),
        latency_s_(config.timing.sample_to_torque_s),
        controller_(config, initial, StartMode::kRunning),
        plant_(config.arm),
        tau_Nm_(JointVector::Zero(config.arm.dof)),
        leader_(std::move(leader)) {}

  ArmController& controller() { return controller_; }
  PlanarPlant& plant() { return plant_; }
  double time_s() const { return static_cast<double>(tick_) * period_s_; }
  /// The latency of the world; that of the configuration unless set.
  void set_latency_s(double latency_s) { latency_s_ = latency_s; }
  /// Time from the tick to the joints' sample; the neighbours are those of the tick.
  void set_sample_delay_s(double delay_s) { sample_delay_s_ = delay_s; }
  /// Torque that the world adds, N m.
  void set_disturbance(const JointVector& d_Nm) { d_Nm_ = d_Nm; }

  /// What the controller would see at this tick.
  ArmInput Sample() const {
    ArmInput in;
    in.sample_s = time_s();
    in.tick_s = in.sample_s - sample_delay_s_;
    in.q_rad = FromPlant(plant_, plant_.q_rad);
    in.dq_rad_s = FromPlant(plant_, plant_.dq_rad_s);
    in.neighbours.count = 1;
    in.neighbours.list[0] = {1.0, leader_(in.tick_s), 0.0, Estimator::kMaxAgreement, true};
    return in;
  }

  /// One period; with `missed` the board sleeps through it and its last torque stays in force.
  void Tick(bool missed = false) {
    const JointVector next_Nm = missed ? tau_Nm_ : controller_.Step(Sample());
    const double start_s = time_s();
    constexpr double kStep_s = 0.001;
    const int steps = static_cast<int>(std::lround(period_s_ / kStep_s));
    for (int i = 0; i < steps; ++i) {
      const double t_s = i * kStep_s;
      JointVector tau_Nm = t_s < latency_s_ - 1e-9 ? tau_Nm_ : next_Nm;
      if (d_Nm_.size() > 0) tau_Nm -= d_Nm_;
      plant_.Step(ToPlant(tau_Nm), kStep_s);
      Record(start_s + t_s + kStep_s);
    }
    tau_Nm_ = next_Nm;
    ++tick_;
  }

  void RunUntil(double t_s) {
    while (time_s() < t_s - 1e-9) Tick();
  }

  /// Forgets the errors so far.
  void StartWindow() { *this = WithoutErrors(*this); }
  double rms_m() const { return std::sqrt(sum_squares_m2_ / count_); }
  double max_m() const { return max_m_; }

 private:
  static ClosedLoop WithoutErrors(ClosedLoop loop) {
    loop.sum_squares_m2_ = loop.max_m_ = 0.0;
    loop.count_ = 0;
    return loop;
  }

  void Record(double t_s) {
    const PlanarPlant::Tip tip = plant_.EndEffector();
    const Zeta leader = leader_(t_s);
    const double error_m = std::hypot(tip.x_m[0] - leader.x_m[0], tip.x_m[1] - leader.x_m[1]);
    sum_squares_m2_ += error_m * error_m;
    max_m_ = std::max(max_m_, error_m);
    ++count_;
  }

  double period_s_;
  double latency_s_;
  double sample_delay_s_ = 0.0;
  ArmController controller_;
  PlanarPlant plant_;
  JointVector tau_Nm_;
  JointVector d_Nm_;
  std::function<Zeta(double)> leader_;
  int tick_ = 0;
  double sum_squares_m2_ = 0.0;
  double max_m_ = 0.0;
  int count_ = 0;
};

}  // namespace armada
