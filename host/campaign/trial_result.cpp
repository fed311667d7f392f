#include "host/campaign/trial_result.h"

#include "host/campaign/judge.h"
#include "host/json.h"
#include "host/sim/simulation.h"

namespace armada {

TrialResult RunTrial(const ScenarioConfig& trial, uint64_t seed) {
  Judge judge(trial);
  Simulation simulation(trial, seed, &judge);
  simulation.Run(nullptr);
  return {judge.violations(), simulation.TransitionsTaken(), judge.met()};
}

std::string ToText(const TrialResult& result) {
  Json json = {{"transitions", result.transitions}, {"violations", Json::array()}, {"met", Json::array()}};
  for (const Violation& violation : result.violations) {
    json["violations"].push_back(
        {static_cast<int>(violation.invariant), violation.t_s, violation.arm, violation.what});
  }
  for (const auto& state : result.met) json["met"].push_back(state ? Json(*state) : Json(nullptr));
  return json.dump();
}

TrialResult TrialResultOf(const std::string& text) {
  const Json json = Json::parse(text);
  TrialResult result;
  result.transitions = json["transitions"];
  for (const Json& violation : json["violations"]) {
    result.violations.push_back({static_cast<Invariant>(violation[0].get<int>()), violation[1].get<double>(),
                                 violation[2].get<int>(), violation[3].get<std::string>()});
  }
  for (const Json& state : json["met"]) {
    result.met.push_back(state.is_null() ? std::nullopt : std::optional<int>(state.get<int>()));
  }
  return result;
}

}  // namespace armada
