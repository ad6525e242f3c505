#include <cstdlib>
#include <map>
#include <optional>

#include "operations/command_line/demo.hpp"
#include "operations/command_line/meeting_client.hpp"
#include "operations/manifest/tree.hpp"

namespace usher::operations {

namespace {

namespace state = usher_msgs::msg::MeetingStatus_Constants;

constexpr std::uint32_t kPersons = 2;
constexpr double kSeed = 559.0;  // [s] R IV-G: two persons from medium distances
constexpr int kTellEvery = 5;    // [s]

/// Between its walls, in map [m].
struct Room {
  geometry::Point2 low{0, 0}, high{0, 0};
  bool contains(const geometry::Point2& point) const {
    return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
  }
};

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
    return read_rooms(deployment);
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
    const auto room = status_ ? rooms_.find(status_->mission().room()) : rooms_.end();
    for (const char* const name : {"ada", "boole"}) {
      const auto at = record.person(name);
      if (at && room != rooms_.end() && room->second.contains(*at)) ++there;
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

  /// What the site's file says of its meeting rooms.
  Status read_rooms(const Deployment& deployment) {
    for (const auto& file : deployment.files) {
      for (const auto& value : file.values) {
        if (value.name != "site.meeting_rooms") continue;
        const auto list = parse_tree(value.yaml, value.origin);
        if (!list) return Error{list.error()};
        for (const Tree& room : list->items) {
          const auto wall = [&](const char* side) {
            const Tree* at = room.find(side);
            return at == nullptr ? 0.0 : std::strtod(at->scalar.c_str(), nullptr);
          };
          if (const Tree* name = room.find("name"))
            rooms_[name->scalar] = {{wall("west"), wall("south")}, {wall("east"), wall("north")}};
        }
        return {};
      }
    }
    return Error{"nobody in " + text().manifest + " asks for the site's meeting rooms"};
  }

  MeetingCall call_{kPersons, 0.0};
  std::optional<usher_msgs::msg::MeetingStatus> status_;
  std::map<std::string, Room> rooms_;
  std::optional<std::uint8_t> told_;
  int silent_ = 0;
  // Last: they end before what they fill.
  std::optional<runtime::Observer::Writer<usher_msgs::msg::MeetingRequest>> requests_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::MeetingStatus>> statuses_;
};

}  // namespace

std::unique_ptr<Demo> meeting_demo() { return std::make_unique<MeetingDemo>(); }

}  // namespace usher::operations
