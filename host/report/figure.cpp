#include "host/report/figure.h"

#include <algorithm>
#include <sstream>

#include "host/report/number_text.h"
#include "host/report/palette.h"

namespace armada {
namespace {

// Layout in pixels of the SVG; the PNG is the same picture at kPngScale.
constexpr int kLeftMargin_px = 66;
constexpr int kRightMargin_px = 18;
constexpr int kBottomMargin_px = 46;
constexpr int kTopMargin_px = 10;
constexpr int kPanelTitle_px = 22;
constexpr int kLegendLine_px = 20;
constexpr int kColumnGap_px = 74;
constexpr int kRowGap_px = 38;
constexpr int kSwatch_px = 22;
constexpr int kCharacter_px = 8;
constexpr int kPngScale = 2;
// More points than this on one curve are invisible and make the page slow.
constexpr size_t kPointsPerCurve = 4000;

std::string Quoted(const std::string& text) {
  return '"' + text + '"';
}

std::string RangeText(const AxisRange& range) {
  return '[' + GnuplotNumber(range.lo) + ':' + GnuplotNumber(range.hi) + ']';
}

int EntryWidth_px(const LegendEntry& entry) {
  return kSwatch_px + kCharacter_px * (static_cast<int>(entry.text.size()) + 2);
}

/// The legend broken into lines that fit the figure's width.
std::vector<std::vector<LegendEntry>> LegendLines(const Figure& figure) {
  std::vector<std::vector<LegendEntry>> lines;
  int used_px = figure.width_px;
  for (const LegendEntry& entry : figure.legend) {
    if (used_px + EntryWidth_px(entry) > figure.width_px) {
      lines.emplace_back();
      used_px = 0;
    }
    lines.back().push_back(entry);
    used_px += EntryWidth_px(entry);
  }
  return lines;
}

int TitleHeight_px(const Figure& figure) {
  const bool titled = std::any_of(figure.panels.begin(), figure.panels.end(),
                                  [](const Panel& panel) { return !panel.title.empty(); });
  return titled ? kPanelTitle_px : 0;
}

int TopMargin_px(const Figure& figure) {
  return kTopMargin_px + kLegendLine_px * static_cast<int>(LegendLines(figure).size()) +
         TitleHeight_px(figure);
}

int RowGap_px(const Figure& figure) {
  return kRowGap_px + TitleHeight_px(figure);
}

int Rows(const Figure& figure) {
  return (static_cast<int>(figure.panels.size()) + figure.columns - 1) / figure.columns;
}

int Height_px(const Figure& figure) {
  const int rows = Rows(figure);
  return TopMargin_px(figure) + rows * figure.panel_height_px + (rows - 1) * RowGap_px(figure) +
         kBottomMargin_px;
}

/// gnuplot's own key fits one panel; this one stands above all of them, made of arrows and labels.
void WriteLegend(std::ostream& script, const Figure& figure) {
  const auto x = [&](int px) { return "screen " + GnuplotNumber(px / static_cast<double>(figure.width_px)); };
  const auto y = [&](int px) {
    return "screen " + GnuplotNumber(1.0 - px / static_cast<double>(Height_px(figure)));
  };
  int y_px = kLegendLine_px / 2;
  for (const std::vector<LegendEntry>& line : LegendLines(figure)) {
    int width_px = 0;
    for (const LegendEntry& entry : line) width_px += EntryWidth_px(entry);
    int x_px = (figure.width_px - width_px) / 2;
    for (const LegendEntry& entry : line) {
      script << "set arrow from " << x(x_px) << ", " << y(y_px) << " to " << x(x_px + kSwatch_px) << ", "
             << y(y_px) << " nohead " << entry.style << "\n"
             << "set label " << Quoted(entry.text) << " at " << x(x_px + kSwatch_px + kCharacter_px / 2)
             << ", " << y(y_px) << "\n";
      x_px += EntryWidth_px(entry);
    }
    y_px += kLegendLine_px;
  }
}

std::string DataText(const RecordedRun& run) {
  std::ostringstream script;
  size_t rows = 0;
  std::string ids;
  for (const ArmRecord& arm : run.arms) {
    rows = std::max(rows, arm.trace.rows());
    ids += (ids.empty() ? "" : " ") + std::to_string(arm.id);
  }
  script << "set datafile separator comma\n"
         << "arms = " << run.arms.size() << "\n"
         << "id(i) = word(" << Quoted(ids) << ", i)\n"
         << "trace(i) = \"../arm_\".id(i).\".csv\"\n"
         << "leader = \"../leader.csv\"\n"
         << "step = " << 1 + rows / kPointsPerCurve << "  # draw every step-th row\n";
  return script.str();
}

void WriteStyle(std::ostream& script, const std::vector<int>& arm_ids) {
  script << "set encoding utf8\n"
            "unset key\n"
            "set border 3 linecolor rgb \"black\" linewidth 0.8\n"
            "set tics nomirror scale 0.6\n"
            "set grid linecolor rgb \"#808080\" linewidth 0.4 dashtype 1\n";
  for (size_t i = 0; i < arm_ids.size(); ++i) {
    script << "set linetype " << i + 1 << " linecolor rgb " << Quoted(ArmColour(i))
           << " linewidth 1.5 dashtype " << ArmDash(i) << "  # arm " << arm_ids[i] << "\n";
  }
}

void WriteTerminals(std::ostream& script, const Figure& figure) {
  script << "do for [format in \"svg png\"] {\n"
         << "if (format eq \"svg\") {\n"
         << "  set terminal svg size " << figure.width_px << ',' << Height_px(figure)
         << " font \"DejaVu Sans,12\" noenhanced background \"white\" name " << Quoted(figure.name) << "\n"
         << "} else {\n"
         << "  set terminal pngcairo size " << figure.width_px * kPngScale << ','
         << Height_px(figure) * kPngScale << " font \"DejaVu Sans,9\" noenhanced fontscale " << kPngScale
         << " linewidth " << kPngScale << "\n"
         << "}\n"
         << "set output " << Quoted(figure.name + ".") << ".format\n";
}

void WriteLayout(std::ostream& script, const Figure& figure) {
  const auto width = static_cast<double>(figure.width_px);
  const auto height = static_cast<double>(Height_px(figure));
  script << "set multiplot layout " << Rows(figure) << ',' << figure.columns << " margins "
         << GnuplotNumber(kLeftMargin_px / width) << ',' << GnuplotNumber(1.0 - kRightMargin_px / width)
         << ',' << GnuplotNumber(kBottomMargin_px / height) << ','
         << GnuplotNumber(1.0 - TopMargin_px(figure) / height) << " spacing "
         << GnuplotNumber(kColumnGap_px / width) << ',' << GnuplotNumber(RowGap_px(figure) / height) << "\n";
}

/// The bottom panel of each column carries the column's horizontal label.
void WritePanel(std::ostream& script, const Figure& figure, size_t index) {
  const Panel& panel = figure.panels[index];
  const bool bottom = index + static_cast<size_t>(figure.columns) >= figure.panels.size();
  script << "set title " << Quoted(panel.title) << " offset 0,-0.6\n"
         << "set xlabel " << Quoted(bottom ? panel.x.label : "") << " offset 0,0.5\n"
         << "set ylabel " << Quoted(panel.y.label) << " offset 0.8,0\n"
         << "set xrange " << RangeText(panel.x.range) << "\n"
         << "set yrange " << RangeText(panel.y.range) << "\n"
         << panel.setup << "plot " << panel.plot << "\n"
         << "unset arrow\nunset label\n";
}

}  // namespace

std::string ScriptText(const Figure& figure, const RecordedRun& run) {
  std::vector<int> arm_ids;
  for (const ArmRecord& arm : run.arms) arm_ids.push_back(arm.id);
  return ScriptText(figure, arm_ids, DataText(run));
}

std::string ScriptText(const Figure& figure, const std::vector<int>& arm_ids, const std::string& data) {
  std::ostringstream script;
  script << "# " << figure.title
         << ". Written by `armada report`, which overwrites it: keep a changed copy under\n"
         << "# another name. To draw it again, in this folder: gnuplot " << figure.name << ".gp\n"
         << data;
  WriteStyle(script, arm_ids);
  WriteTerminals(script, figure);
  WriteLayout(script, figure);
  WriteLegend(script, figure);
  for (size_t i = 0; i < figure.panels.size(); ++i) WritePanel(script, figure, i);
  script << "unset multiplot\nset output\n}\n";
  return script.str();
}

std::vector<LegendEntry> ArmLegend(const RecordedRun& run) {
  std::vector<LegendEntry> legend;
  for (size_t i = 0; i < run.arms.size(); ++i) {
    const ArmRecord& arm = run.arms[i];
    legend.push_back({"arm " + std::to_string(arm.id) + (arm.diverged ? " DIVERGED" : ""),
                      "linetype " + std::to_string(i + 1) + " linewidth 2.5"});
  }
  return legend;
}

std::string ArmsAndLeader(const Columns& arms, const Columns& leader) {
  return "for [i=1:arms] trace(i) every step using \"" + arms.x + "\":\"" + arms.y +
         "\" with lines linetype i, \\\n     leader every step using \"" + leader.x + "\":\"" + leader.y +
         "\" with lines " + kLeaderStyle;
}

}  // namespace armada
