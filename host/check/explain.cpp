#include "host/check/explain.h"

#include <algorithm>
#include <cctype>
#include <map>

namespace armada {
namespace {

// "arm.3.link.2.m_kg" as "arm.*.link.*.m_kg".
std::string WithoutLabels(const std::string& key) {
  std::string general;
  for (size_t begin = 0; begin <= key.size();) {
    const size_t end = std::min(key.find('.', begin), key.size());
    const std::string part = key.substr(begin, end - begin);
    const bool is_label = !part.empty() && std::all_of(part.begin(), part.end(),
                                                       [](unsigned char c) { return std::isdigit(c) != 0; });
    general += (general.empty() ? "" : ".") + (is_label ? "*" : part);
    begin = end + 1;
  }
  return general;
}

void PrintValue(const std::string& key, const EffectiveValue& value, std::ostream& out) {
  out << key << " = " << value.value << (value.unit.empty() ? "" : " ") << value.unit << '\n';
}

}  // namespace

bool Explain(const std::vector<EffectiveValue>& values, const std::string& part, std::ostream& out) {
  // In the order of their first element.
  std::vector<std::string> order;
  std::map<std::string, std::vector<const EffectiveValue*>> families;
  for (const EffectiveValue& value : values) {
    if (value.key.find(part) == std::string::npos) continue;
    const std::string general = WithoutLabels(value.key);
    if (families[general].empty()) order.push_back(general);
    families[general].push_back(&value);
  }
  for (const std::string& general : order) {
    const auto& family = families[general];
    const EffectiveValue& first = *family.front();
    const bool agree = std::all_of(family.begin(), family.end(),
                                   [&](const EffectiveValue* other) { return other->value == first.value; });
    if (family.size() > 1 && agree) {
      PrintValue(general, first, out);
    } else {
      for (const EffectiveValue* value : family) PrintValue(value->key, *value, out);
    }
    out << "    " << first.meaning << "; default " << first.fallback << ", allowed " << first.allowed << '\n';
  }
  return !order.empty();
}

}  // namespace armada
