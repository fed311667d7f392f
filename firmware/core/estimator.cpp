#include "firmware/core/estimator.h"

#include <algorithm>
#include <cmath>

namespace armada {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double Sign(double value) {
  return static_cast<double>((value > 0.0) - (value < 0.0));
}

// One block (x, v or a) of (1.9), explicit: a step of h beta against the sign of the disagreement. False when
// out of the band.
bool ExplicitStep(const TaskVector& mean, double h_beta, double band, TaskVector& state) {
  bool in_band = true;
  for (Eigen::Index c = 0; c < state.size(); ++c) {
    const double disagreement = state[c] - mean[c];
    if (std::abs(disagreement) > band) in_band = false;
    state[c] -= h_beta * Sign(disagreement);
  }
  return in_band;
}

// The same with the sgn evaluated at the end of the step, solved in closed form: f moves to the mean, or by h
// beta.
bool ImplicitStep(const TaskVector& f, const TaskVector& mean, double h_beta, double band,
                  TaskVector& state) {
  bool in_band = true;
  for (Eigen::Index c = 0; c < state.size(); ++c) {
    const double distance = f[c] - mean[c];
    // Equality up to rounding is inside: a slope of exactly beta must not flicker.
    if (std::abs(distance) > (1.0 + 1e-7) * band) in_band = false;
    state[c] = mean[c] + Sign(distance) * std::max(0.0, std::abs(distance) - h_beta);
  }
  return in_band;
}

}  // namespace

Estimator::Estimator(const EstimatorConfig& config, const Zeta& initial)
    : config_(config), zeta_(initial), jerk_m_s3_(TaskVector::Zero(initial.x_m.size())) {
  if (config_.leaderless) {
    // The arms agree on a point. An agreed velocity would make that point drift without an agreed clock.
    zeta_.v_m_s.setZero();
    zeta_.a_m_s2.setZero();
  }
}

bool Estimator::CountsAsHeard(const Neighbour& neighbour) const {
  if (neighbour.weight <= 0.0 || !neighbour.heard || neighbour.age_s > config_.age_max_s) return false;
  return config_.leaderless || neighbour.leader_age_s <= config_.age_max_s;
}

double Estimator::YoungestNews(const Neighbours& neighbours) const {
  double youngest_s = kInfinity;
  for (int j = 0; j < neighbours.count; ++j) {
    const Neighbour& neighbour = neighbours.list[static_cast<size_t>(j)];
    if (CountsAsHeard(neighbour)) youngest_s = std::min(youngest_s, neighbour.leader_age_s);
  }
  return youngest_s;
}

