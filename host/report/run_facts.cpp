#include "host/report/run_facts.h"

#include <algorithm>
#include <cmath>

#include "host/report/number_text.h"

namespace armada {
namespace {

/// Fraction of the arm's rows within `time` in which some drawn column lies outside its axis or is not
/// finite.
double FractionOutside(const ArmRecord& arm, const std::vector<DrawnColumn>& drawn, const AxisRange& time) {
  const std::vector<double>& t_s = arm.trace.Column("t_s");
  size_t rows = 0;
  size_t outside = 0;
  for (size_t row = 0; row < t_s.size(); ++row) {
    if (!time.Contains(t_s[row])) continue;
    ++rows;
    const bool seen = std::all_of(drawn.begin(), drawn.end(), [&](const DrawnColumn& drawn_column) {
      return drawn_column.range.Contains(arm.trace.Column(drawn_column.column)[row]);
    });
    if (!seen) ++outside;
  }
  return rows == 0 ? 0.0 : static_cast<double>(outside) / static_cast<double>(rows);
}

std::string Percent(double fraction) {
  return NumberText(std::max(0.1, 100.0 * fraction), 2) + " %";
}

}  // namespace

std::string ArmList(const std::vector<std::string>& names) {
  std::string text = names.size() == 1 ? "arm " : "arms ";
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

AxisRange TransientSpan(const RecordedRun& run) {
  constexpr double kShortest_s = 6.0;
  constexpr double kAfterSettling = 1.25;
  double until_s = run.start_s + kShortest_s;
  for (const ArmRecord& arm : run.arms) {
    if (!arm.settled_s) return {run.start_s, run.end_s};
    until_s = std::max(until_s, run.start_s + std::ceil(kAfterSettling * *arm.settled_s));
  }
  return {run.start_s, std::min(until_s, run.end_s)};
}

int PanelColumns(const AxisRange& time) {
  constexpr double kLongest_s = 12.0;
  return time.span() > kLongest_s ? 1 : 2;
}

std::string TimeSpanText(const RecordedRun& run, const AxisRange& time) {
  if (time.hi >= run.end_s) return "Shown: the whole run.";
  return "Shown: the first " + ShortNumber(time.span()) + " s of " + ShortNumber(run.end_s - run.start_s) +
         " s; every arm settles within them and stays so.";
}

std::string SyncText(const RecordedRun& run) {
  double last_s = run.start_s;
  std::vector<std::string> never;
  for (const ArmRecord& arm : run.arms) {
    const std::vector<double>& t_s = arm.trace.Column("t_s");
    const std::vector<double>& synced = arm.trace.Column("synced");
    const auto last_out = std::find(synced.rbegin(), synced.rend(), 0.0);
    if (last_out == synced.rbegin()) {
      never.push_back(std::to_string(arm.id));
    } else if (last_out != synced.rend()) {
      last_s = std::max(last_s, t_s[static_cast<size_t>(synced.rend() - last_out)]);
    }
  }
  if (!never.empty()) return "Out of its band at the end: the estimator of " + ArmList(never) + ".";
  if (last_s <= run.start_s) return "All estimators are in their band throughout.";
  return "All estimators are in their band from " + ShortNumber(last_s) + " s on.";
}

std::string OutOfPictureText(const RecordedRun& run, const std::vector<DrawnColumn>& drawn,
                             const AxisRange& time) {
  std::vector<std::string> leaving;
  std::vector<std::string> diverged;
  for (const ArmRecord& arm : run.arms) {
    const double fraction = FractionOutside(arm, drawn, time);
    if (fraction > 0.0) leaving.push_back(std::to_string(arm.id) + " (" + Percent(fraction) + ")");
    if (arm.diverged) {
      diverged.push_back(std::to_string(arm.id) + " (recorded until " +
                         ShortNumber(arm.trace.Column("t_s").back()) + " s)");
    }
  }
  std::string text = leaving.empty()
                         ? "No arm leaves the picture."
                         : "Out of the picture for a part of their samples: " + ArmList(leaving) + ".";
  if (!diverged.empty()) text += " DIVERGED: " + ArmList(diverged) + ".";
  return text;
}

}  // namespace armada
