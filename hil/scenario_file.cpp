#include "hil/scenario_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/fleet_layout.h"
#include "firmware/app/config/override.h"
#include "firmware/app/config/parameter_reader.h"
#include "firmware/app/config/reference_writer.h"
#include "firmware/app/config/spelling.h"
#include "firmware/app/config/toml_parser.h"
#include "firmware/app/config/toml_writer.h"
#include "firmware/app/config/value_text.h"
#include "firmware/app/initial_state.h"
#include "hil/scenario_base.h"
#include "hil/scenario_rules.h"

namespace armada {
namespace {

constexpr const char* kFleetFile = "fleet.toml";
constexpr const char* kScenarioFile = "scenario.toml";
constexpr const char* kCommandLine = "--set";  // the "file" of what it gives, see ConfigError

/// The scenario file as it is written.
struct ScenarioLayout {
  std::string fleet;
  ScenarioConfig scenario;
  std::string base = kNoBase;

  void Visit(ParameterVisitor& parameter) {
    parameter({"name", "", 0, 0, "name of the scenario"}, scenario.name);
    parameter({"fleet", "", 0, 0, "fleet file, relative to this one"}, fleet);
    parameter({"base", "", 0, 0,
               "scenario file, relative to this one, or none: what is given here goes before what is given "
               "there, table by table; a list replaces a list"},
              base);
    scenario.Visit(parameter);
  }
};

bool Contains(const std::vector<std::string>& keys, const std::string& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

/// Applies those meant for the scenario, and returns the fleet's.
std::vector<Override> ApplyOwn(const std::vector<Override>& overrides, ConfigNode* root,
                               std::vector<ConfigError>* errors) {
  ScenarioLayout layout;
  const std::vector<std::string> own = KeysOf(&layout);
  const std::vector<std::string> of_fleet = FleetKeys();
  std::vector<Override> rest;
  for (const Override& change : overrides) {
    const std::string top = change.key.substr(0, change.key.find('.'));
    if (Contains(own, top)) {
      Apply(change, root, errors);
    } else if (Contains(of_fleet, top)) {
      rest.push_back(change);
    } else {
      std::vector<std::string> all = own;
      all.insert(all.end(), of_fleet.begin(), of_fleet.end());
      errors->push_back({change.value.file, change.value.line, change.key, UnknownKeyMessage(top, all)});
    }
  }
  return rest;
}

/// What a key of a scenario names is relative to the file that it stands in, a base perhaps; on the command
/// line to the scenario.
std::filesystem::path PathFrom(const ConfigCursor& at, const std::string& scenario_path,
                               const std::string& name) {
  const std::filesystem::path file(at.node().file == kCommandLine ? scenario_path : at.node().file);
  return (file.parent_path() / name).lexically_normal();
}

std::optional<LoadedFleet> LoadItsFleet(const std::string& scenario_path, const std::string& name,
                                        const ConfigCursor& at, const std::vector<Override>& overrides,
                                        std::vector<ConfigError>* errors) {
  if (name.empty()) return std::nullopt;  // said already
  const std::filesystem::path path = PathFrom(at, scenario_path, name);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    Report(at, "given " + ValueText(name) + ", but there is no file " + path.string(), errors);
    return std::nullopt;
  }
  return LoadFleetTree(path.string(), overrides, errors);
}

// What the arms have learnt, as start.learned says.
void LoadLearned(const ConfigCursor& at, ScenarioConfig* scenario, std::vector<ConfigError>* errors) {
  if (scenario->start.learned == StartConfig().learned) return;
  const std::filesystem::path folder =
      std::filesystem::absolute(PathFrom(at, scenario->file, scenario->start.learned));
  bool found = false;
  for (const ArmEntry& arm : scenario->fleet.arms) {
    scenario->learned.emplace_back();
    const std::string path = LearnedFile(folder.string(), arm.id);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) continue;
    found = true;
    scenario->learned.back() = LoadInitialState(path, arm, errors);
  }
  if (!found) {
    Report(at,
           "given " + ValueText(scenario->start.learned) + ", but no arm has a file like " +
               LearnedFile(folder.string(), scenario->fleet.arms.front().id),
           errors);
  }
  scenario->start.learned = folder.string();  // wherever the scenario is written
}

}  // namespace

