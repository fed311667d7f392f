#include "host/report/recorded_sweep.h"

#include <fstream>

#include "host/report/report_error.h"

namespace armada {
namespace {

SweepFigure FigureOf(const std::string& of, const Json& distribution) {
  SweepFigure figure{of, distribution, 0, {}};
  if (distribution.is_null()) return figure;
  const Json& histogram = distribution.at("histogram");
  figure.first_bin = histogram.at("first_bin").get<int>();
  figure.counts = histogram.at("counts").get<std::vector<double>>();
  return figure;
}

// All keys but `runs`, which may be large.
Json SummaryOf(std::istream& file) {
  constexpr int kOfWhole = 1;
  return Json::parse(file, [](int depth, Json::parse_event_t event, Json& parsed) {
    return !(depth == kOfWhole && event == Json::parse_event_t::key && parsed == "runs");
  });
}

}  // namespace

RecordedSweep LoadRecordedSweep(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw ReportError(path.string() + ": cannot be read");
  try {
    RecordedSweep sweep;
    sweep.summary = SummaryOf(file);
    if (sweep.summary.at("schema") != 1 || sweep.summary.at("mode") != "sweep")
      throw ReportError(path.string() + ": not a sweep of schema 1");
    sweep.bins_per_decade = sweep.summary.at("bins_per_decade").get<double>();
    sweep.count = sweep.summary.at("count").get<double>();
    for (const Json& arm : sweep.summary.at("arms")) {
      sweep.arm_ids.push_back(arm.at("id").get<int>());
      const std::string of = "arm " + std::to_string(sweep.arm_ids.back());
      sweep.settled_s.push_back(FigureOf(of, arm.at("settled_s")));
      sweep.rms_mm.push_back(FigureOf(of, arm.at("rms_mm")));
      sweep.max_mm.push_back(FigureOf(of, arm.at("max_mm")));
      if (arm.contains("over_floor")) sweep.over_floor.push_back(FigureOf(of, arm.at("over_floor")));
    }
    sweep.settled_s.push_back(FigureOf("fleet", sweep.summary.at("fleet_settled_s")));
    sweep.rms_mm.push_back(FigureOf("fleet", sweep.summary.at("fleet_rms_all_mm")));
    sweep.max_mm.push_back(FigureOf("fleet", sweep.summary.at("fleet_max_mm")));
    if (!sweep.over_floor.empty())
      sweep.over_floor.push_back(FigureOf("fleet", sweep.summary.at("fleet_over_floor")));
    return sweep;
  } catch (const nlohmann::json::exception& problem) {
    throw ReportError(path.string() + ": " + problem.what());
  }
}

}  // namespace armada
