// What it costs to turn messages into bytes and back, and how much of it is judging bytes from
// outside.
#include <cstdlib>
#include <memory>

#include "idl/topics.hpp"
#include "runtime/dds/message_layout.hpp"
#include "runtime/dds/message_types.hpp"
#include "support/bench.hpp"

namespace {

using namespace usher::runtime;

template <class Message>
void measure(usher::bench::Bench& bench, const std::string& name, const Message& message) {
  const MessageType& type = message_type<Message>();
  const MessageLayout& layout = *MessageLayouts::built_in().find(type.name);
  auto cdr = std::make_shared<Bytes>();
  if (!type.serialize(&message, *cdr)) std::abort();
  bench.time(name + "_judge_us", 1e-6, [cdr, &layout] {
    if (!is_well_formed(layout, *cdr)) std::abort();
  });
  bench.time(name + "_decode_us", 1e-6, [cdr, &type] {
    if (type.deserialize(*cdr) == nullptr) std::abort();
  });
  bench.time(name + "_encode_us", 1e-6, [cdr, message, &type] { type.serialize(&message, *cdr); });
}

}  // namespace

int main(int argc, char** argv) {
  using usher::bench::Bound;
  usher::bench::Bench bench("messages",
                            "costmap 200x200, scan of 541 beams, path of 200 poses, drive command");
  usher_msgs::msg::Costmap costmap;
  costmap.costs().resize(40000);
  sensor_msgs::msg::LaserScan scan;
  scan.ranges().resize(541);
  nav_msgs::msg::Path path;
  path.poses().resize(200);
  measure(bench, "costmap", costmap);
  measure(bench, "scan", scan);
  measure(bench, "path", path);
  measure(bench, "drive_command", usher_msgs::msg::DriveCommand{});
  bench.target("costmap_judge_us", Bound::kAtMost, 1.0);
  return bench.run(argc, argv);
}
