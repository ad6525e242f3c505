#include <cmath>
#include <limits>

#include "operations/command_line/demo.hpp"
#include "operations/command_line/table.hpp"

namespace usher::operations {

namespace {

constexpr double kArrivalTolerance = 0.4;  // [m] of the robot from the goal
constexpr double kVisitorTolerance = 3.5;  // [m] of the visitor from the robot
constexpr const char* kVisitor = "visitor";

class GuideDemo final : public Demo {
 public:
  GuideDemo(std::string destination, bool pixels)
      : text_{"demo", pixels ? "demo-pixels.yaml" : "demo.yaml", "MARVIN guides a visitor",
              "the visitor got there", "the visitor did not get there as promised"},
        destination_(std::move(destination)) {}
  const Text& text() const override { return text_; }
  std::chrono::seconds longest() const override { return std::chrono::minutes(6); }
  std::vector<Override> overrides() const override {
    if (destination_.empty()) return {};
    return {{kVisitor, "destination", destination_}};
  }
  Status attach(const Deployment& /*deployment*/, runtime::Observer& /*observer*/,
                std::mutex& /*mutex*/) override {
    return {};
  }

  /// Where the dialogue is.
  std::string progress(const RunRecord& record) override {
    const auto& screen = record.screen();
    if (!screen) return {};
    const bool driving = screen->state() == "guide_active";
    if (screen->state() == last_state_ && !driving) return {};
    last_state_ = screen->state();
    if (!driving) return screen->title();
    std::string line = "driving";
    if (const auto& status = record.navigation()) {
      line += format("  %3.0f %%", status->progress() * 100.0) +
              format("  %5.1f m left", status->remaining());
      if (std::isfinite(status->eta())) line += format("  %3.0f s", status->eta());
      if (!status->reason().empty()) line += "  " + status->reason();
    }
    if (record.samples().empty()) return line;
    return line + format("  %4.2f m/s", record.samples().back().v) +
           format("  clearance %.2f m", record.samples().back().clearance);
  }

  bool over(const RunRecord& record) const override {
    const auto& dialogue = record.dialogue();
    return !dialogue.empty() && (dialogue.back() == "guide_error" || dialogue.back() == "end");
  }

  void judge(const RunRecord& record, ResultSheet& sheet) const override {
    const auto truth = record.truth();
    const auto& navigation = record.navigation();
    const auto visitor = record.person(kVisitor);
    double off_goal = std::numeric_limits<double>::infinity();
    double visitor_off = std::numeric_limits<double>::infinity();
    if (truth && navigation) {
      const auto& goal = navigation->goal().pose().position();
      off_goal = std::hypot(truth->x - goal.x(), truth->y - goal.y());
    }
    if (truth && visitor) visitor_off = (truth->position() - *visitor).norm();
    sheet.flags["reached"] =
        record.reached_a_goal() && off_goal < kArrivalTolerance && visitor_off < kVisitorTolerance;
    sheet.metrics["off_goal_m"] = off_goal;
    sheet.metrics["visitor_distance_m"] = visitor_off;
    sheet.published["mean_speed_m_s"] = 0.72;
  }

 private:
  Text text_;
  std::string destination_;
  std::string last_state_;
};

}  // namespace

std::unique_ptr<Demo> guide_demo(const std::string& destination, bool pixels) {
  return std::make_unique<GuideDemo>(destination, pixels);
}

}  // namespace usher::operations
