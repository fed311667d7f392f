#pragma once

#include <string>
#include <vector>

#include "host/report/axis_range.h"
#include "host/report/recorded_run.h"

namespace armada {

struct Axis {
  std::string label;  ///< with its unit
  AxisRange range;
};

/// One pair of axes with what is drawn in it.
struct Panel {
  std::string title;
  Axis x;
  Axis y;
  std::string plot;        ///< what follows gnuplot's `plot`; may use the names of ScriptText
  std::string setup = {};  ///< further gnuplot settings of this panel alone
};

/// One entry of a figure's legend: `style` is what gnuplot calls a line's properties.
struct LegendEntry {
  std::string text;
  std::string style;
};

/// One figure: what to draw, and what to tell its reader.
struct Figure {
  std::string name;  ///< file name without extension
  std::string title;
  std::string caption;
  int width_px = 760;
  int panel_height_px = 0;
  int columns = 1;  ///< panels side by side; rows follow from the number of panels
  std::vector<LegendEntry> legend;
  std::vector<Panel> panels;
};

/// The gnuplot script that draws `figure` as <name>.svg and <name>.png in the folder it stands in. It reads
/// the recorded CSV files beside that folder, so it can be changed and run again by hand. Panels may use
/// `arms` (how many), `trace(i)`, `id(i)`, line type i of the i-th arm, `leader`, and `step` (draw every
/// step-th row).
std::string ScriptText(const Figure& figure, const RecordedRun& run);

/// The same of any data: `data` are the gnuplot lines that name it. Line type i is of the i-th arm.
std::string ScriptText(const Figure& figure, const std::vector<int>& arm_ids, const std::string& data);

/// Legend entries of all arms.
std::vector<LegendEntry> ArmLegend(const RecordedRun& run);

/// The commonest panel content: `y` over `x` of every arm's trace, and the leader's in dashed black above
/// them. Columns by name.
struct Columns {
  std::string x;
  std::string y;
};
std::string ArmsAndLeader(const Columns& arms, const Columns& leader);

/// Line properties of the leader, in every figure.
inline constexpr char kLeaderStyle[] = "linecolor rgb \"black\" linewidth 1.2 dashtype (6,4)";

}  // namespace armada
