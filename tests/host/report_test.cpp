#include "host/report/report.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>

#include "host/report/axis_range.h"
#include "host/report/csv_table.h"
#include "host/report/html_page.h"
#include "host/report/number_text.h"
#include "host/report/process_table.h"
#include "host/report/recorded_run.h"
#include "host/report/run_facts.h"
#include "tests/host/report_golden/sample_run.h"
#include "tests/support/temp_dir.h"

namespace armada {
namespace {

using namespace report_sample;

int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
  return count;
}

/// Runs a command for its exit status and what it prints.
int RunCommand(const std::string& command, std::string* output) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer;
  for (size_t count; (count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    output->append(buffer.data(), count);
  return pclose(pipe);
}

/// Sets PATH for as long as it lives.
class ScopedPath {
 public:
  explicit ScopedPath(const std::string& value) : before_(getenv("PATH")) {
    setenv("PATH", value.c_str(), 1);
  }
  ScopedPath(const ScopedPath&) = delete;
  ScopedPath& operator=(const ScopedPath&) = delete;
  ~ScopedPath() { setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

const std::vector<std::string> kFigures = {
    "estimates", "states", "paths", "posture_arm_6", "manipulability_arm_7", "error", "torques", "timing"};

/// One report of the sample, looked at from several sides.
class Report : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = new TempDir;
    WriteSample(dir());
    std::string error;
    ASSERT_TRUE(WriteReport(dir(), &error)) << error;
    page_ = ReadText(dir() / "report.html");
  }
  static void TearDownTestSuite() { delete dir_; }

  static const fs::path& dir() { return dir_->path(); }
  static fs::path Drawn(const std::string& file) { return dir() / "report" / file; }
  /// The caption of a figure as it stands in the page.
  static std::string Caption(const std::string& figure) {
    const size_t start = page_.find("<figcaption>", page_.find("<figure id=\"" + figure + "\""));
    return page_.substr(start, page_.find("</figcaption>", start) - start);
  }

  static inline TempDir* dir_ = nullptr;
  static inline std::string page_;
};

TEST_F(Report, KeepsTheScriptBesideEveryFigureAndLeavesNothingUnfinished) {
  std::set<std::string> expected = {"error.csv"};
  for (const std::string& figure : kFigures) {
    for (const char* extension : {".gp", ".png", ".svg"}) expected.insert(figure + extension);
  }
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(dir() / "report")) found.insert(entry.path().filename());
  EXPECT_EQ(found, expected);
}

TEST_F(Report, EveryPngIsWholeAndTwiceTheSizeOfItsSvg) {
  for (const std::string& figure : kFigures) {
    const std::string png = ReadText(Drawn(figure + ".png"));
    ASSERT_GT(png.size(), 1000U) << figure;
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n") << figure;
    EXPECT_EQ(png.substr(png.size() - 8, 4), "IEND") << figure;
    const auto byte = [&](size_t at) { return static_cast<unsigned>(static_cast<unsigned char>(png[at])); };
    const std::string svg = ReadText(Drawn(figure + ".svg"));
    const unsigned width = byte(18) << 8 | byte(19);
    const unsigned height = byte(22) << 8 | byte(23);
    EXPECT_NE(
        svg.find("viewBox=\"0 0 " + std::to_string(width / 2) + " " + std::to_string(height / 2) + "\""),
        std::string::npos)
        << figure;
  }
}

TEST_F(Report, EverySvgIsWellFormedXml) {
  std::string command =
      "/usr/bin/python3 -c 'import sys, xml.etree.ElementTree as tree\n"
      "for path in sys.argv[1:]: assert tree.parse(path).getroot().tag.endswith(\"svg\"), path'";
  for (const std::string& figure : kFigures) command += ' ' + Drawn(figure + ".svg").string();
  std::string output;
  EXPECT_EQ(RunCommand(command, &output), 0) << output;
}

TEST_F(Report, PageHoldsEveryFigureAndFetchesNothing) {
  const fs::path judge = fs::path(__FILE__).parent_path() / "report_golden" / "judge_page.py";
  std::string output;
  ASSERT_EQ(
      RunCommand("/usr/bin/python3 " + judge.string() + " " + (dir() / "report.html").string(), &output), 0)
      << output;
  std::string expected;
  for (const std::string& figure : kFigures) expected += figure + "\n";
  EXPECT_EQ(output, expected);
  EXPECT_EQ(CountOf(page_, "<svg viewBox="), static_cast<int>(kFigures.size()));
}

TEST_F(Report, PageHoldsEveryNumberOfTheMetrics) {
  const Json flat = SampleMetrics().flatten();
  for (const auto& [key, value] : flat.items()) {
    if (value.is_number()) {
      EXPECT_NE(page_.find(value.dump()), std::string::npos) << key;
    }
  }
  for (const char* cell :
       {"<td>1.04</td>", "<td>1.22</td>", "<td>1.26</td>", "<td>2.13×10⁻⁶</td>", "<td>0.00256</td>",
        "<td>144</td>", "<td>0.0271</td>", "<td>0.313</td>", "<td>31.2</td>", "<td>77.5</td>"}) {
    EXPECT_NE(page_.find(cell), std::string::npos) << cell;
  }
}

TEST_F(Report, OpensWithTheVerdict) {
  const std::string opening =
      page_.substr(page_.find("<body>"), page_.find("<h2>Arms") - page_.find("<body>"));
  for (const char* fact :
       {"NOT ok", "sample &amp; co", "4711", "2 to 4 s", "real time", "robust", "predictive"}) {
    EXPECT_NE(opening.find(fact), std::string::npos) << fact;
  }
}

TEST_F(Report, SaysLoudlyWhichArmDiverged) {
  EXPECT_NE(page_.find("<p class=\"alarm\">DIVERGED: arm 4.</p>"), std::string::npos);
  EXPECT_EQ(CountOf(page_, "<strong>DIVERGED</strong>"), 1);
  EXPECT_NE(page_.find("tracking &lt;error&gt;"), std::string::npos);
  EXPECT_NE(page_.find("arm 4 DIVERGED"), std::string::npos) << "in the legends";
  EXPECT_NE(Caption("states").find("DIVERGED: arm 4 (recorded until 1.18 s)"), std::string::npos)
      << Caption("states");
}

TEST_F(Report, ADivergedArmDoesNotFlattenTheOthersAndItsLeavingIsSaid) {
  const std::string script = ReadText(Drawn("states.gp"));
  const std::string start = "set yrange [";
  int panels = 0;
  for (size_t at = 0; (at = script.find(start, at)) != std::string::npos; ++panels) {
    at += start.size();
    EXPECT_GT(std::stod(script.substr(at)), -12.0);
    EXPECT_LT(std::stod(script.substr(script.find(':', at) + 1)), 12.0);
  }
  EXPECT_EQ(panels, 4);
  EXPECT_NE(Caption("states").find("Out of the picture for a part of their samples: arm 4 (98 %)."),
            std::string::npos)
      << Caption("states");
  EXPECT_NE(Caption("estimates").find("No arm leaves the picture."), std::string::npos)
      << Caption("estimates");
}

TEST_F(Report, CaptionsNameThePapersFigures) {
  const std::pair<const char*, const char*> pairs[] = {{"estimates", "Fig. 3"},
                                                       {"states", "Fig. 4"},
                                                       {"paths", "Fig. 5"},
                                                       {"posture_arm_6", "Fig. 6"},
                                                       {"manipulability_arm_7", "Fig. 7"}};
  for (const auto& [figure, paper] : pairs) {
    EXPECT_NE(Caption(figure).find(std::string(paper) + " of the paper"), std::string::npos)
        << Caption(figure);
  }
}

TEST_F(Report, SubtaskFiguresCompareWithTheTwin) {
  EXPECT_NE(Caption("posture_arm_6").find("q2 1 (2)"), std::string::npos) << Caption("posture_arm_6");
  EXPECT_NE(Caption("manipulability_arm_7").find("2 with the subtask and 1 without it"), std::string::npos)
      << Caption("manipulability_arm_7");
  EXPECT_NE(ReadText(Drawn("posture_arm_6.gp")).find("../without_subtask/arm_6.csv"), std::string::npos);
}

TEST_F(Report, ASingleBadTickStaysVisibleInTheErrorFigure) {
  const CsvTable error(Drawn("error.csv"));
  const std::vector<double>& peaks_mm = error.Column("arm_1_mm");
  constexpr size_t kBucket = 24;  // the spike comes at 2.4 s, a bucket lasts 0.1 s
  EXPECT_DOUBLE_EQ(peaks_mm[kBucket], 1e3 * kSpike_m);
  EXPECT_LT(peaks_mm[kBucket + 1], 2.0);
}

TEST_F(Report, AScriptRunByHandDrawsTheSameAgain) {
  const std::string before = ReadText(Drawn("paths.svg"));
  fs::remove(Drawn("paths.svg"));
  std::string output;
  ASSERT_EQ(RunCommand("cd " + (dir() / "report").string() + " && gnuplot paths.gp", &output), 0) << output;
  EXPECT_EQ(output, "");
  EXPECT_EQ(ReadText(Drawn("paths.svg")), before);
}

TEST(ReportOfSpareJoints, DrawsGoalsLimitsAndClearances) {
  TempDir dir;
  WriteSample(dir.path());
  Json metrics = SampleMetrics();
  Json& arm_6 = metrics["arms"][2];
  arm_6["posture_joint"] = 2;
  arm_6["posture_goal_rad"] = 0.875 - 2.0 * M_PI;  // a whole turn from where the joint is
  arm_6["posture_max_rad"] = 0.125;
  arm_6["clearance_min_m"] = 0.0625;
  arm_6["clearance_wanted_m"] = 0.03125;
  Json& arm_1 = metrics["arms"][0];
  arm_1["limit_margin_min_rad"] = 0.75;
  arm_1["q_min_rad"] = {-1.25, -1.5};
  arm_1["q_max_rad"] = nullptr;
  WriteMetrics(dir.path(), metrics);
  std::string error;
  ASSERT_TRUE(WriteReport(dir.path(), &error)) << error;
  const auto script = [&](const char* name) { return ReadText(dir.path() / "report" / name); };
  EXPECT_NE(script("posture_arm_6.gp").find("0.875 with lines"), std::string::npos);
  EXPECT_NE(script("limits_arm_1.gp").find("-1.25 with lines"), std::string::npos);
  EXPECT_NE(script("limits_arm_1.gp").find("../without_subtask/arm_1.csv"), std::string::npos);
  EXPECT_NE(script("clearance_arm_6.gp").find("0.03125 with lines"), std::string::npos);
  const std::string page = ReadText(dir.path() / "report.html");
  EXPECT_NE(page.find("Largest distance from the goal in the window: 0.125 rad"), std::string::npos);
  EXPECT_NE(page.find("Least distance from a limit in the window: 0.75 rad"), std::string::npos);
  EXPECT_NE(page.find("0.0625 m with avoidance and -0.25 m without it"), std::string::npos);
}

TEST(ReportOfASimulation, NeedsNeitherTwinNorTiming) {
  TempDir dir;
  WriteRun(dir.path(), true);
  WriteMetrics(dir.path(), SampleMetrics());
  std::string error;
  ASSERT_TRUE(WriteReport(dir.path(), &error)) << error;
  EXPECT_FALSE(fs::exists(dir.path() / "report" / "timing.svg"));
  EXPECT_NE(ReadText(dir.path() / "report.html").find("no twin run without subtasks"), std::string::npos);
}

TEST(ReportOfARun, SaysWhyItIsNotOkInTheWordsOfTheRun) {
  TempDir dir;
  WriteSample(dir.path());
  Json metrics = SampleMetrics();
  metrics["diagnosis"] = {{{"kind", "stall"}, {"text", "the machine stood <still>"}},
                          {{"kind", "stopped"}, {"text", "arm 4 went to FAULT"}}};
  WriteMetrics(dir.path(), metrics);
  const std::string page = HtmlPage(LoadRecordedRun(dir.path()), {}, dir.path() / "report");
  const std::string verdict = page.substr(0, page.find("<h2>Arms"));
  EXPECT_NE(verdict.find("<ul><li>the machine stood &lt;still&gt;</li><li>arm 4 went to FAULT</li></ul>"),
            std::string::npos);
  EXPECT_EQ(verdict.find("class=\"alarm\""), std::string::npos) << "said twice";
}

/// A sample with one thing wrong, and what the report says about it.
class ReportRefuses : public testing::Test {
 protected:
  ReportRefuses() {
    WriteSample(dir());
    WriteText(dir() / "report.html", "of an earlier run");
  }
  const fs::path& dir() const { return dir_.path(); }
  std::string Error() {
    std::string error;
    EXPECT_FALSE(WriteReport(dir(), &error));
    EXPECT_FALSE(fs::exists(dir() / "report.html")) << "a page that belongs to no finished report";
    return error;
  }
  void ReplaceIn(const std::string& file, const std::string& from, const std::string& to) {
    std::string text = ReadText(dir() / file);
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    WriteText(dir() / file, text.replace(at, from.size(), to));
  }

