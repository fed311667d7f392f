#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/toml_parser.h"
#include "tests/fuzz/config_world.h"
#include "tests/fuzz/edited_text.h"

namespace armada {
namespace {

constexpr const char* kFile = "fleet.toml";

constexpr size_t kEdited = 2;  // the first of them, which are small

const std::vector<std::string>& Fleets() {
  static const std::vector<std::string> fleets = {ReadText(ARMADA_FUZZ_FLEETS "/two_arms.toml"),
                                                  ReadText(ARMADA_FUZZ_FLEETS "/obstacles.toml"),
                                                  ReadText(ARMADA_FUZZ_FLEETS "/paper.toml")};
  return fleets;
}

void TestFleet(const std::string& text) {
  std::vector<ConfigError> errors;
  auto tree = ParseToml(text, kFile, &errors);
  const auto loaded = tree ? FleetFromTree(std::move(*tree), kFile, &errors) : std::nullopt;
  if (loaded) {
    RequireSound(loaded->fleet);
  } else {
    RequireExplained(errors, kFile, text);
  }
}

}  // namespace
}  // namespace armada

/// A fleet file of the repository, edited: it is refused with a reason, or boards can live by it.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace armada;
  ByteSource choices({data, size});
  EditedText file(Fleets()[choices.Byte() % kEdited], Fleets());
  while (!choices.empty()) file.Edit(&choices);
  TestFleet(file.text());
  return 0;
}
