#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "host/can/eds.h"

namespace armada {
namespace {

TEST(Cia402Eds, TheFileInTheDocsIsTheOneThatTheTableGives) {
  std::ifstream file(ARMADA_SOURCE_DIR "/docs/can/cia402.eds");
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_TRUE(text.str() == Eds({})) << "docs/can/cia402.eds is not what the table gives: generate it again";
}

// The rules of CiA 306-1, by a reader of INI files that knows nothing of our table.
TEST(Cia402Eds, AnIndependentReaderFindsItConsistent) {
  const std::string judge = std::string(ARMADA_PYTHON) + " " ARMADA_DRIVE_TESTS "/cia402_eds_judge.py " +
                            ARMADA_SOURCE_DIR "/docs/can/cia402.eds";
  EXPECT_EQ(std::system(judge.c_str()), 0);
}

}  // namespace
}  // namespace armada