 private:
  TempDir dir_;
};

TEST_F(ReportRefuses, AMissingFile) {
  for (const char* file : {"metrics.json", "leader.csv", "arm_6.csv", "without_subtask/arm_7.csv"}) {
    fs::rename(dir() / file, dir() / "aside");
    EXPECT_EQ(Error(), (dir() / file).string() + ": cannot be read");
    fs::rename(dir() / "aside", dir() / file);
  }
}

TEST_F(ReportRefuses, ADirectoryThatIsNone) {
  std::string error;
  EXPECT_FALSE(WriteReport(dir() / "nowhere", &error));
  EXPECT_EQ(error, (dir() / "nowhere").string() + ": is not a directory");
}

TEST_F(ReportRefuses, AMissingColumn) {
  ReplaceIn("arm_1.csv", "manipulability", "manipulation");
  EXPECT_EQ(Error(), (dir() / "arm_1.csv").string() + ": has no column manipulability");
}

TEST_F(ReportRefuses, AFieldThatIsNoNumber) {
  ReplaceIn("leader.csv", "\n0.02,", "\nsoon,");
  EXPECT_EQ(Error(), (dir() / "leader.csv").string() + ":3: column t_s: 'soon' is not a number");
}

TEST_F(ReportRefuses, ARowOfAnotherLength) {
  ReplaceIn("leader.csv", "\n0.02,", "\n0.02,7,");
  EXPECT_EQ(Error(), (dir() / "leader.csv").string() + ":3: 8 fields, the header has 7");
}

TEST_F(ReportRefuses, AFileWithoutRows) {
  WriteText(dir() / "leader.csv", "t_s,x1_m\n");
  EXPECT_EQ(Error(), (dir() / "leader.csv").string() + ": has a header but no rows");
}

TEST_F(ReportRefuses, BrokenJson) {
  WriteText(dir() / "metrics.json", "{\"schema\": 1,");
  const std::string error = Error();
  EXPECT_EQ(error.rfind((dir() / "metrics.json").string() + ": ", 0), 0U) << error;
  EXPECT_NE(error.find("line 1, column"), std::string::npos) << error;
}

TEST_F(ReportRefuses, AnotherSchema) {
  ReplaceIn("metrics.json", "\"schema\": 1", "\"schema\": 2");
  EXPECT_EQ(Error(), (dir() / "metrics.json").string() + ": schema is 2, allowed: 1");
}

TEST_F(ReportRefuses, AMetricThatIsMissing) {
  ReplaceIn("metrics.json", "\"saturated_ticks\"", "\"saturation\"");
  EXPECT_NE(Error().find("arm 1 has no key \"saturated_ticks\""), std::string::npos);
}

TEST_F(ReportRefuses, ToGoOnWithoutGnuplot) {
  const ScopedPath path((dir() / "empty").string());
  const std::string error = Error();
  EXPECT_NE(error.find("gnuplot cannot be started"), std::string::npos) << error;
  EXPECT_NE(error.find("gnuplot-nox"), std::string::npos) << error;
}

TEST_F(ReportRefuses, AFigureThatGnuplotFailsOnAndKeepsNoHalfOfIt) {
  fs::create_directory(dir() / "bin");
  WriteText(dir() / "bin" / "gnuplot",
            "#!/bin/sh\necho half > estimates.svg\necho 'line 7: no such terminal' >&2\nexit 3\n");
  fs::permissions(dir() / "bin" / "gnuplot", fs::perms::owner_all);
  const ScopedPath path((dir() / "bin").string() + ":/usr/bin:/bin");
  const std::string error = Error();
  EXPECT_NE(error.find("estimates.gp"), std::string::npos) << error;
  EXPECT_NE(error.find("line 7: no such terminal"), std::string::npos) << error;
  EXPECT_FALSE(fs::exists(dir() / "report" / "estimates.svg"));
  EXPECT_TRUE(fs::exists(dir() / "report" / "estimates.gp"));
}

TEST_F(ReportRefuses, AFigureOfWhichGnuplotWroteHalfWithoutAWord) {
  fs::create_directory(dir() / "bin");
  WriteText(dir() / "bin" / "gnuplot",
            "#!/bin/sh\necho '<svg></svg>' > estimates.svg\necho half > estimates.png\n");
  fs::permissions(dir() / "bin" / "gnuplot", fs::perms::owner_all);
  const ScopedPath path((dir() / "bin").string() + ":/usr/bin:/bin");
  EXPECT_EQ(Error(), "gnuplot cannot write " + (dir() / "report" / "estimates.png").string());
  EXPECT_FALSE(fs::exists(dir() / "report" / "estimates.png"));
}

TEST(ProcessTable, HasTheSumsOfAListSoThatItStaysNarrow) {
  const Json arm = Json::parse(R"({"id": 2, "bus": {"lcm_sent": 4000, "lcm_heard": [
      {"from": 1, "accepted": 2000, "missed": 0}, {"from": 3, "accepted": 1990, "missed": 10}]}})");
  const ProcessTable table = CollectProcesses({{"arms", {arm}}});
  EXPECT_EQ(table.quantities,
            (std::vector<std::string>{"bus.lcm_sent", "bus.lcm_heard.accepted", "bus.lcm_heard.missed"}));
  EXPECT_EQ(table.values.at({"bus.lcm_heard.accepted", "arm 2"}), 3990);
  EXPECT_EQ(table.values.at({"bus.lcm_heard.missed", "arm 2"}), 10);
}

