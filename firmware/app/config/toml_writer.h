#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "firmware/app/config/value_text.h"
#include "firmware/core/parameter.h"

namespace armada {

/// Visitor that writes a Config struct as a TOML file. The values of a table precede the tables below it, in
/// whatever order the struct visits them.
class TomlWriter {
 public:
  explicit TomlWriter(std::string prefix) : prefix_(std::move(prefix)) {}

  template <class T>
  void operator()(const ParameterInfo& info, T& value) {
    if (IsAbsent(value)) return;
    values_ += std::string(info.key) + " = " + ValueText(value) + "\n";
  }
  template <class Config>
  void Table(const char* name, Config& config) {
    Append("[" + prefix_ + name + "]", name, config);
  }
  template <class Config, class... Prototype>
  void List(const ListInfo& info, std::vector<Config>& list, Prototype...) {
    for (Config& element : list) Append("[[" + prefix_ + info.key + "]]", info.key, element);
  }

  std::string Text() const { return values_ + tables_; }

 private:
  /// No text stands for a list without values: it was not given.
  template <class T>
  static bool IsAbsent(const T& value) {
    if constexpr (requires { value.size(); }) return value.size() == 0;
    return false;
  }

  template <class Config>
  void Append(const std::string& header, const char* name, Config& config) {
    TomlWriter below(prefix_ + name + ".");
    config.Visit(below);
    tables_ += "\n" + header + "\n" + below.Text();
  }

  std::string prefix_;
  std::string values_;
  std::string tables_;
};

template <class Config>
void WriteToml(Config* config, std::ostream& out) {
  TomlWriter writer("");
  config->Visit(writer);
  out << writer.Text();
}

}  // namespace armada
