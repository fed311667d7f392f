#include "host/report/html_page.h"

#include "host/report/html_parts.h"
#include "host/report/html_text.h"
#include "host/report/number_text.h"
#include "host/report/palette.h"
#include "host/report/process_table.h"
#include "host/report/run_facts.h"

namespace armada {
namespace {

/// A value of metrics.json as a reader wants it.
std::string ValueText(const Json& value) {
  if (value.is_null()) return "–";
  if (value.is_number_float()) return NumberText(value.get<double>());
  if (value.is_string()) return HtmlEscaped(value.get<std::string>());
  if (!value.is_array()) return HtmlEscaped(value.dump());
  std::string list;
  for (const Json& part : value) list += (list.empty() ? "" : ", ") + ValueText(part);
  return list.empty() ? "–" : list;
}

std::string Top(const RecordedRun& run, const std::string& key) {
  return ValueText(RequireKey(run.metrics, key, "the top level"));
}

/// Who diverged, and, where the run is not ok, who else is to blame.
std::string BlameText(const RecordedRun& run, bool ok) {
  std::vector<std::string> diverged;
  std::vector<std::string> too_far;
  for (const ArmRecord& arm : run.arms) {
    const Json& max_mm = RequireKey(arm.metrics, "max_mm", "arm " + std::to_string(arm.id));
    const bool within = max_mm.is_number() && max_mm.get<double>() < kCriterion_mm;
    if (arm.diverged) diverged.push_back(std::to_string(arm.id));
    if (!arm.diverged && !within) too_far.push_back(std::to_string(arm.id));
  }
  std::string text;
  if (!diverged.empty()) text += "<p class=\"alarm\">DIVERGED: " + ArmList(diverged) + ".</p>";
  if (ok) return text;
  if (!too_far.empty()) {
    text += "<p class=\"alarm\">" + ShortNumber(kCriterion_mm) +
            " mm or more from the leader within the window: " + ArmList(too_far) + ".</p>";
  }
  if (text.empty())
    text = "<p class=\"alarm\">Every arm follows, but the fleet misses the scenario's own criterion.</p>";
  return text;
}

/// What a run in real time says of itself; empty where it says nothing.
std::string DiagnosisText(const RecordedRun& run) {
  if (!run.metrics.contains("diagnosis") || run.metrics["diagnosis"].empty()) return "";
  std::string html = "<ul>";
  for (const Json& finding : run.metrics["diagnosis"])
    html += "<li>" + HtmlEscaped(RequireKey(finding, "text", "diagnosis").get<std::string>()) + "</li>";
  return html + "</ul>";
}

/// True where the run was measured against its floor.
bool HasFloor(const RecordedRun& run) {
  return run.metrics.contains("floor_rms_mm");
}

std::string FleetText(const RecordedRun& run) {
  std::string text = "Fleet RMS " + Top(run, "fleet_rms_mm") + " mm over the window";
  if (HasFloor(run)) {
    text += ", " + Top(run, "over_floor") + " times the unavoidable " + Top(run, "floor_rms_mm") + " mm";
  }
  return text + ".";
}

std::string Verdict(const RecordedRun& run) {
  const bool ok = RequireKey(run.metrics, "ok", "the top level").get<bool>();
  const std::string diagnosis = DiagnosisText(run);
  const std::string why = (ok || diagnosis.empty() ? BlameText(run, ok) : "") + diagnosis;
  const std::string how = Top(run, "mode") != "run"         ? "armada sim: virtual time, one process"
                          : run.metrics.contains("stepped") ? "armada run: stepped time, one process an arm"
                                                            : "armada run: real time, one process an arm";
  std::string html = std::string("<div class=\"verdict") + (ok ? "" : " bad") + "\"><h1>" +
                     Top(run, "scenario") + ", seed " + Top(run, "seed") + ": <b>" + (ok ? "ok" : "NOT ok") +
                     "</b></h1><p>" + FleetText(run) + "</p>" + why + "</div>\n<dl>";
  const auto fact = [&](const std::string& name, const std::string& value) {
    html += "<div><dt>" + name + "</dt><dd>" + value + "</dd></div>";
  };
  fact("what was run", how);
  fact("control law", Top(run, "law"));
  fact("estimator", Top(run, "estimator"));
  fact("length", Top(run, "seconds") + " s");
  fact("window", ShortNumber(run.window_start_s) + " to " + ShortNumber(run.window_end_s) + " s");
  fact("arms", std::to_string(run.arms.size()));
  return html + "</dl>\n";
}

std::string ArmRow(const ArmRecord& arm, size_t index, bool with_floor) {
  const std::string part = "arm " + std::to_string(arm.id);
  const auto cell = [&](const char* key) {
    return "<td>" + ValueText(RequireKey(arm.metrics, key, part)) + "</td>";
  };
  const auto word = [&](const char* key) {
    return "<td class=\"word\">" + ValueText(RequireKey(arm.metrics, key, part)) + "</td>";
  };
  const Json& estimator = RequireKey(arm.metrics, "estimator_rms", part);
  std::string html = std::string(arm.diverged ? "<tr class=\"bad\">" : "<tr>") +
                     "<th scope=\"row\"><span class=\"swatch\" style=\"background:" + ArmColour(index) +
                     "\"></span>" + std::to_string(arm.id) + "</th><td>" + std::to_string(arm.joints) +
                     "</td>" + "<td class=\"word\">" + (arm.diverged ? "<strong>DIVERGED</strong>" : "no") +
                     "</td>" + cell("settled_s") + cell("rms_mm") + cell("max_mm");
  if (with_floor) html += cell("floor_rms_mm") + cell("over_floor");
  for (const char* state : {"x", "v", "a"}) {
    html += "<td>" + ValueText(RequireKey(estimator, state, part + ", estimator_rms,")) + "</td>";
  }
  return html + cell("torque_max_nm") + cell("saturated_ticks") + cell("parameter_error") + word("subtask") +
         cell("subtask_rms") + word("state") + word("faults") + "</tr>\n";
}

std::string ArmTable(const RecordedRun& run) {
  std::string html = "<h2>Arms</h2>\n<div class=\"wide\"><table><thead><tr>";
  const bool with_floor = HasFloor(run);
  std::vector<const char*> heads = {"arm",         "joints",     "diverged", "settled<br>[s]",
                                    "RMS<br>[mm]", "max<br>[mm]"};
  if (with_floor) heads.insert(heads.end(), {"floor<br>[mm]", "RMS over<br>floor"});
  heads.insert(heads.end(),
               {"estimator<br>RMS x<br>[m]", "estimator<br>RMS v<br>[m/s]", "estimator<br>RMS a<br>[m/s²]",
                "largest<br>torque<br>[N m]", "saturated<br>ticks", "parameter<br>error", "subtask",
                "subtask<br>RMS", "state", "faults"});
  for (const char* head : heads) html += std::string("<th scope=\"col\">") + head + "</th>";
  html += "</tr></thead><tbody>\n";
  for (size_t index = 0; index < run.arms.size(); ++index) html += ArmRow(run.arms[index], index, with_floor);
  return html + "</tbody></table></div>\n";
}

std::string Processes(const RecordedRun& run) {
  const ProcessTable table = CollectProcesses(run.metrics);
  if (table.processes.empty()) return "";
  std::string html = "<h2>Processes</h2>\n<div class=\"wide\"><table><thead><tr><th scope=\"col\"></th>";
  for (const std::string& process : table.processes)
    html += "<th scope=\"col\">" + HtmlEscaped(process) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const std::string& quantity : table.quantities) {
    html += "<tr><th scope=\"row\">" + HtmlEscaped(quantity) + "</th>";
    for (const std::string& process : table.processes) {
      const auto value = table.values.find({quantity, process});
      html += "<td>" + (value == table.values.end() ? "" : ValueText(value->second)) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace

std::string HtmlPage(const RecordedRun& run, const std::vector<Figure>& figures,
                     const std::filesystem::path& folder) {
  std::string html = PageOpening("Armada: " + Top(run, "scenario") + ", seed " + Top(run, "seed")) +
                     Verdict(run) + ArmTable(run) + Processes(run) + "<h2>Figures</h2>\n";
  for (size_t i = 0; i < figures.size(); ++i) html += FigureElement(figures[i], i + 1, folder);
  return html + "<details><summary>All metrics (metrics.json)</summary><pre>" +
         HtmlEscaped(run.metrics.dump(2)) + "</pre></details>\n</body></html>\n";
}

}  // namespace armada
