#pragma once

#include <string>
#include <vector>

#include "firmware/app/config/config_node.h"
#include "firmware/app/config/enum_names.h"
#include "firmware/app/config/value_text.h"
#include "firmware/core/parameter.h"
#include "firmware/core/types.h"

namespace armada {

// Reads one value: true and `*value` set, or an error at `at` that names what was given and what is allowed.

bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, bool* value,
               std::vector<ConfigError>* errors);
bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, int* value,
               std::vector<ConfigError>* errors);
bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, double* value,
               std::vector<ConfigError>* errors);
bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, std::string* value,
               std::vector<ConfigError>* errors);
/// A list of numbers; a single number is a list of one.
bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, std::vector<double>* value,
               std::vector<ConfigError>* errors);
bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, std::vector<std::vector<double>>* value,
               std::vector<ConfigError>* errors);
/// A list of whole numbers.
bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, std::vector<int>* value,
               std::vector<ConfigError>* errors);

template <int kMaxRows>
bool ReadValue(const ConfigCursor& at, const ParameterInfo& info, BoundedVector<kMaxRows>* value,
               std::vector<ConfigError>* errors) {
  std::vector<double> list;
  if (!ReadValue(at, info, &list, errors)) return false;
  if (list.empty() || list.size() > size_t{kMaxRows}) {
    Report(at,
           "given " + std::to_string(list.size()) + " values, allowed are 1 to " + std::to_string(kMaxRows),
           errors);
    return false;
  }
  *value = Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
  return true;
}

template <NamedEnum Enum>
bool ReadValue(const ConfigCursor& at, const ParameterInfo&, Enum* value, std::vector<ConfigError>* errors) {
  const ConfigNode& node = at.node();
  if (node.kind == ConfigNode::Kind::kText) {
    if (const auto kind = EnumNamed<Enum>(std::get<std::string>(node.value))) {
      *value = *kind;
      return true;
    }
  }
  Report(at, "given " + node.Describe() + ", allowed are " + AllNames(Enum{}), errors);
  return false;
}

// A default that is not itself a legal value says that the key must be given.

template <class T>
bool IsRequired(const ParameterInfo&, const T&) {
  return false;
}
inline bool IsRequired(const ParameterInfo& info, double value) {
  return value < info.min || value > info.max;
}
inline bool IsRequired(const ParameterInfo& info, int value) {
  return value < info.min || value > info.max;
}
inline bool IsRequired(const ParameterInfo&, const std::string& value) {
  return value.empty();
}

/// "0.0001 to 1": the legal range of a number.
std::string NumbersText(const ParameterInfo& info);
/// "0.0001 to 1 s": the same with its unit.
std::string RangeText(const ParameterInfo& info);

/// Visitor that fills a Config struct from a table, and collects every mistake in it. Call Finish() last.
class ParameterReader {
 public:
  ParameterReader(const ConfigCursor& table, std::vector<ConfigError>* errors)
      : table_(table), errors_(errors) {}

  template <class T>
  void operator()(const ParameterInfo& info, T& value) {
    const ConfigCursor at = Take(info.key);
    if (at.found()) {
      ReadValue(at, info, &value, errors_);
    } else if (IsRequired(info, value)) {
      Report(at, std::string("missing; it is the ") + info.meaning, errors_);
    }
  }

  template <class Config>
  void Table(const char* name, Config& config) {
    const ConfigCursor at = Take(name);
    if (IsKind(at, ConfigNode::Kind::kTable, "a table")) Read(at, &config);
  }

  template <class Config>
  void List(const ListInfo& info, std::vector<Config>& list) {
    List(info, list, [](size_t) { return Config{}; });
  }

  /// `prototype(i)` is what element i, from 0, has where the file gives nothing.
  template <class Config, class Prototype>
  void List(const ListInfo& info, std::vector<Config>& list, Prototype prototype) {
    const ConfigCursor at = Take(info.key);
    if (!at.found() || !IsKind(at, ConfigNode::Kind::kArray, "a list of tables")) return;
    list.clear();
    for (size_t i = 0; i < at.node().children.size(); ++i) {
      list.push_back(prototype(i));
      if (IsKind(at.Element(i), ConfigNode::Kind::kTable, "a table")) Read(at.Element(i), &list.back());
    }
  }

  /// Reports the keys of the table that nothing has asked for.
  void Finish();

 private:
  template <class Config>
  void Read(const ConfigCursor& at, Config* config) {
    ParameterReader reader(at, errors_);
    config->Visit(reader);
    reader.Finish();
  }
  ConfigCursor Take(const char* key);
  /// True as well for a table that is left out: all its values are then at their defaults.
  bool IsKind(const ConfigCursor& at, ConfigNode::Kind kind, const char* expected);

  ConfigCursor table_;
  std::vector<ConfigError>* errors_;
  std::vector<std::string> known_;
};

/// Fills a Config struct from the root of a file.
template <class Config>
void ReadConfig(const ConfigNode& root, Config* config, std::vector<ConfigError>* errors) {
  ParameterReader reader(ConfigCursor(root), errors);
  config->Visit(reader);
  reader.Finish();
}

}  // namespace armada
