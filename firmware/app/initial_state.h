#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/app/config/config_error.h"
#include "firmware/app/fleet.h"
#include "firmware/core/parameter.h"

namespace armada {

/// Where a controller starts, as a TOML file: zeta(0), theta_hat(0) and its covariance. What a run has learnt
/// is such a file, too: the warm start of the next one.
struct InitialStateFile {
  TaskVector zeta_x_m = TaskVector::Zero(PlanarArm::kTaskDim);
  TaskVector zeta_v_m_s = TaskVector::Zero(PlanarArm::kTaskDim);
  TaskVector zeta_a_m_s2 = TaskVector::Zero(PlanarArm::kTaskDim);
  ParameterVector theta_hat;
  std::vector<std::vector<double>> P_theta;
  std::string arm_entry = "any";

  void Visit(ParameterVisitor& parameter) {
    parameter({"zeta_x_m", "m", -1e6, 1e6, "x_hat at the start"}, zeta_x_m);
    parameter({"zeta_v_m_s", "m/s", -1e6, 1e6, "v_hat at the start"}, zeta_v_m_s);
    parameter({"zeta_a_m_s2", "m/s^2", -1e6, 1e6, "a_hat at the start"}, zeta_a_m_s2);
    parameter({"theta_hat", "kg m^2, kg m", -1e6, 1e6, "theta_hat at the start, in the order of PlanarArm"},
              theta_hat);
    parameter({"P_theta", "kg^2 m^4, ..", -1e12, 1e12,
               "covariance of theta_hat, by rows; left out: adaptation.initial_deviation"},
              P_theta);
    parameter(
        {"arm_entry", "", 0, 0, "digest of the [[arm]] of the fleet file that theta_hat belongs to, or any"},
        arm_entry);
  }
};

/// Where a controller starts when nobody says otherwise: zeta = 0, theta_hat from the fleet file's nominal
/// links.
ArmInitialState NominalInitialState(const ArmEntry& arm);

/// The nominal start with what `controller` has learnt of its arm's dynamics.
ArmInitialState WarmStart(const ArmEntry& arm, const ArmController& controller);

/// Digest of what theta_hat depends on in an arm's entry: its id, links, gravity and drives, not its control.
std::string DigestOf(const ArmEntry& arm);

/// File of one arm in a folder of what arms have learnt: arm_<id>.toml.
std::string LearnedFile(const std::string& folder, int arm_id);

/// Reads the file; what it leaves out is nominal. Nothing, and errors, when it does not fit the arm or was
/// learnt with another entry of it.
std::optional<ArmInitialState> LoadInitialState(const std::string& path, const ArmEntry& arm,
                                                std::vector<ConfigError>* errors);

/// Writes the file that reads back to exactly `state`, whole or not at all. False with *error set.
bool WriteInitialState(const ArmInitialState& state, const ArmEntry& arm, const std::string& path,
                       std::string* error);

}  // namespace armada
