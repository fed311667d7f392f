#include "host/sweep/sweep_text.h"

#include <algorithm>
#include <cstdio>
#include <ostream>

namespace armada {
namespace {

constexpr size_t kWorstShown = 3;
constexpr size_t kFailedShown = 50;

template <class... Values>
std::string Format(const char* format, Values... values) {
  char text[160];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

void PrintRow(const std::string& of, const Distribution& figures, int digits, std::ostream& out) {
  if (figures.count == 0) {
    out << Format("  %-8s  of no seed\n", of.c_str());
    return;
  }
  const auto seed = static_cast<unsigned long long>(figures.worst_seed);
  out << Format("  %-8s  %9.*f  %9.*f  %9.*f  %9.*f  %9.*f  %10llu\n", of.c_str(), digits, figures.median,
                digits, figures.p95, digits, figures.p99, digits, figures.p999, digits, figures.max, seed);
}

struct Figure {
  const char* title;
  int digits;
  Distribution SweepArmSummary::*of_arm;
  Distribution SweepSummary::*of_fleet;
};
constexpr Figure kFigures[] = {
    {"settled_s", 2, &SweepArmSummary::settled_s, &SweepSummary::fleet_settled_s},
    {"rms_mm", 3, &SweepArmSummary::rms_mm, &SweepSummary::fleet_rms_all_mm},
    {"max_mm", 3, &SweepArmSummary::max_mm, &SweepSummary::fleet_max_mm},
};
constexpr Figure kOverFloor{"rms/floor", 3, &SweepArmSummary::over_floor, &SweepSummary::fleet_over_floor};

void PrintFigure(const Figure& figure, const SweepSummary& summary, std::ostream& out) {
  out << Format("%-10s  %9s  %9s  %9s  %9s  %9s  %10s\n", figure.title, "median", "95%", "99%", "99.9%",
                "worst", "worst seed");
  for (const SweepArmSummary& arm : summary.arms)
    PrintRow(Format("arm %d", arm.id), arm.*figure.of_arm, figure.digits, out);
  PrintRow("fleet", summary.*figure.of_fleet, figure.digits, out);
}

void PrintWorst(const char* title, const Sweep& sweep, const WorstSeeds& worst, std::ostream& out) {
  for (size_t i = 0; i < std::min(kWorstShown, worst.list().size()); ++i) {
    const WorstSeed& entry = worst.list()[i];
    out << Format("  %-9s  %9.3f  arm %-2d  ", i == 0 ? title : "", entry.value, entry.arm)
        << ReplayCommand(sweep, entry.seed) << '\n';
  }
}

void PrintFailures(const Sweep& sweep, const SweepSummary& summary, std::ostream& out) {
  if (summary.failed_seeds.empty()) return;
  out << "not ok, " << summary.failed_count() << " seeds:";
  const size_t shown = std::min(kFailedShown, summary.failed_seeds.size());
  for (size_t i = 0; i < shown; ++i) out << ' ' << summary.failed_seeds[i];
  if (static_cast<int64_t>(shown) < summary.failed_count()) out << " ..";
  out << "\n  " << ReplayCommand(sweep, summary.failed_seeds.front()) << '\n';
}

}  // namespace

void PrintSweep(const Sweep& sweep, const SweepSummary& summary, std::ostream& out) {
  for (const Figure& figure : kFigures) PrintFigure(figure, summary, out);
  if (summary.has_floors) PrintFigure(kOverFloor, summary, out);
  for (const SweepArmSummary& arm : summary.arms) {
    if (arm.diverged + arm.never_settled == 0) continue;
    out << "arm " << arm.id << " diverged in " << arm.diverged << " seeds, never settled in "
        << arm.never_settled << '\n';
  }
  out << "worst fleets in which no arm diverged\n";
  PrintWorst("settled_s", sweep, summary.worst_settled_s, out);
  PrintWorst("rms_mm", sweep, summary.worst_rms_mm, out);
  PrintWorst("max_mm", sweep, summary.worst_max_mm, out);
  PrintFailures(sweep, summary, out);
  out << summary.ok_count << " of " << summary.count << " fleets ok";
  if (summary.fleet_rms_mm) out << Format(", their RMS %.3f mm", *summary.fleet_rms_mm);
  if (summary.floor_rms_mm) {
    out << Format(", %.2f times their floor of %.3f mm", *summary.fleet_rms_mm / *summary.floor_rms_mm,
                  *summary.floor_rms_mm);
  }
  out << Format(", estimator RMS %.3g mm\n", summary.estimator_rms_x_m * 1e3);
}

}  // namespace armada
