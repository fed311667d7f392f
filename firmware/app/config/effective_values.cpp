#include "firmware/app/config/effective_values.h"

#include "firmware/app/config/parameter_text.h"

namespace armada {
namespace {

/// Collects the defaults of one table, in the order in which the table names its values.
class DefaultLister final : public ParameterVisitor {
 public:
  std::vector<std::string> texts;

 private:
  void OnValue(const ParameterInfo& info, const ParameterValue& value) override {
    texts.push_back(DefaultText(info, value));
  }
  void OnTable(const char*, const ParameterTable&) override {}
  void OnList(const ListInfo&, ParameterList&) override {}
};

class ValueLister final : public ParameterVisitor {
 public:
  ValueLister(std::string prefix, std::vector<std::string> defaults, std::vector<EffectiveValue>* values)
      : prefix_(std::move(prefix)), defaults_(std::move(defaults)), values_(values) {}

 private:
  void OnValue(const ParameterInfo& info, const ParameterValue& value) override {
    values_->push_back({prefix_ + info.key, ValueText(value), info.unit, defaults_[next_++],
                        AllowedText(info, value), info.meaning});
  }
  void OnTable(const char* name, const ParameterTable& table) override {
    DefaultLister defaults;
    table.VisitDefaults(defaults);
    ValueLister below(prefix_ + name + ".", std::move(defaults.texts), values_);
    table.Visit(below);
  }
  void OnList(const ListInfo& info, ParameterList& list) override {
    for (size_t i = 0; i < list.size(); ++i) {
      DefaultLister defaults;
      list.Prototype(i).Visit(defaults);
      ValueLister below(prefix_ + info.key + "." + std::to_string(list.Label(i)) + ".",
                        std::move(defaults.texts), values_);
      list.Element(i).Visit(below);
    }
  }

  std::string prefix_;
  std::vector<std::string> defaults_;
  std::vector<EffectiveValue>* values_;
  size_t next_ = 0;
};

class KeyLister final : public ParameterVisitor {
 public:
  std::vector<std::string> keys;

 private:
  void OnValue(const ParameterInfo& info, const ParameterValue&) override { keys.emplace_back(info.key); }
  void OnTable(const char* name, const ParameterTable&) override { keys.emplace_back(name); }
  void OnList(const ListInfo& info, ParameterList&) override { keys.emplace_back(info.key); }
};

}  // namespace

std::vector<EffectiveValue> ListValues(const ParameterTable& config) {
  DefaultLister defaults;
  config.VisitDefaults(defaults);
  std::vector<EffectiveValue> values;
  ValueLister lister("", std::move(defaults.texts), &values);
  config.Visit(lister);
  return values;
}

std::vector<std::string> KeysOf(const ParameterTable& config) {
  KeyLister lister;
  config.Visit(lister);
  return lister.keys;
}

}  // namespace armada