TEST(NumberText, KeepsSignificantDigitsAndNeverPrintsNotANumber) {
  EXPECT_EQ(NumberText(0.84712), "0.847");
  EXPECT_EQ(NumberText(12.0), "12.0");
  EXPECT_EQ(NumberText(1234.6), "1235");
  EXPECT_EQ(NumberText(9.999), "10.0");
  EXPECT_EQ(NumberText(-2.131e-6), "-2.13×10⁻⁶");
  EXPECT_EQ(NumberText(4.5e12), "4.50×10¹²");
  EXPECT_EQ(NumberText(0.0), "0");
  EXPECT_EQ(NumberText(NAN), "–");
  EXPECT_EQ(ShortNumber(12.0), "12");
  EXPECT_EQ(ShortNumber(0.25), "0.25");
  EXPECT_EQ(ShortNumber(1500.0), "1500");
}

TEST(RobustRange, FollowsTheBulkOfASeriesButNotFurtherThanItsReach) {
  const AxisRange core{-1.0, 1.0};
  std::vector<double> calm(1000, 1.5);
  calm[3] = 900.0;  // less than 1 % of the samples
  AxisRange range = RobustRange(core, {calm}, 10.0);
  EXPECT_NEAR(range.lo, -1.125, 1e-12);
  EXPECT_NEAR(range.hi, 1.625, 1e-12);
  range = RobustRange(core, {std::vector<double>(1000, -1e300), {NAN, INFINITY}}, 10.0);
  EXPECT_NEAR(range.lo, -11.6, 1e-12);
  EXPECT_NEAR(range.hi, 1.6, 1e-12);
}

TEST(ArmList, ReadsLikeASentence) {
  EXPECT_EQ(ArmList({"4"}), "arm 4");
  EXPECT_EQ(ArmList({"4", "5"}), "arms 4 and 5");
  EXPECT_EQ(ArmList({"1", "4", "5"}), "arms 1, 4 and 5");
}

}  // namespace
}  // namespace armada
