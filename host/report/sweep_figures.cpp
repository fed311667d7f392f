#include "host/report/sweep_figures.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "host/report/number_text.h"
#include "host/report/report_error.h"

namespace armada {
namespace {

constexpr char kFleetStyle[] = "linecolor rgb \"black\" linewidth 1.6 dashtype (6,3)";
constexpr double kLinearUpTo = 30.0;  // ratio of an axis' ends; beyond, it is logarithmic

struct Subject {
  const char* name;
  const char* title;
  const char* axis;
  const char* meaning;
  std::vector<SweepFigure> RecordedSweep::*figures;
};
const Subject kSubjects[] = {
    {"settling", "Settling time over the seeds", "settling time [s]",
     "Time after which an arm's error stays below the criterion; the fleet's is that of its last arm. Where "
     "there are seeds in which it never does, the curves end before 1 and 0.",
     &RecordedSweep::settled_s},
    {"rms", "RMS error over the seeds", "RMS error [mm]",
     "RMS distance from the leader within the window; an arm's without the seeds in which it diverged.",
     &RecordedSweep::rms_mm},
    {"max", "Largest error over the seeds", "largest error [mm]",
     "Largest distance from the leader within the window, without the seeds in which the arm, or for the "
     "fleet any arm, diverged.",
     &RecordedSweep::max_mm},
};

/// Bins that hold anything in any of the figures: from the first up to, not including, the end; drawn
/// `merged` at a time, a divisor of their number.
struct Bins {
  int first = std::numeric_limits<int>::max();
  int end = std::numeric_limits<int>::min();
  int merged = 1;
};

Bins BinsOf(const std::vector<SweepFigure>& figures) {
  constexpr int kMostDrawn = 40;
  Bins bins;
  for (const SweepFigure& figure : figures) {
    if (figure.counts.empty()) continue;
    bins.first = std::min(bins.first, figure.first_bin);
    bins.end = std::max(bins.end, figure.end_bin());
  }
  const int count = bins.end - bins.first;
  bins.merged = (count + kMostDrawn - 1) / kMostDrawn;
  bins.end += (bins.merged - count % bins.merged) % bins.merged;
  return bins;
}

double EdgeOf(int bin, const RecordedSweep& sweep) {
  return std::pow(10.0, bin / sweep.bins_per_decade);
}

// Share of the seeds in the merged bins from `bin` on.
double ShareIn(const SweepFigure& figure, int bin, const Bins& bins, const RecordedSweep& sweep) {
  double seeds = 0.0;
  for (int i = bin; i < bin + bins.merged; ++i) seeds += figure.CountIn(i);
  return seeds / sweep.count;
}

// A row an edge: share of the seeds in the merged bins that start there, below it, and not below it, of each
// arm and the fleet.
void WriteTable(const std::filesystem::path& path, const RecordedSweep& sweep,
                const std::vector<SweepFigure>& figures, const Bins& bins) {
  std::ofstream file(path);
  file << "edge";
  for (const char* share : {"in", "below", "above"}) {
    for (const int id : sweep.arm_ids) file << ',' << share << "_arm_" << id;
    file << ',' << share << "_fleet";
  }
  file << '\n';
  std::vector<double> below(figures.size(), 0.0);
  for (int bin = bins.first; bin <= bins.end; ++bin) {
    file << GnuplotNumber(EdgeOf(bin, sweep));
    for (const SweepFigure& figure : figures) file << ',' << GnuplotNumber(ShareIn(figure, bin, bins, sweep));
    for (const double seeds : below) file << ',' << GnuplotNumber(seeds / sweep.count);
    for (const double seeds : below) file << ',' << GnuplotNumber((sweep.count - seeds) / sweep.count);
    file << '\n';
    for (size_t i = 0; i < figures.size(); ++i) below[i] += figures[i].CountIn(bin);
  }
  if (!file.flush()) throw ReportError("cannot write " + path.string() + ": " + std::strerror(errno));
}

std::string Curves(const std::string& name, const std::string& share, const std::string& how, int every = 1) {
  const std::string table = "\"" + name + ".csv\" every " + std::to_string(every) + " using \"edge\":";
  return "for [i=1:arms] " + table + "\"" + share + "_arm_\".id(i) with " + how + " linetype i, \\\n     " +
         table + "\"" + share + "_fleet\" with " + how + " " + kFleetStyle;
}

double LargestShare(const std::vector<SweepFigure>& figures, const Bins& bins, const RecordedSweep& sweep) {
  double largest = 0.0;
  for (const SweepFigure& figure : figures) {
    for (int bin = bins.first; bin < bins.end; bin += bins.merged)
      largest = std::max(largest, ShareIn(figure, bin, bins, sweep));
  }
  return largest;
}

Figure FigureOf(const Subject& subject, const RecordedSweep& sweep, const std::filesystem::path& folder) {
  const std::vector<SweepFigure>& figures = sweep.*subject.figures;
  const Bins bins = BinsOf(figures);
  WriteTable(folder / (std::string(subject.name) + ".csv"), sweep, figures, bins);

  Figure figure;
  figure.name = subject.name;
  figure.title = subject.title;
  figure.panel_height_px = 260;
  figure.columns = 3;
  figure.width_px = 960;
  for (size_t i = 0; i < sweep.arm_ids.size(); ++i) {
    figure.legend.push_back(
        {"arm " + std::to_string(sweep.arm_ids[i]), "linetype " + std::to_string(i + 1) + " linewidth 2.5"});
  }
  figure.legend.push_back({"fleet", kFleetStyle});

  const Axis x{subject.axis, {EdgeOf(bins.first, sweep), EdgeOf(bins.end, sweep)}};
  const std::string scale =
      x.range.hi > kLinearUpTo * x.range.lo ? "set logscale x\nset format x \"%g\"\n" : "unset logscale x\n";
  const double least = 0.5 / sweep.count;
  figure.panels = {
      {"share of seeds in a bin",
       x,
       {"", {0.0, 1.05 * LargestShare(figures, bins, sweep)}},
       Curves(figure.name, "in", "steps", bins.merged),
       scale + "unset logscale y\n"},
      {"share of seeds below",
       x,
       {"", {0.0, 1.02}},
       Curves(figure.name, "below", "lines"),
       scale + "unset logscale y\n"},
      {"share of seeds not below",
       x,
       {"", {least, 1.2}},
       Curves(figure.name, "above", "lines"),
       scale + "set logscale y\nset format y \"%g\"\n"},
  };
  figure.caption =
      std::string(subject.meaning) + " Left: share of the seeds in bins of " +
      ShortNumber(100.0 * (EdgeOf(bins.merged, sweep) - 1.0)) +
      " % width. Middle: share of the seeds below. Right: share not below, on a logarithmic scale: the tail.";
  return figure;
}

}  // namespace

std::vector<Figure> SweepFigures(const RecordedSweep& sweep, const std::filesystem::path& folder) {
  std::vector<Figure> figures;
  for (const Subject& subject : kSubjects) {
    const auto& of_all = sweep.*subject.figures;
    const bool any =
        std::any_of(of_all.begin(), of_all.end(), [](const SweepFigure& f) { return !f.counts.empty(); });
    if (any) figures.push_back(FigureOf(subject, sweep, folder));
  }
  return figures;
}

std::string ScriptText(const Figure& figure, const RecordedSweep& sweep) {
  std::string ids;
  for (const int id : sweep.arm_ids) ids += (ids.empty() ? "" : " ") + std::to_string(id);
  return ScriptText(figure, sweep.arm_ids,
                    "set datafile separator comma\narms = " + std::to_string(sweep.arm_ids.size()) +
                        "\nid(i) = word(\"" + ids + "\", i)\n");
}

}  // namespace armada
