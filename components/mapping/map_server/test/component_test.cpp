#include "mapping/map_server/shell/component.hpp"

#include <gmock/gmock.h>

#include "foundation/grid/map_file.hpp"
#include "runtime/testing/test_host.hpp"
#include "support/folder.hpp"
#include "wire/conversions.hpp"

namespace usher::map_server {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

runtime::ComponentFactory factory() {
  return runtime::component_factory<MapServerComponent>("map_server");
}

class Component : public testing::Test {
 protected:
  std::string saved_map() {
    grid::OccupancyGrid map({20, 10, 0.1, -1.0, 2.0}, grid::kFree);
    map.at({3, 4}) = grid::kOccupied;
    const std::string path = folder.path() + "/map.yaml";
    const auto status = grid::save_map(map, path);
    EXPECT_TRUE(status) << status.error();
    return "site.map: " + path;
  }
  test::Folder folder;
};

TEST_F(Component, PublishesTheSitesMap) {
  runtime::TestHost host(factory(), saved_map());
  host.run_for(milliseconds(100));
  const auto message = host.last(topics::kMap);
  ASSERT_TRUE(message);
  const auto map = wire::from_message(*message);
  ASSERT_TRUE(map) << map.error();
  EXPECT_EQ(map->width(), 20);
  EXPECT_EQ(map->at({3, 4}), grid::kOccupied);
  EXPECT_EQ(map->at({4, 4}), grid::kFree);
}

TEST_F(Component, PublishesItAgainAfterARestart) {
  runtime::TestHost host(factory(), saved_map());
  host.run_for(milliseconds(100));
  host.world().kill(host.name());
  host.run_for(milliseconds(100));
  host.clear();
  host.world().start(host.name());
  host.run_for(milliseconds(100));
  EXPECT_TRUE(host.last(topics::kMap));
}

TEST_F(Component, SaysThatNoMapIsSet) {
  runtime::TestHost host(factory());
  host.run_for(milliseconds(100));
  EXPECT_TRUE(host.running());
  EXPECT_THAT(host.heartbeat().reason(), HasSubstr("no map is set"));
  EXPECT_FALSE(host.last(topics::kMap));
}

TEST_F(Component, EndsWithTheReasonWhenTheMapCannotBeRead) {
  const auto refused = [](const std::string& path) {
    const auto status = runtime::TestHost::try_make(factory(), "site.map: " + path);
    return status ? std::string("made") : status.error();
  };
  EXPECT_THAT(refused(folder.path() + "/none.yaml"), HasSubstr("none.yaml"));
  const auto broken = folder.file("map.yaml", "image: map.pgm\nresolution: 0.05\norigin: [0, 0]\n");
  EXPECT_THAT(refused(broken), HasSubstr("map.yaml"));
  const auto no_image = folder.file("map2.yaml",
                                    "image: none.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n"
                                    "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
  EXPECT_THAT(refused(no_image), HasSubstr("none.pgm"));
}

}  // namespace
}  // namespace usher::map_server
