#pragma once

#include <string>
#include <vector>

#include "host/report/axis_range.h"
#include "host/report/recorded_run.h"

namespace armada {

/// What metrics.json counts as tracking, unless the scenario says otherwise (`criterion.error_max_m`).
inline constexpr double kCriterion_mm = 20.0;

/// The part of a run in which something still happens: until the last arm has settled, with a little after
/// it; the whole run where an arm never settles.
AxisRange TransientSpan(const RecordedRun& run);

/// Panels side by side for curves over `time`: two, but one where so many laps need the whole width.
int PanelColumns(const AxisRange& time);

/// "Shown: ..." for a caption.
std::string TimeSpanText(const RecordedRun& run, const AxisRange& time);

/// When the last estimator was in its band for good, or which arms' never were.
std::string SyncText(const RecordedRun& run);

/// A column of the traces and the axis it is drawn on.
struct DrawnColumn {
  std::string column;
  AxisRange range;
};

/// Which arms cannot be seen fully within the axes, and which diverged: nothing is clipped in silence.
std::string OutOfPictureText(const RecordedRun& run, const std::vector<DrawnColumn>& drawn,
                             const AxisRange& time);

/// "arm 4", "arms 4 and 5", "arms 1, 4 and 5".
std::string ArmList(const std::vector<std::string>& names);

}  // namespace armada
