#include "host/states_reference.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace armada {
namespace {

TEST(StatesReference, IsTheOneInTheDocs) {
  std::ostringstream wanted;
  WriteStatesReference(wanted);
  std::ifstream stream(ARMADA_SOURCE_DIR "/docs/states.md");
  std::stringstream committed;
  committed << stream.rdbuf();
  EXPECT_EQ(committed.str(), wanted.str()) << "docs/states.md is out of date: armada states > docs/states.md";
}

}  // namespace
}  // namespace armada
