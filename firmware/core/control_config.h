#pragma once

#include "firmware/core/augmented_filter.h"
#include "firmware/core/gains.h"
#include "firmware/core/governor.h"
#include "firmware/core/implicit_control.h"
#include "firmware/core/parameter.h"
#include "firmware/core/projection.h"
#include "firmware/core/pseudoinverse.h"
#include "firmware/core/reference.h"
#include "firmware/core/subtask.h"
#include "firmware/core/supervisor.h"

namespace armada {

enum class LawKind {
  kPaper,   ///< (1.2), (1.5), (1.6), (1.8) as printed, explicit Euler
  kRobust,  ///< the same law made to work on a sampled, saturated arm
};

constexpr auto EnumNames(LawKind) {
  using enum LawKind;
  return std::to_array<EnumName<LawKind>>({{kPaper, "paper"}, {kRobust, "robust"}});
}

struct PaperLawConfig {
  double alpha_1_s = 3.0;
  double difference_s = 1e-4;

  void Visit(ParameterVisitor& parameter) {
    parameter({"alpha_1_s", "1/s", 1e-3, 1e3, "alpha of (1.5) and (1.6) in the law as printed"}, alpha_1_s);
    parameter({"difference_s", "s", 1e-8, 0.1,
               "half step along dq of the central difference that gives d phi / dt in (1.6)"},
              difference_s);
  }
};

/// Everything that tunes the local law of one arm.
struct ControlConfig {
  LawKind law = LawKind::kRobust;
  GainsConfig gains;
  PaperLawConfig paper;
  ReferenceConfig reference;
  PseudoinverseConfig pseudoinverse;
  GovernorConfig governor;
  AdaptationConfig adaptation;
  ProjectionConfig projection;
  DisturbanceModelConfig disturbance;
  SensorConfig sensor;
  ImplicitControlConfig implicit_control;
  SubtaskConfig subtask;
  SupervisorConfig supervisor;

  void Visit(ParameterVisitor& parameter) {
    parameter({"law", "", 0, 0, "local law: paper (as printed), robust"}, law);
    parameter.Table("gains", gains);
    parameter.Table("paper", paper);
    parameter.Table("reference", reference);
    parameter.Table("pseudoinverse", pseudoinverse);
    parameter.Table("governor", governor);
    parameter.Table("adaptation", adaptation);
    parameter.Table("projection", projection);
    parameter.Table("disturbance", disturbance);
    parameter.Table("sensor", sensor);
    parameter.Table("implicit_control", implicit_control);
    parameter.Table("subtask", subtask);
    parameter.Table("supervisor", supervisor);
  }

  /// Single values spread over the joints and axes of an arm.
  void Expand(int dof, int task_dim) {
    gains.Expand(dof, task_dim);
    sensor.Expand(dof);
  }
};

/// What a local law sees in one tick. q, dq and zeta are of the same instant, the sample's.
struct LawInput {
  JointVector q_rad;
  JointVector dq_rad_s;
  Zeta zeta;                ///< estimate at the sample
  Zeta zeta_next;           ///< estimate one period later
  bool synced = false;      ///< the estimate may be used for motion
  double elapsed_s = 0;     ///< since the previous sample
  double period_s = 0;      ///< h
  bool adapts = true;       ///< theta_hat follows what is measured
  double gain_share = 1.0;  ///< of K_s and K_x
};

}  // namespace armada
