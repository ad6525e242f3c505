#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/base_obedience/core/writer_right.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::movement_control {

/// A topic that moves the robot, heard from those only who hold the right to write it by the
/// manifest: of a name the first one, until discovery sees that it has left, and then nobody who
/// claimed the name beside it. Whoever else writes is counted. Without a manifest (tests) everybody
/// may.
template <class Message>
class RightfulInput {
 public:
  /// `on_sample` runs for each sample that is heard.
  RightfulInput(runtime::Host& host, const topics::Topic<Message>& topic,
                const runtime::InputOptions& options,
                const std::vector<drive::NamedComponent>& manifest, std::function<void()> on_sample)
      : host_(host),
        anybody_(manifest.empty()),
        right_(drive::allowed_writers(topic.writers, manifest)),
        foreign_(host.health().counter(std::string(topic.name) + ": foreign writer")),
        on_sample_(std::move(on_sample)),
        input_(host.input(topic, options, [this](const auto&, const auto& info) {
          right_.alive(info.writer, host_.now().time_since_epoch());
          if (!may_write(info.writer)) {
            ++foreign_;
          } else if (on_sample_) {
            on_sample_();
          }
        })) {
    host.watch_writers(std::string(topic.name), [this](const runtime::WriterInfo& writer) {
      if (writer.alive) {
        right_.appeared({writer.guid, writer.participant, writer.host},
                        host_.now().time_since_epoch());
      } else {
        right_.gone(writer.guid);
      }
    });
  }
  RightfulInput(const RightfulInput&) = delete;
  RightfulInput& operator=(const RightfulInput&) = delete;

  /// The newest sample; null when it is older than declared, or of somebody who may not write.
  const Message* fresh() const {
    const Message* message = input_.fresh();
    return message != nullptr && may_write(input_.info()->writer) ? message : nullptr;
  }

 private:
  bool may_write(const runtime::Guid& writer) const { return anybody_ || right_.holds(writer); }

  runtime::Host& host_;
  const bool anybody_;
  drive::WriterRight right_;
  std::uint64_t& foreign_;
  std::function<void()> on_sample_;
  runtime::Input<Message> input_;
};

}  // namespace usher::movement_control
