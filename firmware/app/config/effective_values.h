#pragma once

#include <string>
#include <vector>

#include "firmware/app/config/value_text.h"
#include "firmware/core/parameter.h"

namespace armada {

/// A parameter as a run uses it.
struct EffectiveValue {
  std::string key;    ///< full dotted key, arms by id: what --set takes
  std::string value;  ///< in TOML's notation, which is JSON's, too
  std::string unit;   ///< empty: none
};

/// Visitor that lists every value below a Config struct.
class ValueLister {
 public:
  ValueLister(std::string prefix, std::vector<EffectiveValue>* values)
      : prefix_(std::move(prefix)), values_(values) {}

  template <class T>
  void operator()(const ParameterInfo& info, T& value) {
    values_->push_back({prefix_ + info.key, ValueText(value), info.unit});
  }
  template <class Config>
  void Table(const char* name, Config& config) {
    ValueLister below(prefix_ + name + ".", values_);
    config.Visit(below);
  }
  template <class Config, class... Prototype>
  void List(const ListInfo& info, std::vector<Config>& list, Prototype...) {
    for (size_t i = 0; i < list.size(); ++i) {
      std::string label = std::to_string(i + 1);
      if constexpr (requires { list[i].id; }) label = std::to_string(list[i].id);
      ValueLister below(prefix_ + info.key + "." + label + ".", values_);
      list[i].Visit(below);
    }
  }

 private:
  std::string prefix_;
  std::vector<EffectiveValue>* values_;
};

template <class Config>
std::vector<EffectiveValue> ListValues(Config* config) {
  std::vector<EffectiveValue> values;
  ValueLister lister("", &values);
  config->Visit(lister);
  return values;
}

}  // namespace armada
