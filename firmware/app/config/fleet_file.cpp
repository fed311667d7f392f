#include "firmware/app/config/fleet_file.h"

#include <bit>
#include <ostream>
#include <sstream>

#include "firmware/app/config/fleet_layout.h"
#include "firmware/app/config/fleet_rules.h"
#include "firmware/app/config/parameter_reader.h"
#include "firmware/app/config/toml_parser.h"
#include "firmware/app/config/toml_writer.h"
#include "firmware/app/digest.h"

namespace armada {
namespace {

// `pins = [1, 3]` becomes what it is short for.
void SpellOutPins(ConfigNode* root) {
  ConfigNode* graphs = root->Find("graph");
  if (graphs == nullptr) return;
  for (ConfigNode& graph : graphs->children) {
    ConfigNode* pins = graph.Find("pins");
    if (pins == nullptr || pins->kind != ConfigNode::Kind::kArray) continue;
    for (ConfigNode& pin : pins->children) {
      if (pin.kind != ConfigNode::Kind::kInteger) continue;
      ConfigNode arm = pin;
      arm.key = "arm";
      pin.kind = ConfigNode::Kind::kTable;
      pin.children = {arm};
    }
  }
}

// Arms that leave their joints out.
void SpellOutJoints(FleetLayout* layout) {
  for (ArmLayout& arm : layout->arm) {
    if (!arm.joint.empty()) continue;
    for (size_t i = 0; i < arm.link.size(); ++i) arm.joint.push_back(arm.JointPrototype(i));
  }
}

}  // namespace

std::optional<LoadedFleet> LoadFleetTree(const std::string& path, const std::vector<Override>& overrides,
                                         std::vector<ConfigError>* errors) {
  const size_t errors_before = errors->size();
  auto tree = LoadToml(path, errors);
  if (!tree) return std::nullopt;
  for (const Override& change : overrides) Apply(change, &*tree, errors);
  auto loaded = FleetFromTree(std::move(*tree), path, errors);
  SortByPlace(errors, errors_before);
  if (errors->size() > errors_before) return std::nullopt;
  return loaded;
}

std::optional<LoadedFleet> FleetFromTree(ConfigNode tree, const std::string& path,
                                         std::vector<ConfigError>* errors) {
  const size_t errors_before = errors->size();
  SpellOutPins(&tree);
  FleetLayout layout;
  ReadConfig(tree, &layout, errors);
  SpellOutJoints(&layout);
  CheckFleet(layout, ConfigCursor(tree), errors);
  SortByPlace(errors, errors_before);
  if (errors->size() > errors_before) return std::nullopt;
  return LoadedFleet{FleetOf(layout, path), std::move(tree)};
}

std::optional<FleetConfig> LoadFleet(const std::string& path, const std::vector<std::string>& sets,
                                     std::vector<ConfigError>* errors) {
  const size_t errors_before = errors->size();
  const std::vector<Override> overrides = ParseSets(sets, errors);
  auto loaded = LoadFleetTree(path, overrides, errors);
  if (!loaded || errors->size() > errors_before) return std::nullopt;
  return std::move(loaded->fleet);
}

void WriteFleet(const FleetConfig& fleet, std::ostream& out) {
  FleetLayout layout = LayoutOf(fleet);
  WriteToml(&layout, out);
}

int64_t FleetDigest(const FleetConfig& fleet) {
  FleetConfig shared = fleet;
  if (shared.link.has_key()) shared.link.key_file = "file";
  std::ostringstream text;
  WriteFleet(shared, text);
  return std::bit_cast<int64_t>(Fnv1a(text.str()));
}

std::vector<EffectiveValue> EffectiveValues(const FleetConfig& fleet) {
  FleetLayout layout = LayoutOf(fleet);
  return ListValues(&layout);
}

std::vector<std::string> FleetKeys() {
  FleetLayout layout;
  return KeysOf(&layout);
}

}  // namespace armada
