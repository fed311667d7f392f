#pragma once

namespace armada {

/// One parameter of a Config struct. The struct states its parameters once, in
///   template <class Visitor> void Visit(Visitor& parameter),
/// with `parameter(ParameterInfo, member)` for each value, `parameter.Table("name", nested)` for each nested
/// struct and `parameter.List(ListInfo, vector of structs)` for each list of them. The member's initialiser
/// is the default. Reading, overriding, writing and documenting a configuration are visitors
/// (firmware/app/config).
struct ParameterInfo {
  const char* key;
  const char* unit;     ///< empty: none
  double min, max;      ///< legal values, ends included; not used for text, names and truth values
  const char* meaning;  ///< one sentence without its full stop
};

/// A list of tables in a configuration: what one element is.
struct ListInfo {
  const char* key;
  const char* meaning;
};

}  // namespace armada
