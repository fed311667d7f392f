#include "firmware/app/config/parameter_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/app/config/spelling.h"

namespace armada {
namespace {

using Kind = ConfigNode::Kind;

bool Expected(const ConfigCursor& at, const char* what, std::vector<ConfigError>* errors) {
  Report(at, "given " + at.node().Describe() + ", expected " + what, errors);
  return false;
}

}  // namespace

std::string NumbersText(const ParameterInfo& info) {
  return ValueText(info.min) + " to " + ValueText(info.max);
}

std::string RangeText(const ParameterInfo& info) {
  return *info.unit == '\0' ? NumbersText(info) : NumbersText(info) + " " + info.unit;
}

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

ConfigCursor ParameterReader::Take(const char* key) {
  known_.emplace_back(key);
  return table_.At(key);
}

bool ParameterReader::IsKind(const ConfigCursor& at, Kind kind, const char* expected) {
  return !at.found() || at.node().kind == kind || Expected(at, expected, errors_);
}

void ParameterReader::Finish() {
  if (!table_.found()) return;
  for (const ConfigNode& child : table_.node().children) {
    if (std::find(known_.begin(), known_.end(), child.key) == known_.end()) {
      Report(table_.Child(child.key), UnknownKeyMessage(child.key, known_), errors_);
    }
  }
}

}  // namespace armada
