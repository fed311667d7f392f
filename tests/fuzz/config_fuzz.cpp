#include <sstream>
#include <string_view>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/toml_parser.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

constexpr char kFile[] = "fuzz.toml";

/// The fleet that a text means; nothing, and at least one error that says where and what, if it means none.
std::optional<FleetConfig> Read(std::string_view text) {
  std::vector<ConfigError> errors;
  auto tree = ParseToml(text, kFile, &errors);
  Require(tree.has_value() == errors.empty(), "a text is parsed, or what is wrong with it is said");
  if (!tree) return std::nullopt;
  auto loaded = FleetFromTree(std::move(*tree), kFile, &errors);
  Require(loaded.has_value() == errors.empty(), "a fleet is read, or what is wrong with it is said");
  for (const ConfigError& error : errors) {
    Require(error.file == kFile && error.line >= 0 && !error.message.empty(),
            "an error has a place and a message");
  }
  if (!loaded) return std::nullopt;
  return std::move(loaded->fleet);
}

std::string Written(const FleetConfig& fleet) {
  std::ostringstream text;
  WriteFleet(fleet, text);
  return text.str();
}

/// Fleet files: refused with reasons, or read to values that are written and read again unchanged.
void TestFleet(std::string_view text) {
  const auto fleet = Read(text);
  if (!fleet) return;
  const std::string written = Written(*fleet);
  const auto again = Read(written);
  Require(again.has_value(), "what was written is read");
  Require(Written(*again) == written, "it reads back to the same values");
  for (size_t i = 0; i < fleet->arms.size(); ++i) fleet->ControllerConfig(i);
}

}  // namespace
}  // namespace armada

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  armada::TestFleet({reinterpret_cast<const char*>(data), size});
  return 0;
}
