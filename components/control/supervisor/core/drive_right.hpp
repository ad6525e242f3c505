#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/base_obedience/core/base_obedience.hpp"

namespace usher::supervisor {

using drive::Time;
using drive::WriterId;

/// A writer of drive/command as discovery sees it.
struct WriterSighting {
  WriterId writer{};
  std::string participant;  ///< its name, self-declared
  std::string host;         ///< self-declared
};

/// Finds the one writer that may drive, and whoever else tries to.
///
/// The holder is the first live writer whose participant has the manifest's name. Any writer of
/// another name is foreign. A second writer of the right name may be the restart of a holder that
/// died and whose end discovery has not noticed yet: it waits until the holder is seen dead, and is
/// foreign as soon as the holder shows life while both are there.
class DriveRight {
 public:
  /// A sign of life that comes within `slack` after the second writer appeared may have been under
  /// way when the holder died.
  explicit DriveRight(std::string participant, Time slack = std::chrono::milliseconds(50));

  void appeared(const WriterSighting& sighting, Time now);
  /// Discovery lost the writer, or the launcher says that its process ended.
  void gone(const WriterId& writer);
  /// Any message of the participant that owns `writer` arrived.
  void alive(const WriterId& writer, Time now);

  /// Who may drive, if anybody.
  std::optional<WriterId> holder() const;

  /// The oldest writer that must not be there; null when there is none.
  const WriterSighting* foreign() const;

  std::size_t writers() const { return known_.size(); }
  bool knows(const WriterId& writer) const;

 private:
  enum class Role { kHolder, kWaiting, kForeign };
  struct Known {
    WriterSighting sighting;
    Time since{};
    Role role = Role::kForeign;
  };
  static constexpr std::size_t kMostWriters = 64;  ///< more are foreign without being listed

  std::string participant_;
  Time slack_;
  std::vector<Known> known_;  ///< in order of appearance
};

}  // namespace usher::supervisor
