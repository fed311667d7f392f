#include <algorithm>
#include <cmath>

#include "host/report/figures.h"
#include "host/report/number_text.h"
#include "host/report/run_facts.h"

namespace armada {
namespace {

/// A quantity in the plane: its columns end in a component, 1 or 2, and a unit.
struct Quantity {
  std::string title;
  std::string symbol;
  std::string arm_column;
  std::string leader_column;
  std::string unit_suffix;
  std::string unit;

  std::string ArmColumn(int component) const { return arm_column + std::to_string(component) + unit_suffix; }
  std::string LeaderColumn(int component) const {
    return leader_column + std::to_string(component) + unit_suffix;
  }
  std::string Label(int component) const { return symbol + (component == 1 ? "₁" : "₂") + " [" + unit + "]"; }
};

const Quantity kPosition{"position", "x", "x", "x", "_m", "m"};
const Quantity kVelocity{"velocity", "ẋ", "v", "v", "_m_s", "m/s"};
const Quantity kEstimates[] = {{"", "x̂", "xhat", "x", "_m", "m"},
                               {"", "v̂", "vhat", "v", "_m_s", "m/s"},
                               {"", "â", "ahat", "a", "_m_s2", "m/s²"}};

/// Axis of one component: the leader's own range, and beyond it as far as arms go within reason.
AxisRange RangeOf(const RecordedRun& run, const Quantity& quantity, int component, const AxisRange& time) {
  constexpr double kReach_spans = 2.5;  // of the leader's livelier component
  constexpr double kLeastReach = 1.0;   // [m], [m/s] or [m/s^2], around a leader that stands still
  const AxisRange core[] = {FiniteRange(Slice(run.leader, quantity.LeaderColumn(1), time)),
                            FiniteRange(Slice(run.leader, quantity.LeaderColumn(2), time))};
  std::vector<std::vector<double>> series;
  for (const ArmRecord& arm : run.arms) {
    series.push_back(Slice(arm.trace, quantity.ArmColumn(component), time));
  }
  const double reach = std::max(kReach_spans * std::max(core[0].span(), core[1].span()), kLeastReach);
  return RobustRange(core[component - 1], series, reach);
}

/// Rows of quantities over time, one column of panels per component.
Figure OverTime(const RecordedRun& run, const std::vector<Quantity>& quantities, const AxisRange& time) {
  Figure figure;
  figure.columns = PanelColumns(time);
  figure.panel_height_px = figure.columns == 1 ? 110 : 180;
  figure.legend = ArmLegend(run);
  figure.legend.push_back({"leader", kLeaderStyle});
  std::vector<DrawnColumn> drawn;
  for (const Quantity& quantity : quantities) {
    for (const int component : {1, 2}) {
      const AxisRange range = RangeOf(run, quantity, component, time);
      figure.panels.push_back({.title = "",
                               .x = {"time [s]", time},
                               .y = {quantity.Label(component), range},
                               .plot = ArmsAndLeader({"t_s", quantity.ArmColumn(component)},
                                                     {"t_s", quantity.LeaderColumn(component)})});
      drawn.push_back({quantity.ArmColumn(component), range});
    }
  }
  figure.caption = TimeSpanText(run, time) + " " + OutOfPictureText(run, drawn, time);
  return figure;
}

Figure EstimatesFigure(const RecordedRun& run) {
  const AxisRange time = TransientSpan(run);
  Figure figure = OverTime(run, {std::begin(kEstimates), std::end(kEstimates)}, time);
  figure.name = "estimates";
  figure.title = "Estimates of the leader";
  figure.caption =
      "Each arm's estimate of the leader's position x̂, velocity v̂ and acceleration â, by component, "
      "against the leader (black, dashed). " +
      SyncText(run) + " " + figure.caption + " Fig. 3 of the paper.";
  return figure;
}

Figure StatesFigure(const RecordedRun& run) {
  const AxisRange time = TransientSpan(run);
  Figure figure = OverTime(run, {kPosition, kVelocity}, time);
  figure.name = "states";
  figure.title = "Task-space position and velocity";
  figure.caption =
      "Position x and velocity ẋ of each end-effector, by component, against the leader (black, dashed). " +
      figure.caption + " Fig. 4 of the paper.";
  return figure;
}

/// Both ranges with the longer one's span: one metre is as long to the right as upwards.
void MakeSquare(AxisRange* x, AxisRange* y) {
  const double half = std::max(x->span(), y->span()) / 2.0;
  for (AxisRange* range : {x, y}) {
    const double middle = (range->lo + range->hi) / 2.0;
    *range = {middle - half, middle + half};
  }
}

/// Rows of the time span [from, to] only: the rest is drawn as nothing.
std::string While(const AxisRange& time, const std::string& column) {
  return "(column(\"t_s\") >= " + GnuplotNumber(time.lo) +
         " && column(\"t_s\") <= " + GnuplotNumber(time.hi) + " ? column(\"" + column + "\") : NaN)";
}

Panel PathPanel(const Quantity& quantity, const AxisRange& x, const AxisRange& y, const AxisRange& transient,
                const AxisRange& final_laps) {
  const std::string column_y = "\"" + quantity.ArmColumn(2) + "\"";
  return {.title = quantity.title,
          .x = {quantity.Label(1), x},
          .y = {quantity.Label(2), y},
          .plot = "for [i=1:arms] trace(i) every step using " + While(transient, quantity.ArmColumn(1)) +
                  ":" + column_y + " with lines linetype i linewidth 0.7, \\\n" +
                  "     for [i=1:arms] trace(i) every step using " +
                  While(final_laps, quantity.ArmColumn(1)) + ":" + column_y +
                  " with lines linetype i linewidth 2.4, \\\n" + "     leader every step using " +
                  While(final_laps, quantity.LeaderColumn(1)) + ":\"" + quantity.LeaderColumn(2) +
                  "\" with lines linecolor rgb \"black\" linewidth 0.8"};
}

Figure PathsFigure(const RecordedRun& run) {
  constexpr double kFinalPart = 0.2;
  const AxisRange transient = TransientSpan(run);
  const AxisRange final_laps{run.end_s - kFinalPart * (run.end_s - run.start_s), run.end_s};
  Figure figure;
  figure.name = "paths";
  figure.title = "Paths in the XY plane";
  figure.panel_height_px = 302;
  figure.columns = 2;
  figure.legend = ArmLegend(run);
  figure.legend.push_back({"leader", "linecolor rgb \"black\" linewidth 0.8"});
  std::vector<DrawnColumn> drawn;
  for (const Quantity& quantity : {kPosition, kVelocity}) {
    AxisRange x = RangeOf(run, quantity, 1, transient);
    AxisRange y = RangeOf(run, quantity, 2, transient);
    MakeSquare(&x, &y);
    figure.panels.push_back(PathPanel(quantity, x, y, transient, final_laps));
    drawn.push_back({quantity.ArmColumn(1), x});
    drawn.push_back({quantity.ArmColumn(2), y});
  }
  figure.caption =
      "End-effector positions (left) and velocities (right) in the plane. Thin: " +
      (transient.hi < run.end_s ? "the first " + ShortNumber(transient.span()) + " s" : "the whole run") +
      ". Thick: the final laps, the last " + ShortNumber(final_laps.span()) +
      " s, over which an arm that follows hides under the leader (black). " +
      OutOfPictureText(run, drawn, transient) + " Fig. 5 of the paper.";
  return figure;
}

}  // namespace

std::vector<Figure> TaskSpaceFigures(const RecordedRun& run) {
  return {EstimatesFigure(run), StatesFigure(run), PathsFigure(run)};
}

}  // namespace armada
