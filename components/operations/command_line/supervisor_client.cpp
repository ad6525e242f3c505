#include "operations/command_line/supervisor_client.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace usher::operations {

namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg;

constexpr auto kRepeat = milliseconds(200);
constexpr auto kPatience = std::chrono::seconds(3);
constexpr auto kAnswer = std::chrono::seconds(5);

bool is_stop(std::uint8_t command) {
  using namespace SupervisorRequest_Constants;
  return command == COMMAND_STOP || command == COMMAND_EMERGENCY_STOP;
}

}  // namespace

std::uint64_t fresh_id() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

Status tell_supervisor(runtime::Observer& observer, std::uint8_t command, const std::string& goal,
                       std::chrono::seconds stop_patience) {
  auto writer = observer.writer(topics::kSupervisorRequest);
  auto status = observer.reader(topics::kSupervisorStatus);
  if (!writer) return Error{writer.error()};
  if (!status) return Error{status.error()};
  // A stop is asked for as long as nobody answers: with keys the two may need half a minute to
  // know each other, and a supervisor that is being restarted is back before.
  const auto started = std::chrono::steady_clock::now();
  const auto patience = is_stop(command) ? stop_patience : kPatience;
  if (!writer->wait_for_readers(1, kPatience)) {
    if (is_stop(command))
      std::fputs(
          "usher: no supervisor answers yet; trying on (is it the robot of this domain? usher "
          "status --domain N)\n",
          stderr);
    if (!is_stop(command) || !writer->wait_for_readers(1, patience - kPatience))
      return Error{
          "no supervisor in this domain; `usher status --domain N` looks into another one"};
  }
  SupervisorRequest request;
  request.id(fresh_id());
  request.client(kOperatorName);
  request.command(command);
  request.goal(goal);
  const auto last = std::max(started + patience, std::chrono::steady_clock::now() + kAnswer);
  while (std::chrono::steady_clock::now() < last) {
    writer->write(request);
    const auto until = std::chrono::steady_clock::now() + kRepeat;
    while (std::chrono::steady_clock::now() < until) {
      const auto answer = status->take(milliseconds(50));
      const bool ours = answer && answer->last_request() == request.id() &&
                        answer->last_request_client() == request.client();
      if (!ours) continue;
      if (!answer->last_request_done()) return Error{"refused: " + answer->last_request_reason()};
      return {};
    }
  }
  return Error{"the supervisor did not answer"};
}

std::shared_ptr<const SupervisorStatus> newest_status(
    runtime::Observer::Reader<SupervisorStatus>& reader, milliseconds patience) {
  auto status = reader.take(patience);
  while (auto newer = reader.take()) status = std::move(newer);
  return status;
}

std::string stopped_by(const SupervisorStatus& status) {
  std::string names;
  for (const auto& client : status.stopped_by()) names += (names.empty() ? "" : ", ") + client;
  return names;
}

}  // namespace usher::operations
