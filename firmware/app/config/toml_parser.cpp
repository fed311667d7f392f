#include "firmware/app/config/toml_parser.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

// toml++ 3.3 has preconditions that a file can break ("[[[x]]]"): an abort in a debug build, undefined in a
// release. Here they are kept in both, and are an error of the file like any other.
namespace armada {
struct BrokenPrecondition {};
constexpr void RequireOfToml(bool condition) {
  if (!condition) throw BrokenPrecondition{};
}
}  // namespace armada
#undef NDEBUG
#define TOML_ASSERT(condition) armada::RequireOfToml(static_cast<bool>(condition))
#define TOML_EXCEPTIONS 1
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

namespace armada {
namespace {

ConfigNode Convert(const toml::node& from, const toml::source_region& place, const std::string& file) {
  ConfigNode node;
  node.file = file;
  node.line = static_cast<int>(place.begin.line);
  if (const toml::table* table = from.as_table()) {
    node.kind = ConfigNode::Kind::kTable;
    // toml++ sorts by key; complaints are better read in the file's order.
    std::vector<std::pair<toml::source_position, ConfigNode>> in_order;
    for (const auto& [key, child] : *table) {
      in_order.emplace_back(key.source().begin, Convert(child, key.source(), file));
      in_order.back().second.key = key.str();
    }
    std::stable_sort(in_order.begin(), in_order.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& [position, child] : in_order) node.children.push_back(std::move(child));
  } else if (const toml::array* array = from.as_array()) {
    node.kind = ConfigNode::Kind::kArray;
    for (const toml::node& child : *array) node.children.push_back(Convert(child, child.source(), file));
  } else if (const auto* boolean = from.as_boolean()) {
    node.kind = ConfigNode::Kind::kBool;
    node.value = boolean->get();
  } else if (const auto* integer = from.as_integer()) {
    node.kind = ConfigNode::Kind::kInteger;
    node.value = integer->get();
  } else if (const auto* real = from.as_floating_point()) {
    node.kind = ConfigNode::Kind::kReal;
    node.value = real->get();
  } else if (const auto* text = from.as_string()) {
    node.kind = ConfigNode::Kind::kText;
    node.value = text->get();
  } else {
    node.kind = ConfigNode::Kind::kOther;
    node.value = std::string("a date or time");
  }
  return node;
}

}  // namespace

std::optional<ConfigNode> ParseToml(std::string_view text, const std::string& file,
                                    std::vector<ConfigError>* errors) {
  try {
    const toml::table table = toml::parse(text, file);
    ConfigNode root = Convert(table, table.source(), file);
    root.line = std::max(root.line, 1);
    return root;
  } catch (const toml::parse_error& error) {
    errors->push_back(
        {file, static_cast<int>(error.source().begin.line), "", std::string(error.description())});
  } catch (const BrokenPrecondition&) {
    errors->push_back({file, 0, "", "not TOML: a header in brackets has no name"});
  }
  return std::nullopt;
}

std::optional<ConfigNode> LoadToml(const std::string& path, std::vector<ConfigError>* errors) {
  const auto fail = [&](const std::string& message) {
    errors->push_back({path, 0, "", message});
    return std::nullopt;
  };
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  std::string text(kMaxConfigBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad()) return fail("cannot be read: " + std::string(std::strerror(errno)));
  text.resize(static_cast<size_t>(stream.gcount()));
  if (text.size() > kMaxConfigBytes) {
    return fail("more than " + std::to_string(kMaxConfigBytes) + " bytes, allowed is at most 1 MiB");
  }
  return ParseToml(text, path, errors);
}

}  // namespace armada
