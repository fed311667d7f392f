#include <cmath>
#include <ostream>

#include "host/check/check_output.h"
#include "host/json.h"

namespace armada {
namespace {

Json ToJson(const TopologyCheck& topology, const std::vector<ArmCheck>& arms) {
  Json depth = Json::object();
  for (size_t i = 0; i < arms.size(); ++i) {
    const bool reached = topology.depth[i] != Digraph::kUnreachable;
    depth[std::to_string(arms[i].id)] = reached ? Json(topology.depth[i]) : Json(nullptr);
  }
  Json cuts = Json::array();
  for (const SingleCut& cut : topology.single_cuts) {
    cuts.push_back({{"from", cut.from_id}, {"to", cut.to_id}, {"cut_off", cut.cut_ids}});
  }
  return {{"holds", topology.holds()}, {"root", topology.root_id}, {"depth", depth}, {"single_cuts", cuts}};
}

Json ToJson(const EstimatorCheck& estimator) {
  Json beta = Json::array();
  Json leader = Json::array();
  Json ratio = Json::array();
  for (const BetaMargin& margin : estimator.margins) {
    beta.push_back(margin.beta);
    leader.push_back(margin.leader);
    ratio.push_back(margin.ratio());
  }
  return {{"holds", estimator.holds()},
          {"beta", beta},
          {"leader", leader},
          {"ratio", ratio},
          {"t_f_max_s", estimator.settled_max_s}};
}

Json ToJson(const ArmCheck& arm) {
  Json json = {
      {"id", arm.id}, {"dof", arm.dof}, {"bus_load", arm.bus_load}, {"leader_news_s", arm.leader_news_s}};
  if (arm.estimate) {
    json["estimate_error_max"] = {
        {"x", arm.estimate->x_m}, {"v", arm.estimate->v_m_s}, {"a", arm.estimate->a_m_s2}};
  }
  if (arm.disturbance) {
    json["K_r_min_nm"] = arm.disturbance->K_r_min_Nm;
    json["disturbance_2norm_nm"] = arm.disturbance->d_2norm_Nm;
    json["K_r_suffices"] = arm.disturbance->holds();
  }
  if (arm.path) {
    json["reach_outer_m"] = arm.path->reach_outer_m;
    json["reach_inner_m"] = arm.path->reach_inner_m;
    json["sigma_min"] = arm.path->sigma_min;
    json["ideal_error_m"] = arm.path->error_m;
    json["sampled_s"] = arm.path->sampled_s;
    for (const TorqueNeed& torque : arm.path->torques) {
      json["torque_needed_nm"].push_back(torque.needed_Nm);
      json["torque_limit_nm"].push_back(torque.limit_Nm);
    }
  }
  if (arm.path && std::isfinite(arm.path->clearance_m)) json["clearance_min_m"] = arm.path->clearance_m;
  if (arm.path && std::isfinite(arm.path->limit_margin_rad))
    json["limit_margin_min_rad"] = arm.path->limit_margin_rad;
  if (arm.posture) {
    json["posture"] = {{"joint", arm.posture->joint},
                       {"goal_rad", arm.posture->goal_rad},
                       {"at_goal_share", arm.posture->at_goal},
                       {"stretched_share", arm.posture->stretched},
                       {"folded_share", arm.posture->folded}};
  }
  return json;
}

}  // namespace

void PrintJson(const CheckResult& result, std::ostream& out) {
  Json json = {
      {"schema", 1}, {"name", result.name}, {"file", result.file}, {"ok", result.ok()}, {"A1", result.A1()}};
  for (const TopologyCheck& topology : result.topologies)
    json["topologies"].push_back(ToJson(topology, result.arms));
  if (result.estimator) json["estimator"] = ToJson(*result.estimator);
  for (const ArmCheck& arm : result.arms) json["arms"].push_back(ToJson(arm));
  json["findings"] = Json::array();
  for (const Finding& finding : result.findings) {
    const char* severity = finding.severity == Severity::kError ? "error" : "warning";
    json["findings"].push_back({{"severity", severity}, {"text", finding.text}});
  }
  out << json.dump(2) << '\n';
}

}  // namespace armada
