#include "operations/command_line/supervisor_client.hpp"

#include <chrono>

#include "idl/topics.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg;

constexpr auto kRepeat = milliseconds(200);

}  // namespace

std::uint64_t fresh_id() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

Status tell_supervisor(runtime::Observer& observer, std::uint8_t command, const std::string& goal) {
  auto writer = observer.writer(topics::kSupervisorRequest);
  auto status = observer.reader(topics::kSupervisorStatus);
  if (!writer) return Error{writer.error()};
  if (!status) return Error{status.error()};
  if (!writer->wait_for_readers(1, std::chrono::seconds(3)))
    return Error{"no supervisor in this domain"};
  SupervisorRequest request;
  request.id(fresh_id());
  request.client(kOperatorName);
  request.command(command);
  request.goal(goal);
  for (int tries = 0; tries < 25; ++tries) {
    writer->write(request);
    const auto until = std::chrono::steady_clock::now() + kRepeat;
    while (std::chrono::steady_clock::now() < until) {
      const auto answer = status->take(milliseconds(50));
      if (!answer || answer->last_request() != request.id()) continue;
      if (!answer->last_request_done()) return Error{"refused: " + answer->last_request_reason()};
      return {};
    }
  }
  return Error{"the supervisor did not answer within 5 s"};
}

}  // namespace usher::operations
