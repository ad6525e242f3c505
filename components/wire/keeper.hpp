#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "runtime/api/host.hpp"

namespace usher::wire {

/// A value that a component keeps over restarts. It goes to the disk beside the handlers, one write
/// at a time, the newest value next; while the disk takes nothing, again each second. What a crash
/// meanwhile loses are the last milliseconds.
class Keeper {
 public:
  /// `told` hears what became of each write, as a handler. Failures are counted under the key. What
  /// was kept and cannot be read ends the component: taken for none, an emergency stop would be
  /// forgotten.
  Keeper(runtime::Host& host, std::string key, std::function<void(const Status&)> told = {})
      : host_(host),
        key_(std::move(key)),
        told_(std::move(told)),
        failures_(host.health().counter(key_ + ": not kept")),
        again_(host.timer("keep " + key_, runtime::Duration{}, [this](auto) {
          again_.stop();
          waits_ = false;
          write();
        })) {
    const auto kept = host.kept(key_);
    if (!kept) host.fault("what was kept over the restart cannot be read: " + kept.error());
    if (*kept) found_.assign((*kept)->begin(), (*kept)->end());
    wanted_ = found_;
    kept_ = found_;
  }
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  /// What an earlier life kept; empty: nothing.
  const std::string& found() const { return found_; }

  /// At most 1 MB. No write when it is what was kept last.
  void keep(std::string_view value) {
    if (wanted_ == value) return;
    wanted_ = value;
    write();
  }

 private:
  static constexpr auto kWriting = std::chrono::milliseconds(5);  // in simulation
  static constexpr auto kAgain = std::chrono::seconds(1);

  void write() {
    if (writing_ || waits_ || wanted_ == kept_) return;
    writing_ = true;
    struct Job {
      std::string value;
      Status outcome;
    };
    const auto job = std::make_shared<Job>(Job{wanted_, {}});
    host_.offload(
        kWriting,
        [&host = host_, key = key_, job] {
          const auto* bytes = reinterpret_cast<const std::uint8_t*>(job->value.data());
          job->outcome = host.keep(key, {bytes, job->value.size()});
        },
        [this, job] { written(std::move(job->value), job->outcome); });
  }
  void written(std::string value, const Status& outcome) {
    writing_ = false;
    if (outcome) {
      kept_ = std::move(value);
    } else {
      kept_.reset();
      ++failures_;
      waits_ = true;
      again_.restart(kAgain);
    }
    if (told_) told_(outcome);
    write();
  }

  runtime::Host& host_;
  const std::string key_;
  std::function<void(const Status&)> told_;
  std::uint64_t& failures_;
  std::string found_, wanted_;
  std::optional<std::string> kept_;  ///< nothing: it could not be written
  bool writing_ = false;             ///< a value is on its way
  bool waits_ = false;               ///< after a failure
  runtime::Timer again_;
};

}  // namespace usher::wire
