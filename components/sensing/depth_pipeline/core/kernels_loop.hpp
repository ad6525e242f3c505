#pragma once

#include "sensing/depth_pipeline/core/kernels.hpp"

// One text of the loop for all instruction sets: `Lane` says how many unsigned 16-bit values are
// handled at once, and how. It calls nothing of the standard library: each set is compiled with its
// own flags, and an inline function shared with the rest of the program could end up with them.
namespace usher::depth_pipeline::kernels {

inline constexpr int round_up(int width) { return (width + 15) / 16 * 16; }

/// A measured row with kNothing for invalid pixels, and the border repeated.
template <class Lane>
void load_row(const Frame& frame, int row, std::uint16_t* out) {
  using V = typename Lane::V;
  const std::uint16_t* in = frame.depth + static_cast<long>(row) * frame.width;
  const V least = Lane::all(frame.least);
  int c = 0;
  for (; c + Lane::kSize <= frame.width; c += Lane::kSize) {
    const V v = Lane::load(in + c);
    Lane::store(out + c, Lane::either(v, Lane::flip(Lane::at_most(least, v))));
  }
  for (; c < frame.width; ++c) out[c] = in[c] < frame.least ? kNothing : in[c];
  for (int i = frame.width; i < round_up(frame.width) + kPad; ++i) out[i] = out[frame.width - 1];
  for (int i = 1; i <= kPad; ++i) out[-i] = out[0];
}

template <class Lane, bool kErode>
typename Lane::V extreme(typename Lane::V a, typename Lane::V b) {
  if constexpr (kErode) {
    return Lane::lower(a, b);
  } else {
    return Lane::higher(a, b);
  }
}

/// The minimum (erosion) or maximum (dilation) of 3 x 3 pixels.
template <class Lane, bool kErode>
void filter_row(const std::uint16_t* above, const std::uint16_t* middle, const std::uint16_t* below,
                int width, std::uint16_t* columns, std::uint16_t* out) {
  const int end = round_up(width);
  for (int c = 0; c < end; c += Lane::kSize) {
    const auto a = Lane::load(above + c);
    const auto m = Lane::load(middle + c);
    const auto b = Lane::load(below + c);
    Lane::store(columns + c, extreme<Lane, kErode>(extreme<Lane, kErode>(a, m), b));
  }
  columns[-1] = columns[0];
  for (int i = width; i < end + kPad; ++i) columns[i] = columns[width - 1];
  for (int c = 0; c < end; c += Lane::kSize) {
    const auto left = Lane::load(columns + c - 1);
    const auto middle_one = Lane::load(columns + c);
    const auto right = Lane::load(columns + c + 1);
    Lane::store(out + c, extreme<Lane, kErode>(extreme<Lane, kErode>(left, middle_one), right));
  }
  for (int i = width; i < end + kPad; ++i) out[i] = out[width - 1];
}

/// Keeps the nearest and the second nearest.
template <class Lane>
void keep_nearest(const Columns::Nearest& nearest, int c, typename Lane::V distance,
                  typename Lane::V row) {
  const auto first = Lane::load(nearest.first + c);
  const auto second = Lane::load(nearest.second + c);
  const auto first_row = Lane::load(nearest.first_row + c);
  const auto second_row = Lane::load(nearest.second_row + c);
  const auto kept = Lane::at_most(first, distance);  // the first stays
  const auto other = Lane::higher(first, distance);
  const auto other_row = Lane::choose(kept, row, first_row);
  const auto same = Lane::at_most(second, other);  // the second stays
  Lane::store(nearest.first + c, Lane::lower(first, distance));
  Lane::store(nearest.first_row + c, Lane::choose(kept, first_row, row));
  Lane::store(nearest.second + c, Lane::lower(second, other));
  Lane::store(nearest.second_row + c, Lane::choose(same, second_row, other_row));
}

/// Sorts the pixels of one opened row into obstacles, floor and what lies below.
template <class Lane>
void sort_row(const Frame& frame, int row, const std::uint16_t* opened, std::uint16_t* kept) {
  using V = typename Lane::V;
  const V nothing = Lane::all(kNothing);
  const V here = Lane::all(static_cast<std::uint16_t>(row));
  const V scale = Lane::all(frame.floor->scales()[row].forward);
  const V farthest = Lane::all(FloorPrediction::kMaxDepth);
  const Columns& columns = frame.columns;
  for (int strip = 0; strip < frame.floor->strips(); ++strip) {
    const RowLimits& limits = frame.floor->rows(strip)[row];
    const V obstacle_limit = Lane::all(limits.obstacle);
    const V high_limit = Lane::all(limits.high);
    const V fall_limit = Lane::all(limits.fall);
    const V floor = Lane::all(limits.floor);
    const V extent = Lane::all(frame.fall_extent);
    const int end = frame.floor->first_column(strip + 1);
    for (int c = frame.floor->first_column(strip); c < end; c += Lane::kSize) {
      const V v = Lane::load(opened + c);
      const V missing = Lane::equal(v, nothing);
      Lane::store(columns.valid + c,
                  Lane::subtract(Lane::add(Lane::load(columns.valid + c), Lane::all(1)),
                                 Lane::both(missing, Lane::all(1))));
      const V obstacle = Lane::at_most(v, obstacle_limit);
      Lane::store(kept + c, Lane::both(v, obstacle));
      if (Lane::any(obstacle)) {
        const V distance = Lane::high_product(Lane::times_four(Lane::lower(v, farthest)), scale);
        const V high = Lane::both(obstacle, Lane::at_most(v, high_limit));
        const V low = Lane::without(obstacle, high);
        keep_nearest<Lane>(columns.high, c, Lane::either(distance, Lane::flip(high)), here);
        if (Lane::any(low))
          keep_nearest<Lane>(columns.low, c, Lane::either(distance, Lane::flip(low)), here);
      }
      if (limits.floor == 0) continue;
      V below = Lane::at_most(fall_limit, v);
      if (!frame.missing_is_fall) below = Lane::without(below, missing);
      // A run keeps the distance at which it began, kNothing while there is none.
      const V begin =
          Lane::either(Lane::lower(Lane::load(columns.fall_begin + c), floor), Lane::flip(below));
      Lane::store(columns.fall_begin + c, begin);
      const V found = Lane::at_most(extent, Lane::subtract_to_zero(floor, begin));
      const V fall = Lane::load(columns.fall + c);
      Lane::store(columns.fall + c, Lane::choose(found, Lane::lower(fall, begin), fall));
    }
  }
}

template <class Lane>
void process(const Frame& frame) {
  const int last = frame.height - 1;
  std::uint16_t* const measured[3] = {frame.buffers[0], frame.buffers[1], frame.buffers[2]};
  std::uint16_t* const eroded[3] = {frame.buffers[3], frame.buffers[4], frame.buffers[5]};
  std::uint16_t* const opened = frame.buffers[6];
  std::uint16_t* const columns = frame.buffers[7];
  const auto clamp = [last](int row) { return row < 0 ? 0 : row > last ? last : row; };
  const auto load = [&](int row) { load_row<Lane>(frame, row, measured[row % 3]); };
  const auto erode = [&](int row) {
    filter_row<Lane, true>(measured[clamp(row - 1) % 3], measured[row % 3],
                           measured[clamp(row + 1) % 3], frame.width, columns, eroded[row % 3]);
  };
  // From the bottom up: runs below the floor begin near the robot.
  load(last);
  load(last - 1);
  if (frame.open) erode(last);
  for (int row = last; row >= 0; --row) {
    const std::uint16_t* sorted = measured[row % 3];
    if (frame.open) {
      if (row > 1) load(row - 2);
      if (row > 0) erode(row - 1);
      filter_row<Lane, false>(eroded[clamp(row - 1) % 3], eroded[row % 3],
                              eroded[clamp(row + 1) % 3], frame.width, columns, opened);
      sorted = opened;
    } else if (row < last - 1) {
      load(row);
    }
    // The last row buffer holds what is kept, since the image's rows need not be padded.
    sort_row<Lane>(frame, row, sorted, columns);
    std::uint16_t* out = frame.processed + static_cast<long>(row) * frame.width;
    __builtin_memcpy(out, columns, static_cast<unsigned long>(frame.width) * sizeof(*out));
  }
}

}  // namespace usher::depth_pipeline::kernels
