// What it costs to keep book of what was seen and to choose a viewpoint, in the arena.
#include <cstdio>
#include <optional>

#include "foundation/grid/map_file.hpp"
#include "navigation/explorer/core/explorer.hpp"
#include "support/bench.hpp"

namespace {

using namespace usher::explorer;

/// An explorer half-way through the arena, as the first views of each run leave it.
class Workload {
 public:
  explicit Workload(const usher::grid::OccupancyGrid& map)
      : seen_(std::move(SeenArea::create({})).value()),
        strategy_(std::move(make_strategy({}, 1)).value()) {
    seen_.set_map(map, {});
    if (!ground_.set_map(map, {}, 0.24, 0.35)) std::abort();
    strategy_->begin_round();
    robot_ = {1.5, 1.5, 1.57};
    for (int i = 0; i < 15; ++i) choose();
  }
  void look() { seen_.look(robot_); }
  /// The next view, taken.
  void choose() {
    look();
    if (!ground_.start_from(robot_.position())) return;
    const auto view = strategy_->next({seen_, ground_, robot_, {}});
    if (view) {
      robot_ = *view;
    } else {
      seen_.forget();
      strategy_->begin_round();
    }
  }
  void first_choice() {
    seen_.forget();
    strategy_->begin_round();
    choose();
  }

 private:
  SeenArea seen_;
  Ground ground_;
  std::unique_ptr<Strategy> strategy_;
  Pose2 robot_;
};

}  // namespace

int main(int argc, char** argv) {
  using usher::bench::Bound;
  usher::bench::Bench bench("explorer", "the arena, 345 x 265 cells");
  const auto map =
      usher::grid::load_map(std::string(USHER_SOURCE_DIR) + "/config/sites/arena/map.yaml");
  if (!map) {
    std::fprintf(stderr, "%s\n", map.error().c_str());
    return 1;
  }
  Workload work(*map);
  bench.time("look_us", 1e-6, [&] { work.look(); });
  bench.target("look_us", Bound::kAtMost, 100);
  bench.time("choose_ms", 1e-3, [&] { work.choose(); });
  bench.target("choose_ms", Bound::kAtMost, 50);
  bench.time("first_choice_ms", 1e-3, [&] { work.first_choice(); });
  bench.target("first_choice_ms", Bound::kAtMost, 50);
  return bench.run(argc, argv);
}