void Estimator::Update(const Neighbours& neighbours, double h_s, double missed_s) {
  const bool predict = config_.kind == EstimatorKind::kPredictive;
  const Eigen::Index m = zeta_.x_m.size();
  const double step_s = missed_s + h_s;
  // Without the jerk: if it were wrong, beta_3 would not suffice to correct it.
  const Zeta f = predict ? Taylor(zeta_, step_s) : zeta_;

  // Weighted mean of what was heard. Without a leader a node is one of its own neighbours: averaging over the
  // others alone only passes values around a ring.
  Zeta mean = config_.leaderless ? f : Zeta::Zero(m);
  TaskVector mean_jerk_m_s3 = TaskVector::Zero(m);
  double degree = config_.leaderless ? 1.0 : 0.0;
  double oldest_s = 0.0;
  const double youngest_s = std::min(leader_age_s_ + missed_s, YoungestNews(neighbours));
  const double used_up_to_s = predict && !config_.leaderless ? youngest_s + 0.5 * h_s : kInfinity;
  for (int j = 0; j < neighbours.count; ++j) {
    const Neighbour& neighbour = neighbours.list[static_cast<size_t>(j)];
    if (!CountsAsHeard(neighbour) || neighbour.leader_age_s > used_up_to_s) continue;
    const TaskVector jerk_m_s3 = neighbour.jerk_m_s3.head(m);
    const Zeta z_j = predict ? Taylor(neighbour.zeta, jerk_m_s3, neighbour.age_s + h_s) : neighbour.zeta;
    mean.x_m += neighbour.weight * z_j.x_m;
    mean.v_m_s += neighbour.weight * z_j.v_m_s;
    mean.a_m_s2 += neighbour.weight * z_j.a_m_s2;
    mean_jerk_m_s3 += neighbour.weight * jerk_m_s3;
    degree += neighbour.weight;
    oldest_s = std::max(oldest_s, neighbour.age_s);
  }
  leader_age_s_ = youngest_s + h_s;

  if (degree <= 0.0) {
    Coast(step_s, youngest_s);
  } else {
    mean.x_m /= degree;
    mean.v_m_s /= degree;
    mean.a_m_s2 /= degree;
    // No leader within (A2) has more; without the bound one wrong message could move the prediction anywhere.
    const double beta_3 = config_.beta_3_m_s3;
    jerk_m_s3_ = (mean_jerk_m_s3 / degree).cwiseMax(-beta_3).cwiseMin(beta_3);
    // Since it was last corrected a leader within (A2) can have moved by beta over the time, and over the age
    // of what was heard.
    const double since_s = step_s + (coasted_s_ <= config_.age_max_s ? coasted_s_ : 0.0);
    const double band_s = since_s + oldest_s;
    const auto step = [&](const TaskVector& f_part, const TaskVector& mean_part, double beta,
                          TaskVector& part) {
      return config_.kind == EstimatorKind::kPaper
                 ? ExplicitStep(mean_part, step_s * beta, config_.chatter_bands * band_s * beta, part)
                 : ImplicitStep(f_part, mean_part, since_s * beta, band_s * beta, part);
    };
    const bool x_in_band = step(f.x_m, mean.x_m, config_.beta_1_m_s, zeta_.x_m);
    const bool v_in_band = step(f.v_m_s, mean.v_m_s, config_.beta_2_m_s2, zeta_.v_m_s);
    const bool a_in_band = step(f.a_m_s2, mean.a_m_s2, config_.beta_3_m_s3, zeta_.a_m_s2);
    in_band_ = x_in_band && v_in_band && a_in_band;
    coasted_s_ = 0.0;
  }
  UpdateAgreement(neighbours, used_up_to_s);
}

void Estimator::Coast(double step_s, double leader_age_s) {
  coasted_s_ += step_s;
  in_band_ = in_band_ && leader_age_s <= config_.age_max_s;
  if (config_.kind != EstimatorKind::kPredictive) return;
  zeta_ = Taylor(zeta_, jerk_m_s3_, step_s);
  if (coasted_s_ > config_.age_max_s) {
    // A prediction of nothing any more. It would fly away, and take long to come back.
    zeta_.v_m_s.setZero();
    zeta_.a_m_s2.setZero();
    jerk_m_s3_.setZero();
  }
}

// Who is heard with older news than those in use has no part in the estimate, nor in the agreement; who is
// dead has none, either.
void Estimator::UpdateAgreement(const Neighbours& neighbours, double used_up_to_s) {
  // What nobody confirms does not count.
  const int confirmed = coasted_s_ > 0.0 ? 0 : 1;
  agreement_ = in_band_ ? std::min(agreement_ + confirmed, kMaxAgreement) : 0;
  for (int j = 0; j < neighbours.count; ++j) {
    const Neighbour& neighbour = neighbours.list[static_cast<size_t>(j)];
    const bool heard = CountsAsHeard(neighbour);
    if (neighbour.weight <= 0.0 || neighbour.silent || (heard && neighbour.leader_age_s > used_up_to_s))
      continue;
    agreement_ = std::min(agreement_, heard ? neighbour.agreement + 1 : 0);
  }
  ticks_out_of_band_ = in_band_ ? 0 : ticks_out_of_band_ + 1;
  if (agreement_ >= config_.sync_ticks) synced_ = true;
  if (ticks_out_of_band_ >= config_.desync_ticks) synced_ = false;
}

}  // namespace armada
