#include "host/report/report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "host/report/axis_range.h"
#include "host/report/csv_table.h"
#include "host/report/number_text.h"
#include "host/report/report_error.h"
#include "host/report/run_facts.h"

namespace armada {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kTick_s = 0.02;
constexpr int kTicks = 200;
constexpr int kSpikeTick = 120;
constexpr double kSpike_m = 0.4321;

std::string ReadText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void WriteText(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
  return count;
}

/// Runs a command for its exit status and what it prints.
int Run(const std::string& command, std::string* output) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer;
  for (size_t count; (count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) output->append(buffer.data(), count);
  return pclose(pipe);
}

class TempDir {
 public:
  TempDir() {
    std::string name = (fs::temp_directory_path() / "armada_report_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  ~TempDir() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Sets PATH for as long as it lives.
class ScopedPath {
 public:
  explicit ScopedPath(const std::string& value) : before_(getenv("PATH")) { setenv("PATH", value.c_str(), 1); }
  ScopedPath(const ScopedPath&) = delete;
  ScopedPath& operator=(const ScopedPath&) = delete;
  ~ScopedPath() { setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

struct SampleArm {
  int id;
  int joints;
  std::string subtask;
  bool diverged;
};
const std::vector<SampleArm> kArms = {
    {1, 2, "none", false}, {4, 2, "none", true}, {6, 3, "posture", false}, {7, 3, "manipulability", false}};

/// An arm that closes in on the leader; a diverging one doubles its velocity every tick until it is not finite. Arm 1
/// has one tick far away from the leader.
void WriteTrace(const fs::path& path, const SampleArm& arm, bool with_subtask) {
  std::ostringstream csv;
  csv << "t_s";
  for (const char* column : {"q", "dq", "tau"}) {
    const std::string unit = column == std::string("q") ? "_rad" : column == std::string("dq") ? "_rad_s" : "_Nm";
    for (int joint = 1; joint <= arm.joints; ++joint) csv << ',' << column << joint << unit;
  }
  csv << ",ignored,x1_m,x2_m,v1_m_s,v2_m_s,xhat1_m,xhat2_m,vhat1_m_s,vhat2_m_s,ahat1_m_s2,ahat2_m_s2,error_m,sigma_min,"
         "manipulability,subtask_rad_s,synced\n";
  const int ticks = arm.diverged ? 60 : kTicks;
  for (int tick = 0; tick < ticks; ++tick) {
    const double t_s = tick * kTick_s;
    const double offset_m = 0.8 * std::exp(-4.0 * t_s);
    const double runaway = arm.diverged ? std::pow(2.0, tick * 20.0) : 0.0;  // infinite from tick 52 on
    const double s = std::sin(M_PI * t_s);
    const double c = std::cos(M_PI * t_s);
    const double error_m = arm.id == 1 && tick == kSpikeTick ? kSpike_m : offset_m + 1e-3;
    csv << t_s;
    for (int joint = 1; joint <= arm.joints; ++joint) csv << ',' << (with_subtask ? 1.0 : 2.0) + 0.1 * joint * s;
    for (int joint = 1; joint <= 2 * arm.joints; ++joint) csv << ',' << 10.0 * joint * c;
    csv << ",word" << std::string(0, ' ').size() << '\n';
    csv.seekp(-6, std::ios::cur);
    csv << ",0," << 1.2 + 0.5 * s + offset_m << ',' << 1.3 + 0.3 * c << ',' << 1.57 * c + runaway << ','
        << -0.94 * s - runaway << ',' << 1.2 + 0.5 * s << ',' << 1.3 + 0.3 * c << ',' << 1.57 * c << ',' << -0.94 * s
        << ',' << -4.9 * s << ',' << -2.96 * c << ',' << error_m << ",0.5," << (with_subtask ? 2.0 : 1.0) + 0.2 * c
        << ",0.01," << (t_s > 0.5) << '\n';
  }
  WriteText(path, csv.str());
}
