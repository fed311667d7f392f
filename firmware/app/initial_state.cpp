#include "firmware/app/initial_state.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "firmware/app/config/parameter_reader.h"
#include "firmware/app/config/toml_parser.h"
#include "firmware/app/config/toml_writer.h"

namespace armada {

ArmInitialState NominalInitialState(const ArmEntry& arm) {
  return {Zeta::Zero(PlanarArm::kTaskDim), PlanarArm(arm.arm).Theta()};
}

std::optional<ArmInitialState> LoadInitialState(const std::string& path, const ArmEntry& arm,
                                                std::vector<ConfigError>* errors) {
  const auto root = LoadToml(path, errors);
  if (!root) return std::nullopt;
  InitialStateFile file;
  file.theta_hat = NominalInitialState(arm).theta_hat;
  const Eigen::Index parameter_count = file.theta_hat.size();
  const size_t errors_before = errors->size();
  ReadConfig(*root, &file, errors);
  const auto require_size = [&](const char* key, Eigen::Index given, Eigen::Index allowed) {
    if (given == allowed) return;
    Report(ConfigCursor(*root).At(key),
           "given " + std::to_string(given) + " values, arm " + std::to_string(arm.id) + " has " +
               std::to_string(allowed),
           errors);
  };
  require_size("zeta_x_m", file.zeta_x_m.size(), PlanarArm::kTaskDim);
  require_size("zeta_v_m_s", file.zeta_v_m_s.size(), PlanarArm::kTaskDim);
  require_size("zeta_a_m_s2", file.zeta_a_m_s2.size(), PlanarArm::kTaskDim);
  require_size("theta_hat", file.theta_hat.size(), parameter_count);
  if (errors->size() > errors_before) return std::nullopt;
  return ArmInitialState{{file.zeta_x_m, file.zeta_v_m_s, file.zeta_a_m_s2}, file.theta_hat};
}

bool WriteInitialState(const ArmInitialState& state, const std::string& path, std::string* error) {
  InitialStateFile values{state.zeta.x_m, state.zeta.v_m_s, state.zeta.a_m_s2, state.theta_hat};
  std::ofstream file(path);
  WriteToml(&values, file);
  if (file.flush()) return true;
  *error = "cannot write " + path + ": " + std::strerror(errno);
  return false;
}

}  // namespace armada
