#pragma once

#include <string>
#include <vector>

#include "firmware/app/config/parameter_text.h"
#include "firmware/core/parameter.h"

namespace armada {

/// A parameter as a run uses it, and what its documentation says.
struct EffectiveValue {
  std::string key;       ///< full dotted key, arms by id: what --set takes
  std::string value;     ///< in TOML's notation, which is JSON's, too
  std::string unit;      ///< empty: none
  std::string fallback;  ///< the default; "required" or "none"
  std::string allowed;
  std::string meaning;
};

/// Visitor that collects the defaults of one table, in the order in which the table names its values.
class DefaultLister {
 public:
  template <class T>
  void operator()(const ParameterInfo& info, T& value) {
    texts_.push_back(DefaultText(info, value));
  }
  template <class Config>
  void Table(const char*, Config&) {}
  template <class Config, class... Prototype>
  void List(const ListInfo&, std::vector<Config>&, Prototype...) {}

  std::vector<std::string> Take() { return std::move(texts_); }

 private:
  std::vector<std::string> texts_;
};

/// Visitor that lists every value below a Config struct.
class ValueLister {
 public:
  /// `prototype` has the defaults of the struct to be visited.
  template <class Config>
  ValueLister(std::string prefix, Config prototype, std::vector<EffectiveValue>* values)
      : prefix_(std::move(prefix)), values_(values) {
    DefaultLister defaults;
    prototype.Visit(defaults);
    defaults_ = defaults.Take();
  }

  template <class T>
  void operator()(const ParameterInfo& info, T& value) {
    values_->push_back({prefix_ + info.key, ValueText(value), info.unit, defaults_[next_++],
                        AllowedText(info, value), info.meaning});
  }
  template <class Config>
  void Table(const char* name, Config& config) {
    ValueLister below(prefix_ + name + ".", Config{}, values_);
    config.Visit(below);
  }
  template <class Config>
  void List(const ListInfo& info, std::vector<Config>& list) {
    List(info, list, [](size_t) { return Config{}; });
  }
  template <class Config, class Prototype>
  void List(const ListInfo& info, std::vector<Config>& list, Prototype prototype) {
    for (size_t i = 0; i < list.size(); ++i) {
      std::string label = std::to_string(i + 1);
      if constexpr (requires { list[i].id; }) label = std::to_string(list[i].id);
      ValueLister below(prefix_ + info.key + "." + label + ".", prototype(i), values_);
      list[i].Visit(below);
    }
  }

 private:
  std::string prefix_;
  std::vector<EffectiveValue>* values_;
  std::vector<std::string> defaults_;
  size_t next_ = 0;
};

template <class Config>
std::vector<EffectiveValue> ListValues(Config* config) {
  std::vector<EffectiveValue> values;
  ValueLister lister("", Config{}, &values);
  config->Visit(lister);
  return values;
}

}  // namespace armada
