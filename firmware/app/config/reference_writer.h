#pragma once

#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "firmware/app/config/markdown_cell.h"
#include "firmware/app/config/parameter_text.h"

namespace armada {

/// Visitor that documents a Config struct in markdown: a section for each table of the file. A struct that
/// comes again is documented where it came first.
class ReferenceWriter {
 public:
  /// Headings of the structs documented so far.
  using Documented = std::vector<std::pair<std::type_index, std::string>>;

  ReferenceWriter(std::string prefix, Documented* documented)
      : prefix_(std::move(prefix)), documented_(documented) {}

  template <class T>
  void operator()(const ParameterInfo& info, T& value) {
    rows_ += std::string("| `") + info.key + "` | " + info.unit + " | " + Quoted(DefaultText(info, value)) +
             " | " + AllowedText(info, value) + " | " + MarkdownCell(info.meaning) + " |\n";
  }
  template <class Config>
  void Table(const char* name, Config& config) {
    AddSection("[" + prefix_ + name + "]", "", name, config);
  }
  template <class Config>
  void List(const ListInfo& info, std::vector<Config>& list) {
    List(info, list, [](size_t) { return Config{}; });
  }
  template <class Config, class Prototype>
  void List(const ListInfo& info, std::vector<Config>&, Prototype prototype) {
    Config element = prototype(0);
    AddSection("[[" + prefix_ + info.key + "]]", std::string("\nEach: ") + info.meaning + ".\n", info.key,
               element);
  }

  std::string Text() const {
    const char* head =
        rows_.empty() ? "" : "\n| key | unit | default | allowed | meaning |\n|---|---|---|---|---|\n";
    return head + rows_ + sections_;
  }

 private:
  static std::string Quoted(const std::string& fallback) {
    return fallback == "required" || fallback == "none" ? fallback : "`" + fallback + "`";
  }
  template <class Config>
  void AddSection(const std::string& heading, const std::string& meaning, const char* name, Config& config) {
    sections_ += "\n### `" + heading + "`\n" + meaning;
    for (const auto& [type, first_heading] : *documented_) {
      if (type != std::type_index(typeid(Config))) continue;
      sections_ +=
          "\nThe keys of `" + first_heading + "`; what is given here goes before what is given there.\n";
      return;
    }
    documented_->emplace_back(typeid(Config), heading);
    ReferenceWriter below(prefix_ + name + ".", documented_);
    config.Visit(below);
    sections_ += below.Text();
  }

  std::string prefix_;
  Documented* documented_;
  std::string rows_;
  std::string sections_;
};

}  // namespace armada
