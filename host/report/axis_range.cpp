#include "host/report/axis_range.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace armada {

std::vector<double> Slice(const CsvTable& table, const std::string& column, const AxisRange& time) {
  const std::vector<double>& t_s = table.Column("t_s");
  const std::vector<double>& values = table.Column(column);
  std::vector<double> slice;
  for (size_t row = 0; row < t_s.size(); ++row) {
    if (time.Contains(t_s[row])) slice.push_back(values[row]);
  }
  return slice;
}

double Quantile(std::vector<double> values, double fraction) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto rank = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<size_t>(rank)];
}

AxisRange FiniteRange(const std::vector<double>& values) {
  AxisRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range.lo = std::min(range.lo, value);
    range.hi = std::max(range.hi, value);
  }
  return range.lo <= range.hi ? range : AxisRange{};
}

AxisRange RobustRange(const AxisRange& core, const std::vector<std::vector<double>>& series, double reach) {
  constexpr double kTail = 0.01;
  constexpr double kPadding = 0.05;
  constexpr double kLeastPadding = 1e-6;  // what stands still gets an axis too
  AxisRange range = core;
  for (const std::vector<double>& values : series) {
    const double low = Quantile(values, kTail);
    const double high = Quantile(values, 1.0 - kTail);
    if (low < range.lo) range.lo = std::max(low, core.lo - reach);
    if (high > range.hi) range.hi = std::min(high, core.hi + reach);
  }
  const double padding = std::max(kPadding * range.span(), kLeastPadding);
  return {range.lo - padding, range.hi + padding};
}

}  // namespace armada
