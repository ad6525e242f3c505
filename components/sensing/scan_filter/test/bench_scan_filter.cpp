// One 541-beam scan through the filter, upright and leaning.
#include <algorithm>
#include <cmath>
#include <vector>

#include "foundation/geometry/angle.hpp"
#include "foundation/random/random.hpp"
#include "sensing/scan_filter/core/scan_filter.hpp"
#include "support/bench.hpp"

int main(int argc, char** argv) {
  using usher::bench::Bound;
  using usher::geometry::radians;
  // A corridor 1.4 m wide that ends after 12 m.
  usher::Random random(1);
  std::vector<float> ranges;
  for (int i = 0; i < 541; ++i) {
    const double angle = radians(-135.0 + 0.5 * i);
    const double side = 0.7 / std::max(1e-3, std::abs(std::sin(angle)));
    const double end = std::cos(angle) > 0.0 ? 12.0 / std::cos(angle) : 1e9;
    ranges.push_back(static_cast<float>(std::min({side, end, 19.0}) + 0.012 * random.gaussian()));
  }
  const usher::scan_filter::ScanGeometry geometry{radians(-135.0), radians(0.5), 0.05, 20.0};
  auto filter = usher::scan_filter::ScanFilter::make({}).value();
  usher::scan_filter::PlanarScan out;
  bool ok = true;
  const auto run = [&](double pitch) {
    ok = filter.filter(geometry, ranges, {pitch, 0.0}, out).ok() && ok;
  };

  usher::bench::Bench bench("scan_filter", "541 beams in a corridor, LMS100 on MARVIN");
  bench.time("upright_us", 1e-6, [&] { run(0.0); });
  bench.time("leaning_us", 1e-6, [&] { run(radians(5.0)); });
  bench.instructions("upright_instructions", [&] { run(0.0); });
  bench.instructions("leaning_instructions", [&] { run(radians(5.0)); });
  bench.target("upright_instructions", Bound::kAtMost, 130000.0);
  bench.target("leaning_instructions", Bound::kAtMost, 130000.0);
  bench.target("leaning_us", Bound::kAtMost, 15.0);
  bench.target("upright_us", Bound::kAtMost, 15.0);
  const int code = bench.run(argc, argv);
  return ok ? code : 1;
}
