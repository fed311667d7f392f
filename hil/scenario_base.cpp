#include "hil/scenario_base.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "firmware/app/config/toml_parser.h"
#include "firmware/app/config/value_text.h"

namespace armada {
namespace {

constexpr const char* kBase = "base";
constexpr const char* kOverrides = "overrides";
constexpr int kMostBases = 8;  // more is a file that is its own base

std::optional<ConfigNode> TakeChild(const char* key, ConfigNode* table) {
  const auto child = std::find_if(table->children.begin(), table->children.end(),
                                  [&](const ConfigNode& candidate) { return candidate.key == key; });
  if (child == table->children.end()) return std::nullopt;
  ConfigNode taken = *child;
  table->children.erase(child);
  return taken;
}

/// Takes [overrides] out of a file's tree.
std::vector<Override> TakeOverrides(ConfigNode* root, std::vector<ConfigError>* errors) {
  const auto table = TakeChild(kOverrides, root);
  if (!table) return {};
  if (table->kind == ConfigNode::Kind::kTable) return OverridesIn(*table);
  errors->push_back(
      {table->file, table->line, kOverrides, "given " + table->Describe() + ", expected a table"});
  return {};
}

/// The values of `top` go before those of `base`.
ConfigNode Merged(ConfigNode base, const ConfigNode& top) {
  base.file = top.file;
  base.line = top.line;
  for (const ConfigNode& child : top.children) {
    ConfigNode* const below = base.Find(child.key);
    if (below == nullptr) {
      base.children.push_back(child);
    } else if (below->kind == ConfigNode::Kind::kTable && child.kind == ConfigNode::Kind::kTable) {
      *below = Merged(std::move(*below), child);
    } else {
      *below = child;
    }
  }
  return base;
}

std::optional<ConfigNode> LoadBase(const ConfigNode& name, std::vector<ConfigError>* errors) {
  const auto fail = [&](const std::string& message) {
    errors->push_back({name.file, name.line, kBase, "given " + name.Describe() + ", " + message});
    return std::nullopt;
  };
  if (name.kind != ConfigNode::Kind::kText) return fail("expected text in quotes");
  const std::filesystem::path path =
      (std::filesystem::path(name.file).parent_path() / std::get<std::string>(name.value)).lexically_normal();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return fail("but there is no file " + path.string());
  return LoadToml(path.string(), errors);
}

bool PutOnBase(ConfigNode* tree, int depth, std::vector<Override>* overrides,
               std::vector<ConfigError>* errors) {
  const std::vector<Override> own = TakeOverrides(tree, errors);
  const auto name = TakeChild(kBase, tree);
  const bool has_base =
      name && !(name->kind == ConfigNode::Kind::kText && std::get<std::string>(name->value) == kNoBase);
  if (has_base) {
    if (depth == kMostBases) {
      errors->push_back({name->file, name->line, kBase,
                         "more than " + std::to_string(kMostBases) + " bases: is a file its own?"});
      return false;
    }
    auto base = LoadBase(*name, errors);
    if (!base || !PutOnBase(&*base, depth + 1, overrides, errors)) return false;
    *tree = Merged(std::move(*base), *tree);
  }
  overrides->insert(overrides->end(), own.begin(), own.end());
  return true;
}

}  // namespace

bool PutOnBase(ConfigNode* tree, std::vector<Override>* overrides, std::vector<ConfigError>* errors) {
  return PutOnBase(tree, 0, overrides, errors);
}

}  // namespace armada
