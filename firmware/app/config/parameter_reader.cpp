#include "firmware/app/config/parameter_reader.h"

#include <algorithm>
#include <cmath>

#include "firmware/app/config/parameter_text.h"
#include "firmware/app/config/spelling.h"

namespace armada {
namespace {

using Kind = ConfigNode::Kind;

bool Expected(const ConfigCursor& at, const char* what, std::vector<ConfigError>* errors) {
  Report(at, "given " + at.node().Describe() + ", expected " + what, errors);
  return false;
}

// Read one value: true and `*value` set, or an error at `at` that names what was given and what is allowed.

bool ReadValue(const ConfigCursor& at, const ParameterInfo&, bool* value, std::vector<ConfigError>* errors) {
  if (at.node().kind != Kind::kBool) return Expected(at, "true or false", errors);
  *value = std::get<bool>(at.node().value);
  return true;
}

bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, double* value,
               std::vector<ConfigError>* errors) {
  const ConfigNode& node = at.node();
  if (node.kind != Kind::kReal && node.kind != Kind::kInteger) return Expected(at, "a number", errors);
  const double given = node.kind == Kind::kReal ? std::get<double>(node.value)
                                                : static_cast<double>(std::get<int64_t>(node.value));
  if (!(std::isfinite(given) && given >= info.min && given <= info.max)) {
    Report(at, "given " + node.Describe() + ", allowed is " + RangeText(info), errors);
    return false;
  }
  *value = given;
  return true;
}

bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, int* value,
               std::vector<ConfigError>* errors) {
  if (at.node().kind != Kind::kInteger) return Expected(at, "a whole number", errors);
  double given = 0.0;
  if (!ReadValue(at, info, &given, errors)) return false;
  *value = static_cast<int>(given);
  return true;
}

bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, std::string* value,
               std::vector<ConfigError>* errors) {
  if (at.node().kind != Kind::kText) return Expected(at, "text in quotes", errors);
  const std::string& given = std::get<std::string>(at.node().value);
  if (given.empty()) {
    Report(at, std::string("given \"\", expected the ") + info.meaning, errors);
    return false;
  }
  *value = given;
  return true;
}

bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, std::vector<double>* value,
               std::vector<ConfigError>* errors) {
  std::vector<double> given;
  if (at.node().kind != Kind::kArray) {
    given.resize(1);
    if (at.node().kind != Kind::kReal && at.node().kind != Kind::kInteger) {
      return Expected(at, "a number or a list of numbers", errors);
    }
    if (!ReadValue(at, info, given.data(), errors)) return false;
  } else {
    given.resize(at.node().children.size());
    bool good = true;
    for (size_t i = 0; i < given.size(); ++i)
      good = ReadValue(at.Element(i), info, &given[i], errors) && good;
    if (!good) return false;
  }
  *value = given;
  return true;
}

bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, std::vector<std::vector<double>>* value,
               std::vector<ConfigError>* errors) {
  if (at.node().kind != Kind::kArray) return Expected(at, "a list of points, each a list of numbers", errors);
  std::vector<std::vector<double>> given(at.node().children.size());
  bool good = true;
  for (size_t i = 0; i < given.size(); ++i) good = ReadValue(at.Element(i), info, &given[i], errors) && good;
  if (good) *value = given;
  return good;
}

bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, std::vector<int>* value,
               std::vector<ConfigError>* errors) {
  if (at.node().kind != Kind::kArray) return Expected(at, "a list of whole numbers", errors);
  std::vector<int> given(at.node().children.size());
  bool good = true;
  for (size_t i = 0; i < given.size(); ++i) good = ReadValue(at.Element(i), info, &given[i], errors) && good;
  if (good) *value = given;
  return good;
}

bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, NumberList* value,
               std::vector<ConfigError>* errors) {
  std::vector<double> given;
  if (!ReadValue(at, info, &given, errors)) return false;
  if (given.empty() || given.size() > value->max_count) {
    Report(at,
           "given " + std::to_string(given.size()) + " values, allowed are 1 to " +
               std::to_string(value->max_count),
           errors);
    return false;
  }
  value->values = given;
  return true;
}

bool ReadValue(const ConfigCursor& at, const ParameterInfo&, Choice* value,
               std::vector<ConfigError>* errors) {
  const ConfigNode& node = at.node();
  for (const Choice::Name& name : value->names) {
    if (node.kind != Kind::kText || std::get<std::string>(node.value) != name.name) continue;
    value->value = name.value;
    return true;
  }
  Report(at, "given " + node.Describe() + ", allowed are " + AllNames(*value), errors);
  return false;
}

/// Fills one table.
class ParameterReader final : public ParameterVisitor {
 public:
  ParameterReader(const ConfigCursor& table, std::vector<ConfigError>* errors)
      : table_(table), errors_(errors) {}

  void Read(const ParameterTable& config) {
    config.Visit(*this);
    if (!table_.found()) return;
    for (const ConfigNode& child : table_.node().children) {
      if (std::find(known_.begin(), known_.end(), child.key) == known_.end()) {
        Report(table_.Child(child.key), UnknownKeyMessage(child.key, known_), errors_);
      }
    }
  }

 private:
  void OnValue(const ParameterInfo& info, const ParameterValue& value) override {
    const ConfigCursor at = Take(info.key);
    if (at.found()) {
      std::visit([&](auto* member) { ReadValue(at, info, member, errors_); }, value);
    } else if (IsRequired(info, value)) {
      Report(at, std::string("missing; it is the ") + info.meaning, errors_);
    }
  }

  void OnTable(const char* name, const ParameterTable& table) override {
    const ConfigCursor at = Take(name);
    if (IsKind(at, Kind::kTable, "a table")) ParameterReader(at, errors_).Read(table);
  }

  void OnList(const ListInfo& info, ParameterList& list) override {
    const ConfigCursor at = Take(info.key);
    if (!at.found() || !IsKind(at, Kind::kArray, "a list of tables")) return;
    list.Reset(at.node().children.size());
    for (size_t i = 0; i < list.size(); ++i) {
      const ConfigCursor element = at.Element(i);
      if (IsKind(element, Kind::kTable, "a table")) ParameterReader(element, errors_).Read(list.Element(i));
    }
  }

  ConfigCursor Take(const char* key) {
    known_.emplace_back(key);
    return table_.At(key);
  }
  /// True as well for a table that is left out: all its values are then at their defaults.
  bool IsKind(const ConfigCursor& at, Kind kind, const char* expected) {
    return !at.found() || at.node().kind == kind || Expected(at, expected, errors_);
  }

  ConfigCursor table_;
  std::vector<ConfigError>* errors_;
  std::vector<std::string> known_;
};

}  // namespace

void ReadConfig(const ConfigNode& root, const ParameterTable& config, std::vector<ConfigError>* errors) {
  ParameterReader(ConfigCursor(root), errors).Read(config);
}

}  // namespace armada
