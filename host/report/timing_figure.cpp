#include <algorithm>
#include <cmath>
#include <iterator>

#include "host/report/figures.h"
#include "host/report/number_text.h"

namespace armada {
namespace {

constexpr double kBinsPerDecade = 10.0;
constexpr char kAllStyle[] = "linecolor rgb \"#A3A9B2\"";

struct Measure {
  const char* title;
  const char* column;
};
constexpr Measure kMeasures[] = {{"wake-up lateness", "wakeup_lateness_us"},
                                 {"compute time", "compute_us"},
                                 {"sample to torque", "sample_to_torque_us"}};

/// Tics at whole decades of an axis that carries log10 of microseconds.
std::string DecadeTics(const AxisRange& decades) {
  constexpr const char* kLabels[] = {"1 µs", "10 µs", "100 µs", "1 ms", "10 ms", "100 ms", "1 s", "10 s"};
  std::string tics;
  for (int decade = 0; decade <= static_cast<int>(decades.hi) && decade < std::ssize(kLabels); ++decade) {
    tics += (decade == 0 ? "" : ", ") + ('"' + std::string(kLabels[decade])) + "\" " + std::to_string(decade);
  }
  return "set xtics (" + tics + ")\n";
}

/// Bars for all arms, points for each. Both counts come from gnuplot's own binning of the recorded ticks.
Panel MeasurePanel(const RecordedRun& run, const Measure& measure, double largest_us) {
  // What took less than 1 us, or woke up early, counts as 1 us.
  const std::string value = "column(\"" + std::string(measure.column) + "\")";
  const std::string bin =
      "floor(log10(" + value + " > 1 ? " + value + " : 1) * per_decade) / per_decade + 0.5 / per_decade";
  Panel panel;
  panel.title = measure.title;
  panel.x = {"", {0.0, std::max(1.0, std::ceil(std::log10(std::max(largest_us, 1.0)) + 0.05))}};
  panel.y = {"ticks", {0.5, 2.0 * static_cast<double>(run.timing->rows())}};
  panel.setup = "per_decade = " + GnuplotNumber(kBinsPerDecade) + ".0\nset boxwidth 1 / per_decade\n" +
                "set logscale y\nset format y \"%g\"\nset style fill solid noborder\n" +
                DecadeTics(panel.x.range);
  panel.plot = "\"../timing.csv\" using (" + bin + "):(1) smooth frequency with boxes " + kAllStyle +
               ", \\\n     for [i=1:arms] "
               "\"../timing.csv\" using (column(\"arm\") == id(i) + 0 ? " +
               bin + " : NaN):(1) smooth frequency with points linetype i pointtype 7 pointsize 0.5";
  return panel;
}

}  // namespace

Figure TimingFigure(const RecordedRun& run) {
  Figure figure;
  figure.name = "timing";
  figure.title = "Times of the real-time loop";
  figure.panel_height_px = 220;
  figure.columns = 3;
  figure.legend = ArmLegend(run);
  figure.legend.push_back({"all arms", std::string(kAllStyle) + " linewidth 6"});
  std::string summary;
  for (const Measure& measure : kMeasures) {
    const std::vector<double>& values_us = run.timing->Column(measure.column);
    const double largest_us = FiniteRange(values_us).hi;
    figure.panels.push_back(MeasurePanel(run, measure, largest_us));
    summary += std::string(" ") + measure.title + " " + NumberText(Quantile(values_us, 0.5), 2) + " / " +
               NumberText(Quantile(values_us, 0.99), 2) + " / " + NumberText(largest_us, 2) + " µs;";
  }
  summary.back() = '.';
  figure.caption =
      "How many control ticks took how long, on logarithmic scales, of all arms together (grey) and of "
      "each arm (points). Median / 99th percentile / largest of all arms:" +
      summary + " The paper simulates and has no such figure.";
  return figure;
}

}  // namespace armada
