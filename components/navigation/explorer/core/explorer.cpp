#include "navigation/explorer/core/explorer.hpp"

#include <cmath>
#include <utility>

#include "foundation/result/bounds.hpp"

namespace usher::explorer {

namespace {

constexpr double kPatience = 3.0;  // [s] with a navigator that lives and does not know the drive

}  // namespace

Result<Explorer> Explorer::create(const ExplorerConfig& config, std::uint64_t seed,
                                  std::uint64_t first_id) {
  const Status status =
      within({{"passing_room", config.passing_room, 0.05, 2.0, "m"},
              {"standing_room", config.standing_room, config.passing_room, 2.0, "m"},
              {"most_recoveries", static_cast<double>(config.most_recoveries), 0, 100},
              {"most_failures", static_cast<double>(config.most_failures), 1, 100},
              {"client_silence", config.client_silence, 0.5, 60.0, "s"}});
  if (!status) return Error{status.error()};
  auto seen = SeenArea::create(config.camera);
  if (!seen) return Error{seen.error()};
  auto strategy = make_strategy(config.strategy, seed);
  if (!strategy) return Error{strategy.error()};
  return Explorer(config, std::move(seen).value(), std::move(strategy).value(), first_id);
}

Status Explorer::set_map(const grid::OccupancyGrid& map) {
  if (Status status =
          ground_.set_map(map, config_.leave_out, config_.passing_room, config_.standing_room);
      !status)
    return status;
  seen_.set_map(map, config_.leave_out);
  divide_work();
  begin_round();
  return {};
}

Status Explorer::set_share(const Share& share) {
  if (share.places.size() > Share::kMost)
    return Error{"a share has at most " + std::to_string(Share::kMost) + " places, got " +
                 std::to_string(share.places.size())};
  if (!share.places.empty() && share.own >= share.places.size())
    return Error{"the own place must be one of the share's " + std::to_string(share.places.size()) +
                 ", got " + std::to_string(share.own)};
  if (share == share_) return {};
  share_ = share;
  divide_work();
  seen_.set_aside(of_others_);
  strategy_->begin_round();
  return {};
}

void Explorer::divide_work() {
  of_others_.clear();
  if (share_.places.size() < 2 || seen_.empty()) return;
  of_others_ = divide(ground_, seen_, share_.places);
  for (std::uint8_t& cell : of_others_) cell = cell == share_.own ? 0 : 1;
}

void Explorer::begin_round() {
  seen_.forget();
  seen_.set_aside(of_others_);
  given_up_.clear();
  strategy_->begin_round();
}

void Explorer::request(const ExploreRequest& request) {
  if (request.id == status_.id && request.id != 0 && request.client == status_.client) {
    asked_ = true;
    return;
  }
  const bool sound =
      request.id != 0 && std::isfinite(request.max_speed) && request.max_speed >= 0.0;
  if (!sound && active()) return;
  if (driving_) decision_.cancel = last_drive_;
  driving_ = false;
  status_ = {};
  status_.id = request.id;
  status_.client = request.client;
  request_ = request;
  failures_ = 0;
  if (!sound) {
    status_.state = GoalState::kFailed;
    status_.reason = request.id == 0 ? "a goal needs an id other than 0"
                                     : "max_speed must be finite and 0 or more";
    return;
  }
  status_.state = GoalState::kActive;
  asked_ = true;
  if (request.anew) begin_round();
}

bool Explorer::cancel(std::uint64_t id) {
  if (!active() || (id != 0 && id != status_.id)) return false;
  finish(GoalState::kCancelled, "cancelled");
  return true;
}

void Explorer::finish(GoalState state, const std::string& reason) {
  if (driving_) decision_.cancel = last_drive_;
  driving_ = false;
  status_.state = state;
  status_.reason = reason;
}

void Explorer::wait(const std::string& reason) {
  status_.state = GoalState::kWaiting;
  status_.reason = reason;
}

Decision Explorer::step(const Situation& s) {
  if (std::exchange(asked_, false)) asked_at_ = s.time;
  if (active()) {
    if (s.time - asked_at_ >= config_.client_silence) {
      finish(GoalState::kFailed, "'" + status_.client + "' is silent");
    } else if (seen_.empty()) {
      wait("no map");
    } else if (!s.navigation) {
      wait("no navigator");
    } else if (!s.pose || !s.pose->finite()) {
      wait("robot not localized");
    } else {
      status_.state = GoalState::kActive;
      status_.reason.clear();
      if (driving_) follow_drive(s);
      if (active() && !driving_) choose(s);
    }
  }
  return std::exchange(decision_, {});
}

void Explorer::follow_drive(const Situation& s) {
  if (s.navigation->id == last_drive_ && s.navigation->client == s.client)
    return take_report(s, *s.navigation);
  const bool drives =
      s.navigation->state == GoalState::kActive || s.navigation->state == GoalState::kWaiting;
  if (answered_ && drives && s.navigation->client != s.client)
    return finish(GoalState::kFailed, "'" + s.navigation->client + "' drives the robot elsewhere");
  if (s.time - sent_at_ < kPatience) return;
  // A navigator that was restarted has forgotten it.
  send(s);
  wait("the navigator does not answer");
}

void Explorer::take_report(const Situation& s, const DriveReport& report) {
  answered_ = true;
  sent_at_ = s.time;
  switch (report.state) {
    case GoalState::kSucceeded:
      return reached();
    case GoalState::kFailed:
      return failed(report.reason);
    case GoalState::kCancelled:
      driving_ = false;
      return finish(GoalState::kFailed, "somebody cancelled the drive to the viewpoint");
    case GoalState::kReplaced:
      driving_ = false;
      return finish(GoalState::kFailed, "somebody drives the robot elsewhere");
    case GoalState::kWaiting:
      wait(report.reason);
      break;
    case GoalState::kIdle:
    case GoalState::kActive:
      break;
  }
  if (report.recoveries > static_cast<std::uint32_t>(config_.most_recoveries)) {
    decision_.cancel = last_drive_;  // where another one does not replace it
    return failed(report.reason);
  }
  if (!strategy_->worth(status_.view, seen_)) {
    ++status_.views;
    failures_ = 0;
    driving_ = false;  // the next goal replaces this one
  }
}

/// The robot stands at the viewpoint within the navigator's tolerance: what that was to show counts
/// as looked at, else a sliver that is just out of view would be its next viewpoint for ever.
void Explorer::reached() {
  seen_.look(status_.view);
  ++status_.views;
  failures_ = 0;
  driving_ = false;
}

void Explorer::failed(const std::string& reason) {
  given_up_.push_back(status_.view.position());
  ++status_.given_up;
  driving_ = false;
  if (++failures_ >= config_.most_failures)
    finish(GoalState::kFailed,
           std::to_string(failures_) +
               " viewpoints in a row could not be reached, the last one: " + reason);
}

std::optional<Pose2> Explorer::next_view(const Pose2& robot) {
  auto view = strategy_->next({seen_, ground_, robot, given_up_});
  if (view || !seen_.has_aside()) return view;
  seen_.set_aside({});
  strategy_->begin_round();
  return strategy_->next({seen_, ground_, robot, given_up_});
}

void Explorer::choose(const Situation& s) {
  const auto cancel_last = [&] {
    // A drive that was left because all was seen on the way must not go on.
    if (answered_ && s.navigation->id == last_drive_ && s.navigation->state <= GoalState::kWaiting)
      decision_.cancel = last_drive_;
  };
  if (!ground_.start_from(s.pose->position())) {
    cancel_last();
    return finish(GoalState::kFailed, "the robot stands where the map has no room for it");
  }
  auto view = next_view(*s.pose);
  if (!view) {
    ++status_.round;
    if (request_.rounds > 0 && status_.round >= request_.rounds) {
      cancel_last();
      return finish(GoalState::kSucceeded, "");
    }
    begin_round();
    seen_.look(*s.pose);
    view = next_view(*s.pose);
  }
  if (!view) {
    cancel_last();
    return finish(GoalState::kFailed, "there is nothing to look at that the robot can reach");
  }
  status_.view = *view;
  driving_ = true;
  send(s);
}

void Explorer::send(const Situation& s) {
  decision_.drive = Drive{++last_drive_, status_.view, request_.max_speed};
  decision_.cancel.reset();  // the new goal replaces what drives
  answered_ = false;
  sent_at_ = s.time;
}

}  // namespace usher::explorer
