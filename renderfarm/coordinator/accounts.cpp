// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/accounts.h"

#include <algorithm>
#include <limits>

#include "common/base/check.h"

namespace cyclorama::coordinator {
namespace {

std::size_t index_of(WorkClass work) { return static_cast<std::size_t>(work); }

}  // namespace

Rank Accounts::Turn::rank() const {
  constexpr double kPerSecond = 1e6;
  constexpr double kMaxPosition = 4e18;  // Below Rank::kPerClass; equals 127,000 years of cpu time.
  return {work, static_cast<std::uint64_t>(std::clamp(start * kPerSecond, 0.0, kMaxPosition))};
}

AccountId Accounts::open(const std::string& museum, const Terms& terms) {
  CHECK(terms.weight > 0.0);
  const auto known = museum.empty() ? named_.end() : named_.find(museum);
  const AccountId id = known == named_.end() ? AccountId{++last_id_} : known->second;
  if (!museum.empty()) named_.emplace(museum, id);
  Account& account = accounts_[id];
  account.museum = museum;
  if (account.terms.cores != terms.cores) account.cores = {terms.cores, kQuotaBurstSeconds * terms.cores};
  if (account.terms.megapixels_per_second != terms.megapixels_per_second) {
    account.megapixels = {terms.megapixels_per_second, kQuotaBurstSeconds * terms.megapixels_per_second};
  }
  account.terms = terms;
  ++account.sessions;
  sum_up_weights();
  return id;
}

void Accounts::close(AccountId id) {
  Account& account = accounts_.at(id);
  CHECK(account.sessions > 0);
  if (--account.sessions > 0) return;
  if (account.museum.empty()) {
    accounts_.erase(id);
  } else {
    for (Flow& flow : account.flows) flow = {flow.time, 0.0, 0.0, 0};
  }
  sum_up_weights();
}

double Accounts::fair_time(std::size_t work, TimePoint now) {
  double lead = -std::numeric_limits<double>::infinity();
  for (const auto& [id, account] : accounts_) {
    const Flow& flow = account.flows[work];
    // Less what came at once, so that a piece of work larger than the credit costs nobody what is due.
    if (flow.frames > 0) lead = std::max(lead, flow.time - flow.last_charge);
  }
  FairShare& fair = fair_[work];
  const double grown = fair.time + credit() / kCreditSeconds * to_seconds(std::max(now - fair.at, Duration::zero()));
  fair.at = now;
  fair.time = std::max({fair.time, std::min(grown, fair.latest), lead - credit()});
  return fair.time;
}

Accounts::Turn Accounts::begin(AccountId id, const Demand& demand, TimePoint now) {
  Account& account = accounts_.at(id);
  // Pictures that refine a picture at rest do not count, because the farm itself requests them.
  if (!demand.at_rest) account.megapixels.take(demand.megapixels, now);
  const WorkClass wanted = demand.at_rest ? WorkClass::kAtRest : WorkClass::kMoving;
  Turn turn{is_over_quota(id, now) ? WorkClass::kSpare : wanted, 0.0, demand.cpu_seconds};
  Flow& flow = account.flows[index_of(turn.work)];
  const double fair = fair_time(index_of(turn.work), now);
  // An account that waits keeps its place, however long it waits.
  if (flow.frames++ == 0) flow.time = std::max(flow.time, fair);
  turn.start = flow.time + flow.reserved / account.terms.weight;
  flow.reserved += turn.reserved;
  return turn;
}

void Accounts::end(AccountId id, const Turn& turn) {
  const auto found = accounts_.find(id);
  if (found == accounts_.end()) return;
  Flow& flow = found->second.flows[index_of(turn.work)];
  flow.reserved = std::max(0.0, flow.reserved - turn.reserved);
  if (flow.frames > 0) --flow.frames;
  if (flow.frames == 0) flow.reserved = 0.0;  // Removes the rounding errors of the sums.
}

void Accounts::charge(AccountId id, WorkClass work, double cpu_seconds, TimePoint now) {
  const auto found = accounts_.find(id);
  if (found == accounts_.end() || !(cpu_seconds > 0.0)) return;
  Account& account = found->second;
  account.charged += cpu_seconds;
  account.cores.take(cpu_seconds, now);
  Flow& flow = account.flows[index_of(work)];
  flow.last_charge = cpu_seconds / account.terms.weight;
  flow.time += flow.last_charge;
  double& latest = fair_[index_of(work)].latest;
  latest = std::max(latest, flow.time);
}

bool Accounts::is_over_quota(AccountId id, TimePoint now) const {
  const Account& account = accounts_.at(id);
  return account.cores.paid_at() > now || account.megapixels.paid_at() > now;
}

double Accounts::received(AccountId id, WorkClass work) const {
  const auto found = accounts_.find(id);
  return found == accounts_.end() ? 0.0 : found->second.flows[index_of(work)].time;
}

void Accounts::sum_up_weights() {
  weights_ = 0.0;
  for (const auto& [id, account] : accounts_) {
    if (account.sessions > 0) weights_ += account.terms.weight;
  }
}

double Accounts::credit() const { return weights_ > 0.0 ? kCreditSeconds * threads_ / weights_ : 0.0; }

double Accounts::weight(AccountId id) const { return accounts_.at(id).terms.weight; }

double Accounts::charged_seconds(AccountId id) const {
  const auto found = accounts_.find(id);
  return found == accounts_.end() ? 0.0 : found->second.charged;
}

}  // namespace cyclorama::coordinator
