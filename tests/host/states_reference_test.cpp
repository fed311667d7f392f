#include "host/states_reference.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "firmware/core/cause.h"

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

// A bar in a text would make a cell more, and push the reaction out of the table.
TEST(StatesReference, EveryRowHasTheCellsOfItsHead) {
  std::stringstream text;
  WriteStatesReference(text);
  std::ptrdiff_t of_head = 0;
  int rows = 0;
  for (std::string line; std::getline(text, line);) {
    std::ptrdiff_t cells = 0;
    for (size_t i = 0; line.starts_with('|') && i < line.size(); ++i) {
      if (line[i] == '|' && (i == 0 || line[i - 1] != '\\')) ++cells;
    }
    if (cells > 0 && of_head > 0) {
      EXPECT_EQ(cells, of_head) << line;
      ++rows;
    }
    of_head = cells;
  }
  EXPECT_GT(rows, kCauses);
}

}  // namespace
}  // namespace armada
