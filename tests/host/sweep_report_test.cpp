#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "host/report/csv_table.h"
#include "host/report/report.h"
#include "tests/host/sweep_samples.h"
#include "tests/support/temp_dir.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

/// A folder of this test's own.
fs::path Folder() {
  const fs::path folder =
      fs::path(testing::TempDir()) /
      (std::string("armada_sweep_report_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

fs::path WrittenTo(const Sweep& sweep, const fs::path& folder) {
  const fs::path path = folder / "box.json";
  std::string error;
  EXPECT_TRUE(WriteSweep(sweep, Summarize(sweep.results), path, &error)) << error;
  return path;
}

/// Figures of a page, one a line, by a judge that also refuses what is not well formed or fetched.
std::string JudgePage(const fs::path& page) {
  const fs::path judge = fs::path(__FILE__).parent_path() / "report_golden" / "judge_page.py";
  FILE* pipe = popen(("/usr/bin/python3 " + judge.string() + " " + page.string() + " 2>&1").c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer;
  for (size_t count; (count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    output.append(buffer.data(), count);
  EXPECT_EQ(pclose(pipe), 0) << output;
  return output;
}

TEST(SweepReport, IsOnePageWithPercentilesWorstSeedsAndFigures) {
  const fs::path folder = Folder();
  std::string error;
  ASSERT_TRUE(WriteSweepReport(WrittenTo(SweepOf(1, 200, 1), folder), &error)) << error;
  EXPECT_EQ(JudgePage(folder / "box.html"), "settling\nrms\nmax\n");
  const std::string page = ReadText(folder / "box.html");
  for (const char* text : {"200 of 200 fleets ok", "200 seeds from 1 to 200", "<td>19.8</td>",
                           "<td>20.0</td>", "armada sim scenarios/paper.toml --seed 200"}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(page.find("Not ok"), std::string::npos);
}

TEST(SweepReport, FiguresAreSharesOfTheSeeds) {
  const fs::path folder = Folder();
  std::string error;
  ASSERT_TRUE(WriteSweepReport(WrittenTo(SweepOf(1, 200, 1), folder), &error)) << error;
  const CsvTable table(folder / "box.report" / "settling.csv");
  const auto& edge_s = table.Column("edge");
  const auto& below = table.Column("below_arm_1");
  const auto& above = table.Column("above_arm_1");
  EXPECT_EQ(below.front(), 0.0);
  EXPECT_EQ(below.back(), 1.0);
  for (size_t row = 0; row < table.rows(); ++row) {
    EXPECT_NEAR(below[row] + above[row], 1.0, 1e-5);
    // Seed n settles at n/10 s.
    EXPECT_NEAR(below[row], std::min(1.0, edge_s[row] / 20.0), 0.0051) << edge_s[row];
  }
}

TEST(SweepReport, NamesTheSeedsThatAreNotOk) {
  const fs::path folder = Folder();
  std::vector<SeedResult> results;
  for (uint64_t seed = 1; seed <= 30; ++seed) results.push_back(ResultOf(seed, 0.9, seed % 11 != 0));
  std::string error;
  ASSERT_TRUE(WriteSweepReport(WrittenTo(SweepOf(results), folder), &error)) << error;
  const std::string page = ReadText(folder / "box.html");
  for (const char* text :
       {"28 of 30 fleets ok", "2 seeds:", "11 22 ", "armada sim scenarios/paper.toml --seed 11"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
}

TEST(SweepReport, SetsTheErrorBesideWhatIsUnavoidable) {
  const fs::path folder = Folder();
  std::vector<SeedResult> results;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    results.push_back(ResultOf(seed, 0.75, true));
    results.back().floor_rms_mm = results.back().arms[0].floor_rms_mm = 0.5;
  }
  std::string error;
  ASSERT_TRUE(WriteSweepReport(WrittenTo(SweepOf(results), folder), &error)) << error;
  const std::string page = ReadText(folder / "box.html");
  for (const char* text :
       {"0.750 mm, 1.50 times the unavoidable 0.500 mm", "<h2>RMS error by the unavoidable one</h2>"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  ASSERT_TRUE(WriteSweepReport(WrittenTo(SweepOf(1, 9, 1), folder), &error)) << error;
  EXPECT_EQ(ReadText(folder / "box.html").find("unavoidable"), std::string::npos);
}

TEST(SweepReport, LeavesOutWhatNoSeedHas) {
  const fs::path folder = Folder();
  std::string error;
  ASSERT_TRUE(WriteSweepReport(
      WrittenTo(SweepOf({ResultOf(1, 500.0, false), ResultOf(2, 600.0, false)}), folder), &error))
      << error;
  EXPECT_EQ(JudgePage(folder / "box.html"), "rms\n") << "every arm diverged; the fleets' RMS is of all";
  ASSERT_TRUE(WriteSweepReport(WrittenTo(SweepOf(2, 1, 1), folder), &error)) << error;
  EXPECT_EQ(JudgePage(folder / "box.html"), "\n") << "of no seed at all";
}

TEST(SweepReport, RefusesWhatIsNoSweepAndLeavesNoPage) {
  const fs::path folder = Folder();
  const auto error_of = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name) << text;
    std::string error;
    EXPECT_FALSE(WriteSweepReport(folder / name, &error));
    EXPECT_FALSE(fs::exists(folder / "box.html"));
    return error;
  };
  std::ofstream(folder / "box.html") << "of an earlier sweep";
  EXPECT_NE(error_of("box.json", "{\"schema\": 1, \"mode\": \"sim\"}").find("not a sweep"),
            std::string::npos);
  EXPECT_NE(error_of("box.json", "{\"schema\": 1").find("parse error"), std::string::npos);
  EXPECT_NE(error_of("box.json", "{\"schema\": 1, \"mode\": \"sweep\"}").find("bins_per_decade"),
            std::string::npos);
  EXPECT_NE(error_of("box.txt", "{}").find("ends in .json"), std::string::npos);
  std::string error;
  EXPECT_FALSE(WriteSweepReport(folder / "none.json", &error));
  EXPECT_EQ(error, (folder / "none.json").string() + ": cannot be read");
}

}  // namespace
}  // namespace armada
