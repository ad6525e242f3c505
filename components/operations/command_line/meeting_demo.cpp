#include <map>
#include <optional>

#include "operations/command_line/demo.hpp"
#include "operations/command_line/meeting_client.hpp"
#include "operations/command_line/table.hpp"

namespace usher::operations {

namespace {

namespace state = usher_msgs::msg::MeetingStatus_Constants;

constexpr std::uint32_t kPersons = 2;
constexpr double kInTheRoom = 4.0;  // [m] of a person from the room's place
constexpr double kSeed = 559.0;     // [s] R IV-G: two persons from medium distances
constexpr int kTellEvery = 5;       // [s]

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

  Status attach(runtime::Observer& observer, std::mutex& mutex) override {
    auto writer = observer.writer(topics::kMeetingRequest);
    if (!writer) return Error{writer.error()};
    requests_.emplace(std::move(writer).value());
    auto reader = observer.reader(topics::kMeetingStatus, [&](const auto& status, const auto&) {
      const std::lock_guard lock(mutex);
      take(status);
    });
    if (!reader) return Error{reader.error()};
    statuses_.emplace(std::move(reader).value());
    auto locations = observer.reader(topics::kLocations, [&](const auto& message, const auto&) {
      const std::lock_guard lock(mutex);
      for (const auto& location : message.locations())
        places_[location.name()] = {location.pose().position().x(), location.pose().position().y()};
    });
    if (!locations) return Error{locations.error()};
    locations_.emplace(std::move(locations).value());
    return {};
  }

  void step() override {
    if (!call_.refusal().empty())
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
    if (status_ && places_.contains(status_->mission().room())) {
      for (const char* const name : {"ada", "boole"}) {
        const auto at = record.person(name);
        if (at && (*at - places_.at(status_->mission().room())).norm() < kInTheRoom) ++there;
      }
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
  std::map<std::string, geometry::Point2> places_;
  std::optional<std::uint8_t> told_;
  int silent_ = 0;
  // Last: they end before what they fill.
  std::optional<runtime::Observer::Writer<usher_msgs::msg::MeetingRequest>> requests_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::MeetingStatus>> statuses_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::Locations>> locations_;
};

}  // namespace

std::unique_ptr<Demo> meeting_demo() { return std::make_unique<MeetingDemo>(); }

}  // namespace usher::operations
