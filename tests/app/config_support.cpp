#include "tests/app/config_support.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace armada {

std::string TestDirectory() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  std::string name =
      std::string(info->test_suite_name()) + "." + info->name() + "." + std::to_string(getpid());
  std::replace(name.begin(), name.end(), '/', '_');
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::create_directories(path);
  return path.string();
}

TemporaryFile::TemporaryFile(std::string_view text, const std::string& name)
    : path_(TestDirectory() + "/" + name) {
  std::ofstream(path_, std::ios::binary) << text;
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  const std::filesystem::path path(path_);
  std::filesystem::remove(path, ignored);
  std::filesystem::remove(path.parent_path(), ignored);  // when it was the last one in it
}

std::string WithLine(std::string_view text, int number, const std::string& replacement) {
  std::istringstream lines{std::string(text)};
  std::string result;
  std::string line;
  for (int i = 1; std::getline(lines, line); ++i) result += (i == number ? replacement : line) + "\n";
  return result;
}

void PrintTo(const ConfigCase& one, std::ostream* out) {
  *out << one.name;
}

void ExpectOneError(const ConfigCase& expected, const std::string& file,
                    const std::vector<ConfigError>& errors) {
  ASSERT_EQ(errors.size(), 1u) << Text(errors);
  const ConfigError& error = errors.front();
  EXPECT_EQ(error.file, file);
  EXPECT_EQ(error.line, expected.error_line != 0 ? expected.error_line : expected.line) << Text(errors);
  EXPECT_EQ(error.key, expected.key) << Text(errors);
  for (const std::string& fragment : expected.fragments) {
    EXPECT_NE(error.message.find(fragment), std::string::npos)
        << "no \"" << fragment << "\" in: " << error.message;
  }
}

std::string Text(const std::vector<ConfigError>& errors) {
  std::ostringstream text;
  PrintErrors(errors, text);
  return text.str();
}

}  // namespace armada
