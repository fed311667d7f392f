#include "firmware/app/config/reference_writer.h"

#include "firmware/app/config/markdown_cell.h"
#include "firmware/app/config/parameter_text.h"

namespace armada {
namespace {

class ReferenceWriter final : public ParameterVisitor {
 public:
  ReferenceWriter(std::string prefix, DocumentedTables* documented)
      : prefix_(std::move(prefix)), documented_(documented) {}

  std::string Text() const {
    const char* head =
        rows_.empty() ? "" : "\n| key | unit | default | allowed | meaning |\n|---|---|---|---|---|\n";
    return head + rows_ + sections_;
  }

 private:
  void OnValue(const ParameterInfo& info, const ParameterValue& value) override {
    rows_ += std::string("| `") + info.key + "` | " + info.unit + " | " + Quoted(DefaultText(info, value)) +
             " | " + AllowedText(info, value) + " | " + MarkdownCell(info.meaning) + " |\n";
  }
  void OnTable(const char* name, const ParameterTable& table) override {
    AddSection("[" + prefix_ + name + "]", "", name, table);
  }
  void OnList(const ListInfo& info, ParameterList& list) override {
    AddSection("[[" + prefix_ + info.key + "]]", std::string("\nEach: ") + info.meaning + ".\n", info.key,
               list.Prototype(0));
  }

  static std::string Quoted(const std::string& fallback) {
    return fallback == "required" || fallback == "none" ? fallback : "`" + fallback + "`";
  }
  void AddSection(const std::string& heading, const std::string& meaning, const char* name,
                  const ParameterTable& table) {
    sections_ += "\n### `" + heading + "`\n" + meaning;
    for (const auto& [type, first_heading] : *documented_) {
      if (type != table.type()) continue;
      sections_ +=
          "\nThe keys of `" + first_heading + "`; what is given here goes before what is given there.\n";
      return;
    }
    documented_->emplace_back(table.type(), heading);
    ReferenceWriter below(prefix_ + name + ".", documented_);
    table.Visit(below);
    sections_ += below.Text();
  }

  std::string prefix_;
  DocumentedTables* documented_;
  std::string rows_;
  std::string sections_;
};

}  // namespace

std::string ReferenceText(const ParameterTable& config, DocumentedTables* documented) {
  ReferenceWriter writer("", documented);
  config.Visit(writer);
  return writer.Text();
}

}  // namespace armada