std::optional<ScenarioConfig> LoadScenario(const std::string& path, const std::vector<std::string>& sets,
                                           std::vector<ConfigError>* errors) {
  const size_t errors_before = errors->size();
  const std::vector<Override> overrides = ParseSets(sets, errors);
  auto tree = LoadToml(path, errors);
  if (!tree) return std::nullopt;
  auto scenario = ScenarioFromTree(std::move(*tree), path, overrides, errors);
  if (errors->size() > errors_before) return std::nullopt;
  return scenario;
}

std::optional<ScenarioConfig> ScenarioFromTree(ConfigNode tree, const std::string& path,
                                               const std::vector<Override>& overrides,
                                               std::vector<ConfigError>* errors) {
  const size_t errors_before = errors->size();
  std::vector<Override> all;
  if (!PutOnBase(&tree, &all, errors)) return std::nullopt;
  all.insert(all.end(), overrides.begin(), overrides.end());
  const std::vector<Override> for_fleet = ApplyOwn(all, &tree, errors);

  ScenarioLayout layout;
  ReadConfig(tree, &layout, errors);
  if (layout.base != kNoBase) {
    Report(ConfigCursor(tree).At("base"), "allowed in a scenario file, not in overrides", errors);
  }
  ScenarioConfig& scenario = layout.scenario;
  scenario.file = path;
  TaskVector& centre = scenario.start.zeta_x_centre_m;
  if (centre.size() == 1) centre = TaskVector::Constant(PlanarArm::kTaskDim, centre[0]);

  const ConfigCursor root(tree);
  CheckScenario(scenario, root, errors);
  SortByPlace(errors, errors_before);
  const auto loaded = LoadItsFleet(path, layout.fleet, root.At("fleet"), for_fleet, errors);
  if (!loaded || errors->size() > errors_before) return std::nullopt;
  scenario.fleet = loaded->fleet;
  CheckScenarioWithFleet(scenario, root, ConfigCursor(loaded->tree), errors);
  LoadLearned(root.At("start.learned"), &scenario, errors);
  if (errors->size() > errors_before) return std::nullopt;
  return scenario;
}

bool WriteEffective(const ScenarioConfig& scenario, const std::string& directory, std::string* error) {
  const auto write = [&](const char* name, const auto& write_to) {
    const std::string path = (std::filesystem::path(directory) / name).string();
    errno = 0;
    std::ofstream stream(path);
    stream << "# Written by a run: every value as it was used, overrides applied.\n\n";
    write_to(stream);
    stream.flush();
    if (!stream) *error = "cannot write " + path + ": " + std::strerror(errno);
    return static_cast<bool>(stream);
  };
  ScenarioLayout layout{kFleetFile, scenario};
  return write(kFleetFile, [&](std::ostream& out) { WriteFleet(scenario.fleet, out); }) &&
         write(kScenarioFile, [&](std::ostream& out) { WriteToml(&layout, out); });
}

std::vector<EffectiveValue> EffectiveValues(const ScenarioConfig& scenario) {
  ScenarioLayout layout{scenario.fleet.file, scenario};
  return ListValues(&layout);
}

void WriteParameterReference(std::ostream& out) {
  out << "# Parameters\n"
         "\n"
         "Written by `armada params > docs/parameters.md` from the Config structs of the code; do not edit.\n"
         "\n"
         "A table of a file is headed as it is written in TOML. What is not required may be left out. `--set "
         "key=value`, and\n"
         "`[overrides]` in a scenario, take the full dotted key, with elements of lists by `id` or by number "
         "from 1, and `*`\n"
         "for each: `--set arm.6.control.subtask.kind=none`, `--set 'arm.*.gravity_m_s2=9.81'`,\n"
         "`--set leader.axis.1.amplitude_m=0.4`.\n";
  DocumentedTables documented;
  FleetLayout fleet;
  out << "\n## Fleet files\n" << ReferenceText(&fleet, &documented);
  ScenarioLayout scenario;
  out << "\n## Scenario files\n" << ReferenceText(&scenario, &documented);
  out << "\n### `[overrides]`\n\nQuoted dotted keys of the scenario or its fleet, each with the value to use "
         "instead.\n";
}

}  // namespace armada
