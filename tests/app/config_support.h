#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/config/config_error.h"

namespace armada {

/// A file of this test alone, removed with the object.
class TemporaryFile {
 public:
  /// `name` is unique within a test.
  explicit TemporaryFile(std::string_view text, const std::string& name = "config.toml");
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// A directory of this test alone, below the system's temporary one; it exists afterwards.
std::string TestDirectory();

/// `text` with line `number`, from 1, replaced.
std::string WithLine(std::string_view text, int number, const std::string& replacement);

/// A mistake in a file and how it is to be told: all of what is wrong with it.
struct ConfigCase {
  std::string name;  ///< of the test
  int line;  ///< replaced in the base file, and the one that the error names unless `error_line` is given
  std::string replacement;
  std::string key;                     ///< of the one error
  std::vector<std::string> fragments;  ///< of its message
  int error_line = 0;
};
void PrintTo(const ConfigCase& one, std::ostream* out);

/// Fails unless exactly the error of the case was reported, in `file`.
void ExpectOneError(const ConfigCase& expected, const std::string& file,
                    const std::vector<ConfigError>& errors);

/// All errors as text, one a line.
std::string Text(const std::vector<ConfigError>& errors);

}  // namespace armada
