#include "firmware/app/initial_state.h"

#include <Eigen/Cholesky>
#include <sstream>

#include "firmware/app/config/fleet_layout.h"
#include "firmware/app/config/parameter_reader.h"
#include "firmware/app/config/toml_parser.h"
#include "firmware/app/config/toml_writer.h"
#include "firmware/app/digest.h"
#include "firmware/app/whole_file.h"

namespace armada {
namespace {

std::vector<std::vector<double>> RowsOf(const ParameterMatrix& matrix) {
  std::vector<std::vector<double>> rows;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    rows.emplace_back();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) rows.back().push_back(matrix(i, j));
  }
  return rows;
}

// The covariance that rows mean; empty for none.
ParameterMatrix CovarianceOf(const std::vector<std::vector<double>>& rows, Eigen::Index p,
                             const ConfigCursor& at, std::vector<ConfigError>* errors) {
  if (rows.empty()) return {};
  const auto wrong = [&](const std::string& message) {
    Report(at, message, errors);
    return ParameterMatrix();
  };
  const std::string size = std::to_string(p) + " x " + std::to_string(p);
  if (rows.size() != static_cast<size_t>(p)) {
    return wrong("given " + std::to_string(rows.size()) + " rows; the arm's covariance is " + size);
  }
  ParameterMatrix P(p, p);
  for (Eigen::Index i = 0; i < p; ++i) {
    const std::vector<double>& row = rows[static_cast<size_t>(i)];
    if (row.size() != rows.size()) {
      return wrong("row " + std::to_string(i + 1) + " has " + std::to_string(row.size()) +
                   " values; the arm's covariance is " + size);
    }
    for (Eigen::Index j = 0; j < p; ++j) P(i, j) = row[static_cast<size_t>(j)];
  }
  if (!P.isApprox(P.transpose(), 1e-9) || !Eigen::LDLT<ParameterMatrix>(P).isPositive()) {
    return wrong("no covariance: allowed is a symmetric matrix without negative eigenvalues");
  }
  return P;
}

}  // namespace

ArmInitialState NominalInitialState(const ArmEntry& arm) {
  return {Zeta::Zero(PlanarArm::kTaskDim), PlanarArm(arm.arm).Theta()};
}

ArmInitialState WarmStart(const ArmEntry& arm, const ArmController& controller) {
  return {NominalInitialState(arm).zeta, controller.theta_hat(), controller.P_theta()};
}

std::string LearnedFile(const std::string& folder, int arm_id) {
  return folder + "/arm_" + std::to_string(arm_id) + ".toml";
}

std::string DigestOf(const ArmEntry& arm) {
  FleetConfig alone;
  alone.arms = {arm};
  ArmLayout entry = LayoutOf(alone).arm.front();
  entry.control = {};
  entry.bus.clear();
  entry.obstacle.clear();
  std::ostringstream text;
  WriteToml(&entry, text);
  return Digest(text.str());
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
  const ConfigCursor at(*root);
  const ParameterMatrix P_theta = CovarianceOf(file.P_theta, parameter_count, at.At("P_theta"), errors);
  if (file.arm_entry != InitialStateFile().arm_entry && file.arm_entry != DigestOf(arm)) {
    Report(at.At("arm_entry"),
           "learnt with another entry of the fleet file: arm " + std::to_string(arm.id) +
               "'s id, links, gravity or drives are not those of then; learn anew, or restore them",
           errors);
  }
  if (errors->size() > errors_before) return std::nullopt;
  return ArmInitialState{{file.zeta_x_m, file.zeta_v_m_s, file.zeta_a_m_s2}, file.theta_hat, P_theta};
}

bool WriteInitialState(const ArmInitialState& state, const ArmEntry& arm, const std::string& path,
                       std::string* error) {
  InitialStateFile values{state.zeta.x_m,  state.zeta.v_m_s,      state.zeta.a_m_s2,
                          state.theta_hat, RowsOf(state.P_theta), DigestOf(arm)};
  return WriteWhole(
      path, [&](std::ostream& file) { WriteToml(&values, file); }, error);
}

}  // namespace armada
