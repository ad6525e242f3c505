#include <signal.h>

#include <atomic>
#include <iostream>
#include <limits>
#include <memory>

#include "operations/command_line/commands.hpp"
#include "operations/command_line/meeting_client.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/supervisor_client.hpp"
#include "operations/command_line/usage.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using std::chrono::milliseconds;
namespace outcome = usher_msgs::msg::MeetingStatus_Constants;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds(3);
constexpr auto kGone = std::chrono::seconds(5);     // longer than the launcher needs to restart it
constexpr auto kBegins = std::chrono::seconds(20);  // until all of a robot is ready
constexpr const char* kNotReady = "not ready";

std::atomic<bool> stop_asked{false};

struct MeetingArguments {
  std::uint32_t domain = 0;
  std::uint32_t persons = 2;
  double minutes = 0.0;
  bool no_wait = false;
  bool cancel = false;
};

/// Ends the mission that is on, whoever called it.
int cancel_meeting(const MeetingArguments& arguments) {
  auto observer = Observer::create(reach_robot(kOperatorName, arguments.domain));
  if (!observer) return fail(observer.error());
  auto cancels = (*observer)->writer(topics::kMeetingCancel);
  if (!cancels) return fail(cancels.error());
  auto statuses = (*observer)->reader(topics::kMeetingStatus);
  if (!statuses) return fail(statuses.error());
  if (!cancels->wait_for_readers(1, kPatience))
    return fail(nobody_there("meeting assistant", arguments.domain));
  usher_msgs::msg::GoalCancel cancel;  // id 0: whatever runs
  cancel.client(kOperatorName);
  std::uint64_t mission = 0;
  for (const auto until = Clock::now() + kGone; Clock::now() < until;) {
    const auto status = statuses->take(milliseconds(200));
    if (!status) continue;
    const bool on = status->mission().outcome() == outcome::OUTCOME_OPEN;
    if (!on || status->mission().id() == 0) {
      std::cout << (mission == 0 ? "no meeting is called" : meeting_progress(*status)) << "\n";
      return 0;
    }
    mission = status->mission().id();
    cancels->write(cancel);
  }
  return fail("the meeting assistant does not answer");
}

/// Calls the meeting and tells how it goes; Ctrl-C gives it up.
int meet(const MeetingArguments& arguments) {
  auto observer = Observer::create(reach_robot(kOperatorName, arguments.domain));
  if (!observer) return fail(observer.error());
  auto requests = (*observer)->writer(topics::kMeetingRequest);
  if (!requests) return fail(requests.error());
  auto cancels = (*observer)->writer(topics::kMeetingCancel);
  if (!cancels) return fail(cancels.error());
  auto statuses = (*observer)->reader(topics::kMeetingStatus);
  if (!statuses) return fail(statuses.error());
  if (!requests->wait_for_readers(1, kPatience))
    return fail(nobody_there("meeting assistant", arguments.domain));

  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  MeetingCall call(arguments.persons, 60.0 * arguments.minutes);
  const auto began = Clock::now();
  auto heard = began;
  std::string told;
  for (;;) {
    if (const auto request = call.due()) requests->write(*request);
    if (stop_asked) {
      usher_msgs::msg::GoalCancel cancel;
      cancel.id(call.id());
      cancel.client(kOperatorName);
      cancels->write(cancel);
    }
    const auto status = statuses->take(milliseconds(100));
    if (Clock::now() - heard > kGone)
      return fail("the meeting assistant has been silent for 5 s; what it does is not known");
    if (!status) continue;
    heard = Clock::now();
    const bool was_taken = call.taken();
    call.take(*status);
    const bool too_early = call.refusal().find(kNotReady) != std::string::npos;
    if (too_early && Clock::now() - began < kBegins && !stop_asked) {
      if (told.empty())
        std::cout << (told = "waits until the robot is ready") << "\n" << std::flush;
      call = MeetingCall(arguments.persons, 60.0 * arguments.minutes);
      continue;
    }
    if (!call.refusal().empty()) return fail(call.refusal());
    if (was_taken && !call.taken())
      return fail(status->mission().id() == 0
                      ? "the meeting assistant was restarted; the mission is over"
                      : "the meeting assistant works for somebody else");
    if (!call.taken()) continue;
    if (arguments.no_wait) return 0;
    // Each line once: the seconds that are left change all the time.
    auto quiet = *status;
    quiet.time_left(std::numeric_limits<float>::quiet_NaN());
    if (const auto line = meeting_progress(quiet); line != told) {
      told = line;
      std::cout << meeting_progress(*status) << "\n" << std::flush;
    }
    if (status->mission().outcome() == outcome::OUTCOME_OPEN) continue;
    if (status->mission().outcome() == outcome::OUTCOME_COMPLETE) return 0;
    return fail(stop_asked ? "you gave it up" : status->mission().reason());
  }
}

}  // namespace

void add_meeting_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<MeetingArguments>();
  auto* command = app.add_subcommand(
      "meet", "Call a meeting: the assistant finds a free room, finds people and brings them");
  auto domain = std::make_shared<std::optional<std::uint32_t>>();
  add_domain_option(*command, *domain);
  command->add_option("--persons", arguments->persons, "How many it brings")
      ->check(within(1, 100))
      ->capture_default_str();
  command
      ->add_option("--minutes", arguments->minutes,
                   "It gives up then; 0 = its own limit, 15 unless set")
      ->check(within(0, 60))
      ->capture_default_str();
  command->add_flag("--no-wait", arguments->no_wait, "Return when the assistant took it");
  command->add_flag("--cancel", arguments->cancel, "End the meeting that is called, by whomever");
  command->callback([=, &exit_code] {
    arguments->domain = meant_domain(*domain);
    exit_code = arguments->cancel ? cancel_meeting(*arguments) : meet(*arguments);
  });
}

}  // namespace usher::operations
