#include <algorithm>
#include <optional>

#include "operations/command_line/demo.hpp"
#include "operations/command_line/meeting_client.hpp"
#include "operations/experiments/site_facts.hpp"

namespace usher::operations {

namespace {

namespace state = usher_msgs::msg::MeetingStatus_Constants;

constexpr std::uint32_t kPersons = 2;
constexpr double kSeed = 559.0;  // [s] R IV-G: two persons from medium distances
constexpr int kTellEvery = 5;    // [s]

class MeetingDemo final : public Demo {
 public:
  const Text& text() const override {
    static const Text text{"demo meeting", "meeting-demo.yaml",
                           "The meeting assistant brings two people to a free room",
                           "both are in the meeting room",
                           "they are not in the meeting room as promised"};
    return text;
  }
  std::chrono::seconds longest() const override { return std::chrono::minutes(16); }

  Status attach(const Deployment& deployment, runtime::Observer& observer,
                std::mutex& mutex) override {
    auto writer = observer.writer(topics::kMeetingRequest);
    if (!writer) return Error{writer.error()};
    requests_.emplace(std::move(writer).value());
    auto reader = observer.reader(topics::kMeetingStatus, [&](const auto& status, const auto&) {
      const std::lock_guard lock(mutex);
      take(status);
    });
    if (!reader) return Error{reader.error()};
    statuses_.emplace(std::move(reader).value());
    auto rooms = site_meeting_rooms(deployment);
    if (!rooms) return Error{rooms.error()};
    rooms_ = std::move(rooms).value();
    return {};
  }

  void step() override {
    const bool idle = status_ && status_->state() == state::STATE_IDLE;
    if (!call_.refusal().empty() && idle)
      call_ = MeetingCall(kPersons, 0.0);  // the robot was not ready yet
    if (const auto request = call_.due()) requests_->write(*request);
  }

  std::string progress(const RunRecord& /*record*/) override {
    if (!status_) return {};
    const bool changed = told_ != status_->state();
    if (!changed && ++silent_ < kTellEvery) return {};
    told_ = status_->state();
    silent_ = 0;
    return meeting_progress(*status_);
  }

  bool over(const RunRecord& /*record*/) const override {
    return status_ && call_.taken() && status_->mission().outcome() != state::OUTCOME_OPEN;
  }

  void judge(const RunRecord& record, ResultSheet& sheet) const override {
    double there = 0.0;
    const auto room = std::find_if(rooms_.begin(), rooms_.end(), [&](const SiteRoom& each) {
      return status_ && each.name == status_->mission().room();
    });
    for (const char* const name : {"ada", "boole"}) {
      const auto at = record.person(name);
      if (at && room != rooms_.end() && room->contains(*at)) ++there;
    }
    sheet.flags["reached"] =
        status_ && there >= kPersons && status_->mission().outcome() == state::OUTCOME_COMPLETE;
    sheet.metrics["persons_in_the_room"] = there;
    if (!status_) return;
    sheet.metrics["room_found_s"] = status_->mission().room_time();
    sheet.metrics["mission_s"] = status_->mission().duration();
    sheet.metrics["faces_refused"] = status_->mission().faces_refused();
    sheet.published["mission_s"] = kSeed;
  }

 private:
  void take(const usher_msgs::msg::MeetingStatus& status) {
    call_.take(status);
    status_ = status;
  }

  MeetingCall call_{kPersons, 0.0};
  std::optional<usher_msgs::msg::MeetingStatus> status_;
  std::vector<SiteRoom> rooms_;
  std::optional<std::uint8_t> told_;
  int silent_ = 0;
  // Last: they end before what they fill.
  std::optional<runtime::Observer::Writer<usher_msgs::msg::MeetingRequest>> requests_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::MeetingStatus>> statuses_;
};

}  // namespace

std::unique_ptr<Demo> meeting_demo() { return std::make_unique<MeetingDemo>(); }

}  // namespace usher::operations
