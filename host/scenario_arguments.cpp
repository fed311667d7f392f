#include "host/scenario_arguments.h"

#include <iostream>
#include <sstream>

#include "firmware/app/command_line.h"
#include "hil/scenario_file.h"

namespace armada {

void ScenarioArguments::AddTo(Command* command) {
  AddScenarioTo(command);
  command->add_option("--law", law, "local law instead of the fleet's: paper, robust");
  command->add_option("--estimator", estimator,
                      "estimator instead of the fleet's: paper, implicit, predictive");
}

void ScenarioArguments::AddScenarioTo(Command* command) {
  command->add_option("SCENARIO", scenario, "scenario file (TOML)")->required();
  command->add_option("--seconds", seconds, "length of the run instead of the scenario's")->take_last();
  command
      ->add_option("--set", sets,
                   "key=value: any parameter of scenario or fleet, e.g. control.reference.alpha_1_s=40")
      ->take_all();
}

std::vector<std::string> ScenarioArguments::Overrides() const {
  std::vector<std::string> overrides;
  if (!law.empty()) overrides.push_back("control.law=" + law);
  if (!estimator.empty()) overrides.push_back("estimator.kind=" + estimator);
  if (seconds) {
    std::ostringstream text;
    text << std::showpoint << *seconds;
    overrides.push_back("seconds=" + text.str());
  }
  overrides.insert(overrides.end(), sets.begin(), sets.end());
  return overrides;
}

std::optional<ScenarioConfig> ScenarioArguments::Load() const {
  std::vector<ConfigError> errors;
  auto config = LoadScenario(scenario, Overrides(), &errors);
  if (!config) PrintErrors(errors, std::cerr);
  return config;
}

}  // namespace armada
