#include "host/campaign/trial_script.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "firmware/app/config/value_text.h"
#include "hil/scenario_names.h"

namespace armada {
namespace {

/// Every value of a table as it is written.
class ValueLister {
 public:
  template <class T>
  void operator()(const ParameterInfo& info, const T& value) {
    lines_.emplace_back(std::string(info.key) + " = " + ValueText(value));
  }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
};

template <class Config>
std::vector<std::string> LinesOf(Config config) {
  ValueLister lister;
  config.Visit(lister);
  return lister.lines();
}

/// What is not as it would be without.
template <class Config>
std::string TableOf(const char* header, const Config& config) {
  std::string text = std::string("\n[[") + header + "]]\n";
  const std::vector<std::string> lines = LinesOf(config);
  const std::vector<std::string> defaults = LinesOf(Config{});
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] != defaults[i]) text += lines[i] + "\n";
  }
  return text;
}

}  // namespace

std::string ScriptOf(const ScenarioConfig& trial, const std::string& name, const std::string& directory,
                     const std::string& comment) {
  namespace fs = std::filesystem;
  const std::string base = fs::relative(trial.file, directory).generic_string();
  std::string text = comment + "\nname = " + ValueText(name) + "\nbase = " + ValueText(base) + "\n";
  if (trial.start.mode != StartConfig().mode)
    text += "\n[start]\nmode = " + ValueText(trial.start.mode) + "\n";
  const ArmEntry& arm = trial.fleet.arms.front();
  const FleetStop stop = arm.control.supervisor.fleet_stop;
  text += "\n[overrides]\n\"arm.*.drive\" = " + ValueText(arm.joints.front().profile) + "\n";
  if (stop != SupervisorConfig().fleet_stop)
    text += "\"control.supervisor.fleet_stop\" = " + ValueText(stop) + "\n";
  for (const FaultConfig& fault : trial.faults) text += TableOf("fault", fault);
  for (const OperatorConfig& operation : trial.operations) text += TableOf("operator", operation);
  return text;
}

}  // namespace armada
