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

std::string NoTwinText() {
  return " There is no twin run without subtasks (folder without_subtask) to compare with.";
}

Figure PostureFigure(const RecordedRun& run, const ArmRecord& arm) {
  // Two turns to either side show any winding worth seeing; an arm that runs away leaves the picture.
  constexpr AxisRange kOneTurn{-std::numbers::pi, std::numbers::pi};
  std::vector<std::vector<double>> angles;
  std::string means;
  for (int joint = 1; joint <= arm.joints; ++joint) {
    const std::string column = "q" + std::to_string(joint) + "_rad";
    angles.push_back(Slice(arm.trace, column, WholeRun(run)));
    means += (means.empty() ? "" : ", ") + ("q" + std::to_string(joint)) + " " +
             ShortNumber(MeanInWindow(run, arm.trace, column));
    if (!arm.without_subtask) continue;
    angles.push_back(Slice(*arm.without_subtask, column, WholeRun(run)));
    means += " (" + ShortNumber(MeanInWindow(run, *arm.without_subtask, column)) + ")";
  }
  const AxisRange range = RobustRange(kOneTurn, angles, 3.0 * std::numbers::pi);
  const std::string number = std::to_string(arm.id);
  Figure figure;
  figure.name = "posture_arm_" + number;
  figure.title = "Joints of arm " + number + " with and without its posture subtask";
  figure.panel_height_px = 240;
  figure.columns = arm.without_subtask ? 2 : 1;
  figure.legend = JointLegend(arm.joints);
  const auto panel = [&](const std::string& title, bool with_subtask) {
    return Panel{.title = title,
                 .x = {"time [s]", WholeRun(run)},
                 .y = {"joint angle [rad]", range},
                 .plot = JointCurves(TracePath(arm, with_subtask), arm.joints, "q", "_rad", 1.5)};
  };
  figure.panels.push_back(panel("with subtask", true));
  if (arm.without_subtask) figure.panels.push_back(panel("without subtask", false));
  figure.caption = "Joint angles over the whole run. Means over the window [rad], with the subtask" +
                   std::string(arm.without_subtask ? " (and without it): " : ": ") + means + "." +
                   (arm.without_subtask ? "" : NoTwinText()) + (arm.diverged ? " This arm DIVERGED." : "") +
                   " Fig. 6 of the paper, where the second joint is drawn to 1 rad.";
  return figure;
}

Figure ManipulabilityFigure(const RecordedRun& run, size_t index) {
  const ArmRecord& arm = run.arms[index];
  const std::string number = std::to_string(arm.id);
  std::vector<double> values = arm.trace.Column("manipulability");
  const std::string with_style = "linecolor rgb \"" + ArmColour(index) + "\" linewidth 1.6";
  const std::string without_style = "linecolor rgb \"#808080\" linewidth 1.4 dashtype (5,3)";
  std::vector<std::string> curves = {Curve(TracePath(arm, true), "manipulability", with_style)};
  std::string means = ShortNumber(MeanInWindow(run, arm.trace, "manipulability")) + " with the subtask";
  Figure figure;
  figure.name = "manipulability_arm_" + number;
  figure.title = "Manipulability of arm " + number + " with and without its subtask";
  figure.panel_height_px = 230;
  figure.legend.push_back({"with subtask", with_style});
  if (arm.without_subtask) {
    const std::vector<double>& without = arm.without_subtask->Column("manipulability");
    values.insert(values.end(), without.begin(), without.end());
    means += " and " + ShortNumber(MeanInWindow(run, *arm.without_subtask, "manipulability")) + " without it";
    curves.insert(curves.begin(), Curve(TracePath(arm, false), "manipulability", without_style));
    figure.legend.push_back({"without subtask", without_style});
  }
  figure.panels.push_back({.title = "",
                           .x = {"time [s]", WholeRun(run)},
                           .y = {"det(J Jᵀ) [m⁴]", {0.0, 1.05 * FiniteRange(values).hi}},
                           .plot = Joined(curves)});
  figure.caption = "Manipulability det(J Jᵀ) over the whole run. Mean over the window: " + means + "." +
                   (arm.without_subtask ? "" : NoTwinText()) + (arm.diverged ? " This arm DIVERGED." : "") +
                   " Fig. 7 of the paper.";
  return figure;
}

}  // namespace

std::vector<Figure> SubtaskFigures(const RecordedRun& run) {
  std::vector<Figure> figures;
  for (const ArmRecord& arm : run.arms) {
    if (arm.subtask == "posture") figures.push_back(PostureFigure(run, arm));
  }
  for (size_t index = 0; index < run.arms.size(); ++index) {
    if (run.arms[index].subtask == "manipulability") figures.push_back(ManipulabilityFigure(run, index));
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
