#include "firmware/app/config/toml_writer.h"

#include <ostream>
#include <string>

#include "firmware/app/config/parameter_text.h"

namespace armada {
namespace {

class TomlWriter final : public ParameterVisitor {
 public:
  explicit TomlWriter(std::string prefix) : prefix_(std::move(prefix)) {}

  std::string Text() const { return values_ + tables_; }

 private:
  void OnValue(const ParameterInfo& info, const ParameterValue& value) override {
    if (!IsAbsent(value)) values_ += std::string(info.key) + " = " + ValueText(value) + "\n";
  }
  void OnTable(const char* name, const ParameterTable& table) override {
    Append("[" + prefix_ + name + "]", name, table);
  }
  void OnList(const ListInfo& info, ParameterList& list) override {
    for (size_t i = 0; i < list.size(); ++i)
      Append("[[" + prefix_ + info.key + "]]", info.key, list.Element(i));
  }

  void Append(const std::string& header, const char* name, const ParameterTable& table) {
    TomlWriter below(prefix_ + name + ".");
    table.Visit(below);
    tables_ += "\n" + header + "\n" + below.Text();
  }

  std::string prefix_;
  std::string values_;
  std::string tables_;
};

}  // namespace

void WriteToml(const ParameterTable& config, std::ostream& out) {
  TomlWriter writer("");
  config.Visit(writer);
  out << writer.Text();
}

}  // namespace armada
