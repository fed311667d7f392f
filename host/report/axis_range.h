#pragma once

#include <vector>

#include "host/report/csv_table.h"

namespace armada {

/// A closed interval of an axis or of time, in the unit of what is drawn.
struct AxisRange {
  double lo = 0.0;
  double hi = 0.0;

  double span() const { return hi - lo; }
  bool Contains(double value) const { return value >= lo && value <= hi; }
};

/// Values of `column` in the rows whose t_s lies in `time`; NaN and infinities included.
std::vector<double> Slice(const CsvTable& table, const std::string& column, const AxisRange& time);

/// Value below which the given fraction (0 to 1) of the finite values lies; NaN where none is finite.
double Quantile(std::vector<double> values, double fraction);

/// Smallest and largest finite value; {0, 0} where none is finite.
AxisRange FiniteRange(const std::vector<double>& values);

/// `core` widened to hold the middle 98 % of every series, but by no more than `reach` to either side, then
/// padded by 5 %. One arm that runs away therefore cannot flatten the picture of the others.
AxisRange RobustRange(const AxisRange& core, const std::vector<std::vector<double>>& series, double reach);

}  // namespace armada
