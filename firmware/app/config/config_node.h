#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "firmware/app/config/config_error.h"

namespace armada {

/// A value of a configuration file with its place: TOML after parsing, before anything is known about its
/// meaning.
struct ConfigNode {
  enum class Kind { kTable, kArray, kBool, kInteger, kReal, kText, kOther };

  Kind kind = Kind::kTable;
  std::string key;                                           ///< in its table; empty in an array
  std::variant<bool, int64_t, double, std::string> value{};  ///< by kind; kOther (a date or time): as text
  std::vector<ConfigNode> children;                          ///< kTable, kArray; in the file's order
  std::string file;
  int line = 0;

  /// Child of a table, or null.
  const ConfigNode* Find(std::string_view child_key) const;
  ConfigNode* Find(std::string_view child_key);
  /// The value in TOML's own notation, shortened where it is long: for messages.
  std::string Describe() const;
};

/// How element `index` of an array is called in keys: by its `id` if it is a table that has one, else by its
/// number from 1.
std::string ElementLabel(const ConfigNode& element, size_t index);

/// A dotted key resolved in a tree as far as it goes: what a reader or a rule complains about. The tree must
/// outlive it.
class ConfigCursor {
 public:
  explicit ConfigCursor(const ConfigNode& root) : node_(&root) {}

  /// Below this one; "link.2.r_m" may pass through tables and arrays.
  ConfigCursor At(std::string_view path) const;
  /// One step: a key of a table, which may have dots in it, or the label of an array's element.
  ConfigCursor Child(std::string_view label) const;
  /// Element of an array, from 0.
  ConfigCursor Element(size_t index) const;

  /// False when the key is not in the tree; node() is then the last one on the way that is.
  bool found() const { return found_; }
  const ConfigNode& node() const { return *node_; }
  const std::string& key() const { return key_; }

 private:
  const ConfigNode* node_;
  std::string key_;
  bool found_ = true;
};

/// Adds an error at the cursor's place.
void Report(const ConfigCursor& at, std::string message, std::vector<ConfigError>* errors);

/// False when an error was reported at the cursor's key or below it: rules that build on the value then have
/// no say.
bool IsClean(const ConfigCursor& at, const std::vector<ConfigError>& errors);

}  // namespace armada
