#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/app/config/config_error.h"
#include "firmware/app/fleet.h"

namespace armada {

/// zeta(0) and theta_hat(0) of one arm as a TOML file: zeta_x_m, zeta_v_m_s, zeta_a_m_s2, theta_hat.
struct InitialStateFile {
  TaskVector zeta_x_m = TaskVector::Zero(PlanarArm::kTaskDim);
  TaskVector zeta_v_m_s = TaskVector::Zero(PlanarArm::kTaskDim);
  TaskVector zeta_a_m_s2 = TaskVector::Zero(PlanarArm::kTaskDim);
  ParameterVector theta_hat;

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter({"zeta_x_m", "m", -1e6, 1e6, "x_hat at the start"}, zeta_x_m);
    parameter({"zeta_v_m_s", "m/s", -1e6, 1e6, "v_hat at the start"}, zeta_v_m_s);
    parameter({"zeta_a_m_s2", "m/s^2", -1e6, 1e6, "a_hat at the start"}, zeta_a_m_s2);
    parameter({"theta_hat", "kg m^2, kg m", -1e6, 1e6, "theta_hat at the start, in the order of PlanarArm"},
              theta_hat);
  }
};

/// Where a controller starts when nobody says otherwise: zeta = 0, theta_hat from the fleet file's nominal
/// links.
ArmInitialState NominalInitialState(const ArmEntry& arm);

/// Reads the file; what it leaves out is nominal. Nothing, and errors, when it does not fit the arm.
std::optional<ArmInitialState> LoadInitialState(const std::string& path, const ArmEntry& arm,
                                                std::vector<ConfigError>* errors);

/// Writes the file that reads back to exactly `state`. False with *error set.
bool WriteInitialState(const ArmInitialState& state, const std::string& path, std::string* error);

}  // namespace armada
