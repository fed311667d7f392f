#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/report/figures.h"
#include "host/report/number_text.h"
#include "host/report/palette.h"
#include "host/report/run_facts.h"

namespace armada {
namespace {

AxisRange WholeRun(const RecordedRun& run) {
  return {run.start_s, run.end_s};
}
AxisRange Window(const RecordedRun& run) {
  return {run.window_start_s, run.window_end_s};
}

std::string TracePath(const ArmRecord& arm, bool with_subtask) {
  return (with_subtask ? "../arm_" : "../without_subtask/arm_") + std::to_string(arm.id) + ".csv";
}

/// One curve of a trace over time, in gnuplot's words.
std::string Curve(const std::string& path, const std::string& column, const std::string& style) {
  return "\"" + path + "\" every step using \"t_s\":\"" + column + "\" with lines " + style;
}

std::string Joined(const std::vector<std::string>& curves) {
  std::string text;
  for (const std::string& curve : curves) text += (text.empty() ? "" : ", \\\n     ") + curve;
  return text;
}

std::string JointStyle(int joint) {
  return "linecolor rgb \"" + JointColour(joint) + "\"";
}

/// All joints' `<prefix><joint><suffix>` of one recorded trace, in the joints' colours.
std::string JointCurves(const std::string& path, int joints, const std::string& prefix,
                        const std::string& suffix, double linewidth) {
  const std::string width = " linewidth " + GnuplotNumber(linewidth);
  std::vector<std::string> curves;
  for (int joint = 1; joint <= joints; ++joint) {
    std::string column = prefix;
    column += std::to_string(joint);
    curves.push_back(Curve(path, column + suffix, JointStyle(joint) + width));
  }
  return Joined(curves);
}

std::vector<LegendEntry> JointLegend(int joints) {
  std::vector<LegendEntry> legend;
  for (int joint = 1; joint <= joints; ++joint) {
    legend.push_back({"joint " + std::to_string(joint), JointStyle(joint) + " linewidth 2.5"});
  }
  return legend;
}

double MeanInWindow(const RecordedRun& run, const CsvTable& trace, const std::string& column) {
  double sum = 0.0;
  const std::vector<double> values = Slice(trace, column, Window(run));
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double LeastInWindow(const RecordedRun& run, const CsvTable& trace, const std::string& column) {
  return FiniteRange(Slice(trace, column, Window(run))).lo;
}

std::string NoTwinText() {
  return " There is no twin run without subtasks (folder without_subtask) to compare with.";
}

std::string TwinAndDivergence(const ArmRecord& arm) {
  return (arm.without_subtask ? std::string() : NoTwinText()) + (arm.diverged ? " This arm DIVERGED." : "");
}

/// A level line across a panel.
std::string Level(double value, const std::string& style) {
  return GnuplotNumber(value) + " with lines " + style;
}

/// A number or a list of metrics.json that older runs, and arms that need none, do not have.
const Json* Find(const ArmRecord& arm, const std::string& key) {
  const auto found = arm.metrics.find(key);
  return found == arm.metrics.end() || found->is_null() ? nullptr : &*found;
}

std::string JointColumn(int joint) {
  return "q" + std::to_string(joint) + "_rad";
}

/// What the joints are held to: a posture's goal, limits. Level lines and what the legend says of them.
struct JointMarks {
  std::vector<std::string> levels;
  std::vector<LegendEntry> legend;
};
JointMarks MarksOf(const RecordedRun& run, const ArmRecord& arm) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  JointMarks marks;
  if (const Json* goal = Find(arm, "posture_goal_rad")) {
    const int joint = RequireKey(arm.metrics, "posture_joint", "an arm with a posture").get<int>();
    const double mean = MeanInWindow(run, arm.trace, JointColumn(joint));
    // Whole turns make no difference: the goal that the joint went to.
    const double turns = std::isfinite(mean) ? std::round((mean - goal->get<double>()) / kTurn) : 0.0;
    const std::string style = JointStyle(joint) + " linewidth 1.2 dashtype (8,4)";
    marks.levels.push_back(Level(goal->get<double>() + kTurn * turns, style));
    marks.legend.push_back({"goal of joint " + std::to_string(joint), style});
  }
  for (const char* key : {"q_min_rad", "q_max_rad"}) {
    const Json* limits = Find(arm, key);
    if (limits == nullptr) continue;
    for (int joint = 1; joint <= arm.joints; ++joint) {
      const double limit = limits->at(static_cast<size_t>(joint - 1)).get<double>();
      marks.levels.push_back(Level(limit, JointStyle(joint) + " linewidth 1.2 dashtype (2,3)"));
    }
    if (marks.legend.empty() || marks.legend.back().text != "limits")
      marks.legend.push_back({"limits", "linecolor rgb \"#404040\" linewidth 1.2 dashtype (2,3)"});
  }
  return marks;
}

/// All joints of an arm that has a posture or limits, and of its twin.
Figure JointsFigure(const RecordedRun& run, const ArmRecord& arm) {
  // Two turns to either side show any winding worth seeing; an arm that runs away leaves the picture.
  constexpr AxisRange kOneTurn{-std::numbers::pi, std::numbers::pi};
  std::vector<std::vector<double>> angles;
  std::string means;
  for (int joint = 1; joint <= arm.joints; ++joint) {
    const std::string column = JointColumn(joint);
    angles.push_back(Slice(arm.trace, column, WholeRun(run)));
    means += (means.empty() ? "" : ", ") + ("q" + std::to_string(joint)) + " " +
             ShortNumber(MeanInWindow(run, arm.trace, column));
    if (!arm.without_subtask) continue;
    angles.push_back(Slice(*arm.without_subtask, column, WholeRun(run)));
    means += " (" + ShortNumber(MeanInWindow(run, *arm.without_subtask, column)) + ")";
  }
  const AxisRange range = RobustRange(kOneTurn, angles, 3.0 * std::numbers::pi);
  const bool posture = arm.subtask == "posture";
  const std::string number = std::to_string(arm.id);
  const JointMarks marks = MarksOf(run, arm);
  Figure figure;
  figure.name = (posture ? "posture_arm_" : "limits_arm_") + number;
  figure.title = "Joints of arm " + number +
                 (posture ? " with and without its posture subtask" : " with and without keeping its limits");
  figure.panel_height_px = 240;
  figure.columns = arm.without_subtask ? 2 : 1;
  figure.legend = JointLegend(arm.joints);
  figure.legend.insert(figure.legend.end(), marks.legend.begin(), marks.legend.end());
  const auto panel = [&](const std::string& title, bool with_subtask) {
    std::vector<std::string> curves = marks.levels;
    curves.push_back(JointCurves(TracePath(arm, with_subtask), arm.joints, "q", "_rad", 1.5));
    return Panel{.title = title,
                 .x = {"time [s]", WholeRun(run)},
                 .y = {"joint angle [rad]", range},
                 .plot = Joined(curves)};
  };
  figure.panels.push_back(panel("with subtask", true));
  if (arm.without_subtask) figure.panels.push_back(panel("without subtask", false));
  figure.caption = "Joint angles over the whole run. Means over the window [rad], with the subtask" +
                   std::string(arm.without_subtask ? " (and without it): " : ": ") + means + ".";
  if (const Json* largest = Find(arm, "posture_max_rad")) {
    figure.caption +=
        " Largest distance from the goal in the window: " + ShortNumber(largest->get<double>()) + " rad.";
  }
  if (const Json* margin = Find(arm, "limit_margin_min_rad")) {
    figure.caption += " Least distance from a limit in the window: " + ShortNumber(margin->get<double>()) +
                      " rad (below 0: beyond it).";
  }
  figure.caption += TwinAndDivergence(arm);
  if (posture) figure.caption += " Fig. 6 of the paper, where the second joint is drawn to 1 rad.";
  return figure;
}

/// One column of an arm's trace, and of its twin's behind it.
Figure ComparisonFigure(const RecordedRun& run, size_t index, const std::string& column,
                        const std::string& label) {
  const ArmRecord& arm = run.arms[index];
  const std::string with_style = "linecolor rgb \"" + ArmColour(index) + "\" linewidth 1.6";
  const std::string without_style = "linecolor rgb \"#808080\" linewidth 1.4 dashtype (5,3)";
  std::vector<double> values = arm.trace.Column(column);
  std::vector<std::string> curves = {Curve(TracePath(arm, true), column, with_style)};
  Figure figure;
  figure.panel_height_px = 230;
  figure.legend.push_back({"with subtask", with_style});
  if (arm.without_subtask) {
    const std::vector<double>& without = arm.without_subtask->Column(column);
    values.insert(values.end(), without.begin(), without.end());
    curves.insert(curves.begin(), Curve(TracePath(arm, false), column, without_style));
    figure.legend.push_back({"without subtask", without_style});
  }
  const AxisRange range = FiniteRange(values);
  figure.panels.push_back({.title = "",
                           .x = {"time [s]", WholeRun(run)},
                           .y = {label, {std::min(0.0, 1.05 * range.lo), 1.05 * range.hi}},
                           .plot = Joined(curves)});
  return figure;
}

Figure ManipulabilityFigure(const RecordedRun& run, size_t index) {
  const ArmRecord& arm = run.arms[index];
  Figure figure = ComparisonFigure(run, index, "manipulability", "det(J Jᵀ) [m⁴]");
  figure.name = "manipulability_arm_" + std::to_string(arm.id);
  figure.title = "Manipulability of arm " + std::to_string(arm.id) + " with and without its subtask";
  std::string means = ShortNumber(MeanInWindow(run, arm.trace, "manipulability")) + " with the subtask";
  if (arm.without_subtask)
    means += " and " + ShortNumber(MeanInWindow(run, *arm.without_subtask, "manipulability")) + " without it";
  figure.caption = "Manipulability det(J Jᵀ) over the whole run. Mean over the window: " + means + "." +
                   TwinAndDivergence(arm) + " Fig. 7 of the paper.";
  return figure;
}

Figure ClearanceFigure(const RecordedRun& run, size_t index) {
  const ArmRecord& arm = run.arms[index];
  const double wanted_m =
      RequireKey(arm.metrics, "clearance_wanted_m", "an arm with obstacles").get<double>();
  Figure figure = ComparisonFigure(run, index, "clearance_m", "clearance [m]");
  figure.name = "clearance_arm_" + std::to_string(arm.id);
  figure.title = "Clearance of arm " + std::to_string(arm.id) + " with and without avoidance";
  const std::string wanted_style = "linecolor rgb \"#404040\" linewidth 1.2 dashtype (8,4)";
  const std::string touching_style = "linecolor rgb \"#404040\" linewidth 1";
  figure.legend.push_back({"wanted", wanted_style});
  figure.legend.push_back({"touching", touching_style});
  Panel& panel = figure.panels.front();
  panel.plot = Joined({Level(wanted_m, wanted_style), Level(0.0, touching_style), panel.plot});
  std::string least = ShortNumber(LeastInWindow(run, arm.trace, "clearance_m")) + " m with avoidance";
  if (arm.without_subtask)
    least += " and " + ShortNumber(LeastInWindow(run, *arm.without_subtask, "clearance_m")) + " m without it";
  figure.caption =
      "Least distance of the arm's links from its obstacles over the whole run; below 0 a link is in one. "
      "Least in "
      "the window: " +
      least + "; wanted are " + ShortNumber(wanted_m) + " m." + TwinAndDivergence(arm);
  return figure;
}

}  // namespace

std::vector<Figure> SubtaskFigures(const RecordedRun& run) {
  std::vector<Figure> figures;
  for (const ArmRecord& arm : run.arms) {
    if (arm.subtask == "posture" || Find(arm, "limit_margin_min_rad"))
      figures.push_back(JointsFigure(run, arm));
  }
  for (size_t index = 0; index < run.arms.size(); ++index) {
    if (run.arms[index].subtask == "manipulability") figures.push_back(ManipulabilityFigure(run, index));
  }
  for (size_t index = 0; index < run.arms.size(); ++index) {
    if (Find(run.arms[index], "clearance_min_m")) figures.push_back(ClearanceFigure(run, index));
  }
  return figures;
}

Figure TorqueFigure(const RecordedRun& run) {
  const AxisRange time = TransientSpan(run);
  Figure figure;
  figure.name = "torques";
  figure.title = "Joint torques";
  figure.columns = PanelColumns(time);
  figure.panel_height_px = 126;
  int joints = 0;
  for (const ArmRecord& arm : run.arms) {
    std::vector<double> torques;
    for (int joint = 1; joint <= arm.joints; ++joint) {
      const std::vector<double> slice = Slice(arm.trace, "tau" + std::to_string(joint) + "_Nm", time);
      torques.insert(torques.end(), slice.begin(), slice.end());
    }
    const AxisRange range = FiniteRange(torques);
    const double largest = 1.05 * std::max({std::abs(range.lo), std::abs(range.hi), 1.0});
    joints = std::max(joints, arm.joints);
    figure.panels.push_back({.title = "arm " + std::to_string(arm.id) + (arm.diverged ? " (DIVERGED)" : ""),
                             .x = {"time [s]", time},
                             .y = {"torque [N m]", {-largest, largest}},
                             .plot = JointCurves(TracePath(arm, true), arm.joints, "tau", "_Nm", 0.8)});
  }
  figure.legend = JointLegend(joints);
  figure.caption = "Commanded torque of every joint, one panel an arm, each on its own scale. " +
                   TimeSpanText(run, time) + " The paper shows no torques.";
  return figure;
}

}  // namespace armada
