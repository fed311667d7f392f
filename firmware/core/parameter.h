#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "firmware/core/named_enum.h"
#include "firmware/core/parameter_table.h"
#include "firmware/core/parameter_value.h"

namespace armada {

/// One parameter of a Config struct.
struct ParameterInfo {
  const char* key;
  const char* unit;     ///< empty: none
  double min, max;      ///< legal values, ends included; not used for text, names and truth values
  const char* meaning;  ///< one sentence without its full stop
};

/// A list of tables in a configuration: what one element is.
struct ListInfo {
  const char* key;
  const char* meaning;
};

/// What goes through the parameters of Config structs: reading, writing and documenting a configuration are
/// visitors (firmware/app/config). A struct states its parameters once, in
///   void Visit(ParameterVisitor& parameter),
/// with `parameter(ParameterInfo, member)` for each value, `parameter.Table("name", nested)` for each nested
/// struct and `parameter.List(ListInfo, vector of structs)` for each list of them. The member's initialiser
/// is the default.
class ParameterVisitor {
 public:
  /// Of a type in ParameterValue.
  template <class Value>
  void operator()(const ParameterInfo& info, Value& value) {
    OnValue(info, &value);
  }
  template <NamedEnum Enum>
  void operator()(const ParameterInfo& info, Enum& value) {
    Choice choice{static_cast<int>(value), kChoiceNames<Enum>};
    OnValue(info, &choice);
    value = static_cast<Enum>(choice.value);
  }
  /// Of a BoundedVector.
  template <class Vector>
  requires(Vector::MaxRowsAtCompileTime > 0) void operator()(const ParameterInfo& info, Vector& value) {
    NumberList numbers{{value.data(), value.data() + value.size()}, size_t{Vector::MaxRowsAtCompileTime}};
    OnValue(info, &numbers);
    value.resize(static_cast<decltype(value.size())>(numbers.values.size()));
    std::copy(numbers.values.begin(), numbers.values.end(), value.data());
  }

  template <class Config>
  void Table(const char* name, Config& config) {
    OnTable(name, &config);
  }

  template <class Config>
  void List(const ListInfo& info, std::vector<Config>& list) {
    List(info, list, [](size_t) { return Config{}; });
  }
  /// `make_prototype(i)` is what element i, from 0, has where a file gives nothing.
  template <class Config, class MakePrototype>
  void List(const ListInfo& info, std::vector<Config>& list, MakePrototype make_prototype) {
    VectorAsList<Config, MakePrototype> elements(&list, std::move(make_prototype));
    OnList(info, elements);
  }

 protected:
  ~ParameterVisitor() = default;

 private:
  virtual void OnValue(const ParameterInfo& info, const ParameterValue& value) = 0;
  virtual void OnTable(const char* name, const ParameterTable& table) = 0;
  virtual void OnList(const ListInfo& info, ParameterList& list) = 0;
};

}  // namespace armada
