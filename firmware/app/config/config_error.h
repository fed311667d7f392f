#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace armada {

/// One mistake in a configuration. The message names what was given and what is allowed.
struct ConfigError {
  std::string file;  ///< "--set" for an override of the command line
  int line = 0;      ///< from 1; 0 when the mistake has none (a missing file)
  std::string key;   ///< full dotted key, arms by id: "arm.6.control.gains.K_s_Nms_rad"; may be empty
  std::string message;
};

/// `file:line: key: message`, without the parts that do not apply.
std::string ToString(const ConfigError& error);

/// One line each.
void PrintErrors(const std::vector<ConfigError>& errors, std::ostream& out);

/// Orders the errors from index `first` on by line, file after file as they first came.
void SortByPlace(std::vector<ConfigError>* errors, size_t first);

}  // namespace armada
