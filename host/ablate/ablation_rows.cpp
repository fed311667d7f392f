#include "host/ablate/ablation_rows.h"

namespace armada {

const std::vector<AblationRow>& AblationRows() {
  // Keys of single arms: what an arm's own table says would go before the fleet's.
  static const std::vector<AblationRow> rows = {
      {"parameter projection",
       "keeps the estimated inertia within what arms have",
       {"arm.*.control.projection.inertia_min_kgm2=1e-9", "arm.*.control.projection.inertia_max_kgm2=1e5",
        "arm.*.control.projection.correlation_max=0.999", "arm.*.control.projection.gravity_min_kgm=-1e5",
        "arm.*.control.projection.gravity_max_kgm=1e5"}},
      {"damping of J#",
       "keeps the reference finite where the arm is stretched or folded",
       {"arm.*.control.pseudoinverse.damping_max_m=0.0"}},
      {"governor",
       "changes the reference no faster than torques can follow",
       {"arm.*.control.governor.acceleration_rad_s2=1e5", "arm.*.control.governor.speed_rad_s=1e3"}},
      {"bounded approach",
       "comes from afar at a speed that the torques can brake from",
       {"arm.*.control.reference.approach_speed_m_s=100.0", "arm.*.control.reference.braking_share=1.0",
        "arm.*.control.reference.braking_min_m_s2=1e3"}},
      {"fixed point of dq_r",
       "wants dq_r where the arm will be at the period's end",
       {"arm.*.control.reference.iterations=1"}},
      {"implicit pull",
       "takes errors away as fast as sampling allows (without it at alpha = 0.5/h: more is not stable)",
       {"arm.*.control.reference.implicit_pull=false", "arm.*.control.reference.alpha_per_tick=0.5"}},
      {"implicit step of the law", "has no chatter", {"arm.*.control.implicit_control.on=false"}},
      {"adaptation", "learns the arm's inertia", {"arm.*.control.adaptation.kind=none"}},
      {"Kalman adaptation, (1.8) instead",
       "learns at the rate that the data allow",
       {"arm.*.control.adaptation.kind=gradient"}},
      {"second-order term of the filter",
       "is not sure of wrong parameters after a start far off",
       {"arm.*.control.adaptation.second_order=false"}},
      {"slow disturbance in the filter",
       "cancels what of the disturbance lasts",
       {"arm.*.control.disturbance.drift_Nm=0.0"}},
      {"rough torque in the filter",
       "does not believe that the unknown torque held for exactly the tick",
       {"arm.*.control.disturbance.roughness=0.01"}},
      {"latency compensation",
       "computes the torque for the time at which it acts",
       {"timing.sample_to_torque_s=0.0"}},
      {"prediction in the estimator", "moves what was heard to the present", {"estimator.kind=implicit"}},
      {"prediction and implicit sgn in the estimator",
       "estimates without lag and without chatter",
       {"estimator.kind=paper"}},
      {"all of the robust law, as printed instead",
       "makes the law stand sampling, saturation and singularities",
       {"arm.*.control.law=paper"}},
  };
  return rows;
}

}  // namespace armada
