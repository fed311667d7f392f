#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace armada::report_sample {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

inline constexpr double kTick_s = 0.02;
inline constexpr int kTicks = 200;
inline constexpr int kSpikeTick = 120;
inline constexpr double kSpike_m = 0.4321;

inline void WriteText(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

struct SampleArm {
  int id;
  int joints;
  std::string subtask;
  bool diverged;
};
inline const std::vector<SampleArm> kArms = {
    {1, 2, "none", false}, {4, 2, "none", true}, {6, 3, "posture", false}, {7, 3, "manipulability", false}};

/// An arm that closes in on the leader; a diverging one multiplies its velocity every tick until it is not
/// finite. Arm 1 has one tick far away from the leader.
inline void WriteTrace(const fs::path& path, const SampleArm& arm, bool with_subtask) {
  std::ostringstream csv;
  csv << "t_s";
  for (const char* column : {"q", "dq", "tau"}) {
    const std::string unit = column == std::string("q")    ? "_rad"
                             : column == std::string("dq") ? "_rad_s"
                                                           : "_Nm";
    for (int joint = 1; joint <= arm.joints; ++joint) csv << ',' << column << joint << unit;
  }
  csv << ",ignored,x1_m,x2_m,v1_m_s,v2_m_s,xhat1_m,xhat2_m,vhat1_m_s,vhat2_m_s,ahat1_m_s2,ahat2_m_s2,error_m,"
         "sigma_min,manipulability,subtask_rad_s,synced,clearance_m\n";
  const int ticks = arm.diverged ? 60 : kTicks;
  for (int tick = 0; tick < ticks; ++tick) {
    const double t_s = tick * kTick_s;
    const double offset_m = 0.8 * std::exp(-4.0 * t_s);
    const double runaway = arm.diverged ? std::pow(2.0, tick * 20.0) : 0.0;  // infinite from tick 52 on
    const double s = std::sin(M_PI * t_s);
    const double c = std::cos(M_PI * t_s);
    const double error_m = arm.id == 1 && tick == kSpikeTick ? kSpike_m : offset_m + 1e-3;
    csv << t_s;
    for (int joint = 1; joint <= arm.joints; ++joint) {
      csv << ',' << (with_subtask ? 1.0 : 2.0) + 0.1 * joint * s;
    }
    for (int joint = 1; joint <= 2 * arm.joints; ++joint) csv << ',' << 10.0 * joint * c;
    csv << ",a word," << 1.2 + 0.5 * s + offset_m << ',' << 1.3 + 0.3 * c << ',' << 1.57 * c + runaway << ','
        << -0.94 * s - runaway << ',' << 1.2 + 0.5 * s << ',' << 1.3 + 0.3 * c << ',' << 1.57 * c << ','
        << -0.94 * s << ',' << -4.9 * s << ',' << -2.96 * c << ',' << error_m << ",0.5,"
        << (with_subtask ? 2.0 : 1.0) + 0.2 * c << ",0.01," << (t_s > 0.5) << ','
        << (with_subtask ? 0.0625 : -0.25) << '\n';
  }
  WriteText(path, csv.str());
}

inline void WriteRun(const fs::path& dir, bool with_subtask) {
  fs::create_directories(dir);
  std::ostringstream leader;
  leader << "t_s,x1_m,x2_m,v1_m_s,v2_m_s,a1_m_s2,a2_m_s2\n";
  for (int tick = 0; tick < kTicks; ++tick) {
    const double s = std::sin(M_PI * tick * kTick_s);
    const double c = std::cos(M_PI * tick * kTick_s);
    leader << tick * kTick_s << ',' << 1.2 + 0.5 * s << ',' << 1.3 + 0.3 * c << ',' << 1.57 * c << ','
           << -0.94 * s << ',' << -4.9 * s << ',' << -2.96 * c << '\n';
  }
  WriteText(dir / "leader.csv", leader.str());
  for (const SampleArm& arm : kArms) {
    WriteTrace(dir / ("arm_" + std::to_string(arm.id) + ".csv"), arm, with_subtask);
  }
}

inline Json SampleMetrics() {
  Json arms = Json::array();
  for (const SampleArm& arm : kArms) {
    const Json unless_diverged = arm.diverged ? Json(nullptr) : Json(1.0 + 0.0371 * arm.id);
    arms.push_back({{"id", arm.id},
                    {"subtask", arm.subtask},
                    {"diverged", arm.diverged},
                    {"settled_s", unless_diverged},
                    {"rms_mm", unless_diverged},
                    {"max_mm", unless_diverged},
                    {"estimator_rms", {{"x", 2.13e-6 * arm.id}, {"v", 6.4e-4 * arm.id}, {"a", 0.128}}},
                    {"torque_max_nm", 143.7},
                    {"saturated_ticks", 12},
                    {"parameter_error", 0.0271},
                    {"subtask_rms", arm.subtask == "none" ? Json(nullptr) : Json(0.3127)},
                    {"state", arm.diverged ? "FAULT" : "RUN"},
                    {"faults", arm.diverged ? Json::array({"tracking <error>"}) : Json::array()},
                    {"timing", {{"compute_us", {{"p50", 31.25}, {"max", 77.5}}}, {"missed_ticks", 3}}},
                    {"memory", {{"heap_allocations", 0}}}});
  }
  return {{"schema", 1},  {"scenario", "sample & co"}, {"mode", "run"},  {"law", "robust"},
          {"seed", 4711}, {"estimator", "predictive"}, {"seconds", 4.0}, {"window_s", {2.0, 4.0}},
          {"arms", arms}, {"fleet_rms_mm", nullptr},   {"ok", false}};
}

inline void WriteMetrics(const fs::path& dir, const Json& metrics) {
  WriteText(dir / "metrics.json", metrics.dump(2));
}

inline void WriteTiming(const fs::path& dir) {
  std::ostringstream csv;
  csv << "arm,t_s,wakeup_lateness_us,compute_us,sample_to_torque_us\n";
  for (int tick = 0; tick < kTicks; ++tick) {
    for (const SampleArm& arm : kArms) {
      csv << arm.id << ',' << tick * kTick_s << ',' << tick % 17 - 1 << ',' << 30 + tick % 5 << ','
          << (tick == 50 ? 12345 : 200 + tick) << '\n';
    }
  }
  WriteText(dir / "timing.csv", csv.str());
}

/// The whole sample with everything optional: twin run and timing.
inline void WriteSample(const fs::path& dir) {
  WriteRun(dir, true);
  WriteRun(dir / "without_subtask", false);
  WriteMetrics(dir, SampleMetrics());
  WriteTiming(dir);
}

}  // namespace armada::report_sample
