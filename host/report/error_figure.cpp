#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "host/report/figures.h"
#include "host/report/number_text.h"
#include "host/report/report_error.h"
#include "host/report/run_facts.h"

namespace armada {
namespace {

constexpr double kLargestShown_mm = 1e5;
constexpr double kSmallestShown_mm = 1e-3;
constexpr double kShortestBucket_s = 0.1;
constexpr double kMostBuckets = 400.0;

/// Largest error of each bucket of time. An arm's error oscillates faster than a page resolves; its peaks are
/// what the criterion judges, and this keeps every one of them. NaN where nothing was recorded, infinite
/// where it was not finite.
std::vector<double> BucketPeaks_mm(const CsvTable& trace, double start_s, double bucket_s, size_t buckets) {
  std::vector<double> peaks(buckets, std::numeric_limits<double>::quiet_NaN());
  const std::vector<double>& t_s = trace.Column("t_s");
  const std::vector<double>& error_m = trace.Column("error_m");
  for (size_t row = 0; row < t_s.size(); ++row) {
    const double position = std::floor((t_s[row] - start_s) / bucket_s + 1e-9);
    if (!(position >= 0.0 && position < static_cast<double>(buckets))) continue;
    double& peak = peaks[static_cast<size_t>(position)];
    const double error_mm =
        std::isfinite(error_m[row]) ? 1e3 * error_m[row] : std::numeric_limits<double>::infinity();
    if (!(peak >= error_mm)) peak = error_mm;
  }
  return peaks;
}

/// Whole decades around what is worth showing, the criterion included.
AxisRange DecadesAround(const std::vector<std::vector<double>>& series) {
  double lo = kCriterion_mm;
  double hi = kCriterion_mm;
  for (const std::vector<double>& values : series) {
    for (const double value : values) {
      if (!std::isfinite(value)) continue;
      lo = std::min(lo, std::max(value, kSmallestShown_mm));
      hi = std::max(hi, std::min(value, kLargestShown_mm));
    }
  }
  return {std::pow(10.0, std::floor(std::log10(lo))), std::pow(10.0, std::ceil(std::log10(hi)))};
}

void WriteTable(const std::filesystem::path& path, const RecordedRun& run, double bucket_s,
                const std::vector<std::vector<double>>& series) {
  std::ofstream file(path);
  file << "t_s";
  for (const ArmRecord& arm : run.arms) file << ",arm_" << arm.id << "_mm";
  file << "\n";
  for (size_t bucket = 0; bucket < series.front().size(); ++bucket) {
    file << GnuplotNumber(run.start_s + (static_cast<double>(bucket) + 0.5) * bucket_s);
    for (const std::vector<double>& values : series) {
      file << ',' << (std::isfinite(values[bucket]) ? GnuplotNumber(values[bucket]) : "nan");
    }
    file << "\n";
  }
  if (!file.flush()) throw ReportError("cannot write " + path.string() + ": " + std::strerror(errno));
}

std::string SettlingText(const RecordedRun& run) {
  double last_s = 0.0;
  std::vector<std::string> never;
  for (const ArmRecord& arm : run.arms) {
    if (arm.settled_s) last_s = std::max(last_s, *arm.settled_s);
    if (!arm.settled_s) never.push_back(std::to_string(arm.id));
  }
  if (never.empty()) return "Every arm stays below it from " + ShortNumber(last_s) + " s on.";
  return "Never below it for good: " + ArmList(never) + ".";
}

}  // namespace

Figure ErrorFigure(const RecordedRun& run, const std::filesystem::path& folder) {
  const AxisRange time{run.start_s, run.end_s};
  const double bucket_s = std::max(kShortestBucket_s, time.span() / kMostBuckets);
  const auto buckets = static_cast<size_t>(std::floor(time.span() / bucket_s + 1e-9)) + 1;
  std::vector<std::vector<double>> series;
  for (const ArmRecord& arm : run.arms) {
    series.push_back(BucketPeaks_mm(arm.trace, run.start_s, bucket_s, buckets));
  }
  WriteTable(folder / "error.csv", run, bucket_s, series);

  Figure figure;
  figure.name = "error";
  figure.title = "Distance from the leader";
  figure.panel_height_px = 320;
  figure.legend = ArmLegend(run);
  figure.legend.push_back({"criterion", kLeaderStyle});
  const AxisRange range = DecadesAround(series);
  const std::string criterion = GnuplotNumber(kCriterion_mm);
  Panel panel;
  panel.x = {"time [s]", time};
  panel.y = {"|x − x₀| [mm]", range};
  panel.setup = "set logscale y\nset format y \"%g\"\nset ytics add (\"" + criterion + "\" " + criterion +
                ")\nset object rectangle from " + GnuplotNumber(run.window_start_s) + ", graph 0 to " +
                GnuplotNumber(run.window_end_s) +
                ", graph 1 behind fillcolor rgb \"#808080\" fillstyle solid 0.10 noborder\n";
  panel.plot =
      "for [i=1:arms] \"error.csv\" using \"t_s\":\"arm_\".id(i).\"_mm\" with lines linetype i, \\\n     " +
      criterion + " with lines " + kLeaderStyle;
  figure.panels.push_back(panel);
  figure.caption =
      "Distance of each end-effector from the leader on a logarithmic scale: the largest of every " +
      ShortNumber(bucket_s) + " s. Dashed: the criterion, 20 mm. " + SettlingText(run) +
      " Shaded: the window of the metrics. " +
      OutOfPictureText(run, {{"error_m", {0.0, range.hi * 1e-3}}}, time) +
      " The paper has no figure of this; it shows what Fig. 4 cannot resolve.";
  return figure;
}

}  // namespace armada
