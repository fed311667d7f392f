#include "host/sim/trace_writer.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace armada {
namespace {

template <class Vector>
void Put(std::FILE* file, const Vector& values) {
  for (const double value : values) std::fprintf(file, ",%.9g", value);
}

void PutNames(std::FILE* file, const char* prefix, const char* unit, int count) {
  for (int i = 1; i <= count; ++i) std::fprintf(file, ",%s%d%s", prefix, i, unit);
}

}  // namespace

TraceWriter::File TraceWriter::Create(const std::string& path) {
  File file(std::fopen(path.c_str(), "w"));
  if (!file && error_.empty()) error_ = "cannot write " + path + ": " + std::strerror(errno);
  return file;
}

// After a failed write errno is the kernel's; a later one would be of something else.
void TraceWriter::Note(std::FILE* file, const std::string& path) {
  if (std::ferror(file) != 0 && error_.empty()) error_ = "cannot write " + path + ": " + std::strerror(errno);
}

std::string TraceWriter::PathOf(size_t index) const {
  return directory_ + "/arm_" + std::to_string(ids_[index]) + ".csv";
}

TraceWriter::TraceWriter(const std::string& directory, const FleetConfig& fleet) : directory_(directory) {
  std::error_code code;
  std::filesystem::create_directories(directory, code);
  if (code) {
    error_ = "cannot create " + directory + ": " + code.message();
    return;
  }
  leader_ = Create(directory + "/leader.csv");
  for (const ArmEntry& arm : fleet.arms) {
    ids_.push_back(arm.id);
    arms_.push_back(Create(PathOf(ids_.size() - 1)));
  }
  if (!ok()) return;

  constexpr int m = PlanarArm::kTaskDim;
  std::fputs("t_s", leader_.get());
  PutNames(leader_.get(), "x", "_m", m);
  PutNames(leader_.get(), "v", "_m_s", m);
  PutNames(leader_.get(), "a", "_m_s2", m);
  std::fputc('\n', leader_.get());
  for (size_t i = 0; i < arms_.size(); ++i) {
    std::FILE* file = arms_[i].get();
    const int n = fleet.arms[i].arm.dof;
    std::fputs("t_s", file);
    PutNames(file, "q", "_rad", n);
    PutNames(file, "dq", "_rad_s", n);
    PutNames(file, "tau", "_Nm", n);
    PutNames(file, "x", "_m", m);
    PutNames(file, "v", "_m_s", m);
    PutNames(file, "xhat", "_m", m);
    PutNames(file, "vhat", "_m_s", m);
    PutNames(file, "ahat", "_m_s2", m);
    std::fputs(",error_m,sigma_min,manipulability,subtask_rad_s,synced", file);
    has_obstacles_.push_back(fleet.arms[i].arm.obstacle_count > 0);
    std::fputs(has_obstacles_[i] ? ",clearance_m\n" : "\n", file);
  }
}

void TraceWriter::Leader(double t_s, const Zeta& zeta) {
  std::fprintf(leader_.get(), "%.9g", t_s);
  Put(leader_.get(), zeta.x_m);
  Put(leader_.get(), zeta.v_m_s);
  Put(leader_.get(), zeta.a_m_s2);
  std::fputc('\n', leader_.get());
  Note(leader_.get(), directory_ + "/leader.csv");
}

void TraceWriter::Arm(size_t index, const TraceRow& row) {
  std::FILE* file = arms_[index].get();
  std::fprintf(file, "%.9g", row.t_s);
  Put(file, row.q_rad);
  Put(file, row.dq_rad_s);
  Put(file, row.tau_Nm);
  Put(file, row.x_m);
  Put(file, row.v_m_s);
  Put(file, row.zeta.x_m);
  Put(file, row.zeta.v_m_s);
  Put(file, row.zeta.a_m_s2);
  std::fprintf(file, ",%.9g,%.9g,%.9g,%.9g,%d", row.error_m, row.sigma_min, row.manipulability,
               row.subtask_error_rad_s, row.synced ? 1 : 0);
  if (has_obstacles_[index]) std::fprintf(file, ",%.9g", row.clearance_m);
  std::fputc('\n', file);
  Note(file, PathOf(index));
}

bool TraceWriter::Close() {
  const auto finish = [&](File& file, const std::string& path) {
    if (!file) return;
    std::fflush(file.get());
    Note(file.get(), path);
    file.reset();
  };
  finish(leader_, directory_ + "/leader.csv");
  for (size_t i = 0; i < arms_.size(); ++i) finish(arms_[i], PathOf(i));
  return ok();
}

}  // namespace armada
