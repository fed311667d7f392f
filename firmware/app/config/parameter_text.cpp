#include "firmware/app/config/parameter_text.h"

#include <algorithm>
#include <cmath>

#include "firmware/app/config/value_text.h"

namespace armada {
namespace {

const Choice::Name* FindName(const Choice& choice) {
  const auto found = std::find_if(choice.names.begin(), choice.names.end(),
                                  [&](const Choice::Name& name) { return name.value == choice.value; });
  return found == choice.names.end() ? nullptr : &*found;
}

struct TextOfValue {
  std::string operator()(const Choice* choice) const {
    const Choice::Name* name = FindName(*choice);
    return ValueText(name == nullptr ? "?" : name->name);
  }
  // One value stands for all: written as a number.
  std::string operator()(const NumberList* list) const {
    return list->values.size() == 1 ? ValueText(list->values.front()) : ValueText(list->values);
  }
  template <class Value>
  std::string operator()(const Value* value) const {
    return ValueText(*value);
  }
};

struct AllowedTextOf {
  const ParameterInfo& info;

  std::string operator()(const bool*) const { return "true, false"; }
  std::string operator()(const int*) const { return NumbersText(info); }
  std::string operator()(const double*) const { return NumbersText(info); }
  std::string operator()(const std::string*) const { return "text"; }
  std::string operator()(const Choice* choice) const { return AllNames(*choice); }
  std::string operator()(const NumberList*) const { return NumbersText(info) + ", or a list"; }
  std::string operator()(const std::vector<int>*) const { return "list, each " + NumbersText(info); }
  std::string operator()(const std::vector<std::vector<double>>*) const {
    return "list of points, each number " + NumbersText(info);
  }
};

struct IsNoLegalValue {
  const ParameterInfo& info;

  bool operator()(const int* value) const { return *value < info.min || *value > info.max; }
  bool operator()(const double* value) const { return *value < info.min || *value > info.max; }
  bool operator()(const std::string* value) const { return value->empty(); }
  bool operator()(const Choice* choice) const { return FindName(*choice) == nullptr; }
  bool operator()(const void*) const { return false; }  // the others have no such value
};

struct HasNoValues {
  bool operator()(const std::string* value) const { return value->empty(); }
  bool operator()(const NumberList* list) const { return list->values.empty(); }
  template <class Element>
  bool operator()(const std::vector<Element>* list) const {
    return list->empty();
  }
  bool operator()(const void*) const { return false; }  // the others are no lists
};

}  // namespace

std::string NumbersText(const ParameterInfo& info) {
  return ValueText(info.min) + " to " + ValueText(info.max);
}

std::string RangeText(const ParameterInfo& info) {
  return *info.unit == '\0' ? NumbersText(info) : NumbersText(info) + " " + info.unit;
}

std::string AllNames(const Choice& choice) {
  std::string text;
  for (const Choice::Name& name : choice.names) {
    if (!text.empty()) text += ", ";
    text.append("\"").append(name.name).append("\"");
  }
  return text;
}

std::string ValueText(const ParameterValue& value) {
  return std::visit(TextOfValue{}, value);
}

std::string AllowedText(const ParameterInfo& info, const ParameterValue& value) {
  return std::visit(AllowedTextOf{info}, value);
}

std::string DefaultText(const ParameterInfo& info, const ParameterValue& value) {
  if (IsRequired(info, value)) return "required";
  const auto* number = std::get_if<double*>(&value);
  if (IsAbsent(value) || (number != nullptr && std::isnan(**number))) return "none";
  return ValueText(value);
}

bool IsRequired(const ParameterInfo& info, const ParameterValue& value) {
  return std::visit(IsNoLegalValue{info}, value);
}

bool IsAbsent(const ParameterValue& value) {
  return std::visit(HasNoValues{}, value);
}

}  // namespace armada
