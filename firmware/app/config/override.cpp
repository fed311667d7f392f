#include "firmware/app/config/override.h"

#include <algorithm>
#include <cctype>

#include "firmware/app/config/toml_parser.h"
#include "firmware/app/config/value_text.h"

namespace armada {
namespace {

constexpr const char* kCommandLine = "--set";

bool IsBareWord(std::string_view text) {
  constexpr std::string_view kPunctuation = "_-./:?=+";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || kPunctuation.find(c) != std::string_view::npos;
  });
}

std::optional<ConfigNode> ParseValue(std::string_view text) {
  std::vector<ConfigError> ignored;
  auto table = ParseToml("value = " + std::string(text), kCommandLine, &ignored);
  if (!table && IsBareWord(text)) table = ParseToml("value = " + ValueText(text), kCommandLine, &ignored);
  if (!table || table->children.size() != 1) return std::nullopt;
  return table->children.front();
}

// The command line has no lines.
void ForgetLines(ConfigNode* node) {
  node->line = 0;
  for (ConfigNode& child : node->children) ForgetLines(&child);
}

void Collect(const std::string& prefix, const ConfigNode& table, std::vector<Override>* overrides) {
  for (const ConfigNode& child : table.children) {
    const std::string key = prefix.empty() ? child.key : prefix + "." + child.key;
    if (child.kind == ConfigNode::Kind::kTable) {  // unquoted dotted keys
      Collect(key, child, overrides);
    } else {
      overrides->push_back({key, child});
    }
  }
}

class Application {
 public:
  Application(const Override& change, std::vector<ConfigError>* errors) : change_(change), errors_(errors) {}

  void Descend(ConfigNode* node, std::string_view path) {
    const size_t dot = path.find('.');
    const std::string_view label = path.substr(0, dot);
    const std::string_view rest = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
    if (label.empty()) return Fail("has an empty part");
    switch (node->kind) {
      case ConfigNode::Kind::kTable:
        return IntoTable(node, label, rest);
      case ConfigNode::Kind::kArray:
        return IntoArray(node, label, rest);
      default:
        return Fail("is below a single value, " + node->Describe());
    }
  }

 private:
  void IntoTable(ConfigNode* table, std::string_view label, std::string_view rest) {
    ConfigNode* child = table->Find(label);
    if (child == nullptr) {
      ConfigNode added;
      added.key = label;
      added.file = change_.value.file;
      added.line = change_.value.line;
      child = &table->children.emplace_back(added);
    }
    Step(child, rest);
  }

  void IntoArray(ConfigNode* array, std::string_view label, std::string_view rest) {
    bool any = false;
    std::string labels;
    for (size_t i = 0; i < array->children.size(); ++i) {
      ConfigNode& element = array->children[i];
      const std::string its_label = ElementLabel(element, i);
      labels += (labels.empty() ? "" : ", ") + its_label;
      if (label != "*" && label != its_label) continue;
      any = true;
      Step(&element, rest);
    }
    if (!any) Fail("no element \"" + std::string(label) + "\", allowed are * or one of: " + labels);
  }

  void Step(ConfigNode* child, std::string_view rest) {
    if (!rest.empty()) return Descend(child, rest);
    std::string key = child->key;
    *child = change_.value;
    child->key = std::move(key);
  }

  void Fail(const std::string& message) {
    errors_->push_back({change_.value.file, change_.value.line, change_.key, message});
  }

  const Override& change_;
  std::vector<ConfigError>* errors_;
};

}  // namespace

std::vector<Override> ParseSets(const std::vector<std::string>& sets, std::vector<ConfigError>* errors) {
  std::vector<Override> overrides;
  for (const std::string& text : sets) {
    const size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos) {
      errors->push_back({kCommandLine, 0, "", "given " + ValueText(text) + ", expected key=value"});
      continue;
    }
    const std::string key = text.substr(0, equals);
    auto value = ParseValue(std::string_view(text).substr(equals + 1));
    if (!value) {
      errors->push_back({kCommandLine, 0, key,
                         "given " + ValueText(text.substr(equals + 1)) +
                             ", expected a TOML value (a number, true, false, \"text\", a list) or a word"});
      continue;
    }
    ForgetLines(&*value);
    overrides.push_back({key, *value});
  }
  return overrides;
}

std::vector<Override> OverridesIn(const ConfigNode& table) {
  std::vector<Override> overrides;
  Collect("", table, &overrides);
  // What is said of each element goes first, so that one element can be an exception.
  std::stable_partition(overrides.begin(), overrides.end(),
                        [](const Override& o) { return o.key.find('*') != std::string::npos; });
  return overrides;
}

void Apply(const Override& change, ConfigNode* root, std::vector<ConfigError>* errors) {
  Application(change, errors).Descend(root, change.key);
}

}  // namespace armada
