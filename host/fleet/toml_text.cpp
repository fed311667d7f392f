#include "host/fleet/toml_text.h"

#include <algorithm>

#include "firmware/app/config/value_text.h"

namespace armada {
namespace {

using Kind = ConfigNode::Kind;

constexpr size_t kLineWidth = 110;
constexpr size_t kShort = 3;  // tables of so many values share a line

bool IsSingleValue(const ConfigNode& node) {
  return node.kind != Kind::kTable && node.kind != Kind::kArray;
}

bool HoldsSingleValuesOnly(const ConfigNode& node) {
  return std::all_of(node.children.begin(), node.children.end(), IsSingleValue);
}

bool IsListOfTables(const ConfigNode& node) {
  return node.kind == Kind::kArray && !node.children.empty() && node.children.front().kind == Kind::kTable;
}

bool HasHeader(const ConfigNode& node) {
  const auto& list = node.children;
  return node.kind == Kind::kTable ||
         (IsListOfTables(node) && !std::all_of(list.begin(), list.end(), HoldsSingleValuesOnly));
}

std::string Inline(const ConfigNode& node) {
  if (IsSingleValue(node)) {
    return std::visit(
        [](const auto& value) -> std::string {
          if constexpr (std::is_same_v<std::decay_t<decltype(value)>, int64_t>) {
            return std::to_string(value);
          } else {
            return ValueText(value);
          }
        },
        node.value);
  }
  const bool table = node.kind == Kind::kTable;
  std::string text;
  for (const ConfigNode& child : node.children) {
    text += text.empty() ? "" : ", ";
    if (table) text += child.key + " = ";
    text += Inline(child);
  }
  return table ? "{ " + text + " }" : "[" + text + "]";
}

// A list of flat tables, as many to a line as fit.
std::string InlineTables(const ConfigNode& list) {
  std::string text = "[\n";
  std::string line;
  for (const ConfigNode& table : list.children) {
    const std::string item = Inline(table) + ",";
    const bool fits = table.children.size() <= kShort && line.size() + item.size() + 1 <= kLineWidth;
    if (!line.empty() && !fits) {
      text += line + "\n";
      line.clear();
    }
    line += (line.empty() ? "  " : " ") + item;
  }
  return text + line + "\n]";
}

void Write(const std::string& prefix, const ConfigNode& table, std::string* out) {
  for (const ConfigNode& child : table.children) {
    if (HasHeader(child)) continue;
    *out += child.key + " = " + (IsListOfTables(child) ? InlineTables(child) : Inline(child)) + "\n";
  }
  for (const ConfigNode& child : table.children) {
    if (!HasHeader(child)) continue;
    const std::string name = prefix + child.key;
    if (child.kind == Kind::kTable) {
      // A table of tables only is there by theirs.
      if (!std::all_of(child.children.begin(), child.children.end(), HasHeader)) *out += "\n[" + name + "]\n";
      Write(name + ".", child, out);
      continue;
    }
    for (const ConfigNode& element : child.children) {
      *out += "\n[[" + name + "]]\n";
      Write(name + ".", element, out);
    }
  }
}

}  // namespace

std::string TomlText(const ConfigNode& root) {
  std::string text;
  Write("", root, &text);
  return text;
}

}  // namespace armada
