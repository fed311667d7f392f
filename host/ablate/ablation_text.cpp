#include <algorithm>
#include <cstdio>
#include <ostream>
#include <string_view>

#include "host/ablate/ablation.h"

namespace armada {
namespace {

constexpr char kWhole[] = "(nothing)";

const char* NameOf(const AblationResult& result) {
  return result.row != nullptr ? result.row->component : kWhole;
}

/// A number of a column, or a dash.
std::string Cell(bool given, double value, int width, int digits) {
  char text[64];
  if (given) {
    std::snprintf(text, sizeof text, "  %*.*f", width, digits, value);
  } else {
    std::snprintf(text, sizeof text, "  %*s", width, "-");
  }
  return text;
}

std::string RowText(const AblationResult& result) {
  if (!result.refused.empty()) return "  not possible here: " + result.refused;
  const SweepSummary& summary = result.summary;
  const Distribution& settled = summary.fleet_settled_s;
  return Cell(true, 100.0 * static_cast<double>(summary.ok_count) / static_cast<double>(summary.count), 6,
              2) +
         Cell(true, 100.0 * result.diverged_share, 10, 2) + Cell(settled.count > 0, settled.median, 17, 2) +
         Cell(settled.count > 0, settled.max, 6, 2) +
         Cell(summary.fleet_rms_mm.has_value(), summary.fleet_rms_mm.value_or(0.0), 10, 3) +
         Cell(true, summary.fleet_rms_all_mm.median, 11, 3) +
         Cell(result.ratio.has_value(), result.ratio.value_or(0.0), 6, 3);
}

}  // namespace

void PrintAblation(const Ablation& ablation, std::ostream& out) {
  size_t width = 0;
  for (const AblationResult& result : ablation.rows)
    width = std::max(width, std::string_view(NameOf(result)).size());
  const auto name = [&](std::string_view text) {
    out << text << std::string(width - std::min(width, text.size()), ' ');
  };
  name("without");
  out << "    ok %  diverged %  settled_s: median   worst  rms_mm: ok  all median   ratio\n";
  for (const AblationResult& result : ablation.rows) {
    name(NameOf(result));
    out << RowText(result) << '\n';
  }
  out << "\nwhat each earns\n";
  for (const AblationResult& result : ablation.rows) {
    if (result.row == nullptr || !result.refused.empty()) continue;
    name(result.row->component);
    out << "  " << result.row->purpose << ": " << Earnings(ablation.rows.front(), result) << '\n';
  }
  out << ablation.rows.front().summary.count << " seeds a row, " << ablation.seeds.first << " to "
      << ablation.seeds.last << " of " << ablation.scenario << '\n';
}

}  // namespace armada
